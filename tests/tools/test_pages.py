#!/usr/bin/env python3
"""Checks pages of reports in a browser: they send no requests, fit their window, and are readable at three widths, light and dark, printed, without
scripts, with a screen reader and by keyboard; their columns sort. No text of a report becomes markup. The page of a damaged report names the parts
that it cannot show. Injected faults test the checks.

    tests/tools/test_pages.py RAYA [FOLDER]      FOLDER: for screenshots of all views
RAYA_PAGE_SEED: seed of the damage; RAYA_THOROUGH=1: all views, and more damage. Exit code 77: no Chromium.
"""
import json, os, random, subprocess, sys, tempfile
from pathlib import Path

import browser
from page_checks import INSPECT, complaints
from page_report import HOSTILE, gpu_day, report_of, values_of, with_report

WIDTHS = (400, 820, 1400)
SCENES = Path(__file__).resolve().parents[2] / "scenes"
RAYA = sys.argv[1]
SEED, THOROUGH = int(os.environ.get("RAYA_PAGE_SEED", "20")), os.environ.get("RAYA_THOROUGH") == "1"
DAMAGED_REPORTS = 8 if THOROUGH else 2
VIEWS = [(w, d, True, "") for w in WIDTHS for d in (False, True)] + [(820, False, False, ""), (700, False, True, "print")]
VIEWS = VIEWS if THOROUGH else [VIEWS[0], VIEWS[-3]]

# Returns complaints about landmarks, headings, tables and drawings for screen readers, and about scrolling boxes that the keyboard cannot reach.
INSPECT_STRUCTURE = r"""(() => {
  const wrong = [];
  for (const mark of ["header", "nav", "main", "footer"])
    if (document.querySelectorAll(mark).length !== 1) wrong.push(`${document.querySelectorAll(mark).length} elements ${mark}, expected 1`);
  if (document.querySelectorAll("h1").length !== 1) wrong.push("the number of h1 elements is not 1");
  let level = 0;
  for (const h of document.querySelectorAll("h1, h2, h3, h4")) {
    if (+h.tagName[1] > level + 1) wrong.push(`${h.tagName} after h${level}: ${h.textContent}`);
    level = +h.tagName[1];
  }
  for (const svg of document.querySelectorAll("svg")) {
    const {width, height} = svg.getBoundingClientRect();
    if (svg.getAttribute("role") !== "img" || !(svg.getAttribute("aria-label")?.length > 20)) wrong.push("a drawing without a description");
    if (width < 250 || height < 30 || svg.querySelectorAll("path").length < 2 || svg.querySelectorAll("text").length < 2) wrong.push(`a drawing of ${width} x ${height}`);
    const box = svg.viewBox.baseVal;
    for (const e of svg.querySelectorAll("text, path")) {
      const b = e.getBBox();
      if (b.x < -1 || b.y < -1 || b.x + b.width > box.width + 1 || b.y + b.height > box.height + 1) wrong.push(`out of its drawing: ${e.textContent || e.getAttribute("d").slice(0, 30)}`);
    }
  }
  if (!document.documentElement.lang) wrong.push("the document has no language");
  for (const c of document.querySelectorAll("canvas"))
    if (c.getAttribute("role") !== "img" || !c.getAttribute("aria-label") || new Set(new Uint32Array(c.getContext("2d").getImageData(0, 0, c.width, c.height).data.buffer)).size < 2)
      wrong.push("a map without a description or colours");
  for (const t of document.querySelectorAll("table"))
    if (!t.getAttribute("aria-label") || !t.tHead || [...t.tHead.rows[0].cells].some((c) => c.scope !== "col")) wrong.push("a table without a name or headers");
  for (const e of document.querySelectorAll("main *"))
    if (/auto|scroll/.test(getComputedStyle(e).overflowX) && e.tabIndex < 0 && e.checkVisibility()) wrong.push("scrolls, but not by keys: " + e.className);
  return wrong;
})()"""


