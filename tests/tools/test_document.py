#!/usr/bin/env python3
"""Checks the laboratory's document in a browser at three widths, light and dark, and printed: the document is static HTML; it sends no requests, runs
no scripts and causes no messages in the console; every figure is visible and has a description; text has enough contrast. Injected faults test the
checks.

    tests/tools/test_document.py PACKAGES       a small document, made with the package raya in this folder (build/python)
    tests/tools/test_document.py INDEX.html     another document, without injected faults; page_checks.py makes screenshots
Exit code 77: no Chromium.
"""
import math, os, subprocess, sys, tempfile
from pathlib import Path

import browser
from page_checks import INSPECT, complaints

WIDTHS = (400, 1000, 1600)
HOSTILE = "<script>document.title = 'injected'</script><img src=x onerror='injected()'> \"&amp;\" `a` | {x} $x$ +- \\.nff"

SMALL = """A small study

Does a document of it hold together?

- One table, one plot.
"""
LARGE = """A study of {scene}

What does `{scene}` show?

- Of {scene}, which is long enough
  for a second line.
"""


def claim(lab, paper, place, statement, test, reason=""):
    """Returns a claim with its result. The verdict follows from the p values of `test`, which is None for an untestable claim."""
    kind = "test" if test else "untestable"
    return lab.Judgement(lab.Claim("id", paper, place, "原文", statement, "small", kind, f"Rule: {reason}"), f"Ensemble {reason}", reason, test)


def small_page(lab):
    series = [lab.Series("ours", range(5), [x * x for x in range(5)]), lab.Series("the paper's", [4], [15], "paper")]
    return lab.Page({}, ["A finding."], [lab.Comparison("u", "ms", 15, 16, "a remark", True, 0.5)],
                    [claim(lab, "A & B 1999", "Table 1", "It rises.", lab.Test(0, 1, "1.0 +- 0.1", 0.2), "It does."),
                     claim(lab, "A & B 1999", "Table 2", "It falls.", lab.Test(0.5, 0.5), "Once."),
                     claim(lab, "A & B 1999", "Table 3", "It stays.", None)],
                    [lab.Table("small", "Rows", [{"p": 0, "u": 1.5}, {"p": 8, "u": math.nan}])],
                    [lab.Plot("small", "A plot", "p", "u", series)], ["No paper has it."]).describe("small", SMALL)


def large_page(lab):
    """Returns a page with every colour, style and kind of axis, an interval band, error bars, and names that would be scripts if not escaped."""
    def series(number):
        x = range(1, 60 if number == 1 else 5)
        style = "steps" if number == 7 else "points" if number == 8 else "line" if number < 7 else "paper"
        return lab.Series(f"series {number}" if number else HOSTILE, x, [math.exp(0.1 * value) + number for value in x], style,
                          [0.4 * value for value in x] if number < 3 else [])

    return lab.Page({"scene": HOSTILE, "seeds": [1, 2, 3]}, [HOSTILE], [lab.Comparison(HOSTILE, "", None, math.inf)],
                    [claim(lab, "C 1999", HOSTILE, "Never.", lab.Test(1, 0, HOSTILE), HOSTILE)],
                    [lab.Table("large", "All rows", [{"n": i * 37 % 500, HOSTILE: HOSTILE} for i in range(500)])],
                    [lab.Plot(f"large-{i}", f"Plot {i} {HOSTILE}", "x", "y (ms)", list(map(series, range(11))), log)
                     for i, log in enumerate(("", "x", "y", "xy"))]).describe("large", LARGE)


def write_small_document(packages, folder):
    sys.path.insert(0, packages)
    from raya import lab
    from raya.lab.document import write_document, write_page

    folder = Path(folder)
    pages = [small_page(lab), large_page(lab)]
    for page in pages:
        lab.decide(page.claims)
        page.run = {"command": f"raya study {page.name} '{HOSTILE}' -o DIR", "version": "raya 1.2.3", "device": HOSTILE}
    write_document(folder, pages, {page.name: write_page(folder, page) for page in pages}, [f"study x: {HOSTILE}"])


