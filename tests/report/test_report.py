"""The review page in a headless Chromium."""
import collections
import hashlib
import math
import os
import random
import struct
import tempfile
import time

from browser import Browser, find
from common import MAKE_PAGE, OUT, SCENE, check, equal, finish, rows, run, skip, trace, write

if not find():
    skip("there is no Chromium (package chromium)")
if "\nvideo: none" in run("--version").stdout:
    skip("this build makes no video (packages libav...-dev)")

# Libraries that a video loads and unloads again leave what a leak checker cannot name.
LEAKS = {**os.environ, "ASAN_OPTIONS": "detect_leaks=1"}
os.environ["ASAN_OPTIONS"] = "detect_leaks=0"

FPS = 31
READ_CODE = """(() => {
  const v = stiction.video, c = document.createElement("canvas"), g = c.getContext("2d", {willReadFrequently: true});
  c.width = 640; c.height = 360; g.drawImage(v, 0, 0);
  let n = 0;
  for (let bit = 0; bit < 12; bit++)
    if (g.getImageData(bit * 48 + 24, 24, 1, 1).data[1] > 127) n |= 1 << bit;
  return n;
})()"""
SETTLED = "!stiction.video.seeking && Math.abs(stiction.video.currentTime - (stiction.frame + 0.5) / %d) < 1e-3" % FPS


def make(name, video, *more):
    path = os.path.join(folder, name)
    done = run(path, scene, hand, str(FPS), video, *more, program=MAKE_PAGE, env=None if video == "barcode" else LEAKS)
    check(f"{name} is made", done.returncode == 0, done.stderr)
    return path


def quiet(page, name):
    equal(f"{name}: nothing on the console", page.problems(), [])
    equal(f"{name}: no request", page.requests(), [])


def frame_codes(page):
    """Random seeks, then steps one after the other by key."""
    generator, wrong = random.Random(1), []
    last = page.run("stiction.model.frames - 1")
    for i in [generator.randint(0, last) for _ in range(40)] + [0, last]:
        page.run(f"stiction.go({i})")
        page.wait(SETTLED)
        if page.run(READ_CODE) != i:
            wrong.append(i)
    equal("seeks show the frame asked for", wrong, [])
    page.key("Home")
    wrong = []
    for i in range(1, 41):
        page.key("ArrowRight")
        page.wait(SETTLED)
        if page.run(READ_CODE) != i or page.run("stiction.frame") != i:
            wrong.append(i)
    equal("steps show the next frame", wrong, [])
    # Keys faster than the player seeks end at the right frame all the same.
    page.run("stiction.go(0)")
    for _ in range(25):
        page.key("ArrowRight")
    page.wait(SETTLED)
    equal("fast steps end right", page.run(READ_CODE), 25)


def playing(page):
    page.run("stiction.go(10)")
    page.wait(SETTLED)
    page.key(" ")
    page.wait("stiction.frame > 40")
    page.key(" ")
    equal("space stops", page.run("stiction.playing"), False)
    page.wait(SETTLED)
    equal("the frame shown is the one it stopped at", page.run(READ_CODE), page.run("stiction.frame"))
    page.run("stiction.go(stiction.model.frames - 8)")
    page.key(" ")
    page.wait("!stiction.playing")
    equal("it stops at the end", page.run("stiction.frame"), page.run("stiction.model.frames - 1"))


