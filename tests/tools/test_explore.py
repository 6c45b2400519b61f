#!/usr/bin/env python3
"""The explorer's page in a browser: its figures are the program's, to the last printed digit, in hundreds of random settings; it asks for
nothing from anywhere; controls, pointer, keys and links do what they say; at three widths, light and dark, on paper and without scripts.
In the end the checks are tried on faults.

    tests/tools/test_explore.py EXPLORER_CASES RAYA      EXPLORER_CASES: tests/explore/write_explorer_cases.cpp
RAYA_THOROUGH=1: more settings, every fault. RAYA_EXPLORE_SEED: another seed. Exit code 77 where there is no Chromium.
"""
import json, os, random, re, subprocess, sys, tempfile
from pathlib import Path

import browser
from page_checks import LOOK, told

THOROUGH = os.environ.get("RAYA_THOROUGH") == "1"
SEED = int(os.environ.get("RAYA_EXPLORE_SEED", "1993"))
WIDTHS = (400, 820, 1400)
SCENES = Path(__file__).resolve().parents[2] / "scenes"

# Follows one link after another, and what the page says then; loads and curves where they are asked for.
FOLLOW = r"""(async (cases) => {
  const answers = [];
  for (const {link, whole} of cases) {
    if (location.hash !== "#" + link) {
      const heard = new Promise((done) => addEventListener("hashchange", done, {once: true}));
      location.hash = link;
      await heard;
    }
    while (whole && explorer.curves.known < explorer.about.width) await new Promise((done) => setTimeout(done, 5));
    const texts = Object.fromEntries([...document.querySelectorAll("[data-figure]")].map((e) => [e.dataset.figure, e.textContent]));
    const {figures: f, curves} = explorer;
    answers.push({texts, imbalance: f.imbalance, pes: f.setting.pes, message: document.getElementById("message").hidden ? "" : document.getElementById("message").textContent,
                  ...(whole ? {loads: [...f.loads], cyclic: [...curves.values.cyclic], block: [...(curves.values.block || curves.values.cyclic)]} : {})});
  }
  return answers;
})"""

# Every control that can be reached has a name; what they are.
NAMES = r"""(() => [...document.querySelectorAll("input, select, button")].filter((e) => e.checkVisibility())
  .map((e) => [e.id || e.name, (e.getAttribute("aria-label") || [...(e.labels || [])].map((l) => l.textContent).join(" ") || e.textContent).trim()]))()"""


def start(page, url, **view):
    page.open("about:blank")  # a link within a page would not load it anew
    page.open(url, **view)
    if view.get("scripts", True):
        page.value("explorer.ready")


def compared(page, cases):
    """What differs between the page and the program."""
    asked = [{"link": case["link"], "whole": "loads" in case} for case in cases]
    for case, answer in zip(cases, page.value(f"{FOLLOW}({json.dumps(asked)})")):
        if answer["message"]:
            yield f"{case['link']}: '{answer['message']}'"
        for part in ("texts", "imbalance", "pes", "loads", "cyclic", "block"):
            if part in case and case[part] != answer[part]:
                ours, theirs = case[part], answer[part]
                if part == "texts":
                    ours, theirs = [{k: v for k, v in a.items() if a[k] != b.get(k)} for a, b in ((ours, theirs), (theirs, ours))]
                yield f"{case['link']}: {part}: the program says {str(ours)[:200]}, the page {str(theirs)[:200]}"


def figures(page, html):
    """One page beside the program's figures of it."""
    said = json.loads(html.with_suffix(".json").read_text())
    start(page, html.as_uri())
    yield from compared(page, said["cases"])
    numbers = page.value(f"{json.dumps(said['numbers'])}.map(({{value, digits}}) => fixed(value, digits))")
    for one, text in zip(said["numbers"], numbers):
        if one["text"] != text:
            yield f"{one['value']!r} with {one['digits']} digits: the program says {one['text']}, the page {text}"
    yield from told(page)


