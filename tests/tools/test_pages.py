#!/usr/bin/env python3
"""Pages of reports in a browser: they ask for nothing from anywhere, fit their window, and can be read at three widths, light and dark, on
paper, without scripts, without sight and by keys alone; their columns sort. In the end the checks are tried on faults.

    tests/tools/test_pages.py RAYA [FOLDER]      FOLDER: pictures of all views are left there
Exit code 77 where there is no Chromium.
"""
import json, subprocess, sys, tempfile
from pathlib import Path

import browser
from page_checks import LOOK, told

WIDTHS = (400, 820, 1400)
SCENES = Path(__file__).resolve().parents[2] / "scenes"
VIEWS = [(w, d, True, "") for w in WIDTHS for d in (False, True)] + [(820, False, False, ""), (700, False, True, "print")]

# Landmarks, headings and tables as those find them who do not see; boxes that scroll can be reached by keys.
BUILD = r"""(() => {
  const wrong = [];
  for (const mark of ["header", "nav", "main", "footer"])
    if (document.querySelectorAll(mark).length !== 1) wrong.push(`${document.querySelectorAll(mark).length} of ${mark}`);
  if (document.querySelectorAll("h1").length !== 1) wrong.push("not one h1");
  let level = 0;
  for (const h of document.querySelectorAll("h1, h2, h3, h4")) {
    if (+h.tagName[1] > level + 1) wrong.push(`${h.tagName} after h${level}: ${h.textContent}`);
    level = +h.tagName[1];
  }
  for (const svg of document.querySelectorAll("svg")) {
    const {width, height} = svg.getBoundingClientRect(), words = document.getElementById(svg.getAttribute("aria-describedby"));
    if (svg.getAttribute("role") !== "img" || !svg.getAttribute("aria-label") || !/Across: .+ Up: .+ Series: .+/.test(words?.textContent))
      wrong.push("a drawing without a name or words");
    if (width < 250 || height < 30 || svg.querySelectorAll("path").length < 2 || svg.querySelectorAll("text").length < 2) wrong.push(`a drawing of ${width} x ${height}`);
    const box = svg.viewBox.baseVal;
    for (const e of svg.querySelectorAll("text, path")) {
      const b = e.getBBox();
      if (b.x < -1 || b.y < -1 || b.x + b.width > box.width + 1 || b.y + b.height > box.height + 1) wrong.push(`out of its drawing: ${e.textContent || e.getAttribute("d").slice(0, 30)}`);
    }
  }
  if (!document.documentElement.lang) wrong.push("no language");
  for (const t of document.querySelectorAll("table"))
    if (!t.getAttribute("aria-label") || !t.tHead || [...t.tHead.rows[0].cells].some((c) => c.scope !== "col")) wrong.push("a table without a name or headers");
  for (const e of document.querySelectorAll("main *"))
    if (/auto|scroll/.test(getComputedStyle(e).overflowX) && e.tabIndex < 0 && e.checkVisibility()) wrong.push("scrolls, but not by keys: " + e.className);
  return wrong;
})()"""


def make(raya, folder):
    """Name: (page, words that stand in it)."""
    small, pages = ["--size", "48x32", "--lanes", "4"], {}

    def one(name, *command, code=0):
        files = [Path(folder, f"{name}.{end}") for end in ("json", "html")]
        run = subprocess.run([raya, *map(str, command), "--report", files[0], "--page", files[1]], capture_output=True, text=True)
        assert run.returncode == code, run.stderr
        again = Path(folder, f"{name}-again.html")
        subprocess.run([raya, "page", files[0], "-o", again, "--quiet"], check=True)
        assert again.read_bytes() == files[1].read_bytes(), f"{name}: raya page makes another page"
        again.unlink()
        assert files[1].stat().st_size < 1e6
        pages[name] = files[1]

    image = ["-o", Path(folder, "x.ppm"), "--quiet"]
    nff = Path(folder, "<script>alert(1)<script> & \"more\" scenes.nff")
    nff.write_bytes((SCENES / "spheres.nff").read_bytes())
    one("ring", "render", nff, *small, "--pes", "48", "--antialias", "supersample", *image)
    one("many", "render", SCENES / "planes.nff", *small, "--pes", "1000", "--machine", "grande", *image)
    one("dynamic", "render", SCENES / "planes.nff", *small, "--pes", "12", "--mapping", "dynamic:4", *image)
    one("torus", "render", SCENES / "planes.nff", *small, "--machine", "torus", *image)
    one("verify", "verify", "--only", "machine")
    bench = ["bench", SCENES / "planes.nff", *small, "--samples", "2"]
    one("base", *bench, "--format", "fp32,e6m15")
    one("bench", *bench, "--compare", Path(folder, "base.json"), "--tolerance", "100")
    return pages


