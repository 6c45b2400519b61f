#!/usr/bin/env python3
"""Checks the explorer's page in a browser: its figures equal those of `raya render`, to the last printed digit, for every static mapping; the page
sends no requests; controls, pointer, keys and links work; the page has no faults at three widths, light and dark, printed, and without scripts.
Injected faults test the checks.

    tests/tools/test_explore.py RAYA
RAYA_THOROUGH=1: more settings, all faults. RAYA_EXPLORE_SEED: another seed. Exit code 77: no Chromium.
"""
import base64, gzip, json, os, random, re, subprocess, sys, tempfile
from pathlib import Path

import browser
from page_checks import INSPECT, complaints
from page_report import report_of, with_report

THOROUGH = os.environ.get("RAYA_THOROUGH") == "1"
SEED = int(os.environ.get("RAYA_EXPLORE_SEED", "1993"))
WIDTHS = (400, 820, 1400)
SCENES = Path(__file__).resolve().parents[2] / "scenes"

# Opens links and returns the page's texts and figures for each link; if `whole`, also loads and curves.
FOLLOW_LINKS = r"""(async (cases) => {
  const answers = [];
  for (const {link, whole} of cases) {
    if (location.hash !== "#" + link) {
      const changed = new Promise((done) => addEventListener("hashchange", done, {once: true}));
      location.hash = link;
      await changed;
    }
    while (whole && explorer.curves.known < explorer.size.width) await new Promise((done) => setTimeout(done, 5));
    const texts = Object.fromEntries([...document.querySelectorAll("[data-figure]")].map((e) => [e.dataset.figure, e.textContent]));
    const {figures: f, curves} = explorer;
    answers.push({texts, imbalance: f.imbalance, pes: f.setting.pes, moves: [f.rotations, f.rotations * f.setting.pes * 3 * f.maxShare, f.transfers, f.broadcasts], message: document.getElementById("message").hidden ? "" : document.getElementById("message").textContent,
                  ...(whole ? {loads: [...f.loads], cyclic: [...curves.values.cyclic], block: [...(curves.values.block || curves.values.cyclic)]} : {})});
  }
  return answers;
})"""

# [(id, accessible name)] of all visible controls.
CONTROL_NAMES = r"""(() => [...document.querySelectorAll("input, select, button")].filter((e) => e.checkVisibility())
  .map((e) => [e.id || e.name, (e.getAttribute("aria-label") || [...(e.labels || [])].map((l) => l.textContent).join(" ") || e.textContent).trim()]))()"""


def start(page, url, **view):
    page.open("about:blank")  # otherwise a link within the same page would not reload it
    page.open(url, **view)
    if view.get("scripts", True):
        page.value("ready")


WIDTH, HEIGHT = 48, 36
SQUARE_OPTIONS = ["--size", "64x64", "--lanes", "4", "--format", "fp32"]  # on the SPA, which has a time model
# Cyclic mappings with both folds: as many PEs as columns; fewer PEs, whose number divides the number of columns or not; more PEs than columns. Then
# every other static mapping.
SETTINGS = [("cyclic:7", 48, "cyclic"), ("cyclic:13", 12, "cyclic"), ("cyclic:5", 20, "cyclic"), ("cyclic:5", 20, "block"), ("cyclic:40", 12, "block"),
            ("cyclic:11", 100, "cyclic"), ("cyclic:11", 100, "block"), ("column", 7, "block"), ("rows", 7, ""), ("blocks", 10, ""), ("grid:3x8", 24, ""),
            ("grid:7x2", 14, ""), ("tiles:8x3", 9, ""), ("random:1", 17, ""), ("random:4000000000", 48, "")]


def random_setting(rng):
    kind, pes = rng.choice(["cyclic", "cyclic", "rows", "blocks", "grid", "tiles", "random"]), rng.choice([1, 12, 48, rng.randint(2, 300)])
    a, b = rng.randint(1, 12), rng.randint(1, 12)
    more = {"cyclic": f":{rng.randrange(WIDTH)}", "grid": f":{a}x{b}", "tiles": rng.choice([":8x6", ":4x4", ":1x36"]),
            "random": f":{rng.randrange(2 ** 32)}"}
    return kind + more.get(kind, ""), a * b if kind == "grid" else pes, rng.choice(["cyclic", "block"]) if kind == "cyclic" else ""