def looks(page, html):
    """At all widths, light and dark, on paper, without scripts."""
    said = json.loads(html.with_suffix(".json").read_text())["cases"][0]
    for width, dark, scripts, media in [(w, d, True, "") for w in WIDTHS for d in (False, True)] + [(820, False, False, ""), (700, False, True, "print")]:
        start(page, html.as_uri(), width=width, dark=dark, scripts=scripts, media=media)
        view = f"{width} pixels{', dark' * dark}{', no scripts' * (not scripts)}{', on paper' * bool(media)}: "
        if scripts:
            page.value("document.querySelectorAll('details').forEach((e) => { e.open = true; })")
        look = page.value(LOOK)
        yield from (view + wrong for wrong in [*look["wrong"], *told(page)])
        if look["texts"] < 50 or "planted" in look["title"] and "<script>" not in look["title"]:
            yield f"{view}{look['texts']} texts, title {look['title']}"
        texts = page.value("Object.fromEntries([...document.querySelectorAll('[data-figure]')].map((e) => [e.dataset.figure, e.textContent]))")
        if texts != said["texts"]:
            yield f"{view}opens with {texts}, not {said['texts']}"
        controls = page.value(NAMES)
        if any(not name for _, name in controls):
            yield f"{view}without a name: {controls}"
        if bool(controls) != (scripts and not media):
            yield f"{view}{len(controls)} controls"
        shown = page.value("[...document.querySelectorAll('.stage > *')].filter((e) => e.checkVisibility()).map((e) => e.tagName).join()")
        if shown != ("CANVAS" if scripts else "IMG"):
            yield f"{view}the picture is shown as '{shown}'"
        for canvas in page.value("[...document.querySelectorAll('canvas')].filter((e) => e.checkVisibility()).map((e) => [e.id, new Set(new Uint32Array("
                                 "e.getContext('2d').getImageData(0, 0, e.width, e.height).data.buffer)).size, e.getBoundingClientRect().width])"):
            if canvas[1] < 4 or canvas[2] < 200:
                yield f"{view}canvas {canvas[0]} has {canvas[1]} colours and is {canvas[2]} pixels wide"


def key(page, name):
    page.ask("Input.dispatchKeyEvent", type="keyDown", key=name, code=name, windowsVirtualKeyCode={"ArrowRight": 39, "ArrowLeft": 37, "End": 35}.get(name, 0))
    page.ask("Input.dispatchKeyEvent", type="keyUp", key=name, code=name)
    settle(page)


def settle(page):
    page.value("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")


def mouse(page, kind, canvas, across, down=0.5, **more):
    """At so much of a canvas's width and height."""
    page.value(f"document.getElementById('{canvas}').scrollIntoView({{block: 'center', behavior: 'instant'}})")
    x, y, w, h = page.value(f"(({{x, y, width, height}}) => [x, y, width, height])(document.getElementById('{canvas}').getBoundingClientRect())")
    page.ask("Input.dispatchMouseEvent", type=kind, x=x + across * w, y=y + down * h, **more)
    settle(page)