def looks(page, name, html, folder):
    report = json.loads(html.with_suffix(".json").read_text())
    for width, dark, scripts, media in VIEWS:
        view = f"{name}, {width} pixels{', dark' * dark}{', no scripts' * (not scripts)}{', on paper' * bool(media)}: "
        page.open(html.as_uri(), width=width, dark=dark, scripts=scripts, media=media)
        if folder:
            page.picture(Path(folder, f"{name}-{width}-{media or ('dark' if dark else 'light') + '-plain' * (not scripts)}.png"))
        page.value("document.querySelectorAll('details').forEach((e) => { e.open = true; })")
        look = page.value(LOOK)
        yield from (view + wrong for wrong in [*look["wrong"], *page.value(BUILD), *told(page)])
        if look["texts"] < 40 or not look["title"].startswith("raya "):
            yield f"{view}{look['texts']} texts, title {look['title']}"
        if bool(look["buttons"]) != scripts:
            yield f"{view}{look['buttons']} headers that sort"
    body = html.read_text()
    if "<script>alert" in body or "background-color: rgb" in body:
        yield f"{name}: a name has become a part of the page"
    if "image" in report and f">{report['load']['imbalance']:.3f}<" not in body:
        yield f"{name}: u is not told"


def sorts(page, html):
    """The loads' table by size, narrow spaces or not."""
    page.open(html.as_uri(), width=1400)
    order = page.value(r"""(() => { const t = document.querySelector("#counts table"); const b = t.tHead.querySelectorAll("button")[1]; b.click();
      return [...t.tBodies[0].rows].map((r) => +r.cells[1].textContent.replace(/\D/g, "")); })()""")
    if order != sorted(order) or len(order) < 5:
        yield f"sorted by count: {order}"


# A text of the page, what takes its place: some complaint must follow.
FAULTS = [
    ("<main>", "<main><img src=\"https://example.invalid/x.png\" alt=\"x\">"),
    ("alt=\"The rendered picture", "alt=\"\" title=\"The rendered picture"),
    ("--ink: #1b1b1b", "--ink: #cccccc"),
    ("id=\"loads\"", "id=\"pictures\""),
    ("<h3>Builds", "<h4>Builds"),
    ("<th scope=\"col\"", "<th"),
    ("base64,iVBOR", "base64,xxxxx"),
    ("</main>", "</main><script>console.log(1)</script>"),
    ("class=\"pictures\"", "style=\"width: 2000px\""),
    ("tabindex=\"0\" role=\"region\"", ""),
    ("role=\"img\"", ""),
]


def faults_missed(page, html, folder):
    text = html.read_text()
    for old, new in FAULTS:
        if old not in text:
            yield f"'{old}' stands nowhere, where a fault is to go"
            continue
        broken = Path(folder, "ring-broken.html")
        broken.write_text(text.replace(old, new))
        page.open(broken.as_uri(), width=400)
        if not [*page.value(LOOK)["wrong"], *page.value(BUILD), *told(page)]:
            yield f"nobody sees {new!r} for {old!r}"


def main():
    raya, pictures = sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else None
    if browser.program() is None:
        print("skipped: no Chromium (tools/setup --browser)")
        return 77
    wrong = []
    with tempfile.TemporaryDirectory() as folder, browser.Browser() as page:
        pages = make(raya, folder)
        for name, html in pages.items():
            wrong += looks(page, name, html, pictures)
        wrong += sorts(page, pages["ring"])
        wrong += faults_missed(page, pages["ring"], folder)
    print("\n".join(wrong))
    print(f"{len(pages)} pages in {len(VIEWS)} views: {len(wrong)} faults; {len(FAULTS)} planted ones seen")
    return 1 if wrong else 0


sys.exit(main())