def make_pages(raya, folder):
    """Makes the pages under test, with their reports in the same folder. Returns {name: HTML file}."""
    small, pages = ["--size", "48x32", "--lanes", "4"], {}

    def make_page(name, *command, code=0):
        files = [Path(folder, f"{name}.{extension}") for extension in ("json", "html")]
        run = subprocess.run([raya, *map(str, command), "--report", files[0], "--page", files[1]], capture_output=True, text=True)
        assert run.returncode == code, run.stderr
        second_page = Path(folder, f"{name}-again.html")
        subprocess.run([raya, "page", files[0], "-o", second_page, "--quiet"], check=True)
        assert second_page.read_bytes() == files[1].read_bytes(), f"{name}: raya page gives a different page"
        second_page.unlink()
        pages[name] = files[1]

    image = ["-o", Path(folder, "x.ppm"), "--quiet"]
    nff = Path(folder, "<script>alert(1)<script> & \"more\" scenes.nff")
    nff.write_bytes((SCENES / "spheres.nff").read_bytes())
    make_page("ring", "render", nff, *small, "--pes", "48", "--antialias", "supersample", *image)
    make_page("many", "render", SCENES / "planes.nff", *small, "--pes", "1000", "--machine", "grande", *image)
    make_page("dynamic", "render", SCENES / "planes.nff", *small, "--pes", "12", "--mapping", "dynamic:4", *image)
    make_page("torus", "render", SCENES / "planes.nff", *small, "--machine", "torus", *image)
    make_page("verify", "verify", "--only", "machine")
    report = json.loads(Path(folder, "verify.json").read_text())
    report["devices"][0]["checks"][2] |= {"status": "FAIL", "result": "1 of `20` words +- 0", "where": "PE 3 <b>", "expected": "0x1 & so on", "got": "line\n" * 200,
                                          "build_options": "-DX", "remedies": ["another driver", "`RAYA_BUILD_OPTIONS`"]}
    report["devices"][0]["failed"] = 1
    Path(folder, "failed.json").write_text(json.dumps(report))
    pages["failed"] = Path(folder, "failed.html")
    subprocess.run([raya, "page", Path(folder, "failed.json"), "-o", pages["failed"], "--quiet"], check=True)
    bench = ["bench", SCENES / "planes.nff", *small, "--samples", "2"]
    make_page("base", *bench, "--format", "fp32,e6m15")
    for made, name in zip(gpu_day(raya, Path(folder, "day")), ("gpu_day.json", "gpu_day.html")):
        pages["gpu_day"] = made.rename(Path(folder, name))
    make_page("bench", *bench, "--compare", Path(folder, "base.json"), "--tolerance", "100")
    return pages


def start(page, url, **view):
    page.open(url, **view)
    if view.get("scripts", True):
        page.value("ready")


def check_views(page, name, html, folder):
    report = json.loads(html.with_suffix(".json").read_text())
    for width, dark, scripts, media in VIEWS:
        view = f"{name}, {width} pixels{', dark' * dark}{', no scripts' * (not scripts)}{', printed' * bool(media)}: "
        start(page, html.as_uri(), width=width, dark=dark, scripts=scripts, media=media)
        if folder:
            page.picture(Path(folder, f"{name}-{width}-{media or ('dark' if dark else 'light') + '-plain' * (not scripts)}.png"))
        if not scripts:
            if json.loads(page.value("document.getElementById('report').innerText"))["kind"] != report["kind"] or not page.value("document.getElementById('report').checkVisibility()"):
                yield f"{view}the report is not shown as JSON"
            yield from (view + wrong for wrong in [*page.value(INSPECT)["wrong"], *complaints(page)])
            continue
        page.value("document.querySelectorAll('details').forEach((e) => { e.open = true; })")
        found_elements = page.value(INSPECT)
        yield from (view + wrong for wrong in [*found_elements["wrong"], *page.value(INSPECT_STRUCTURE), *complaints(page)])
        if found_elements["texts"] < 40 or not found_elements["title"].startswith("raya ") or not found_elements["buttons"]:
            yield f"{view}{found_elements['texts']} texts, expected at least 40; {found_elements['buttons']} buttons that sort; title {found_elements['title']}"
    text = page.value("document.body.innerText")
    if "cannot be shown" in text:
        yield f"{name}: a part cannot be shown"
    if "image" in report:
        load = report["load"]
        for words in (f"{load['imbalance']:.3f}", f"{load['speedup']:.1f} of {report['machine']['pes']}", report["image"]["hash"], report["device"]["driver"]):
            if words not in text:
                yield f"{name}: {words} is not shown"
    for check in [check for device in report.get("devices", []) for check in device["checks"]]:
        if check["name"] not in text or check["status"] == "FAIL" and check["expected"] not in text:
            yield f"{name}: the check {check['name']} is not shown"


