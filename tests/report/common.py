"""What the tests of report and plots share."""
import os
import subprocess
import sys
import tempfile

STICTION = os.environ["STICTION"]
MAKE_PAGE = os.environ.get("MAKE_PAGE", "")
OUT = os.environ.get("OUT") or tempfile.gettempdir()
failures = 0


def skip(reason):
    print("skipped:", reason)
    sys.exit(1 if os.environ.get("CI") == "true" else 77)


def check(what, good, found=""):
    global failures
    if not good:
        failures += 1
    print(("ok   " if good else "FAIL ") + what + (f": {found}" if found != "" and not good else ""))


def equal(what, found, expected):
    check(what, found == expected, f"found {found!r}, expected {expected!r}")


def run(*arguments, env=None, program=STICTION, stdin=subprocess.DEVNULL):
    return subprocess.run([program, *arguments], capture_output=True, text=True, env=env, stdin=stdin)


SCENE = """stiction: 1
name: <b>drag</b> & 'turn'
object:
  size: [0.16, 0.08, 0.10]
  pose: {x: 0.10, y: 0.14, angle_deg: 40}
hand:
  stiffness: 200
  rotational_stiffness: 0.5
friction: {static: 0.6, dynamic: 0.3}
surfaces:
  - {name: floor_{x}^2, point: [0, 0], normal_deg: 90}
""".replace("floor_{x}^2", "floor_x^2")


def trace(seconds=6.0, rate=31):
    """A corner is put down, dragged and lifted."""
    lines = ["# stiction-trace 1", "t,x,y,z,qx,qy,qz,qw,buttons"]
    for i in range(int(seconds * rate) + 1):
        t = i / rate
        y = 0.14 - 0.076 * min(t, 1) if t < seconds - 1 else 0.064 + 0.08 * (t - seconds + 1)
        x = 0.10 + (0.04 * (t - 1) if t > 1 else 0)
        lines.append(f"{t:.9f},{x:.9f},{y:.9f},0,0,0,0.34202014332566871,0.93969262078590843,1")
    return "\n".join(lines) + "\n"


def write(path, text):
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
    return path


def rows(path):
    with open(path, encoding="utf-8") as file:
        lines = [line.rstrip("\n").split(",") for line in file if not line.startswith("#")]
    return [dict(zip(lines[0], line)) for line in lines[1:]]


def finish():
    print("all good" if failures == 0 else f"{failures} failed")
    sys.exit(1 if failures else 0)
