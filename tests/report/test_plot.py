"""stiction plot: figures, their marks and labels, and what it refuses."""
import os
import re
import shutil
import subprocess
import tempfile
import xml.etree.ElementTree as ElementTree

from common import SCENE, check, equal, finish, rows, run, skip, trace, write

if not shutil.which("gnuplot"):
    skip("there is no gnuplot (package gnuplot-nox)")


def read(path, mode="r"):
    with open(path, mode) as file:
        return file.read()


def blocks(path):
    """Blocks of a data file by the first word of their comment."""
    found = {}
    for block in read(path).split("\n\n\n"):
        lines = block.strip().split("\n")
        head = [line for line in lines if line.startswith("#")]
        if head:
            found[head[-1][2:]] = [line.split() for line in lines if not line.startswith("#")]
    return found


def vectors(svg):
    """Marks of slips: upright strokes within the plot of that name."""
    count = 0
    for plot in re.findall(r'<title>slips</title>(.*?)\n\t</g>', svg, re.S):
        for path in re.findall(r"<path[^>]* d='([^']*)'", plot):
            pieces = re.findall(r"M([\d.]+),([\d.]+) L([\d.]+),([\d.]+)", path)
            count += sum(1 for x0, y0, x1, y1 in pieces if x0 == x1 and y0 != y1)
    return count


def figures(log, log_rows):
    out = os.path.join(folder, "plots")
    done = run("plot", log, "--out", out, "--keep")
    equal("plot", (done.returncode, done.stderr), (0, ""))
    names = {f"figure-{n}.{e}" for n in (9, 10) for e in ("svg", "pdf", "png", "gp", "dat")}
    equal("figures 9 and 10 in all formats, with script and data", set(os.listdir(out)), names)
    equal("their names are printed", {os.path.basename(n) for n in done.stdout.split()},
          {n for n in names if not n.endswith((".gp", ".dat"))})
    check("PDF", read(os.path.join(out, "figure-9.pdf"), "rb").startswith(b"%PDF"))
    check("PNG", read(os.path.join(out, "figure-9.png"), "rb").startswith(b"\x89PNG"))
    texts = {}
    for n in (9, 10):
        svg = read(os.path.join(out, f"figure-{n}.svg"))
        texts[n] = " ".join("".join(ElementTree.fromstring(svg).itertext()).split())
        check(f"figure {n} is as wide as a column", re.search(r'<svg\s+width="321"', svg) is not None)
        check(f"figure {n} is small", len(svg) < 400000, len(svg))
    for word in ("hand", "object", "rest after a slip", "x / m", "y / m", "angle / °", "time / s", "state"):
        check(f"figure 9 says '{word}'", word in texts[9], texts[9])
    for word in ("normal force N", "friction T", "(static)", "(dynamic)", "slip", "force / N", "time / s", "floor_x^2"):
        check(f"figure 10 says '{word}'", word in texts[10], texts[10])
    state = [i for i, r in enumerate(log_rows) if r["state"] == "vertex"]
    shown = log_rows[max(state[0] - 1, 0):state[-1] + 2]
    slips = sum(1 for a, b in zip(log_rows, log_rows[1:]) if b["slips"] != a["slips"] and b in shown)
    check("there are slips", slips > 5, slips)
    data = blocks(os.path.join(out, "figure-10.dat"))
    equal("every slip is in the data", len(data["slips: t/s"]), slips)
    marks = vectors(read(os.path.join(out, "figure-10.svg")))
    check("every slip is marked", marks == slips, (marks, slips))
    forces = data["forces on floor_x^2: t/s normal/N friction/N"]
    equal("all rows are in the data", len(forces), len(shown))
    check("forces are those of the log", all(
        abs(float(f[1]) - float(r["c1_normal"])) < 1e-6 for f, r in zip(forces, shown) if r["contacts"] == "1"))
    first = {n: read(os.path.join(out, n), "rb") for n in names}
    run("plot", log, "--out", out, "--keep")
    equal("the same log gives the same files", [n for n in names if read(os.path.join(out, n), "rb") != first[n]], [])
    os.remove(os.path.join(out, "figure-9.svg"))
    subprocess.run(["gnuplot", "-d", "figure-9.gp"], cwd=out, check=True)
    equal("the kept script gives the figure again", read(os.path.join(out, "figure-9.svg"), "rb"), first["figure-9.svg"])