def with_separators(number):
    return f"{number:,}".replace(",", "\u202f")


def expected_figures(raya, folder, scene, settings):
    """Renders with each setting. Yields the figures that the page must show: loads, and for mappings that allow antialiasing also the moves of the
    3 x 3 filter."""
    # The machine `grande` has no memory limit, so all pixels of a PE move at the same time.
    report = Path(folder, "report.json")
    size = ["--size", f"{WIDTH}x{HEIGHT}", "--machine", "grande", "--accel", "none", "--lanes", "4", "--format", "fp32"]

    def render(mapping, pes, fold, *more):
        options = ["--mapping", mapping, "--pes", str(pes), *(["--fold", fold] if fold else []), *more]
        out = subprocess.run([raya, "render", scene, "-o", Path(folder, "x.ppm"), *size, *options, "--report", report], check=True, capture_output=True, text=True)
        return json.loads(report.read_text()), out.stdout

    for mapping, pes, fold in settings:
        result, out = render(mapping, pes, fold)
        load, link = result["load"], f"mapping={mapping}&pes={pes}" + (f"&fold={fold}" if fold else "")
        u, speedup, efficiency = re.search(r"^load +u = (.*?), speed-up (.*?), efficiency (.*? %)", out, re.M).groups()
        loads = load["per_pe"]
        load_text = lambda cycles: f"{with_separators(cycles)} cycles (PE {loads.index(cycles)})"
        texts = {"u": u, "speedup": speedup, "efficiency": efficiency, "busiest": load_text(max(loads)), "idlest": load_text(min(loads)),
                 "mean": with_separators(round(load["mean"], 1)) + " cycles"}
        case = {"link": link, "texts": texts, "imbalance": load["imbalance"], "pes": pes, "loads": loads, "mapping": mapping, "fold": fold}
        if not mapping.startswith("random"):
            ring, bus, broadcast = (render(mapping, pes, fold, "--antialias", "filter", "--exchange", method)[0]["communication"] for method in ("ring", "bus", "bus-broadcast"))
            case["moves"] = [ring["rotations"], ring["rotation_words"], bus["transfers"], broadcast["pe_broadcasts"]]
            texts["bus"] = f"{with_separators(bus['transfers'])} transfers or {with_separators(broadcast['pe_broadcasts'])} broadcasts"
        yield case


def figure_differences(page, cases):
    """Yields the differences between the figures of the page and of the renders."""
    asked = [{"link": case["link"], "whole": True} for case in cases]
    for case, answer in zip(cases, page.value(f"{FOLLOW_LINKS}({json.dumps(asked)})")):
        if answer["message"]:
            yield f"{case['link']}: the page refuses this link: '{answer['message']}'"
        if case["mapping"].startswith("cyclic"):
            case["u_in_curve"], answer["u_in_curve"] = case["imbalance"], answer[case["fold"]][int(case["mapping"].split(":")[1])]
        answer["texts"] = {name: answer["texts"][name] for name in case["texts"]}
        for part in ("texts", "imbalance", "pes", "loads", "u_in_curve", "moves"):
            if part in case and case[part] != answer[part]:
                yield f"{case['link']}: {part}: the program has {str(case[part])[:200]}, the page {str(answer[part])[:200]}"