def handled(page, html):
    """What pointer, keys, fields, buttons and links do; of the square page, 64 x 64."""
    state = "[mappingText(explorer.state), settingOf(explorer.state).pes, explorer.state.fold, explorer.state.pe, explorer.state.view]"

    def expect(what, *wanted):
        got = page.value(state)
        if got[:len(wanted)] != list(wanted):
            yield f"{what}: {got}, not {wanted}"

    start(page, html.as_uri() + "#mapping=cyclic:8&pes=64", width=1400)
    yield from expect("a link", "cyclic:8", 64, "cyclic", None, "owners")
    page.value("document.getElementById('offset-slider').focus()")
    key(page, "ArrowRight")
    yield from expect("right on the slider", "cyclic:9", 64)
    key(page, "End")
    yield from expect("end on the slider", "cyclic:63", 64)
    page.value("document.getElementById('pes-slider').focus()")
    key(page, "ArrowLeft")
    yield from expect("left on the PEs' slider", "cyclic:63", 63)
    page.value("document.getElementById('root').click()")
    settle(page)
    yield from expect("the root's button", "cyclic:8", 63)
    page.value("new Promise((done) => { const wait = () => explorer.curves.best ? done() : setTimeout(wait, 5); wait(); })")
    settle(page)
    page.value("document.getElementById('best').click()")
    settle(page)
    least = page.value("explorer.curves.values.cyclic.indexOf(Math.min(...explorer.curves.values.cyclic))")
    yield from expect("the best one's button", f"cyclic:{least}", 63)

    page.value("document.getElementById('pe').focus()")
    page.ask("Input.insertText", text="12")
    settle(page)
    yield from expect("a PE's number", f"cyclic:{least}", 63, "cyclic", 12)
    if "PE 12 owns" not in page.value("document.getElementById('pointed').textContent"):
        yield "nothing is told of the PE that is shown"
    white = page.value("(() => { const c = document.getElementById('picture'); return new Uint32Array(c.getContext('2d').getImageData(0, 0, c.width, c.height)"
                       ".data.buffer).reduce((n, w, at) => n + (w === 0xffffffff) * (explorer.figures.owners[at] === 12 ? 1 : 1e6), 0); })()")
    owned = page.value("explorer.figures.sizes[12]")
    if white != owned:
        yield f"{white} white pixels, {owned} of PE 12"
    page.value("document.getElementById('no-pe').click()")
    yield from expect("all PEs", f"cyclic:{least}", 63, "cyclic", None)

    mouse(page, "mouseMoved", "picture", (10 + 0.5) / 64, (20 + 0.5) / 64)
    words, owner, cost = page.value("[document.getElementById('pointed').textContent, explorer.figures.owners[20 * 64 + 10], grouped(explorer.costs[20 * 64 + 10])]")
    if not words.startswith(f"Row 20, column 10: {cost} cycles. PE {owner} owns"):
        yield f"pointed at row 20, column 10: {words}"
    mouse(page, "mousePressed", "picture", (10 + 0.5) / 64, (20 + 0.5) / 64, button="left", clickCount=1)
    mouse(page, "mouseReleased", "picture", (10 + 0.5) / 64, (20 + 0.5) / 64, button="left", clickCount=1)
    yield from expect("a click on a pixel", f"cyclic:{least}", 63, "cyclic", owner)
    mouse(page, "mousePressed", "curves", 0.5, button="left", clickCount=1)
    mouse(page, "mouseMoved", "curves", 0.999, button="left", buttons=1)
    mouse(page, "mouseReleased", "curves", 0.999, button="left", clickCount=1)
    yield from expect("a drag in the curves", "cyclic:63", 63)

    page.value("document.querySelector('[name=view][value=loads]').click(), document.querySelector('[name=fold][value=block]').click()")
    settle(page)
    for name, mapping in (("rows", "rows"), ("tiles", "tiles:8x8"), ("random", "random:1"), ("column", "column")):
        page.value(f"(() => {{ const e = document.getElementById('mapping'); e.value = '{name}'; e.dispatchEvent(new Event('input', {{bubbles: true}})); }})()")
        settle(page)
        if name != "tiles":  # their sides are the first page's own
            yield from expect(f"choosing {name}", mapping, 63)
    yield from expect("view and fold", "column", 63, "block", owner, "loads")
    page.value("new Promise((done) => setTimeout(done, 400))")
    link, shown = page.value("[location.href, document.getElementById('link').href]")
    if link != shown or "fold=block" not in link:
        yield f"the address is {link}, the link {shown}"
    start(page, link)
    yield from expect("the link, opened", "column", 63, "block", owner, "loads")
    command = page.value("document.getElementById('command').textContent")
    if not command.endswith("--mapping column --pes 63 --fold block"):
        yield f"the command is {command}"

    for link in page.value("[...document.querySelectorAll('main li a')].map((a) => a.getAttribute('href').slice(1))"):
        answer = page.value(f"{FOLLOW}([{{link: '{link}'}}])")[0]
        if answer["message"] or f"pes={answer['pes']}" not in link:
            yield f"the page's own link {link}: '{answer['message']}', {answer['pes']} PEs"

    start(page, html.as_uri() + "#mapping=cyclic:64&pes=0&fold=x&view=%00&pe=9999&what=ever", width=400)
    message = page.value("document.getElementById('message').hidden ? '' : document.getElementById('message').textContent")
    for part in ("offset p must be 0 to 63", "number of PEs must be 1 to 4096", "fold must be", "view must be", "PE to show must be"):
        if part not in message:
            yield f"a link to what cannot be: '{message}' without '{part}'"
    for broken in ("mapping=grid:0x4", "mapping=grid:4096x4096", "mapping=tiles:5x5", "mapping=cyclic:-1", "mapping=", "mapping", "&&==", "mapping=grid:8x8&pes=5&pe=64"):
        start(page, html.as_uri() + "#" + broken)
        yield from (f"#{broken}: {wrong}" for wrong in told(page))
    yield from told(page)