def frame_of(t):
    return max(0, -int(-(t * FPS - 1e-6) // 1))


def keys(page, log):
    slips = sorted({frame_of(float(r["t"])) for r in log if int(r["flags"]) & 1})
    states = sorted({frame_of(float(b["t"])) for a, b in zip(log, log[1:]) if a["state"] != b["state"]})
    check("the run has slips and states", len(slips) > 5 and len(states) > 1, (slips, states))
    for key, back, places in (("n", "p", slips), ("s", "S", states)):
        found = []
        page.key("Home")
        for _ in places:
            page.key(key)
            found.append(page.run("stiction.frame"))
        equal(f"{key} goes from one to the next", found, places)
        page.key(key)
        equal(f"{key} stays at the last", page.run("stiction.frame"), places[-1])
        page.key("End")
        found = []
        for _ in places:
            page.key(back)
            found.append(page.run("stiction.frame"))
        equal(f"{back} goes back", found, [p for p in reversed(places) if p < page.run("stiction.model.frames - 1")][:len(places)])
    page.key("Home")
    page.key("ArrowRight", shift=True)
    equal("shift makes ten", page.run("stiction.frame"), 10)
    page.key("ArrowLeft")
    equal("left goes back", page.run("stiction.frame"), 9)
    page.key("?")
    equal("? opens the keys", page.run("document.getElementById('help').open"), True)
    page.key("?")
    equal("and closes them", page.run("document.getElementById('help').open"), False)


def plots(page, log):
    equal("plots are there", page.run("charts.panels().length") >= 6, True)
    middle = float(log[-1]["t"]) / 2
    box = page.run("(() => { const u = charts.panels()[1].plot, r = u.over.getBoundingClientRect();"
                   f"return [r.left + u.valToPos({middle}, 'x'), r.top + r.height / 2]; }})()")
    page.click(*box)
    check("a click in a plot goes there", abs(page.run("stiction.frame") - middle * FPS) < 1, page.run("stiction.frame"))
    row = log[page.run("stiction.model.frameRow[stiction.frame]")]
    check("data are those of the log", abs(page.run("stiction.model.x[stiction.model.frameRow[stiction.frame]]") - float(row["x"])) < 1e-6)
    check("labels show the values", f"{float(row['x']):.4f}" in page.run("document.querySelector('.panel').innerText"),
          page.run("document.querySelector('.panel').innerText"))
    check("units are shown", all(u in page.run("document.getElementById('plots').innerText") for u in ("/ m", "/ °", "/ N")))


def events_table(page, events):
    shown = page.run("[...document.querySelectorAll('#events tbody tr')].map(r => [...r.cells].map(c => c.textContent))")
    equal("all events are listed", len(shown), len(events))
    good = all(abs(float(s[0].replace("−", "-")) - float(e["t"])) < 1e-6 and s[1] == e["event"] for s, e in
               zip(shown, sorted(events, key=lambda e: float(e["t"]))))
    check("with their times and kinds", good)
    page.run("document.querySelectorAll('#events tbody tr')[2].click()")
    check("a click goes to the event", abs(page.run("stiction.frame / 31") - float(events[2]["t"])) <= 1 / FPS + 1e-6)
    page.run("document.querySelector('#event-kinds input').click()")
    check("kinds can be hidden", page.run("document.querySelectorAll('#events tbody tr').length") < len(events))


def size_of_png(path):
    with open(path, "rb") as file:
        return struct.unpack(">II", file.read(24)[16:24])


def with_video(browser, log, events):
    path = make("barcode.html", "barcode", "timing")
    page = browser.page()
    page.open(path)
    equal("the video is taken", page.run("document.documentElement.dataset.video"), "ready")
    print(f"     {os.path.getsize(path)} bytes, plots after {page.plots_s:.2f} s, video after {page.video_s:.2f} s")
    check("plots and first frame within 2 s", page.video_s < 2 * float(os.environ.get("SLOW", "2")), page.video_s)
    frame_codes(page)
    playing(page)
    keys(page, log)
    plots(page, log)
    events_table(page, events)
    check("histogram has the deadline", "31 Hz" in page.run("document.getElementById('histogram').textContent"))
    check("provenance has the trace's hash", page.run("stiction.model.run.sha256") == sha256(hand))
    equal("names are text, not markup", page.run("document.querySelector('h1').textContent"), "<b>drag</b> & 'turn'")
    check("the scene's text is whole", page.run("document.getElementById('scene-text').textContent") == SCENE)
    quiet(page, "barcode.html")


def sha256(path):
    with open(path, "rb") as file:
        return hashlib.sha256(file.read()).hexdigest()


def without_video(browser):
    path = make("plain.html", "none")
    again = make("again.html", "none")
    with open(path, "rb") as a, open(again, "rb") as b:
        check("without timing the same run gives the same page", a.read() == b.read())
    page = browser.page()
    page.open(path)
    equal("there is no video", page.run("document.documentElement.dataset.video"), "none")
    page.key("n")
    check("keys work all the same", page.run("stiction.frame") > 0)
    before = page.run("stiction.frame")
    page.key(" ")
    page.wait(f"stiction.frame > {before} + 5")
    page.key(" ")
    check("the scene is drawn", page.run("""(() => { const c = document.getElementById('sketch'), d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;
      const seen = new Set(); for (let i = 0; i < d.length; i += 4) seen.add(d[i] << 16 | d[i + 1] << 8 | d[i + 2]); return seen.size; })()""") > 8)
    quiet(page, "plain.html")
    # A browser that cannot decode the video: here, because it is none.
    broken = make("broken.html", write(os.path.join(folder, "broken.mp4"), "this is no video"))
    page = browser.page()
    page.open(broken)
    equal("a video that cannot be shown is replaced", page.run("document.documentElement.dataset.video"), "none")
    check("and it is said", "cannot show the video" in page.run("document.getElementById('screen-note').textContent"))


def pictures_of_page(browser):
    path = os.path.join(folder, "barcode.html")
    for width, height, theme in ((1280, 800, "light"), (1920, 1080, "light"), (1280, 800, "dark")):
        page = browser.page(width, height)
        page.theme(theme)
        page.open(path)
        page.run("stiction.go(100)")
        page.wait(SETTLED)
        time.sleep(0.2)
        shot = os.path.join(OUT, f"report-{width}-{theme}.png")
        page.screenshot(shot)
        equal(f"picture of {width} x {height}, {theme}", size_of_png(shot), (width, height))
        check("nothing is wider than the window", page.run("document.documentElement.scrollWidth") <= width)
        last = page.run("(() => { const r = charts.panels().at(-1).plot.root.getBoundingClientRect(); return r.bottom; })()")
        check("all plots are in sight", last <= height + 2, last)
    page.print_pdf(os.path.join(OUT, "report.pdf"))
    check("it prints", os.path.getsize(os.path.join(OUT, "report.pdf")) > 10000)
    quiet(page, "printing")


def program():
    """What the command line does and refuses."""
    page = os.path.join(folder, "page.html")
    small = ("--size", "320x240", "--quality", "fast")
    done = run("replay", scene, hand, "--report", page, "--timing", os.path.join(folder, "t.json"), *small)
    if done.returncode == 5:
        print("     no renderer here:", done.stderr.strip())
    equal("replay --report", done.returncode, 0)
    check("the page is there", os.path.exists(page))
    equal("nothing else is", [n for n in os.listdir(folder) if n.startswith(".")], [])
    seconds = float(log_rows[-1]["t"])
    check("at most 0.5 MB per second", os.path.getsize(page) < 0.5e6 * seconds + 3e5, os.path.getsize(page) / seconds)
    with open(page, encoding="utf-8") as file:
        text = file.read()
    check("the command line is in it", "--quality fast" in text)
    for what, arguments, code in (
        ("an absent folder", ("--report", os.path.join(folder, "no/page.html")), 5),
        ("a folder as the page", ("--report", folder), 5),
        ("the trace as the page", ("--report", hand), 2),
        ("two outputs in one", ("--report", page, "--log", page), 2),
        ("no pictures a second", ("--report", page, "--fps", "0"), 2),
        ("an absurd size", ("--report", page, "--size", "7x7"), 2),
    ):
        done = run("replay", scene, hand, *arguments)
        equal(f"{what} is refused with {code}", done.returncode, code)
        equal(f"{what}: one message", len(done.stderr.strip().splitlines()), 1)
    bad = write(os.path.join(folder, "bad.csv"), trace() + "1,2,3\n")
    done = run("replay", scene, bad, "--report", os.path.join(folder, "bad.html"), *small)
    equal("a bad trace ends with 3", done.returncode, 3)
    check("and leaves no page", not os.path.exists(os.path.join(folder, "bad.html")))
    equal("nor anything beside it", [n for n in os.listdir(folder) if n.startswith(".")], [])
    done = run("replay", scene, hand, "--report", "-", *small)
    check("a page to standard output", done.returncode == 0 and done.stdout.endswith("</html>\n"))
    check("has no video and says so", "without video" in done.stderr and len(done.stdout) < 1e6, done.stderr)
    done = run("replay", scene, hand, "--report", "/dev/full", *small)
    equal("a full disk ends with 5", done.returncode, 5)
    return page


def real_page(browser, path):
    page = browser.page()
    page.open(path)
    equal("the program's page shows its video", page.run("document.documentElement.dataset.video"), "ready")
    equal("its video is as long as it says", round(page.run("stiction.video.duration") * FPS), page.run("stiction.model.frames"))
    page.run("stiction.go(50)")
    page.wait(SETTLED)
    quiet(page, "page.html")


def round_bowl():
    """A disc led round in a bowl of twelve walls: more surfaces than colours."""
    walls = [(math.cos(a), math.sin(a), math.degrees(a) + 180) for a in (i * math.pi / 6 for i in range(12))]
    bowl = SCENE[:SCENE.index("surfaces:")].replace("x: 0.10, y: 0.14, angle_deg: 40", "x: 0") + "surfaces:\n" + "".join(
        f"  - {{name: w{i}, point: [{0.3 * x!r}, {0.3 * y!r}], normal_deg: {a!r}}}\n" for i, (x, y, a) in enumerate(walls))
    way = ["# stiction-trace 1"] + [f"{i / 31!r},{0.3 * min(i / 31, 1) * math.cos(i / 40)!r},"
                                    f"{0.3 * min(i / 31, 1) * math.sin(i / 40)!r},0,0,0,0,1,0" for i in range(200)]
    return bowl, "\n".join(way) + "\n"


def odd_runs(browser):
    """More surfaces than colours, a single row, and a narrow window."""
    texts = {"bowl": round_bowl(), "one": (SCENE, "# stiction-trace 1\n5,0.1,0.2,0,0,0,0,1,0\n")}
    paths = {}
    for name, files in texts.items():
        files = [write(os.path.join(folder, f"{name}.{kind}"), text) for kind, text in zip(("yaml", "csv"), files)]
        paths[name] = os.path.join(folder, name + ".html")
        done = run(paths[name], *files, str(FPS), "none", program=MAKE_PAGE, env=LEAKS)
        check(f"{name} is made", done.returncode == 0, done.stderr)
    done = run("replay", os.path.join(folder, "bowl.yaml"), os.path.join(folder, "bowl.csv"), "--log",
               os.path.join(folder, "bowl.log"))
    seen = collections.Counter(s for r in rows(os.path.join(folder, "bowl.log"))
                               for s in {r[f"c{n}_surface"] for n in range(1, 5)} if s)
    check("the bowl is touched at many places", len(seen) > 5, seen)
    most = sorted(sorted(seen, key=lambda s: (-seen[s], int(s)))[:4], key=int)
    page = browser.page(420, 800)
    page.open(paths["bowl"])
    equal("curves of the surfaces touched longest", page.run("stiction.model.surfaces.map(s => String(s.index))"), most)
    check("and how many there are besides", f"and {len(seen) - 4} more" in page.run("document.getElementById('plots').innerText"),
          page.run("document.getElementById('plots').innerText"))
    page.run("stiction.go(stiction.model.frames - 1)")
    check("in a narrow window no numbers over each other", page.run(
        "document.querySelector('.readout dl').getBoundingClientRect().bottom <= document.getElementById('contacts').getBoundingClientRect().top"))
    quiet(page, "bowl.html")
    page = browser.page()
    page.open(paths["one"])
    for i in range(3):
        found = page.run(f"charts.panels()[{i}].plot.axes[1]._values")
        check(f"numbers of a flat curve can be told apart, {i}", len(found) == len(set(found)) > 1, found)
    check("a single row is seen", page.run("charts.panels().every(p => p.plot.series.slice(1).every(s => s.points.show(p.plot, 1)))"))
    quiet(page, "one.html")


with tempfile.TemporaryDirectory(prefix="stiction-report-") as folder:
    scene = write(os.path.join(folder, "scene.yaml"), SCENE)
    hand = write(os.path.join(folder, "hand.csv"), trace())
    log, events = os.path.join(folder, "log.csv"), os.path.join(folder, "events.csv")
    equal("replay", run("replay", scene, hand, "--log", log, "--events", events).returncode, 0)
    log_rows = rows(log)
    made = program()
    with Browser() as chromium:
        with_video(chromium, log_rows, rows(events))
        without_video(chromium)
        pictures_of_page(chromium)
        real_page(chromium, made)
        odd_runs(chromium)
finish()
