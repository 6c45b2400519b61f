#!/usr/bin/env python3
"""The studies' document in a browser: it asks for nothing from anywhere, no error reaches the console, every figure is seen and told in words,
text has contrast, columns sort and plots tell their figures; at three widths, light and dark, on paper, with scripts and without. In the end
the checks are tried on faults.

    tests/tools/test_document.py --program PROGRAM       PROGRAM FOLDER writes the document to look at (tests/study/write_small_document.cpp)
    tests/tools/test_document.py INDEX.html              a document of one's own, no faults; page_checks.py leaves screenshots
Exit code 77 where there is no Chromium.
"""
import argparse, subprocess, sys, tempfile
from pathlib import Path

import browser
from page_checks import LOOK, told

WIDTHS = (400, 1000, 1600)

# Every column, rising and falling: whether rows come in order. Numbers are read as in the table's column class.
SORT = r"""(() => {
  const wrong = [];
  for (const table of document.querySelectorAll("table"))
    for (const header of table.tHead.rows[0].cells) {
      const button = header.querySelector("button");
      if (!button) { if (header.textContent) wrong.push("a column without a button: " + header.textContent); continue; }
      const rows = table.tBodies[0].rows.length;
      for (const sign of [1, -1]) {
        button.click();
        if (header.getAttribute("aria-sort") !== (sign > 0 ? "ascending" : "descending")) wrong.push("no order told: " + header.textContent);
        let cells = [...table.tBodies[0].rows].map((row) => row.cells[header.cellIndex].textContent);
        if (cells.length !== rows) wrong.push("rows lost");
        if (header.classList.contains("n"))
          cells = cells.map((text) => text === "inf" ? Infinity : text === "-inf" ? -Infinity : parseFloat(text)).filter((v) => !Number.isNaN(v));
        const compare = typeof cells[0] === "string" ? (a, b) => a.localeCompare(b) : (a, b) => (a === b ? 0 : a - b);
        if (cells.some((cell, i) => i > 0 && sign * compare(cells[i - 1], cell) > 0)) wrong.push("out of order: " + header.textContent);
      }
    }
  return wrong;
})()"""

# Scrolls a drawing into view; where in the window the points of its series lie, and what is to be said of each.
POINTS = r"""((number) => {
  const drawing = document.querySelectorAll(".drawing")[number], data = drawing.querySelector("g.data");
  drawing.scrollIntoView({block: "center", inline: "start"});
  const box = drawing.getBoundingClientRect();
  return [...data.children].flatMap((series) => series.dataset.points.split(" ").filter(Boolean).map((text) => {
    const [x, y, half, left, top] = text.split(",");
    return {x: box.left + left / 100 * box.width, y: box.top + top / 100 * box.height,
            says: [series.dataset.label, `${data.dataset.x} ${x}, ${data.dataset.y} ${y}` + (half > 0 ? ` ± ${half}` : "")]};
  }));
})"""
TIP = r"""((number) => {
  const drawing = document.querySelectorAll(".drawing")[number], tip = drawing.querySelector(".tip"), mark = drawing.querySelector(".mark");
  const box = tip.getBoundingClientRect(), around = drawing.getBoundingClientRect();
  return {shown: tip.checkVisibility() && mark.checkVisibility(), words: tip.textContent,
          inside: box.left >= around.left - 1 && box.right <= around.right + 1 && box.top >= around.top - 1 && box.bottom <= around.bottom + 1};
})"""


def hovering(page):
    """Points at a point of every drawing, then moves on by keys."""
    for number in range(page.value("document.querySelectorAll('.drawing').length")):
        points = page.value(f"{POINTS}({number})")
        if not points:
            continue
        for point in (points[0], points[-1]):
            page.ask("Input.dispatchMouseEvent", type="mouseMoved", x=point["x"], y=point["y"])
            tip = page.value(f"{TIP}({number})")
            if not tip["shown"] or not any(all(part in tip["words"] for part in other["says"]) for other in points
                                           if abs(other["x"] - point["x"]) < 1 and abs(other["y"] - point["y"]) < 1):
                yield f"drawing {number} says '{tip['words']}' for {point['says']}"
            if not tip["inside"]:
                yield f"drawing {number}: '{tip['words']}' reaches out of it"
        page.ask("Input.dispatchMouseEvent", type="mouseMoved", x=1, y=1)
        page.value(f"document.querySelectorAll('.drawing')[{number}].parentElement.focus()")
        said = []
        for key in ("ArrowDown", "ArrowLeft", "ArrowRight"):
            page.ask("Input.dispatchKeyEvent", type="keyDown", key=key, code=key)
            said.append(page.value(f"{TIP}({number})")["words"])
        of_series = [p for p in points if said[1].startswith(p["says"][0] + ": ")]
        if not set(said) <= {f"{p['says'][0]}: {p['says'][1]}" for p in points} or said[1] == said[2] and len(of_series) > 1:
            yield f"drawing {number} says by keys: {said}"