def check_arithmetic(page):
    """Returns complaints about figures that no render prints: shortest vectors (compared with a search of all pairs), rotations and times on Kohata &
    Ito's array, rounding to digits (compared with Python's)."""
    wrong = page.value("""(() => {
      const wrong = [], side = 48;
      const check = (setting, width) => {
        const size = {width, height: side}, owners = ownersOf(setting, size), vector = vectorOf(setting, size);
        let minimum = Infinity;
        for (let i = 0; i < owners.length; ++i)
          for (let j = 0; j < i; ++j)
            if (owners[i] === owners[j]) minimum = Math.min(minimum, (Math.floor(i / width) - Math.floor(j / width)) ** 2 + (i % width - j % width) ** 2);
        if (!vector || vector[0] ** 2 + vector[1] ** 2 !== minimum) wrong.push(`${JSON.stringify(setting)}: vector ${vector}, nearest pair ${minimum}`);
      };
      for (const pes of [8, 12, 24]) for (let offset = 0; offset < 24; ++offset) check({kind: "slots", fold: "cyclic", offset, pes}, pes === 24 ? 48 : 24);
      for (const [a, b] of [[3, 5], [5, 3], [4, 4], [1, 6]]) check({kind: "grid", pes: a * b, a, b}, 30);
      check({kind: "rows", pes: 7}, 30);
      for (const [fold, pes] of [["cyclic", 7], ["cyclic", 48], ["block", 12]])
        if (vectorOf({kind: "slots", fold, offset: 3, pes}, {width: 24})) wrong.push(`${fold} fold, ${pes} PEs: a vector, but the mapping is not a lattice`);
      for (const [offset, rotations] of [[0, 2], [8, 18], [16, 34]]) {
        const size = {width: 256, height: 256}, f = figuresOf({kind: "slots", fold: "cyclic", offset, pes: 256}, size, new Float64Array(65536).fill(1),
          {cycle_ns: 100, cycle_factor: 3, setup_ms: 2, link_words_per_s: 1e6, rotation_sync_ms: 0.25});
        if (f.rotations !== rotations || f.maxShare !== 256 || f.imbalance !== 0) wrong.push(`p = ${offset}: ${f.rotations} rotations`);
        if (Math.abs(f.time.compute - 0.0768) > 1e-9 || Math.abs(f.time.rotations - 2 - rotations * (0.25 + 0.768)) > 1e-9) wrong.push(`p = ${offset}: ${f.time.compute} and ${f.time.rotations} ms`);
      }
      return wrong;
    })()""")
    rng = random.Random(SEED)
    numbers = [(rng.choice([rng.randrange(1 << 20) * 2.0 ** -rng.randrange(12), rng.randrange(1 << 30) / rng.randint(1, 100000)]), i % 4) for i in range(400)]
    for (value, digits), text in zip(numbers, page.value(f"{json.dumps(numbers)}.map(([value, digits]) => fixed(value, digits))")):
        if text != f"{value:.{digits}f}":
            wrong.append(f"{value!r} rounded to {digits} digits: {text}")
    return wrong


