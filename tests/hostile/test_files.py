"""Hostile files: for every command that reads or writes one, one clear line, the contract's exit code, and each output
whole or absent."""
import os
import resource
import signal
import socket
import subprocess
import time

from common import (PACKET, SANITIZED, SCENE, SERIAL, TRACE_HEAD, await_handlers, check, finish, folder, leftovers, path,
                    read, rows, run, start, wait, write)

scene = write("scene.yaml", SCENE)
trace = write("hand.csv", TRACE_HEAD + rows(300))
recording = write("poses.txt", "".join(f"{i}.5 0 0.1 0.2 0 0 0 1\n" for i in range(300)))
serial = write("serial.txt", SERIAL)
log = path("good.log")
assert run("replay", scene, trace, "--log", log).code == 0
LOG = read(log).decode()

GIGABYTE = 1 << 30


def sparse(name, head, size, tail=b""):
    """A file of zero bytes that takes no room."""
    write(name, head)
    os.truncate(path(name), size)
    with open(path(name), "ab") as file:
        file.write(tail)
    return path(name)


def special_places():
    """Names that are no readable file, whatever is expected in them."""
    os.mkdir(path("directory"))
    os.symlink("circle", path("circle"))
    os.symlink("nowhere", path("dangling"))
    with socket.socket(socket.AF_UNIX) as s:
        s.bind(path("socket"))
    names = ["directory", "circle", "dangling", "socket", "absent", "scene.yaml/x", "x" * 300]
    return [path(n) for n in names] + ["", "/dev/zero", "/dev/full", "/proc/self/mem"]