def check_map(page, name, html):
    """Checks the map of loads. Each pixel has the colour of its owner's load, so there are as many colours as loads; a torus has a cell per node."""
    loads = set(json.loads(html.with_suffix(".json").read_text())["load"]["per_pe"])
    start(page, html.as_uri())
    colours = page.value("(() => { const c = document.querySelector('canvas'); return new Set(new Uint32Array(c.getContext('2d').getImageData(0, 0, c.width, c.height).data.buffer)).size; })()")
    if not 0.5 * len(loads) < colours <= len(loads) + 1:
        yield f"{name}: the map has {colours} colours for {len(loads)} different loads"


STRUCTURE = """[...document.querySelectorAll("*")].filter((e) => /^(SCRIPT|STYLE|TEMPLATE|IFRAME|OBJECT|LINK|META|BASE)$/.test(e.tagName)
  || [...e.attributes].some(({name}) => name.startsWith("on"))).length"""
SELECTING = {"kind", "png", "mapping", "fold", "links", "format", "status"}  # members whose values select the parts that a page shows


def check_escaping(page, name, html, folder):
    """Replaces every text of the report, and names of members, by HOSTILE, which the page must show as text."""
    text, changed = html.read_text(), Path(folder, "hostile.html")
    start(page, html.as_uri())
    active_elements = page.value(STRUCTURE)
    for kept_members in (SELECTING, {"kind"}):
        report = report_of(text)
        for holder, key in list(values_of(report, lambda value: isinstance(value, str))):
            if key not in kept_members:
                holder[key] = HOSTILE
        for part in ("rays", "shading", "load"):
            if part in report:
                report[part][HOSTILE] = 7
        saved = Path(folder, "hostile.json")
        saved.write_text(json.dumps(report))
        if name == "explore":
            changed.write_text(with_report(text, report))
        else:
            subprocess.run([RAYA, "page", saved, "-o", changed, "--quiet"], check=True)
        start(page, changed.as_uri())
        page.value("new Promise((done) => setTimeout(done, 200))")
        yield from (f"{name}, hostile: {wrong}" for wrong in [*complaints(page), *(w for w in page.value(INSPECT)["wrong"] if "attribute" in w)])
        if page.value("window.hit"):
            yield f"{name}: the page ran a text of the report"
        if page.value(STRUCTURE) != active_elements:
            yield f"{name}: a text of the report became markup"
        if "window.hit = 1</script>" not in page.value("document.body.innerText"):
            yield f"{name}: hostile text is not shown as text"
        start(page, changed.as_uri(), scripts=False)
        if "\\u003c/pre" not in page.value("document.getElementById('report').textContent"):
            yield f"{name}: the report is incomplete without scripts"


