"""A long run through CSV, samples at 250 Hz in at standard input and rows out at standard output: memory does not grow, a
stuck contact does not drift by a bit, and times keep their ns, also 1e9 s after the clock's zero. LONG=1: eight hours
(7,200,000 samples), else five minutes."""
import math
import os
import subprocess
import threading

from common import SCENE, TRACE_HEAD, check, finish, start, write

RATE = 250
COUNT = RATE * (8 * 3600 if os.environ.get("LONG") == "1" else 300)
GROWTH_KB = 256
scene = write("scene.yaml", SCENE)
# Pressed down at a corner, with a tremor that friction holds.
PLACES = [f"{0.1 + 1e-4 * math.sin(k):.9f},{0.06 + 1e-4 * math.cos(3 * k):.9f},0,0,0,0.1736,0.9848,1\n" for k in range(977)]


def time_text(start_s, i):
    ns = i * (1000000000 // RATE) + i % 7  # the last digits too
    return f"{start_s + ns // 1000000000}.{ns % 1000000000:09d}"


def feed(pipe, start_s):
    with pipe:
        pipe.write(TRACE_HEAD.encode())
        for first in range(0, COUNT, 1000):
            pipe.write("".join(f"{time_text(start_s, i)},{PLACES[i % 977]}" for i in
                               range(first, min(first + 1000, COUNT))).encode())


def resident_kb(process):
    with open(f"/proc/{process.pid}/status", encoding="ascii") as status:
        return next(int(line.split()[1]) for line in status if line.startswith("VmRSS"))


def follow(start_s):
    process = start(["replay", scene, "-", "--log", "-"], stdin=subprocess.PIPE, before=None)
    feeder = threading.Thread(target=feed, args=(process.stdin, start_s))
    feeder.start()
    count, wrong, places, early = 0, 0, set(), 0
    for line in process.stdout:
        if not line[:1].isdigit():
            continue
        fields = line.split(b",", 24)
        wrong += fields[0].decode() != time_text(start_s, count)
        if count > 1000:
            places.add((fields[17], fields[20], fields[21]))
        count += 1
        if count == COUNT // 4:
            early = resident_kb(process)
        if count == COUNT - COUNT // 16:
            late = resident_kb(process)
    feeder.join()
    err = process.stderr.read().decode()
    code = process.wait()
    what = f"{COUNT} samples from {start_s} s"
    check(f"{what}: all solved", code == 0 and count == COUNT and err == "", (code, count, err))
    check(f"{what}: times to the ns", wrong == 0, wrong)
    check(f"{what}: one contact, at one place", len(places) == 1 and next(iter(places))[0] == b"1", list(places)[:3])
    check(f"{what}: memory", late - early <= GROWTH_KB, (early, late))
    print(f"{what}: {early} kB resident after a quarter, {late} kB at the end", flush=True)


for offset in (0, 1000000000):
    follow(offset)
finish()