def rendered(page, raya, folder, count):
    """A page of a scene beside renders of it, as they are printed and reported."""
    rng, size = random.Random(SEED), ["--size", "48x36", "--machine", "grande", "--accel", "none", "--lanes", "4"]
    html = Path(folder, "scene.html")
    scene = str(SCENES / "spheres.nff")
    said = subprocess.run([raya, "explore", scene, "-o", html, *size], check=True, capture_output=True, text=True).stdout
    if f"page    {html} ({html.stat().st_size / 1e3:.0f} KB)" not in said:
        yield f"raya explore says {said}"
    start(page, html.as_uri())
    for _ in range(count):
        kind, pes, fold = rng.choice(["cyclic", "column", "rows", "blocks", "grid", "tiles"]), rng.choice([12, 48, rng.randint(2, 200)]), "cyclic"
        more = {"cyclic": f":{rng.randrange(48)}", "grid": f":{rng.randint(1, 12)}x{rng.randint(1, 12)}", "tiles": rng.choice([":8x6", ":4x4", ":1x36"])}.get(kind, "")
        options = ["--mapping", kind + more]
        if kind == "grid":
            pes = eval(more[1:].replace("x", "*"))
        if kind in ("cyclic", "column"):
            fold = rng.choice(["cyclic", "block"])
            options += ["--fold", fold]
        report = Path(folder, "report.json")
        out = subprocess.run([raya, "render", scene, "-o", Path(folder, "x.ppm"), *size, "--pes", str(pes), *options, "--antialias", "filter", "--report", report],
                             check=True, capture_output=True, text=True).stdout
        link = f"mapping={kind}{more}&pes={pes}&fold={fold}"
        answer = page.value(f"{FOLLOW}([{{link: '{link}', whole: true}}])")[0]
        made, texts = json.loads(report.read_text()), answer["texts"]
        line = f"u = {texts['u']}, speed-up {texts['speedup']}, efficiency {texts['efficiency']} "
        if line not in out:
            yield f"{link}: the page says {line}, the program {out}"
        rotations = made["communication"]["rotations"]
        words = rotations and made["communication"]["rotation_words"] // rotations // pes
        if answer["loads"] != made["load"]["per_pe"] or answer["message"]:
            yield f"{link}: loads {str(answer['loads'])[:80]} {answer['message']}, the program's {str(made['load']['per_pe'])[:80]}"
        narrow = texts["rotations"].replace("\u202f", "")
        if not narrow.startswith(f"{rotations} rotations of {words or ''}"):
            yield f"{link}: the page says {texts['rotations']}, the program {rotations} rotations of {words} words"
    yield from told(page)


