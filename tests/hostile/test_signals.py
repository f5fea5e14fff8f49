"""SIGINT, SIGTERM and SIGHUP at any moment: every output whole or absent, nothing temporary left, exit code 128 + n (run:
0). The delays sweep the program's own time, measured first; what is asserted holds at any of them."""
import os
import shutil
import signal
import subprocess
import time

from common import SCENE, SERIAL, TRACE_HEAD, await_handlers, check, finish, folder, leftovers, path, read, rows, run, start, wait, write

TURNS = int(os.environ.get("TURNS", "3"))  # per command; more on request
scene = write("scene.yaml", SCENE)
trace = write("hand.csv", TRACE_HEAD + rows(200))
long_trace = write("long.csv", TRACE_HEAD + rows(60000))
recording = write("poses.txt", "".join(f"{i}.5 0 0.1 0.2 0 0 0 1\n" for i in range(100000)))
log = path("good.log")
assert run("replay", scene, trace, "--log", log).code == 0
device = "trace:speed=1000000,file=" + long_trace
temporary = path("tmp")
os.mkdir(temporary)
os.environ["TMPDIR"] = temporary  # where plot works

# What an output that is whole looks like: its end.
ENDS = {".csv": lambda d: d.endswith(b"\n"), ".log": lambda d: d.endswith(b"\n"), ".json": lambda d: d.endswith(b"}\n"),
        ".png": lambda d: d.endswith(b"IEND\xaeB`\x82"), ".html": lambda d: d.rstrip().endswith(b"</html>"),
        ".svg": lambda d: d.rstrip().endswith(b"</svg>"), ".mkv": lambda d: d.startswith(b"\x1aE\xdf\xa3")}

video = ["--video", "OUT/v.mkv"] if run("replay", scene, trace, "--size", "160x120", "--video", path("v.mkv"),
                                        before=None).code == 0 else []
COMMANDS = {
    "replay": ["replay", scene, trace, "--log", "OUT/l.log", "--events", "OUT/e.csv", "--timing", "OUT/t.json",
               "--frames", "OUT/frames", "--size", "160x120", "--report", "OUT/r.html", *video],
    "replay-long": ["replay", scene, long_trace, "--log", "OUT/l.log", "--events", "OUT/e.csv"],
    "still": ["still", scene, trace, "--sheet", "--out", "OUT/s.png"],
    "plot": ["plot", log, "--figure", "all", "--out", "OUT/plots", "--format", "svg"],
    "check": ["check", scene, long_trace],
    "explain": ["explain", scene, long_trace],
    "trade": ["bench", "trade", "--quick", scene, trace, "--csv", "OUT/trade.csv"],
    "validate": ["bench", "validate", "--quick", "--csv", "OUT/validate.csv"],
    "run": ["run", scene, "--device", device, "--log", "OUT/l.log", "--events", "OUT/e.csv", "--timing", "OUT/t.json",
            "--record", "OUT/record.csv"],
    "run-pictures": ["run", scene, "--device", "trace:file=" + trace, "--frames", "OUT/frames", "--size", "160x120",
                     "--record", "OUT/record.csv", "--log", "OUT/l.log", *video],
    "run-auto": ["run", scene, "--device", device, "--accuracy", "auto", "--log", "OUT/l.log"],
    "monitor": ["monitor", "--plain", "--device", device],
    "convert": ["convert", recording, "OUT/c.csv"],
    "extremes": ["bench", "extremes", scene, long_trace, "--csv", "OUT/x.csv"],
    "devices": ["bench", "devices", "--quick", "--csv", "OUT/d.csv"],
}
LIVE = ("run", "monitor")  # end with 0 once they have begun


def signalled(name, out, after, number):
    """Starts, signals after a while, and waits."""
    process = start([a.replace("OUT", out) for a in COMMANDS[name]], before=None, stdout=subprocess.PIPE)
    time.sleep(after)
    process.send_signal(number)
    return wait(process)


def judge(name, what, done, number, out):
    files = [os.path.join(at, n) for at, _, names in os.walk(out) for n in names]
    early = done.code == 1000 + number and not files  # before main() could catch anything
    # It may have ended before.
    check(f"{what}: code", done.code in (0, 128 + number) or early, done)
    check(f"{what}: quiet", done.code == 0 or not done.lines or COMMANDS[name][0] in LIVE, done)
    check(f"{what}: no sanitizer", "Sanitizer" not in done.err and "runtime error" not in done.err, done)
    for file in files:
        whole = ENDS[os.path.splitext(file)[1]](read(file))
        check(f"{what}: {os.path.basename(file)} is whole", whole, os.path.getsize(file))
    if done.code == 128 + number and name != "plot" and COMMANDS[name][0] not in LIVE:
        check(f"{what}: no output", not files, files)
    if os.path.exists(out + "/record.csv") and done.code == 0:
        same = [len([line for line in read(out + n).split(b"\n") if line[:1].isdigit()])
                for n in ("/record.csv", "/l.log")]
        check(f"{what}: as many rows as samples", same[0] == same[1], (same, done))
    pictures = [f for f in files if "/frames/" in f]
    check(f"{what}: all pictures or none", len(pictures) in (0, 62) or name == "run-pictures", len(pictures))
    left = leftovers() + [os.path.join(temporary, n) for n in os.listdir(temporary)]
    check(f"{what}: nothing left", not left, left)
    for file in left:
        shutil.rmtree(file, ignore_errors=True)