def spoiled(good, kind):
    """Files that are wrong whatever the format: name -> bytes."""
    g = good.encode()
    return {
        f"empty.{kind}": b"",
        f"zeros.{kind}": g[:-9] + b"\0" + g[-9:],
        f"zero-first.{kind}": b"\0" + g,
        f"utf16le.{kind}": b"\xff\xfe" + good.encode("utf-16-le"),
        f"utf16be.{kind}": b"\xfe\xff" + good.encode("utf-16-be"),
        f"utf16bare.{kind}": good.encode("utf-16-le"),
        f"utf32.{kind}": good.encode("utf-32"),
        f"latin.{kind}": b"\xe9\xe8\xff\n" + g,
        f"noise.{kind}": bytes((i * 7919 + i // 251 * 31) & 255 for i in range(5000)),
        f"control.{kind}": b"\x1b[2J\x07\x7f\x01\n" + g,
        f"version.{kind}": g.replace(b" 1", b" 2", 1),
        f"huge-version.{kind}": g.replace(b" 1", b" 99999999999999999999", 1),
        f"long-line.{kind}": b"a" * 300000 + b"\n" + g,
        f"only-ends.{kind}": b"\n" * 5000,
        f"cr.{kind}": b"a\r" + g.replace(b"\n", b"\r"),
    }


def bad_scenes():
    bad = dict(spoiled(SCENE, "yaml"))
    bad["laughs.yaml"] = b"a: &a [x, x, x, x, x, x, x, x, x]\n" + b"".join(
        b"%c: &%c [%s]\n" % (c, c, b", ".join([b"*%c" % (c - 1)] * 9)) for c in range(ord("b"), ord("z")))
    bad["deep.yaml"] = b"[" * 200000
    bad["deep-map.yaml"] = b"{a: " * 100000
    bad["deep-block.yaml"] = b"".join(b" " * i + b"a:\n" for i in range(1000))
    bad["deep-dash.yaml"] = b"- " * 200000
    bad["self.yaml"] = b"&a [*a]\n"
    bad["two.yaml"] = (SCENE + "---\n" + SCENE).encode()
    bad["twice.yaml"] = (SCENE + SCENE).encode()
    bad["tag.yaml"] = ("!!python/object:os.system\n" + SCENE).encode()
    bad["merge.yaml"] = SCENE.replace("hand: {", "hand: {<<: {a: 1}, ").encode()
    bad["many-keys.yaml"] = (SCENE + "".join(f"k{i}: 1\n" for i in range(2000))).encode()
    bad["many-surfaces.yaml"] = (SCENE + "  - {point: [0, -1], normal_deg: 90}\n" * 20000).encode()
    for i, size in enumerate(("1e999", "1e300", "-1e308", "1e-400", "nan", ".inf", "0x10", "1" * 5000, "1e99999999999",
                              "99999999999999999999999999999999", "0", "''")):
        bad[f"size{i}.yaml"] = SCENE.replace("0.16", size).encode()
    for i in range(1, 8):
        bad[f"cut{i}.yaml"] = SCENE.encode()[:i * len(SCENE) // 8]
    return bad


def bad_traces():
    good = TRACE_HEAD + rows(5)
    bad = dict(spoiled(good, "csv"))
    bad["head-only.csv"] = TRACE_HEAD.encode()
    bad["a-log.csv"] = LOG.encode()
    bad["a-scene.csv"] = SCENE.encode()
    bad["twice.csv"] = (good + good).encode()
    bad["no-end.csv"] = good.encode()[:-1].replace(b"\n0.0", b" ").replace(b"buttons", b"b")
    for i, value in enumerate(("1e999", "nan", "inf", "0x1p3", "1e19", "-1e300", "1" * 400, "", " ", "1 2", "'1'")):
        bad[f"x{i}.csv"] = (TRACE_HEAD + f"0,{value},0.2,0,0,0,0,1,0\n").encode()
        bad[f"t{i}.csv"] = (TRACE_HEAD + rows(1) + f"{value},0.1,0.2,0,0,0,0,1,0\n").encode()
    bad["long.csv"] = (TRACE_HEAD + rows(2) + "5" * 70000 + ",1,2,3,0,0,0,1,0\n").encode()
    bad["buttons.csv"] = (TRACE_HEAD + "0,0,0.2,0,0,0,0,1,4294967296\n").encode()
    bad["norm.csv"] = (TRACE_HEAD + "0,0,0.2,0,1e200,1e200,0,1,0\n").encode()
    return bad


def bad_logs():
    good = LOG
    bad = dict(spoiled(good, "log"))
    bad["head.log"] = good[:good.index("\nt,state")].encode() + b"\n"
    bad["no-rows.log"] = (good[:good.index("c4_friction") + 12]).encode()
    bad["cut.log"] = good.encode()[:-30]
    bad["a-trace.log"] = read(trace)
    bad["twice.log"] = (good + good).encode()
    bad["nan.log"] = (good + good.split("\n")[-2].replace(",0,", ",nan,", 1) + "\n").encode()
    bad["provenance.log"] = ("# stiction-log 1\n" + "# scene: x\n" * 5000 + "t,state\n").encode()
    return bad


def bad_recordings():
    bad = dict(spoiled(SERIAL, "serial"))
    bad["head.serial"] = b"# stiction-serial 1\n"
    bad["odd.serial"] = SERIAL[:-2].encode() + b"\n"
    bad["huge-time.serial"] = b"# stiction-serial 1\n99999999999999999999 00\n"
    bad["back.serial"] = b"# stiction-serial 1\n20 00\n10 00\n"
    bad["no-hex.serial"] = b"# stiction-serial 1\n0 zz\n"
    bad["no-device.hid"] = b"E: 0.000000 8 00 01 02 03 04 05 06 07\n"
    bad["huge-report.hid"] = b"D: 0\nR: 1 05\nI: 3 046d c626\nE: 0.000000 99999999999 00\n"
    bad["huge-id.hid"] = b"D: 99999999999999999999\n"
    return bad


def bad_poses():
    good = read(recording).decode()
    bad = dict(spoiled(good.replace("0 0 1\n", "0 0  1\n"), "tum"))
    for i, value in enumerate(("1e999", "nan", "inf", "-", "1" * 400)):
        bad[f"value{i}.tum"] = f"0 {value} 0 0 0 0 0 1\n".encode()
    bad["back.tum"] = b"1 0 0 0 0 0 0 1\n0 0 0 0 0 0 0 1\n"
    bad["norm.tum"] = b"1 0 0 0 0 0 0 9\n"
    bad["huge-time.tum"] = b"1e300 0 0 0 0 0 0 1\n"
    bad["euroc.csv"] = b"#timestamp, p_RS_R_x [m]\n99999999999999999999,0,0,0,1,0,0,0\n"
    return bad


def bad_trackers():
    good = "stiction: 1\ntracker: {scale: 1}\n"
    bad = dict(spoiled(good, "tracker"))
    for i, text in enumerate(("scale: 1e999", "scale: 0", "axes: [x, x, x]", "axes: [1, 2, 3, 4, 5, 6, 7, 8, 9]", "a: 1")):
        bad[f"values{i}.tracker"] = good.replace("scale: 1", text).encode()
    return bad


# For each kind of file, commands that read it; FILE is put in.
def commands_with(kind):
    device = "trace:speed=1000000,file="
    monitor = ["monitor", "--plain", "--seconds", "9", "--device"]
    return {
        "scene": [["replay", "FILE", trace], ["check", "FILE"], ["explain", "FILE"], ["explain", "FILE", trace],
                  ["still", "FILE", trace, "--at", "0", "--out", path("no.png")],
                  ["run", "FILE", "--device", device + trace], ["bench", "trade", "--quick", "FILE", trace],
                  ["run", "FILE", "--accuracy", "auto", "--device", device + trace],
                  ["bench", "extremes", "FILE", trace, "--csv", path("no.csv")]],
        "trace": [["replay", scene, "FILE", "--log", path("no.log")], ["check", scene, "FILE"],
                  ["explain", scene, "FILE"],
                  ["still", scene, "FILE", "--at", "0", "--out", path("no.png")],
                  ["run", scene, "--log", path("live.log"), "--device", device + "FILE"],
                  ["convert", "FILE", path("no.csv")], [*monitor, device + "FILE"],
                  ["bench", "trade", "--quick", scene, "FILE"],
                  ["bench", "extremes", scene, "FILE", "--csv", path("no.csv")]],
        "log": [["plot", "FILE", "--out", path("no.svg"), "--figure", "9"]],
        "tracker": [["run", scene, "--tracker", "FILE", "--device", device + trace],
                    [*monitor, device + trace, "--tracker", "FILE"],
                    ["convert", serial, path("no.csv"), "--tracker", "FILE"]],
        "recording": [["convert", "FILE", path("no.csv")],
                      [*monitor, "recording:speed=1000000,file=FILE"],
                      ["run", scene, "--log", path("live.log"), "--device", "recording:speed=1000000,file=FILE"]],
        "poses": [["convert", "FILE", path("no.csv")],
                  ["convert", "FILE", path("no.csv"), "--from", "tum", "--grip"]],
    }[kind]


def expect_refusal(arguments, name):
    """3, or 1 where all findings are told; one line that names the file; nothing written."""
    what = " ".join(arguments).replace(folder, ".")[:200]
    done = run(*arguments)
    command = arguments[0]
    check(f"{what}: code", done.code == (1 if command == "check" else 3), done)
    told = done.lines
    if command == "run":  # it may have begun, and says how it kept up
        told = [line for line in told if not line.startswith("stiction: ")]
        check(f"{what}: the error is the last word", told == done.lines[-1:], done)
    if command == "convert":
        told = [line for line in told if not line.startswith("warning: ")]
    if command == "check":
        check(f"{what}: findings", 1 <= len(told), done)
    else:
        check(f"{what}: one line", len(told) == 1, done)
    check(f"{what}: names the file", name == "" or any(os.path.basename(name)[:100] in line for line in told), done)
    check(f"{what}: printable", all(c >= " " for line in done.lines for c in line), done)
    check(f"{what}: no sanitizer", "runtime error" not in done.err and "Sanitizer" not in done.err, done)
    left = leftovers() + [path(n) for n in ("no.log", "no.png", "no.svg", "no.csv") if os.path.exists(path(n))]
    check(f"{what}: nothing left", not left, left)
    for name in left:
        os.unlink(name)


def refusals():
    places = special_places()
    for kind, bad in (("scene", bad_scenes()), ("trace", bad_traces()), ("log", bad_logs()),
                      ("tracker", bad_trackers()), ("recording", bad_recordings()), ("poses", bad_poses())):
        files = [write("bad-" + name, data) for name, data in bad.items()] + places
        for i, name in enumerate(files):
            commands = commands_with(kind)
            # Every command for the places, and in turns for the rest: they share the readers.
            for j, command in enumerate(commands):
                if name not in places and (i + j) % len(commands) > 1:
                    continue
                if name == "" and command[0] in ("run", "monitor"):
                    continue  # a device without a file is wrong usage
                if name == path("dangling") and kind == "log":
                    continue
                expect_refusal([a.replace("FILE", name) for a in command], name)


def odd_but_good():
    """What is unusual and right."""
    bom = b"\xef\xbb\xbf"
    text = read(trace)
    want = LOG[LOG.index("\nt,state"):]
    odd_scene = write("odd.yaml", bom + SCENE.replace("\n", "\r\n").encode())
    odd_trace = write("odd.csv", bom + text.replace(b"\n", b"\r\n"))
    done = run("replay", odd_scene, odd_trace, "--log", "-")
    check("byte-order mark and CRLF", done.code == 0 and done.err == "" and done.out.endswith(want), done)
    done = run("replay", scene, write("cut.csv", text[:-20]), "--log", "-")
    check("a trace cut in its last line", done.code == 0 and len(done.lines) == 1 and "no end" in done.err, done)
    done = run("plot", write("crlf.log", bom + LOG.replace("\n", "\r\n").encode()), "--figure", "9", "--out",
               path("x.svg"))
    check("a log with CRLF", done.code in (0, 2), done)
    done = run("replay", scene, "-", stdin=open(trace, "rb"), stdout=subprocess.PIPE)
    check("a trace from standard input", done.code == 0, done)


def long_lines():
    """A line of 1 GB must not be kept; lenient, it is passed over."""
    line = sparse("gigabyte.csv", TRACE_HEAD + rows(3), GIGABYTE, b"\n" + rows(3, start=10).encode())
    expect_refusal(["replay", scene, line, "--log", path("no.log")], line)
    expect_refusal(["plot", sparse("gigabyte.log", LOG, GIGABYTE), "--figure", "9", "--out", path("no.svg")],
                   "gigabyte.log")
    expect_refusal(["check", sparse("gigabyte.yaml", SCENE, GIGABYTE)], "gigabyte.yaml")
    line = sparse("long.csv", TRACE_HEAD + rows(3), 64 << 20, b"\n" + rows(3, start=10).encode())
    done = run("replay", scene, line, "--lenient", "--log", path("lenient.log"))
    check("a long line, lenient", done.code == 0 and len(done.lines) == 1 and "1 bad line" in done.err, done)
    check("all other rows", read(path("lenient.log")).count(b"\n0.") == 6, read(path("lenient.log"))[-300:])
    process = start(["replay", scene, "-"], stdin=subprocess.PIPE)
    try:
        process.stdin.write(TRACE_HEAD.encode())
        while True:
            process.stdin.write(b"1" * 65536)
    except BrokenPipeError:
        pass
    process.stdin = None
    done = wait(process)
    check("a line without end in a pipe", done.code == 3 and len(done.lines) == 1 and ":3: " in done.err, done)


has_video = run("replay", scene, write("short.csv", TRACE_HEAD + rows(3)), "--size", "160x120", "--video", path("v.mkv"),
                before=None).code == 0


def outputs():
    """Places that cannot be written, for every output."""
    device = "trace:speed=1000000,file=" + trace
    commands = [["replay", scene, trace, option, "OUT"] for option in ("--log", "--events", "--timing")]
    commands += [["run", scene, "--device", device, option, "OUT"]
                 for option in ("--log", "--events", "--timing", "--record")]
    commands += [["still", scene, trace, "--at", "0", "--size", "160x120", "--out", "OUT.png"],
                 ["plot", log, "--figure", "9", "--out", "OUT"],
                 ["bench", "trade", "--quick", scene, trace, "--csv", "OUT"],
                 ["bench", "validate", "--quick", "--csv", "OUT"],
                 ["convert", recording, "OUT"],
                 ["replay", scene, trace, "--size", "160x120", "--video", "OUT.mkv"],
                 ["replay", scene, trace, "--size", "160x120", "--frames", "OUT"],
                 ["replay", scene, trace, "--size", "160x120", "--report", "OUT"],
                 ["run", scene, "--device", device, "--size", "160x120", "--video", "OUT.mkv"],
                 ["run", scene, "--device", device, "--size", "160x120", "--frames", "OUT"],
                 ["bench", "extremes", scene, trace, "--csv", "OUT"],
                 ["bench", "devices", "--quick", "--csv", "OUT"]]
    places = ["/dev/full", path("directory"), path("circle"), path("dangling"), path("absent", "x"),
              path("scene.yaml", "x"), "/proc/version", "/sys/kernel/x", path("y" * 300), ""]
    if not has_video:
        commands = [c for c in commands if "--video" not in c]
    for command in commands:
        for place in places:
            if command[0] == "bench" and place not in places[:2]:
                continue
            suffix = ".svg" if command[0] == "plot" else ""
            if command[0] == "plot" and not place.startswith(folder + "/absent"):
                continue
            if "--frames" in command and place in (path("directory"), path("dangling")):
                continue
            if "--video" in command and place in (path("directory"), path("dangling"), path("circle"), "/proc/version",
                                                  "/dev/full", ""):
                continue
            if "--record" in command and place == path("dangling"):
                continue  # makes its target
            if command[0] == "still" and place in (path("directory"), path("dangling"), path("circle"), "/dev/full",
                                                   "/proc/version", ""):
                continue  # only names that end with .png
            arguments = [a.replace("OUT", place + suffix) for a in command]
            done = run(*arguments, before=None)
            what = " ".join(arguments).replace(folder, ".")[:200]
            check(f"{what}: code", done.code == 5, done)
            told = done.lines
            if command[0] == "run" and place:
                told = [line for line in told if not line.startswith("stiction: ")]
            if "--report" in command:
                told = [line for line in told if "without video" not in line]
            if command[0] == "plot":
                told = [line for line in told if "the log has no" not in line]
            check(f"{what}: one line", len(told) == 1, done)
            check(f"{what}: nothing left", not leftovers(), leftovers())


def same_file():
    """An output that is an input, by any name."""
    os.symlink(trace, path("link.csv"))
    os.link(trace, path("hard.csv"))
    before = read(trace)
    device = "trace:speed=1000000,file=" + trace
    for name in (trace, path("link.csv"), path("hard.csv"), path("directory", "..", "hand.csv")):
        for arguments in (["replay", scene, trace, "--log", name], ["replay", scene, trace, "--report", name],
                          ["still", scene, trace, "--at", "0", "--out", name],
                          ["run", scene, "--device", device, "--record", name],
                          ["run", scene, "--device", device, "--log", name],
                          ["bench", "trade", "--quick", scene, trace, "--csv", name],
                          ["bench", "extremes", scene, trace, "--csv", name],
                          ["bench", "extremes", scene, trace, "--picture", name], ["convert", trace, name]):
            done = run(*arguments)
            what = " ".join(arguments).replace(folder, ".")
            check(f"{what}: refused", done.code == 2 and len(done.lines) == 1, done)
            check(f"{what}: untouched", read(trace) == before, "changed")
    done = run("plot", log, "--figure", "9", "--out", log)
    check("plot onto its log", done.code == 2 and read(log).decode() == LOG, done)
    # Through a link the link stays.
    target = write("target.log", "old\n")
    os.symlink("target.log", path("link.log"))
    done = run("replay", scene, trace, "--log", path("link.log"))
    check("a link's target is written", done.code == 0 and os.path.islink(path("link.log")) and
          read(target).startswith(b"# stiction-log 1"), done)


def full_disk():
    """The limit of a file's size stands for a disk that fills up."""
    def tiny():
        os.environ.update(GCOV_PREFIX=path("counts"), GCOV_ERROR_FILE="/dev/null")  # it would cut those off too
        resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))
    for option in ("--log", "--report"):
        out = path("full" + option)
        done = run("replay", scene, trace, option, out, before=tiny)
        check(f"full disk, {option}", done.code == 5 and "too large" in done.err, done)
        check(f"full disk, {option}: absent", not os.path.exists(out) and not leftovers(), leftovers())
    os.mkdir(path("full-frames"))
    for arguments in (["--frames", path("full-frames")], *([["--video", path("full.mkv")]] * has_video)):
        done = run("replay", scene, trace, *arguments, "--size", "320x240", before=tiny)
        check(f"full disk, {arguments[0]}", done.code == 5 and len(done.lines) == 1, done)
    check("full disk: no pictures", not os.listdir(path("full-frames")) and not os.path.exists(path("full.mkv")) and
          not leftovers(), leftovers())
    # A recording is readable to its last whole line.
    record = path("full-record.csv")
    done = run("run", scene, "--device", "trace:speed=1000000,file=" + trace, "--record", record, before=tiny)
    check("full disk, --record", done.code == 5 and "too large" in done.err, done)
    done = run("replay", scene, record)
    check("a recording on a full disk", done.code == 0 and os.path.getsize(record) == 4096, done)


def waiting_pipes():
    """A pipe without another end is waited for, and a signal ends that as it ends the rest."""
    pipe = path("pipe")
    os.mkfifo(pipe)
    device = "trace:speed=1000000,file=" + trace
    for arguments in (["replay", scene, trace, "--log", pipe], ["replay", scene, pipe], ["convert", recording, pipe],
                      ["still", scene, pipe, "--at", "0", "--out", path("no.png")], ["check", pipe], ["plot", pipe],
                      ["run", scene, "--device", device, "--log", pipe],
                      ["run", scene, "--device", device, "--record", pipe]):
        process = start(arguments, before=None)
        await_handlers(process)
        time.sleep(0.2)  # most likely it waits by now
        process.send_signal(signal.SIGTERM)
        done = wait(process)
        what = " ".join(arguments).replace(folder, ".")
        check(f"{what}: ended by a signal", done.code == 143 and not done.lines, done)
    check("waiting pipes: nothing left", not leftovers() and not os.path.exists(path("no.png")), leftovers())


def few_descriptors():
    """Each number of file descriptors: done, or one word why not."""
    device = "trace:speed=1000000,file=" + trace
    for count in range(3, 20):
        def few():
            resource.setrlimit(resource.RLIMIT_NOFILE, (count, count))
        for arguments in (["replay", scene, trace, "--log", path("few.csv"), "--events", path("few-events.csv")],
                          ["run", scene, "--device", device, "--log", path("few.csv")]):
            done = run(*arguments, before=few)
            told = [line for line in done.lines if "descriptors" in line or "Too many open files" in line]
            early = done.code == 127 and "shared libraries" in done.err
            check(f"{count} descriptors, {arguments[0]}", done.code == 0 or early or
                  done.code in (3, 5, 6) and len(done.lines) == len(told) == 1, done)
            check(f"{count} descriptors, {arguments[0]}: whole or absent", os.path.exists(path("few.csv")) ==
                  (done.code == 0), done)
            for name in os.listdir(folder):
                if name.startswith("few"):
                    os.unlink(path(name))
    check("few descriptors: nothing left", not leftovers(), leftovers())


def older_recording():
    """A run that does not begin takes no older recording with it, and leaves no new one."""
    older, new = write("older.csv", read(trace)), path("new.csv")
    os.mkdir(path("older-frames"))
    write(os.path.join("older-frames", "frame_000000.png"), "x")
    for record in (older, new):
        for arguments in (["--video", "x.avi"], ["--fps", "0", "--frames", path("no-frames")],
                          ["--frames", path("older-frames")]):
            done = run("run", scene, "--device", "trace:speed=1000000,file=" + trace, "--record", record, *arguments,
                       before=None)
            check(f"{arguments[0]}: does not begin", done.code in (2, 5) and len(done.lines) == 1, done)
            check(f"{arguments[0]}: the older recording stays", read(older) == read(trace) and not os.path.exists(new))


def in_the_way():
    """A folder where a picture has to go."""
    os.makedirs(path("way", "frame_000003.png"))
    done = run("replay", scene, trace, "--frames", path("way"), "--size", "160x120", "--fps", "2", "--force", before=None)
    check("a folder in the way of a picture", done.code == 5 and len(done.lines) == 1 and
          ("frame_000003.png" in done.err or "renderer" in done.err), done)
    check("no other picture is left", os.listdir(path("way")) == ["frame_000003.png"], os.listdir(path("way")))


def closed_streams():
    """A reader that left, and streams that were never there."""
    big = write("big.csv", TRACE_HEAD + rows(20000))
    device = "trace:speed=1000000,file=" + trace
    for arguments in (["replay", scene, big, "--log", "-"], ["run", scene, "--device", device, "--log", "-"],
                      ["replay", scene, trace, "--log", path("l.csv"), "--events", "-"], ["check", scene, trace],
                      ["check", scene, path("scene.yaml")], ["explain", scene], ["explain", scene, "--json"], ["--help"],
                      ["--version"], ["replay", "--help"], ["devices"], ["devices", "--json"],
                      ["monitor", "--plain", "--device", device], ["convert", serial, "-"],
                      ["still", scene, trace, "--at", "0", "--out", "-"],
                      ["bench", "validate", "--quick"], ["bench", "trade", "--quick", scene, trace],
                      ["bench", "extremes", scene, trace, "--csv", "-"]):
        what = " ".join(arguments).replace(folder, ".")
        ends = os.pipe()
        os.close(ends[0])
        done = run(*arguments, stdout=ends[1], before=None)
        os.close(ends[1])
        said = [line for line in done.lines if arguments[0] != "run" and "scene.yaml:1:" not in line]
        check(f"{what} into a closed pipe", done.code == 141 and (SANITIZED or not said), done)
        with open("/dev/full", "wb") as full:
            done = run(*arguments, stdout=full, before=None)
        said = [line for line in done.lines if "cannot write: No space left" in line]
        check(f"{what} onto a full device", done.code == 5 and said == done.lines[-1:], done)
    for command, name in ((f"replay {scene} {trace} --log - --events {path('e.csv')}", "e.csv"),
                          (f"replay {scene} {trace} --log {path('l.csv')}", "l.csv")):
        done = subprocess.run(["sh", "-c", f'"$STICTION" {command} <&- >&- 2>{path("err")}'], check=False)
        want = 5 if "--log - " in command else 0
        check(f"closed streams, {name}", done.returncode == want and (want == 0) == os.path.exists(path(name)),
              (done.returncode, read(path("err"))))
    subprocess.run(["sh", "-c", f'"$STICTION" replay {scene} /nowhere --log {path("l2.csv")} 2>&-'], check=False)
    check("closed standard error", not os.path.exists(path("l2.csv")), "")


def no_window():
    """A window that cannot be opened is told before anything is solved."""
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        os.environ.pop(name, None)
    done = run("run", scene, "--device", "trace:file=" + trace, "--log", path("unseen.log"), "--view", before=None)
    check("no window", done.code in (2, 5) and len(done.lines) == 1, done)  # 2: built without
    done = run("run", scene, "--device", "mouse", "--log", path("unseen.log"), before=None)
    check("a mouse without a window", done.code == 2 and len(done.lines) == 1 and "--view" in done.err, done)
    check("no window: nothing written", not os.path.exists(path("unseen.log")) and not leftovers(), leftovers())


def through_pipes():
    """Each input may be a pipe, which can be read once only."""
    device = "trace:speed=1000000,file="
    given = {"scene": read(scene), "trace": read(trace), "log": LOG.encode(), "recording": read(serial),
             "tracker": b"stiction: 1\ntracker: {scale: 1}\n"}
    for kind, arguments in (
            ("scene", ["check", "PIPE"]), ("scene", ["run", "PIPE", "--accuracy", "auto", "--device", device + trace]),
            ("scene", ["replay", "PIPE", trace, "--report", path("piped.html"), "--size", "160x120"]),
            ("scene", ["explain", "PIPE", trace]), ("scene", ["bench", "extremes", "PIPE", trace]),
            ("trace", ["check", scene, "PIPE"]), ("trace", ["explain", scene, "PIPE"]),
            ("trace", ["replay", scene, "PIPE", "--frames", path("piped"), "--force", "--size", "160x120"]),
            ("trace", ["still", scene, "PIPE", "--at", "largest-slip", "--out", path("piped.png")]),
            ("trace", ["run", scene, "--device", device + "PIPE"]), ("trace", ["bench", "extremes", scene, "PIPE"]),
            ("trace", ["monitor", "--plain", "--device", device + "PIPE"]),
            ("log", ["plot", "PIPE", "--figure", "9", "--out", path("piped.svg")]),
            ("recording", ["convert", "PIPE", path("piped.csv"), "--from", "serial"]),
            ("tracker", ["run", scene, "--tracker", "PIPE", "--device", device + trace])):
        process = start([a.replace("PIPE", "/dev/stdin") for a in arguments], stdin=subprocess.PIPE, before=None)
        try:
            process.stdin.write(given[kind])
            process.stdin.close()
        except BrokenPipeError:
            pass
        process.stdin = None
        done = wait(process)
        what = " ".join(arguments).replace(folder, ".")
        lacks = done.code == 5 and "renderer" in done.err  # no OpenGL here
        check(f"{what}: through a pipe", done.code == 0 or lacks, done)


def vanishing():
    """Files that are cut, grown or taken away while they are read."""
    head = TRACE_HEAD + rows(200)
    for what, act in (("cut", lambda n: os.truncate(n, 5000)), ("emptied", lambda n: os.truncate(n, 0)),
                      ("deleted", os.unlink), ("replaced", lambda n: os.replace(write("other", "x"), n))):
        name = write(f"{what}.csv", head + rows(200000, start=300))
        done_log = path(what + ".log")
        process = start(["replay", scene, name, "--log", done_log, "--accuracy", "frame"], before=None)
        act(name)
        done = wait(process)
        whole = os.path.exists(done_log) and read(done_log).endswith(b"\n")
        check(f"a trace {what} while it is read", done.code == 0 and whole or
              done.code == 3 and len(done.lines) == 1 and not os.path.exists(done_log), done)
    check("vanishing: nothing left", not leftovers(), leftovers())


def two_writers():
    """Two at once: each whole, or one refused with a word."""
    out = path("both.log")
    long_trace = write("long-hand.csv", TRACE_HEAD + rows(20000))
    processes = [start(["replay", scene, long_trace, "--log", out, "--accuracy", a], before=None)
                 for a in ("frame", "event", "frame", "event")]
    done = [wait(p) for p in processes]
    check("four writers of one log", all(d.code == 0 for d in done), done)
    text = read(out)
    check("the log is whole", text.count(b"\n") == 20000 + 7 and text.endswith(b"\n") and
          text.count(b"# stiction-log") == 1, text[:200])
    frames = path("both")
    processes = [start(["replay", scene, trace, "--frames", frames, "--size", size], before=None)
                 for size in ("160x120", "192x144", "256x192")]
    done = [wait(p) for p in processes]
    sizes = {read(os.path.join(frames, n))[16:24] for n in os.listdir(frames)}
    check("pictures of one writer only", sorted(d.code for d in done) in ([0, 5, 5],) and len(sizes) == 1 and
          len(os.listdir(frames)) == 93, (done, len(os.listdir(frames)), sizes))
    record = path("both-record.csv")
    first = start(["run", scene, "--device", "trace:speed=1000,file=-", "--record", record], stdin=subprocess.PIPE,
                  before=None)
    first.stdin.write(read(trace))
    first.stdin.flush()
    while first.poll() is None and not (os.path.exists(record) and os.path.getsize(record)):
        time.sleep(0.01)
    second = run("run", scene, "--device", "trace:file=" + trace, "--record", record, before=None)
    check("one recorder only", second.code == 5 and "another program" in second.err, second)
    done = wait(first)
    check("the first recorder", done.code == 0, done)
    check("the recording is whole", run("replay", scene, record).code == 0 and
          sum(not line.startswith(b"#") for line in read(record).splitlines()) == 300 + 1, read(record)[:200])


refusals()
odd_but_good()
long_lines()
outputs()
same_file()
full_disk()
waiting_pipes()
few_descriptors()
older_recording()
in_the_way()
closed_streams()
no_window()
through_pipes()
vanishing()
two_writers()
finish()
