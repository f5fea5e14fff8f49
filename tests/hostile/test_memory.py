"""Every allocation of this project's own code fails once, and once with all after it, in every command: no crash, no
leak, exit code 6 and one message, or all that had been asked for. FULL=1 leaves none out; FIRST=N
begins with the N-th command."""
import os
import shutil
import subprocess
import time

from common import SCENE, STICTION, TRACE_HEAD, check, finish, folder, leftovers, path, read, rows, run, write

FULL = os.environ.get("FULL") == "1"
PRELOAD = os.environ["PRELOAD"]
scene = write("scene.yaml", SCENE)
trace = write("hand.csv", TRACE_HEAD + rows(150))
short = write("short.csv", TRACE_HEAD + rows(20))
log = path("good.log")
assert run("replay", scene, trace, "--log", log).code == 0
serial = write("serial.txt", "# stiction-serial 1\n" + "".join(
    f"{20000000 * i} 80 00 07 68 7f 6c 3c 00 00 01 03 10 6d 30 00 04\n" for i in range(30)))
tracker = write("tracker.yaml", "stiction: 1\ntracker: {scale: 1}\n")
poses = write("poses.txt", "".join(f"{i}.5 0 0.1 0.2 0 0 0 1\n" for i in range(300)))
os.environ.pop("DISPLAY", None)  # no window is opened
os.environ.pop("WAYLAND_DISPLAY", None)
device = "trace:speed=1000000,file=" + trace
has_video = run("replay", scene, short, "--size", "160x120", "--video", path("v.mkv"), before=None).code == 0
report = path("report")

COMMANDS = [
    ["check", scene, trace, "--set", "friction.static=0.6", "--set", "hand.reach=1"],
    ["replay", scene, trace, "--log", "OUT/l.log", "--events", "OUT/e.csv", "--timing", "OUT/t.json", "--set",
     "friction.static=0.6"],
    ["replay", scene, trace, "--log", "-", "--accuracy", "substep=3", "--precision", "f80"],
    ["replay", scene, short, "--frames", "OUT/frames", "--size", "160x120"],
    ["replay", scene, short, "--report", "OUT/r.html", "--size", "160x120", *(["--video", "OUT/v.mkv"] * has_video)],
    ["explain", scene, trace], ["explain", scene],
    ["still", scene, short, "--at", "0", "--out", "OUT/s.png", "--size", "160x120"],
    ["still", scene, trace, "--sheet", "--out", "OUT/s.png", "--size", "160x120"],
    ["plot", log, "--scene", scene, "--figure", "10", "--out", "OUT/p.svg"],
    ["run", scene, "--device", device, "--record", "OUT/r.csv", "--log", "OUT/l.log"],
    ["run", scene, "--device", "spacemouse"], ["run", scene, "--device", "hydra"],
    ["run", scene, "--device", "logitech:port=/dev/null"],
    ["run", scene, "--device", "recording:speed=1000000,file=" + serial, "--log", "OUT/l.log", "--tracker", tracker],
    ["run", scene, "--device", device, "--accuracy", "auto", "--log", "OUT/l.log"],
    ["run", scene, "--device", "mouse", "--view"],
    ["run", scene, "--device", "trace:speed=1000000,file=" + short, "--frames", "OUT/frames", "--size", "160x120"],
    ["monitor", "--plain", "--device", device], ["monitor", "--plain", "--device", "recording:speed=1000000,file=" + serial],
    ["devices"], ["devices", "--json"], ["explain", scene, "--json"],
    ["convert", serial, "OUT/c.csv", "--tracker", tracker], ["convert", poses, "OUT/c.csv"],
    ["bench", "extremes", scene, short, "--csv", "OUT/x.csv"],
    ["bench", "trade", "--quick", scene, short, "--csv", "OUT/trade.csv"],
]


def attempt(command, **environment):
    """Done, and how many allocations there were and how many were left."""
    out = path("out")
    shutil.rmtree(out, ignore_errors=True)
    os.mkdir(out)
    env = dict(os.environ, LD_PRELOAD=PRELOAD, FAIL_REPORT=report, **{k: str(v) for k, v in environment.items()})
    if os.path.exists(report):
        os.unlink(report)
    process = subprocess.run([STICTION, *[a.replace("OUT", out) for a in command]], env=env, capture_output=True,
                             timeout=120)
    err = process.stderr.decode(errors="replace")
    numbers = [int(n) for n in read(report).split()] if os.path.exists(report) else [0, 0]
    return process.returncode, [line for line in err.split("\n") if line], numbers


def files_of(out):
    return sorted(os.path.relpath(os.path.join(at, n), out) for at, _, names in os.walk(out) for n in names)


def chosen(count, slow):
    """All of them on request and where a run takes milliseconds; else the first ones and some of the rest."""
    first, some = (2, 2) if slow else (10, 4)
    if FULL or count <= first + some:
        return range(1, count + 1)
    return [*range(1, first + 1), *(first + (i + 1) * (count - first) // some for i in range(some))]


def sweep(command):
    usual, _, (count, left) = attempt(command)
    name = " ".join(command).replace(folder, ".")
    whole = files_of(path("out"))
    if FULL:
        print(time.strftime("%H:%M:%S"), count, name, flush=True)
    check(f"{name}: undisturbed", usual in (0, 4, 5) and left == 0 and count > 0, (usual, count, left))
    slow = command[0] == "bench" or "auto" in command or any("160x120" in a for a in command)
    for how in ("FAIL_AT", "FAIL_FROM"):
        for n in chosen(count, slow):
            code, lines, (_, left) = attempt(command, **{how: n})
            what = f"{name}: {how}={n} of {count}"
            check(f"{what}: code", code in (6, usual), (code, lines))
            told = sum("memory" in line and "memory locked" not in line and "the page draws" not in line for line in lines)
            check(f"{what}: message", code != 6 or told == 1 or (command[0] == "check" and told > 1), (code, lines))
            check(f"{what}: freed", left == 0, (left, lines))
            made = files_of(path("out"))
            check(f"{what}: whole or absent", set(made) <= set(whole) and (code == 6 or made == whole), (code, made))
            check(f"{what}: nothing left", not leftovers(), leftovers())
    return count


def sweep_others():
    """Allocations of the C library and of libyaml as well. popt ends the program itself (1, "virtual memory
    exhausted") or loses the arguments. ODE is left out: it is C++ and aborts or crashes, in stic_sim_create() only."""
    command = COMMANDS[0]
    _, _, (count, _) = attempt(command, FAIL_ALL=1)
    for n in range(1, count + 1, 1 if FULL else 1 + count // 80):
        code, lines, (_, left) = attempt(command, FAIL_ALL=1, FAIL_AT=n)
        of_popt = any(part in line for part in ("virtual memory exhausted", "opt->arg", "arguments are missing")
                      for line in lines)
        what = f"check, any library: {n} of {count}"
        check(f"{what}: code", code in (0, 6) or of_popt, (code, lines))
        check(f"{what}: message", code == 0 or any("memory" in line for line in lines) or of_popt, lines)
        check(f"{what}: freed", left == 0 or of_popt, left)


first = int(os.environ.get("FIRST", "0"))
total = sum(sweep(command) for command in COMMANDS[first:])
sweep_others()
print(f"{total} allocations in {len(COMMANDS) - first} commands")
finish()
