"""`stiction monitor` in a pseudo terminal: what stands on the screen, keys, and the terminal left as found."""
import os
import pty
import re
import select
import signal
import struct
import subprocess
import sys
import tempfile
import termios
import time
import fcntl

PROGRAM, EMULATOR, OUT = os.environ["STICTION"], os.environ["EMULATOR"], os.environ["OUT"]
ROWS, COLUMNS = 24, 80
failures = 0
folder = tempfile.mkdtemp(prefix="stiction-monitor-")


def check(name, good, shown=""):
    global failures
    failures += not good
    print(("ok   " if good else "FAIL ") + name + ("" if good else f": {shown}"))


class Screen:
    """As much of a terminal as the program uses; anything else fails."""

    def __init__(self):
        self.lines = [[" "] * COLUMNS for _ in range(ROWS)]
        self.row = self.column = 0
        self.alternate, self.cursor, self.wrap, self.pages = False, True, True, 0
        self.strange, self.lowest = [], 0
        self.rest = ""

    def feed(self, text):
        text = self.rest + text
        at = 0
        self.rest = ""
        while at < len(text):
            c = text[at]
            if c == "\033":
                match = re.match(r"\033\[(\??)([0-9;]*)([A-Za-z])", text[at:])
                if not match:
                    self.rest = text[at:]
                    return
                self.escape(*match.groups())
                at += match.end()
                continue
            at += 1
            if c == "\r":
                self.column = 0
            elif c == "\n":
                self.row += 1
                self.lowest = max(self.lowest, self.row if self.alternate else 0)
                if self.row == ROWS and self.alternate:
                    self.strange.append("the page is too high")
                self.row = min(self.row, ROWS - 1)
            elif self.column < COLUMNS:
                self.lines[self.row][self.column] = c
                self.column += 1
            elif self.alternate:
                self.strange.append(f"row {self.row} is too long: {c!r}")

    def escape(self, private, numbers, letter):
        if letter == "H" and not numbers:
            self.row = self.column = 0
            self.pages += 1
        elif letter == "K":
            self.lines[self.row][self.column:] = [" "] * (COLUMNS - self.column)
        elif letter == "J":
            if numbers != "2":
                self.lines[self.row][self.column:] = [" "] * (COLUMNS - self.column)
            for row in range(0 if numbers == "2" else self.row + 1, ROWS):
                self.lines[row] = [" "] * COLUMNS
        elif private and numbers == "1049":
            self.alternate = letter == "h"
        elif private and numbers == "7":
            self.wrap = letter == "h"
        elif private and numbers == "25":
            self.cursor = letter == "h"
        elif letter != "m":
            self.strange.append(private + numbers + letter)

    def text(self):
        return "\n".join("".join(line).rstrip() for line in self.lines)


class Monitor:
    def __init__(self, *arguments, utf8=True, rows=ROWS, columns=COLUMNS, term="xterm"):
        self.master, slave = pty.openpty()
        fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))
        self.slave = slave
        self.found = termios.tcgetattr(slave)
        self.screen = Screen()
        self.raw = b""
        environment = {**os.environ, "LC_ALL": "C.UTF-8" if utf8 else "C", "TERM": term}
        self.child = subprocess.Popen([PROGRAM, "monitor", *arguments], stdin=slave, stdout=slave,
                                      stderr=subprocess.PIPE, env=environment, start_new_session=True,
                                      preexec_fn=lambda: fcntl.ioctl(slave, termios.TIOCSCTTY, 0))

    def read(self, seconds, until=None):
        end = time.monotonic() + seconds
        while time.monotonic() < end and not (until and until(self.screen)):
            if not select.select([self.master], [], [], 0.05)[0]:
                if self.child.poll() is not None:
                    break
                continue
            self.raw += os.read(self.master, 65536)
            good = len(self.raw)
            while good > 0:  # a character may be cut
                try:
                    self.screen.feed(self.raw[:good].decode())
                    break
                except UnicodeDecodeError:
                    good -= 1
            self.raw = self.raw[good:]
        return self.screen

    def key(self, key):
        os.write(self.master, key.encode())

    def end(self, name, how, code=0):
        how()
        self.read(20, lambda s: self.child.poll() is not None)
        self.read(1)
        self.child.wait(20)
        check(f"{name}: exit code {code}", self.child.returncode == code,
              f"{self.child.returncode}: {self.child.stderr.read().decode()}")
        check(f"{name}: the terminal is as found",
              termios.tcgetattr(self.slave) == self.found and not self.screen.alternate and self.screen.cursor)
        check(f"{name}: nothing strange was written", self.screen.strange == [], self.screen.strange[:3])
        os.close(self.master)
        os.close(self.slave)


def keep(name, screen):
    with open(os.path.join(OUT, f"monitor-{name}.txt"), "w") as f:
        f.write(screen.text() + "\n")


def trail_cells(screen):
    return sum("⠁" <= c <= "⣿" for c in screen.text())


def sample_device():
    m = Monitor("--device", "sample:rate=100")
    s = m.read(20, lambda s: "running" in s.text() and trail_cells(s) > 60)
    keep("sample", s)
    text = s.text()
    check("sample: named, running, tracked", "sample hand on a circle" in text and "● running" in text and
          "tracked" in text, text)
    rate = re.search(r"([0-9.]+) Hz", text)
    check("sample: the rate is told", rate and 99 < float(rate[1]) < 101, text)
    check("sample: both sketches", "side: x right, y up" in text and "top: x right, z nearer" in text and
          trail_cells(s) > 60, text)
    check("sample: 24 rows are used", s.text().split("\n")[-1].startswith(" q quit"), text)
    before = s.pages
    m.read(1)
    check("sample: pictures go on", s.pages - before > 5, s.pages - before)
    count = trail_cells(s)
    m.key("r")
    m.read(20, lambda s: trail_cells(s) < count - 10)
    check("sample: r forgets the way", trail_cells(s) < count - 10, f"{count}, then {trail_cells(s)}")
    m.end("sample, q", lambda: m.key("q"))