def choices(log):
    one = os.path.join(folder, "it's one.svg")
    equal("one figure", run("plot", log, "--figure", "11", "--out", one).returncode, 0)
    check("it is there, with a quote in its name", os.path.exists(one))
    check("a figure without its state says so", "two-vertex" in run("plot", log, "--figure", "11", "--out", one).stderr)
    png = os.path.join(folder, "short.png")
    equal("a stretch", run("plot", log, "--figure", "10", "--from", "2", "--to", "3", "--out", png).returncode, 0)
    lost = write(os.path.join(folder, "lost.csv"), re.sub(r"# scene: .*", "# scene: gone.yaml", read(log)))
    done = run("plot", lost, "--figure", "10", "--out", os.path.join(folder, "bare.svg"))
    check("without the scene limits are left out", done.returncode == 0 and "--scene" in done.stderr, done.stderr)
    check("and not drawn", "static limit" not in read(os.path.join(folder, "bare.svg")))
    done = run("plot", lost, "--scene", scene, "--figure", "10", "--out", os.path.join(folder, "again.svg"))
    check("--scene brings them back", (done.returncode, done.stderr) == (0, "") and "static limit" in read(os.path.join(folder, "again.svg")))
    other = os.path.join(folder, "other.csv")
    run("replay", scene, hand, "--set", "friction.static=0.5", "--log", other)
    run("plot", other, "--figure", "10", "--out", os.path.join(folder, "set.svg"), "--keep")
    check("overrides of the run count", "mu_s = 0.5;" in read(os.path.join(folder, "set.gp")))
    with open(log) as file:
        equal("a log from standard input", run("plot", "-", "--figure", "9", "--out", png, stdin=file).returncode, 0)


def short_logs(log):
    """One row is a point, and where nothing is touched there are no forces to show."""
    head, states = read(log).split("\nt,state", 1)
    lines = states.split("\n")
    free = next(line for line in lines if ",free," in line)
    one = write(os.path.join(folder, "one.csv"), f"{head}\nt,state{lines[0]}\n{free}\n")
    out = os.path.join(folder, "one")
    equal("one row", run("plot", one, "--out", out, "--format", "svg").returncode, 0)
    equal("without forces", os.listdir(out), ["figure-9.svg"])
    svg = read(os.path.join(out, "figure-9.svg"))
    equal("points of hand and object, in the plane and over time", svg.count("<use xlink:href='#gpPt6'"), 8)
    texts = " ".join("".join(ElementTree.fromstring(svg).itertext()).split())
    check("and its state", "free" in texts, texts)
    ticks = re.findall(r"-?\d+\.\d+", texts)
    check("its numbers are short", all(len(n) <= 7 for n in ticks), ticks)
    lines_end = os.path.join(folder, "a\nb.svg")
    equal("a line's end in a name", run("plot", log, "--figure", "9", "--out", lines_end).returncode, 0)
    check("is kept", os.path.exists(lines_end))


def long_log():
    """An hour is thinned."""
    hand = write(os.path.join(folder, "long.csv"), trace(600, 31))
    log = os.path.join(folder, "long-log.csv")
    run("replay", scene, hand, "--log", log, "--accuracy", "frame")
    out = os.path.join(folder, "long.svg")
    done = run("plot", log, "--figure", "9", "--out", out, "--keep")
    equal("a long log", done.returncode, 0)
    data = blocks(os.path.join(folder, "long.dat"))
    check("is thinned", len(data["object: t/s x/m y/m angle/deg"]) <= 6600, len(data["object: t/s x/m y/m angle/deg"]))
    check("to a small file", os.path.getsize(out) < 900000, os.path.getsize(out))