def check_damaged_reports(page, name, html, folder, count):
    """Removes members or changes their types. The page must then say which part it cannot show, and no script may fail."""
    text, rng, named, changed = html.read_text(), random.Random(SEED), 0, Path(folder, "damaged.html")
    for i in range(count):
        report = report_of(text)
        holder, key = rng.choice([place for place in values_of(report, lambda value: True) if rng.random() < 0.2 or place[1] != 0] or [(report, "kind")])
        if i == 0:  # later faults may only change a number in a long list, which the page cannot detect
            key = "every part"
            report |= {part: 7 for part, value in report.items() if isinstance(value, (dict, list))}
        elif rng.random() < 0.4 and isinstance(holder, dict):
            del holder[key]
        else:
            holder[key] = rng.choice([None, True, -1, 1.5, 1e300, "<b>'\"&", [], {}, [[]], 2 ** 40])
        changed.write_text(with_report(text, report))
        start(page, changed.as_uri())
        yield from (f"{name}, damage {i} at {key}: {wrong}" for wrong in complaints(page))
        shown = page.value("document.body.innerText")
        named += "cannot be shown" in shown
        if len(shown) < 60:
            yield f"{name}, damage {i} at {key}: an empty page"
    if not named:
        yield f"{name}: for none of {count} damaged reports does the page say that a part cannot be shown"


def check_sorting(page, html):
    """Yields a complaint if the column of counts is not sorted by value; its numbers contain narrow spaces."""
    start(page, html.as_uri(), width=1400)
    order = page.value(r"""(() => { const t = document.querySelector("#counts table"); const b = t.tHead.querySelectorAll("button")[1]; b.click();
      return [...t.tBodies[0].rows].map((r) => +r.cells[1].textContent.replace(/\D/g, "")); })()""")
    if order != sorted(order) or len(order) < 5:
        yield f"the button does not sort the counts: {order}"


# (text of the page, faulty replacement); the checks must then find a complaint.
FAULTS = [
    ('<main id="main">', '<main id="main"><img src="https://example.invalid/x.png" alt="x">'),
    ("`The rendered image of ${str(r, \"scene\")}, ${pixels}`", '""'),
    ("--ink: #1b1b1b", "--ink: #cccccc"),
    ('"loads", torus', '"pictures", torus'),
    ('make("h3", {}, prose(title))', 'make("h4", {}, prose(title))'),
    ('scope: "col"', 'title: "col"'),
    ("iVBORw0KGgo", "xxxxxxxxxxx"),
    ('document.title = `${kicker}', 'console.log(1); document.title = `${kicker}'),
    (".pictures {", ".pictures { width: 2000px;"),
    ('tabindex: 0, role: "region"', 'title: "x"'),
    ('role: "img", "aria-label": description', 'title: description'),
]


def undetected_faults(page, html, folder):
    text = html.read_text()
    for old, new in FAULTS:
        if old not in text:
            yield f"the page has no '{old}': update FAULTS of this test"
            continue
        broken = Path(folder, "ring-broken.html")
        broken.write_text(text.replace(old, new))
        page.open(broken.as_uri(), width=400)
        if not [*page.value(INSPECT)["wrong"], *page.value(INSPECT_STRUCTURE), *complaints(page)]:
            yield f"{new!r} instead of {old!r} is not detected"


def main():
    raya, pictures = RAYA, sys.argv[2] if len(sys.argv) > 2 else None
    if browser.program() is None:
        print("skipped: no Chromium (tools/setup --browser)")
        return 77
    wrong = []
    with tempfile.TemporaryDirectory() as folder, browser.Browser() as page:
        pages = make_pages(raya, folder)
        for name, html in pages.items():
            wrong += check_views(page, name, html, pictures)
            wrong += check_escaping(page, name, html, folder)
            wrong += check_damaged_reports(page, name, html, folder, DAMAGED_REPORTS)
        wrong += check_sorting(page, pages["ring"])
        for name in ("ring", "torus"):
            wrong += check_map(page, name, pages[name])
        explore = Path(folder, "explore.html")
        subprocess.run([raya, "explore", SCENES / "planes.nff", "--size", "48x32", "--lanes", "4", "-o", explore, "--quiet"], check=True)
        wrong += check_escaping(page, "explore", explore, folder)
        wrong += check_damaged_reports(page, "explore", explore, folder, DAMAGED_REPORTS)
        wrong += undetected_faults(page, pages["ring"], folder)
    print("\n".join(wrong))
    print(f"{len(pages)} pages in {len(VIEWS)} views: {len(wrong)} complaints; {len(FAULTS)} injected faults checked")
    return 1 if wrong else 0


sys.exit(main())