def check_costs(page, html, folder):
    """Yields a complaint if the page does not decode costs up to a sum of 2^53 - 1, or does not report incomplete costs."""
    report, rng, changed_page = report_of(html.read_text()), random.Random(SEED), Path(folder, "costs.html")
    for bits in (0, 9, 33, 41):
        cycles = [rng.getrandbits(bits) if bits else 0 for _ in range(WIDTH * HEIGHT)]
        if bits == 41:
            cycles[-1] += 2 ** 53 - 1 - sum(cycles)
        bytes_ = max(1, (max(cycles).bit_length() + 7) // 8)
        planes = b"".join(bytes(cost >> 8 * byte & 255 for cost in cycles) for byte in range(bytes_))
        report["cost"] = {"bytes": bytes_, "gzip": base64.b64encode(gzip.compress(planes)).decode()}
        changed_page.write_text(with_report(html.read_text(), report))
        start(page, changed_page.as_uri())
        figures_right = page.value("[...explorer.costs]") == cycles and page.value("explorer.figures.sum") == sum(cycles)
        if not figures_right or with_separators(sum(cycles)) not in page.value("document.body.innerText"):
            yield f"costs of {bits} bits are not decoded"
        if not bits and page.value("[explorer.figures.busiest, explorer.figures.idlest]") != [0, 0]:
            yield "equal loads: the page does not name the first PE"
        yield from complaints(page)
    report["cost"]["bytes"] += 1
    changed_page.write_text(with_report(html.read_text(), report))
    start(page, changed_page.as_uri())
    if "cannot be shown: the embedded costs are incomplete" not in page.value("document.body.innerText"):
        yield "incomplete costs are not reported"


def check_views(page, html):
    """Yields complaints about the page at all widths, with both colour schemes, printed, and without scripts."""
    for width, dark, scripts, media in [(w, d, True, "") for w in WIDTHS for d in (False, True)] + [(820, False, False, ""), (700, False, True, "print")]:
        start(page, html.as_uri(), width=width, dark=dark, scripts=scripts, media=media)
        view = f"{width} pixels{', dark' * dark}{', no scripts' * (not scripts)}{', printed' * bool(media)}: "
        if not scripts:
            yield from (view + wrong for wrong in [*page.value(INSPECT)["wrong"], *complaints(page)])
            if page.value("JSON.parse(document.getElementById('report').innerText).kind") != "raya explore":
                yield f"{view}the report is not shown as JSON"
            continue
        page.value("document.querySelectorAll('details').forEach((e) => { e.open = true; })")
        found_elements = page.value(INSPECT)
        yield from (view + wrong for wrong in [*found_elements["wrong"], *complaints(page)])
        if found_elements["texts"] < 50 or found_elements["title"] != "raya explore: spheres.nff":
            yield f"{view}{found_elements['texts']} texts, expected at least 50; title {found_elements['title']}"
        controls = page.value(CONTROL_NAMES)
        if any(not name for _, name in controls):
            yield f"{view}a control has no accessible name: {controls}"
        has_offset = any(id == "offset" for id, _ in controls)
        if has_offset == bool(media):
            yield f"{view}the offset control is {'visible on the printed page' if has_offset else 'not visible'}"
        for canvas in page.value("[...document.querySelectorAll('canvas')].filter((e) => e.checkVisibility()).map((e) => [e.id, new Set(new Uint32Array("
                                 "e.getContext('2d').getImageData(0, 0, e.width, e.height).data.buffer)).size, e.getBoundingClientRect().width])"):
            if canvas[1] < 4 or canvas[2] < 200:
                yield f"{view}the canvas {canvas[0]} is incomplete: {canvas[1]} colours, {canvas[2]} pixels wide"
        for name, marks, width_ in page.value("[...document.querySelectorAll('svg')].map((e) => [e.getAttribute('aria-label'), e.querySelectorAll('path').length, e.getBoundingClientRect().width])"):
            if len(name) < 20 or marks < 8 or width_ < 200:
                yield f"{view}the drawing '{name}' is incomplete: {marks} paths, {width_} pixels wide"


def press_key(page, name):
    page.ask("Input.dispatchKeyEvent", type="keyDown", key=name, code=name, windowsVirtualKeyCode={"ArrowRight": 39, "ArrowLeft": 37, "End": 35}.get(name, 0))
    page.ask("Input.dispatchKeyEvent", type="keyUp", key=name, code=name)
    settle(page)


def settle(page):
    page.value("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")


def mouse(page, kind, canvas, across, down=0.5, **more):
    """Dispatches a mouse event at a fraction of a canvas's width and height."""
    page.value(f"document.getElementById('{canvas}').scrollIntoView({{block: 'center', behavior: 'instant'}})")
    x, y, w, h = page.value(f"(({{x, y, width, height}}) => [x, y, width, height])(document.getElementById('{canvas}').getBoundingClientRect())")
    page.ask("Input.dispatchMouseEvent", type=kind, x=x + across * w, y=y + down * h, **more)
    settle(page)


def check_controls(page, html):
    """Yields complaints about pointer, keys, fields, buttons and links of the square page, 64 x 64."""
    state = "[mappingText(explorer.state), settingOf(explorer.state).pes, explorer.state.fold, explorer.state.pe, explorer.state.view]"

    def expect(what, *wanted):
        got = page.value(state)
        if got[:len(wanted)] != list(wanted):
            yield f"{what}: {got}, not {wanted}"

    start(page, html.as_uri() + "#mapping=cyclic:8&pes=64", width=1400)
    yield from expect("a link with mapping and PEs", "cyclic:8", 64, "cyclic", None, "owners")
    page.value("document.getElementById('offset-slider').focus()")
    press_key(page, "ArrowRight")
    yield from expect("the right arrow key on the slider of the offset", "cyclic:9", 64)
    press_key(page, "End")
    yield from expect("the end key on the slider of the offset", "cyclic:63", 64)
    page.value("document.getElementById('pes-slider').focus()")
    press_key(page, "ArrowLeft")
    yield from expect("the left arrow key on the slider of the PEs", "cyclic:63", 63)
    page.value("document.getElementById('root').click()")
    settle(page)
    yield from expect("the button p = sqrt(P)", "cyclic:8", 63)
    page.value("new Promise((done) => { const wait = () => explorer.curves.best ? done() : setTimeout(wait, 5); wait(); })")
    settle(page)
    page.value("document.getElementById('best').click()")
    settle(page)
    best_offset = page.value("explorer.curves.values.cyclic.indexOf(Math.min(...explorer.curves.values.cyclic))")
    yield from expect("the button of the best offset", f"cyclic:{best_offset}", 63)

    page.value("document.getElementById('pe').focus()")
    page.ask("Input.insertText", text="12")
    settle(page)
    yield from expect("entering a PE's number", f"cyclic:{best_offset}", 63, "cyclic", 12)
    if "PE 12 owns" not in page.value("document.getElementById('pointed').textContent"):
        yield "the page does not describe the selected PE 12"
    white = page.value("(() => { const c = document.getElementById('picture'); return new Uint32Array(c.getContext('2d').getImageData(0, 0, c.width, c.height)"
                       ".data.buffer).reduce((n, w, at) => n + (w === 0xffffffff) * (explorer.figures.owners[at] === 12 ? 1 : 1e6), 0); })()")
    owned = page.value("explorer.figures.sizes[12]")
    if white != owned:
        yield f"the pixels of the selected PE 12 are not white: {white} white pixels (each pixel of another PE counts 10^6), {owned} pixels of PE 12"
    page.value("document.getElementById('no-pe').click()")
    yield from expect("the button that shows all PEs", f"cyclic:{best_offset}", 63, "cyclic", None)

    mouse(page, "mouseMoved", "picture", (10 + 0.5) / 64, (20 + 0.5) / 64)
    description, owner, cost = page.value("[document.getElementById('pointed').textContent, explorer.figures.owners[20 * 64 + 10], grouped(explorer.costs[20 * 64 + 10])]")
    if not description.startswith(f"Row 20, column 10: {cost} cycles. PE {owner} owns"):
        yield f"pointed at row 20, column 10: {description}"
    mouse(page, "mousePressed", "picture", (10 + 0.5) / 64, (20 + 0.5) / 64, button="left", clickCount=1)
    mouse(page, "mouseReleased", "picture", (10 + 0.5) / 64, (20 + 0.5) / 64, button="left", clickCount=1)
    yield from expect("a click on a pixel", f"cyclic:{best_offset}", 63, "cyclic", owner)
    mouse(page, "mousePressed", "curves", 0.5, button="left", clickCount=1)
    mouse(page, "mouseMoved", "curves", 0.999, button="left", buttons=1)
    mouse(page, "mouseReleased", "curves", 0.999, button="left", clickCount=1)
    yield from expect("a drag in the curves", "cyclic:63", 63)

    page.value("document.querySelector('[name=view][value=loads]').click(), document.querySelector('[name=fold][value=block]').click()")
    settle(page)
    for name, mapping in (("rows", "rows"), ("tiles", "tiles:8x8"), ("random", "random:1"), ("column", "column")):
        page.value(f"(() => {{ const e = document.getElementById('mapping'); e.value = '{name}'; e.dispatchEvent(new Event('input', {{bubbles: true}})); }})()")
        settle(page)
        if name != "tiles":  # the page chooses the sides of tiles
            yield from expect(f"choosing {name}", mapping, 63)
    yield from expect("choosing view and fold", "column", 63, "block", owner, "loads")
    page.value("new Promise((done) => setTimeout(done, 400))")
    link, shown = page.value("[location.href, document.getElementById('link').href]")
    if link != shown or "fold=block" not in link:
        yield f"the address {link} differs from the shown link {shown}, or does not contain fold=block"
    start(page, link)
    yield from expect("the link, opened", "column", 63, "block", owner, "loads")
    command = page.value("document.getElementById('command').textContent")
    if not command.endswith("--mapping column --pes 63 --fold block"):
        yield f"the page shows the command {command}, expected the end --mapping column --pes 63 --fold block"

    for link in page.value("[...document.querySelectorAll('main li a')].map((a) => a.getAttribute('href').slice(1))"):
        answer = page.value(f"{FOLLOW_LINKS}([{{link: '{link}'}}])")[0]
        if answer["message"] or f"pes={answer['pes']}" not in link:
            yield f"the page's own link {link}: '{answer['message']}', {answer['pes']} PEs"

    start(page, html.as_uri() + "#mapping=cyclic:64&pes=0&fold=x&view=%00&pe=9999&what=ever", width=400)
    message = page.value("document.getElementById('message').hidden ? '' : document.getElementById('message').textContent")
    for part in ("offset p must be 0 to 63", "number of PEs must be 1 to 4096", "fold must be", "view must be", "PE to show must be"):
        if part not in message:
            yield f"a link with invalid values: '{message}' without '{part}'"
    for broken in ("mapping=grid:0x4", "mapping=grid:4096x4096", "mapping=tiles:5x5", "mapping=cyclic:-1", "mapping=", "mapping", "&&==", "mapping=grid:8x8&pes=5&pe=64"):
        start(page, html.as_uri() + "#" + broken)
        yield from (f"#{broken}: {wrong}" for wrong in complaints(page))
    yield from complaints(page)


# (text of the page, faulty replacement); the checks must then find a complaint.
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
    ("pe + pes - origin", "pe + pes - origin - 1"),
    ("n <= distances.length", "n < distances.length"),
    ("otherPes * pes", "otherPes"),
    ("rows * rows < squaredLength", "rows < 3"),
    ("width % pes === 0 : width === pes", "true : width === pes"),
    ("b <= a ? [0, b] : [a, 0]", "[a, 0]"),
    ("1e-6 * rates.cycle_ns", "1e-6 * 99"),
    ("3 * maxShare;", "maxShare;"),
    ("Number(truncated.at(-1)) % 2 === 0 ? truncated : ", ""),
    ("2 ** (8 * Math.floor(at / pixels))", "2 ** (7 * Math.floor(at / pixels))"),
    ("new Float64Array(pes);\n  for (let at", "new Float32Array(pes);\n  for (let at"),
]