def refusals(log):
    text = read(log)
    good = os.path.join(folder, "x.svg")
    version = write(os.path.join(folder, "v2.csv"), text.replace("# stiction-log 1", "# stiction-log 2", 1))
    cut = write(os.path.join(folder, "cut.csv"), text[:-20])
    bad = write(os.path.join(folder, "bad.csv"), text + "1,2,3\n")
    empty = write(os.path.join(folder, "empty.csv"), "".join(l for l in text.splitlines(True) if l[0] in "#t"))
    lines = text.count("\n")
    for what, arguments, code, words in (
        ("a log of another version", (version,), 3, "v2.csv:1: "),
        ("a cut log", (cut,), 3, f"cut.csv:{lines}: "),
        ("a bad row", (bad,), 3, f"bad.csv:{lines + 1}: "),
        ("an empty log", (empty,), 3, "no rows"),
        ("no log", (os.path.join(folder, "none.csv"),), 3, "none.csv"),
        ("no argument", (), 2, "LOG"),
        ("another figure", (log, "--figure", "13"), 2, "9, 10, 11, 12 or all"),
        ("one file for all", (log, "--out", good), 2, "--figure"),
        ("two formats", (log, "--figure", "11", "--out", good, "--format", "pdf"), 2, "--format"),
        ("another format", (log, "--format", "gif"), 2, "svg, pdf or png"),
        ("no time", (log, "--from", "soon", "--figure", "9", "--out", good), 2, "seconds"),
        ("a stretch backwards", (log, "--from", "3", "--to", "2", "--figure", "9", "--out", good), 2, "earlier"),
        ("a stretch beyond", (log, "--from", "99", "--figure", "9", "--out", good), 2, "no rows from 99 s;"),
        ("a stretch before", (log, "--to", "-1", "--out", os.path.join(folder, "none")), 2, "no rows to -1 s;"),
        ("the log as the plot", (log, "--out", log, "--figure", "9"), 2, "input"),
        ("an absent folder", (log, "--out", os.path.join(folder, "no/x.svg"), "--figure", "9"), 5, "x.svg"),
        ("a bad scene", (log, "--scene", log, "--figure", "9", "--out", good), 3, "log.csv"),
    ):
        done = run("plot", *arguments)
        equal(f"{what} is refused with {code}", done.returncode, code)
        check(f"{what}: one message that says it", words in done.stderr and len(done.stderr.strip().splitlines()) == 1, done.stderr)
    check("refusals leave nothing", not os.path.exists(good) and not os.path.exists(os.path.join(folder, "none")))
    done = run("plot", log, "--figure", "9", "--out", good, env={**os.environ, "PATH": "/nowhere"})
    equal("without gnuplot it ends with 2", done.returncode, 2)
    check("and names the package", "gnuplot-nox" in done.stderr, done.stderr)
    temporary = os.path.join(folder, "temporary")
    os.mkdir(temporary)
    run("plot", log, "--figure", "9", "--out", good, env={**os.environ, "TMPDIR": temporary})
    equal("nothing stays in the temporary folder", os.listdir(temporary), [])


with tempfile.TemporaryDirectory(prefix="stiction-plot-test-") as folder:
    scene = write(os.path.join(folder, "scene.yaml"), SCENE)
    hand = write(os.path.join(folder, "hand.csv"), trace())
    first_log = os.path.join(folder, "log.csv")
    equal("replay", run("replay", scene, hand, "--log", first_log).returncode, 0)
    figures(first_log, rows(first_log))
    choices(first_log)
    short_logs(first_log)
    long_log()
    refusals(first_log)
finish()