def looks(page, url, count):
    """All that is wrong with a document of so many figures."""
    try:
        yield from all_looks(page, url, count)
    except RuntimeError as problem:  # the page lacks what is looked for
        yield f"{problem}"
        yield from told(page)


def all_looks(page, url, count):
    titles = set()
    for width, dark, scripts, media in [(w, d, True, "") for w in WIDTHS for d in (False, True)] + [(1000, False, False, ""), (700, False, True, "print")]:
        page.open(url, width, dark, scripts, media)
        if scripts:  # what is folded counts too
            page.value("document.querySelectorAll('details').forEach((e) => { e.open = true; })")
        view = f"{width} pixels{', dark' * dark}{', no scripts' * (not scripts)}{', on paper' * bool(media)}: "
        look = page.value(LOOK)
        titles.add(look["title"])
        yield from (view + wrong for wrong in [*look["wrong"], *told(page)])
        if look["figures"] != count or look["texts"] < 50:
            yield f"{view}{look['figures']} figures of {count}, {look['texts']} texts"
        if (look["buttons"] > 0) != scripts:
            yield f"{view}{look['buttons']} buttons"
    if len(titles) != 1 or titles == {"planted"}:
        yield f"titles {titles}"
    page.open(url)
    page.value("document.querySelectorAll('details').forEach((e) => { e.open = true; })")
    yield from page.value(SORT)
    yield from hovering(page)
    yield from told(page)


# Text of the document, what takes its place, and a part of what must be found wrong then.
FAULTS = [
    ("<meta http-equiv=\"Content", "<img src=\"http://127.0.0.1:9/x.png\" alt=\"x\"><meta name=\"Content", "a request"),
    ("<main>", "<main><img src=\"http://127.0.0.1:9/x.png\" alt=\"x\">", "attribute src"),
    ("<main>", "<main><script>document.title = 'planted'</script>", "planted"),
    ("</style>", "@font-face { font-family: x; src: url(http://127.0.0.1:9/x) } h1 { font-family: x }</style>", "in the log"),
    ("\"use strict\";", "console.log('x');", "in the console"),
    ("\"use strict\";", "nothing();", "an exception"),
    ("--soft: #555555", "--soft: #999999", "a contrast"),
    ("--plot-000000: #e8e8e6", "--plot-000000: #555555", "dark: a contrast"),
    ("role=\"img\"", "", "no image"),
    ("<desc id=", "<desc class=", "without a description"),
    ("<title id=\"plot-large-0-title\">", "<title class=\"\">", "without a name"),
    ("plot-large-1-", "plot-large-2-", "an id twice"),
    (".drawing svg { display: block; width: 100%", ".drawing svg { display: block; width: 10%", "a drawing of"),
    (".wide { overflow-x: auto; }", "", "in a window of 400"),
    ("href=\"#small\"", "href=\"#smell\"", "nowhere"),
    ("numeric ? a - b || 0 : ", "", "out of order"),
    ("this.tip.textContent = words;", "", "says ''"),
    ("event.clientX", "event.clientY", "says"),
    ("ArrowRight: 1", "ArrowRight: 0", "by keys"),
    ("left > 50 ? \"calc(-100% - 12px)\"", "left < 150 ? \"-90vw\"", "reaches out"),
    ("&lt;img src=x", "<img src=x", "attribute on"),
]


def faults_missed(page, text, count, folder):
    for old, new, complaint in FAULTS:
        if old not in text:
            yield f"no '{old}' to put a fault into"
            continue
        broken = Path(folder, "broken.html")
        broken.write_text(text.replace(old, new))
        found = []
        for wrong in looks(page, broken.as_uri(), count):  # as far as need be
            found.append(wrong)
            if complaint in wrong:
                break
        else:
            yield f"with {new!r} for {old!r}: {found[:3]}"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--program")
    parser.add_argument("document", nargs="?")
    asked = parser.parse_args()
    if browser.program() is None:
        print("skipped: no Chromium (tools/setup --browser)")
        return 77
    with tempfile.TemporaryDirectory() as folder, browser.Browser() as page:
        if asked.program:
            subprocess.run([asked.program, folder], check=True)
        index = Path(asked.document or Path(folder, "index.html")).resolve()
        text = index.read_text(errors="replace")
        count = text.count("<figure class=\"plot\">")
        wrong = list(looks(page, index.as_uri(), count))
        if asked.program:
            wrong += [f"{count} figures"] * (count != 5)
            wrong += faults_missed(page, text, count, folder) if not wrong else []
    for line in wrong:
        print("test_document.py:", line, file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