def undetected_faults(page, html, cases, folder):
    text, broken = html.read_text(), Path(folder, "broken.html")
    for old, new in FAULTS if THOROUGH else FAULTS[::6]:
        if text.count(old) != 1:
            yield f"the page has '{old}' {text.count(old)} times instead of once: update FAULTS of this test"
            continue
        broken.write_text(text.replace(old, new))
        start(page, broken.as_uri())
        if not [*figure_differences(page, cases), *check_arithmetic(page)] and not [*check_costs(page, broken, folder)]:
            yield f"{new!r} instead of {old!r} is not detected"


def main():
    raya, scene = sys.argv[1], str(SCENES / "spheres.nff")
    if browser.program() is None:
        print("skipped: no Chromium (tools/setup --browser)")
        return 77
    wrong, rng = [], random.Random(SEED)
    settings = SETTINGS + [random_setting(rng) for _ in range(40 if THOROUGH else 0)]
    with tempfile.TemporaryDirectory() as folder, browser.Browser() as page:
        def explore(name, *size):
            html = Path(folder, name)
            output = subprocess.run([raya, "explore", scene, "-o", html, *size], check=True, capture_output=True, text=True).stdout
            assert f"page    {html} ({html.stat().st_size / 1e3:.0f} KB)" in output, output
            assert not re.search(r"https?://(?!www.w3.org/2000/svg)", html.read_text())
            return html

        html = explore("scene.html", "--size", f"{WIDTH}x{HEIGHT}", "--machine", "grande", "--accel", "none", "--lanes", "4", "--format", "fp32")
        square = explore("square.html", *SQUARE_OPTIONS)
        cases = list(expected_figures(raya, folder, scene, settings))
        start(page, html.as_uri())
        wrong += [*figure_differences(page, cases), *check_arithmetic(page), *complaints(page), *check_costs(page, html, folder)]
        print(f"seed {SEED}: {len(cases)} settings, {len(wrong)} complaints")
        report = Path(folder, "square.json")
        subprocess.run([raya, "render", scene, *SQUARE_OPTIONS, "-o", Path(folder, "x.ppm"), "--report", report, "--quiet"], check=True)
        start(page, square.as_uri())
        time = page.value("explorer.texts.time")
        if not time.startswith(f"{json.loads(report.read_text())['modelled_ms']['compute']:.1f} ms to trace, "):
            wrong.append(f"the page shows the time '{time}', which is not the modelled computing time of the render")
        wrong += check_views(page, square)
        wrong += check_controls(page, square)
        if not wrong:
            wrong += undetected_faults(page, html, cases, folder)
    for line in wrong:
        print("test_explore.py:", line, file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