def signals():
    for number in (signal.SIGINT, signal.SIGTERM):
        m = Monitor("--device", "sample")
        m.read(20, lambda s: s.pages > 3)
        m.end(f"signal {number}", lambda: m.child.send_signal(number))
    m = Monitor("--device", "sample")
    m.read(20, lambda s: s.pages > 3)
    m.end("Ctrl-C", lambda: m.key("\x03"))
    m = Monitor("--device", "sample", "--seconds", "0.5")
    m.end("--seconds", lambda: None)


def recording():
    path = os.path.join(folder, "raw.txt")
    with open(path, "w") as f:
        f.write("D: 0\nN: SpaceNavigator\nI: 3 046d c626\nE: 0.000000 3 03 01 00\n")
        for i in range(150):
            push = "5e 01 00 00 00 00" if i < 60 else "00 00 00 00 a2 fe"
            f.write(f"E: {i * 16 // 1000}.{i * 16 % 1000:03d}000 7 01 {push}\n")
    m = Monitor("--device", f"recording:file={path},loop", "--ascii")
    s = m.read(20, lambda s: s.pages > 2)
    check("recording: ASCII where it is asked for", "SpaceNavigator" in s.text() and all(ord(c) < 127 for c in s.text()),
          s.text())
    m.end("--ascii", lambda: m.key("q"))
    m = Monitor("--device", f"recording:file={path},speed=2,loop", "--raw", utf8=False)
    s = m.read(20, lambda s: "GRIP" in s.text() and s.text().count(".") > 40)
    keep("recording", s)
    text = s.text()
    check("recording: the driver is named", "SpaceNavigator 046d:c626" in text, text)
    check("recording: raw bytes", re.search(r" raw +0[123] ", text), text)
    check("recording: the device's bits", "device's bits: 0" in text, text)
    check("recording: ASCII where the locale has no more", all(ord(c) < 127 for c in text), text)
    m.end("recording", lambda: m.key("q"))


def emulated():
    link = os.path.join(folder, "port")
    emulator = subprocess.Popen([EMULATOR, "--link", link], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    emulator.stdout.readline()
    m = Monitor("--device", f"logitech:port={link}")
    s = m.read(30, lambda s: "● running" in s.text() and trail_cells(s) > 40)
    keep("logitech", s)
    check("emulator: running, with its firmware", "firmware 12" in s.text() and "● running" in s.text(), s.text())
    m.read(20, lambda s: "◆" in s.text())
    check("emulator: the grip shows", "◆" in s.text(), s.text())
    emulator.terminate()
    emulator.wait()
    s = m.read(20, lambda s: "lost" in s.text() and "port:" in s.text().split("\n")[-1])
    keep("lost", s)
    check("emulator: unplugged shows as lost, with why", "○ lost" in s.text() and "port" in s.text().split("\n")[-1], s.text())
    m.end("lost", lambda: m.key("q"))


def odd_terminals():
    m = Monitor("--device", "sample", rows=5, columns=20)
    s = m.read(20, lambda s: s.pages >= 3)
    check("small: lines are cut, not wrapped", not s.wrap and s.alternate)
    check("small: a page scrolls nothing", s.lowest == 4, s.lowest)
    m.end("small", lambda: m.key("q"))
    check("small: lines are wrapped again", m.screen.wrap)
    for term in ("dumb", ""):
        m = Monitor("--device", "sample", "--seconds", "1.2", term=term)
        s = m.read(20, lambda s: s.text().count("running") > 1)
        check(f"terminal '{term}': plain lines", s.text().count("running") > 1 and not s.pages, s.text())
        m.child.wait(20)


def plain():
    done = subprocess.run([PROGRAM, "monitor", "--device", "sample", "--seconds", "1.5", "--raw"], capture_output=True,
                          text=True, timeout=60)
    lines = done.stdout.split("\n")
    check("plain: a line a second, no escapes", done.returncode == 0 and len(lines) == 3 and "\033" not in done.stdout and
          all("running" in line for line in lines[:2]), done.stdout + done.stderr)
    trace = os.path.join(folder, "t.csv")
    with open(trace, "w") as f:
        f.write("# stiction-trace 1\n0,1,2,3,0,0,0,1,1\n0.1,1,2,4,0,0,0,1,1\n")
    done = subprocess.run([PROGRAM, "monitor", "--device", f"trace:file={trace}"], capture_output=True, text=True, timeout=60)
    check("a trace that ends is the end", done.returncode == 0 and "z +4.0000" in done.stdout and "GRIP" in done.stdout,
          done.stdout + done.stderr)
    with open(trace, "a") as f:
        f.write("x\n")
    done = subprocess.run([PROGRAM, "monitor", "--device", f"trace:file={trace}"], capture_output=True, text=True, timeout=60)
    check("a bad trace ends with 3 and its line", done.returncode == 3 and "t.csv:4: " in done.stderr, done.stderr)
    for arguments, code, words in (((), 2, "no device"), (("--device", "sample", "--seconds", "-1"), 2, "--seconds is -1"),
                                   (("--device", "mouse"), 2, "in the window of run --view"),
                                   (("--device", "logitech:port=/nonexistent"), 4, "No such file")):
        done = subprocess.run([PROGRAM, "monitor", *arguments], capture_output=True, text=True, timeout=60)
        check(f"refused: {words}", done.returncode == code and words in done.stderr, done.stderr)


sample_device()
signals()
recording()
emulated()
odd_terminals()
plain()
sys.exit(1 if failures else 0)
