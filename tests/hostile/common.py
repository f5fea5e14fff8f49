"""What the hostile tests share: good files to spoil, and the program run under a limit of memory and time."""
import os
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time

STICTION = os.environ["STICTION"]
SANITIZED = os.environ.get("SANITIZED") == "1"  # address sanitizer: shadow memory instead of a limit
MEMORY = 256 << 20
folder = tempfile.mkdtemp(prefix="stiction-hostile-")
failures = 0
checks = 0

SCENE = """stiction: 1
name: hostile
object:
  size: [0.16, 0.08, 0.10]
  pose: {x: 0.10, y: 0.20, angle_deg: 20}
hand: {stiffness: 200, rotational_stiffness: 0.5}
friction: {static: 0.5, dynamic: 0.3}
surfaces:
  - {name: floor, point: [0, 0], normal_deg: 90}
"""
PACKET = "80 00 07 68 7f 6c 3c 00 00 01 03 10 6d 30 00 04"  # of the ultrasonic tracker
SERIAL = "# stiction-serial 1\n" + "".join(f"{20000000 * i} {PACKET}\n" for i in range(30))
TRACE_HEAD = "# stiction-trace 1\nt,x,y,z,qx,qy,qz,qw,buttons\n"


def rows(count, rate=100, start=0):
    return "".join(f"{(start + i) / rate:.9f},{0.1 + 0.0001 * (i % 500):.6f},{max(0.05, 0.16 - 0.001 * i):.6f},0,"
                   f"0,0,0.1736,0.9848,1\n" for i in range(count))


def check(what, good, found=""):
    global failures, checks
    checks += 1
    if not good:
        failures += 1
        print(f"FAIL {what}: {found}", flush=True)


def path(*names):
    return os.path.join(folder, *names)


def write(name, data):
    with open(path(name), "wb") as file:
        file.write(data.encode() if isinstance(data, str) else data)
    return path(name)


def read(name):
    with open(name, "rb") as file:
        return file.read()


def limit():
    if not SANITIZED:
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))


def big_limit():  # llvmpipe and libx264 map more than they use
    pass


class Done:
    def __init__(self, process, out, err):
        self.code = process.returncode if process.returncode >= 0 else 1000 - process.returncode
        self.out, self.err = out, err
        self.lines = [line for line in err.split("\n") if line]

    def __repr__(self):
        return f"exit {self.code}, said {self.err[:600]!r}"


def start(arguments, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, before=limit):
    return subprocess.Popen([STICTION, *arguments], stdin=stdin, stdout=stdout, stderr=subprocess.PIPE,
                            preexec_fn=before)


def await_handlers(process):
    """Until the program catches SIGTERM, or has ended: a signal before that is not its own."""
    while process.poll() is None:
        with open(f"/proc/{process.pid}/status", encoding="ascii") as status:
            caught = next(int(line.split()[1], 16) for line in status if line.startswith("SigCgt"))
        if caught >> (signal.SIGTERM - 1) & 1:
            return
        time.sleep(0.005)


def wait(process, timeout=500):  # hung, however loaded the machine is
    try:
        out, err = process.communicate(timeout=timeout)
    except subprocess.TimeoutExpired:
        process.kill()
        out, err = process.communicate()
        err += b"\nHUNG"
    return Done(process, (out or b"").decode(errors="replace"), err.decode(errors="replace"))


def run(*arguments, **options):
    return wait(start(arguments, **options))


def leftovers():
    """Temporary files of ours, anywhere below the folder."""
    found = []
    for at, folders, files in os.walk(folder):
        found += [os.path.join(at, n) for n in folders + files if n.endswith(".tmp") or n.startswith(".")]
    return found


def finish():
    shutil.rmtree(folder, ignore_errors=True)
    print(f"{checks} checks, {failures} failed")
    sys.exit(1 if failures else 0)