def check_views(page, url, count):
    """Yields complaints about a document with `count` figures."""
    titles = set()
    views = [(width, dark, True, "") for width in WIDTHS for dark in (False, True)]
    for width, dark, scripts, media in views + [(1000, False, False, ""), (700, False, True, "print")]:
        page.open(url, width, dark, scripts, media)
        page.value("document.querySelectorAll('details').forEach((e) => { e.open = true; })")  # unfolds everything
        view = f"{width} pixels{', dark' * dark}{', no scripts' * (not scripts)}{', printed' * bool(media)}: "
        found_elements = page.value(INSPECT)
        titles.add(found_elements["title"])
        yield from (view + wrong for wrong in [*found_elements["wrong"], *complaints(page)])
        if found_elements["figures"] != count or found_elements["texts"] < 50:
            yield f"{view}{found_elements['figures']} figures, expected {count}; {found_elements['texts']} texts, expected at least 50"
        active = page.value("document.querySelectorAll('script, iframe, object, embed, form, button').length")
        if active:
            yield f"{view}{active} active elements"
    if len(titles) != 1 or titles == {"injected"}:
        yield f"the title differs between views, or a scene's name has changed it: {titles}"


# (text of the document, faulty replacement, part of the expected complaint)
FAULTS = [
    ("<meta http-equiv=\"Content", "<img src=\"http://127.0.0.1:9/x.png\" alt=\"x\"><meta name=\"Content", "a request"),
    ("<main>", "<main><img src=\"http://127.0.0.1:9/x.png\" alt=\"x\">", "attribute src"),
    ("<main>", "<main><script>document.title = 'injected'</script>", "active elements"),
    ("</style>", "@font-face { font-family: x; src: url(http://127.0.0.1:9/x) } h1 { font-family: x }</style>", "in the log"),
    ("--soft: #555555", "--soft: #999999", "a contrast"),
    ("--plot-000000: #e8e8e6", "--plot-000000: #555555", "dark: a contrast"),
    ("role=\"img\"", "", "without role=img"),
    ("<desc id=", "<desc class=", "without a description"),
    ("<title id=\"plot-large-0-title\">", "<title class=\"\">", "without a name"),
    ("plot-large-1-", "plot-large-2-", "an id twice"),
    (".drawing svg { display: block; width: 100%", ".drawing svg { display: block; width: 10%", "a drawing of"),
    (".wide { overflow-x: auto; }", "", "in a window of 400"),
    ("href=\"#small\"", "href=\"#smell\"", "nowhere"),
    ("&lt;img src=x", "<img src=x", "attribute on"),
]


def undetected_faults(page, text, count, folder):
    """Yields the injected faults that check_views() does not detect."""
    for old, new, expected in FAULTS:
        if old not in text:
            yield f"the document has no '{old}': update FAULTS of this test"
            continue
        broken = Path(folder, "broken.html")
        broken.write_text(text.replace(old, new))
        found = []
        for wrong in check_views(page, broken.as_uri(), count):  # stops at the expected complaint
            found.append(wrong)
            if expected in wrong:
                break
        else:
            yield f"{new!r} instead of {old!r} is not detected as '{expected}': {found[:3]}"


def main(package_or_html):
    if browser.program() is None:
        print("skipped: no Chromium (tools/setup --browser)")
        return 77
    with tempfile.TemporaryDirectory() as folder, browser.Browser() as page:
        is_package = Path(package_or_html).is_dir()
        if is_package:
            python = os.environ.get("RAYA_PYTHON", "/usr/bin/python3")  # as `raya study` chooses it
            subprocess.run([python, __file__, str(Path(package_or_html).resolve()), folder], check=True)
        index = Path(folder, "index.html") if is_package else Path(package_or_html).resolve()
        text = index.read_text(errors="replace")
        count = text.count("<figure class=\"plot\">")
        wrong = list(check_views(page, index.as_uri(), count))
        if is_package:
            wrong += [f"the small document has {count} figures, expected 5"] * (count != 5)
            shown = page.value("document.body.textContent").replace("±", "+-")
            wrong += [f"the document shows the hostile text {part!r} {shown.count(part)} times, expected at least 400 times"
                      for part in HOSTILE.split("`") if shown.count(part) < 400]
            wrong += undetected_faults(page, text, count, folder) if not wrong else []
    for line in wrong:
        print("test_document.py:", line, file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(write_small_document(*sys.argv[1:]) if len(sys.argv) == 3 else main(sys.argv[1]))