# Text of the page, what takes its place; what it says of some setting must be found wrong then.
FAULTS = [
    ("slot % pes :", "(slot + 1) % pes :"),
    ("row % stepsBelow", "row % 1 + 0 * stepsBelow"),
    ("floorRatio(slot * pes, width);", "slot % pes;"),
    ("floorRatio(row * sharers, height)", "row % sharers"),
    ("0xc2b2ae35", "0xc2b2ae37"),
    ("bits - (bits >> 1)", "bits >> 1"),
    ("while (number >= count)", "while (false)"),
    ("(row) => row % pes", "(row) => (row + 1) % pes"),
    ("floorRatio(row * pes, height);\n  if (kind === \"grid\")", "row % pes;\n  if (kind === \"grid\")"),
    ("row % a * b", "row % a + b"),
    ("floorRatio(width, a) + floorRatio", "floorRatio(width, b) + floorRatio"),
    ("width - row * setting.offset % width", "width + row * setting.offset % width"),
    ("loads[pe] > loads[busiest]", "loads[pe] >= loads[busiest]"),
    ("(max - mean) / mean", "max / mean"),
    ("begin = (begin + offset) % width", "begin = (begin + offset + 1) % width"),
    ("from + pes - to", "from + pes - to - 1"),
    ("n <= distances.length", "n < distances.length"),
    ("distant * pes", "distant"),
    ("rows * rows < square", "rows < 3"),
    ("width % pes === 0 : width === pes", "true : width === pes"),
    ("b <= a ? [0, b] : [a, 0]", "[a, 0]"),
    ("1e-6 * machine.cycleNs", "1e-6 * 99"),
    ("3 * share;", "share;"),
    ("Number(down.at(-1)) % 2 === 0 ? down : ", ""),
    ("2 ** (8 * Math.floor(at / pixels))", "2 ** (7 * Math.floor(at / pixels))"),
    ("new Float64Array(pes);\n  for (let at", "new Float32Array(pes);\n  for (let at"),
]


def faults_missed(page, pages, folder):
    for old, new in FAULTS if THOROUGH else FAULTS[::6]:
        for html in pages:
            text = html.read_text()
            if text.count(old) != 1:
                yield f"'{old}' stands {text.count(old)} times in the page, where a fault is to go"
                break
            broken = Path(folder, "broken.html")
            broken.write_text(text.replace(old, new))
            broken.with_suffix(".json").write_bytes(html.with_suffix(".json").read_bytes())
            if next(figures(page, broken), None):
                break
        else:
            yield f"nobody sees {new!r} for {old!r}"


def main():
    cases, raya = sys.argv[1:3]
    if browser.program() is None:
        print("skipped: no Chromium (tools/setup --browser)")
        return 77
    count = 120 if THOROUGH else 40
    wrong = []
    with tempfile.TemporaryDirectory() as folder, browser.Browser() as page:
        subprocess.run([cases, folder, str(SEED), str(count)], check=True)
        pages = sorted(Path(folder).glob("*.html"))
        for html in pages:
            wrong += [f"{html.stem}: {text}" for text in figures(page, html)]
            if html.stat().st_size >= 1e6 or re.search(r"https?:", html.read_text()):
                wrong.append(f"{html.stem}: {html.stat().st_size} bytes, or an address")
        print(f"seed {SEED}: {len(pages)} pages with {count} settings each: {len(wrong)} complaints")
        square = Path(folder, "square.html")
        wrong += looks(page, square)
        wrong += handled(page, square)
        wrong += rendered(page, raya, folder, 24 if THOROUGH else 4)
        if not wrong:
            wrong += faults_missed(page, [p for p in pages if p.stem in ("wide", "odd", "huge", "nothing", "square", "large")], folder)
    for line in wrong:
        print("test_explore.py:", line, file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