def sweep(name):
    out = path("out")
    shutil.rmtree(out, ignore_errors=True)
    os.mkdir(out)
    begun = time.monotonic()
    done = run(*[a.replace("OUT", out) for a in COMMANDS[name]], before=None)
    length = time.monotonic() - begun
    check(f"{name}: undisturbed", done.code == 0, done)
    ended = 0
    for i in range(TURNS):
        number = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)[i % 3]
        shutil.rmtree(out)
        os.mkdir(out)
        after = length * (i + 0.5) / TURNS
        done = signalled(name, out, after, number)
        judge(name, f"{name}, {signal.Signals(number).name} after {after * 1000:.0f} of {length * 1000:.0f} ms", done,
              number, out)
        ended += done.code > 128
        length *= 0.5 if done.code == 0 and COMMANDS[name][0] not in LIVE else 1  # measured on a busier machine than now
    check(f"{name}: some were ended", ended > 0 or COMMANDS[name][0] in LIVE, ended)


def waiting_readers():
    """Nobody writes the pipe that they read: a signal still ends them."""
    commands = [["replay", scene, "PIPE"], ["check", scene, "PIPE"], ["check", "PIPE"], ["explain", scene, "PIPE"],
                ["plot", "PIPE", "--out", path("p.svg"), "--figure", "9"], ["bench", "trade", scene, "PIPE"],
                ["bench", "extremes", scene, "PIPE"], ["convert", "PIPE", path("c.csv"), "--from", "tum"],
                ["convert", "PIPE", path("c.csv"), "--from", "serial"],
                ["still", scene, "PIPE", "--at", "0", "--out", path("p.png")],
                ["run", "PIPE", "--device", device], ["run", scene, "--device", device, "--tracker", "PIPE"],
                ["run", scene, "--device", "trace:file=PIPE"], ["run", scene, "--device", "recording:file=PIPE"],
                ["monitor", "--plain", "--device", "recording:file=PIPE"], ["monitor", "--plain", "--device", "trace:file=PIPE"]]
    for open_first in (False, True):
        waiting = []
        for i, command in enumerate(commands):
            pipe = path(f"pipe{i}")
            if not open_first:
                os.mkfifo(pipe)
            process = start([a.replace("PIPE", pipe) for a in command], before=None)
            waiting.append((command, process, os.open(pipe, os.O_WRONLY) if open_first else -1))
        for _, process, _ in waiting:
            await_handlers(process)
        time.sleep(0.1)
        for _, process, _ in waiting:
            process.terminate()
        ended = [wait(process) for _, process, _ in waiting]
        for (command, _, fd), done in zip(waiting, ended):
            if fd >= 0:
                os.close(fd)
            what = " ".join(command).replace(folder, ".") + (", opened" if open_first else "")
            # Opening a device is not yet running, and one that has not opened may not have got to main().
            want = [143] + [0] * (command[0] in LIVE) + [1015] * (not open_first)
            check(f"{what}: ended", done.code in want, done)
        check("waiting readers: nothing left", not leftovers(), leftovers())


def stalled_writers():
    """A device that gave samples and then blocks in the middle of a read: what it gave is written."""
    out = path("stalled")
    for command in (["run", scene, "--device", "recording:file=PIPE", "--log", out + "/l.log"],
                    ["monitor", "--plain", "--device", "recording:file=PIPE"]):
        shutil.rmtree(out, ignore_errors=True)
        os.mkdir(out)
        pipe = path("stalled.pipe")
        os.mkfifo(pipe)
        process = start([a.replace("PIPE", pipe) for a in command], before=None)
        fd = os.open(pipe, os.O_WRONLY)
        os.write(fd, SERIAL.encode())
        await_handlers(process)
        time.sleep(1)
        process.terminate()
        done = wait(process)
        os.close(fd)
        os.remove(pipe)
        check(f"{command[0]}, stalled: ended", done.code == 0, done)
        if command[0] == "run":
            lines = [line for line in read(out + "/l.log").split(b"\n") if line[:1].isdigit()]
            check("run, stalled: what came is written", len(lines) > 10, len(lines))
    check("stalled: nothing left", not leftovers(), leftovers())


def a_gap_of_years():
    """Pictures of a trace with a gap that would take for ever to draw."""
    gap = write("gap.csv", TRACE_HEAD + rows(2) + rows(2, rate=1, start=3000000000))
    process = start(["replay", scene, gap, "--frames", path("gap"), "--size", "160x120"], before=None)
    await_handlers(process)
    time.sleep(0.3)
    process.terminate()
    done = wait(process)
    check("a gap of years can be ended", done.code == 143 and not os.path.exists(path("gap")), done)


for command in COMMANDS:
    sweep(command)
waiting_readers()
stalled_writers()
a_gap_of_years()
finish()
