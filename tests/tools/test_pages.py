#!/usr/bin/env python3
"""Opens pages of raya in headless Chromium: no script fails, no text of a report becomes markup, parts of a damaged report are named.
The figures that the explorer computes: tests/python.

    tests/tools/test_pages.py RAYA     Exit code 77: no Chromium (tools/setup --browser)
"""
import html, json, re, shutil, subprocess, sys, tempfile
from pathlib import Path

SCENES = Path(__file__).resolve().parents[2] / "scenes"
RAYA = str(Path(sys.argv[1]).resolve())
SMALL = ["--size", "48x36", "--machine", "grande", "--accel", "none", "--lanes", "4", "--format", "fp32"]
# Text that would mark the page's body if it became markup or code.
HIT = "document.body.dataset.hit = 1"
HOSTILE = f"</pre></script></template></title><script>{HIT}</script><img src=x onerror='{HIT}'>&lt;&#60;{{{{report}}}}<!--\u2028\0'\"`${{{HIT}}}`"


def raya(*arguments):
    return subprocess.run([RAYA, *map(str, arguments)], check=True, capture_output=True, text=True).stdout


def opened(page):
    """Opens a page and waits for its scripts. Returns (its elements as HTML, messages of the console, which names failed scripts and requests)."""
    with tempfile.TemporaryDirectory() as profile:
        command = [BROWSER, "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", f"--user-data-dir={profile}",
                   "--virtual-time-budget=5000", "--enable-logging=stderr", "--dump-dom", page.as_uri()]
        done = subprocess.run(command, check=True, capture_output=True, text=True, timeout=120)
    return done.stdout, re.findall(r".*:CONSOLE.*", done.stderr)


def faults_of_page(page, expected):
    """Yields faults of a page, which must contain the texts `expected`."""
    elements, messages = opened(page)
    yield from (f"{page.name}: {message}" for message in messages)
    body = html.unescape(re.sub(r'<pre id="report".*?</pre>', "", elements, flags=re.S))
    yield from (f"{page.name}: '{text}' is not shown" for text in expected if text not in body)
    if "data-hit" in elements:
        yield f"{page.name}: a text of the report became markup or code"


def texts_of(value):
    """Yields (container, key) of every text in a report."""
    for key in value if isinstance(value, dict) else range(len(value)):
        if isinstance(value[key], str):
            yield value, key
        elif isinstance(value[key], (dict, list)):
            yield from texts_of(value[key])


def faults_of_report(folder, name, expected, *command):
    """Makes a report and its page. Yields faults of the page, of one with HOSTILE in place of every text, and of one whose every part is damaged."""
    file, page = folder / f"{name}.json", folder / f"{name}.html"
    raya(*command, "--report", file, "--page", page)
    report = json.loads(file.read_text())
    yield from faults_of_page(page, [text(report) for text in expected])
    damaged = {key: 7 if isinstance(value, (dict, list)) else value for key, value in report.items()}
    for holder, key in list(texts_of(report)):
        if key not in ("kind", "png", "mapping", "fold", "links", "format", "status"):  # these select the parts that a page shows
            holder[key] = HOSTILE
    file.write_text(json.dumps(report))
    hostile, broken = folder / f"{name}-hostile.html", folder / f"{name}-damaged.html"
    raya("page", file, "-o", hostile, "--quiet")
    yield from faults_of_page(hostile, [f"{HIT}</script>"])
    broken.write_text(re.sub(r'(<pre id="report"[^>]*>).*?(?=</pre>)', lambda found: found[1] + json.dumps(damaged), page.read_text(), flags=re.S))
    yield from faults_of_page(broken, ["cannot be shown"])


def main(folder):
    image = ["-o", folder / "x.ppm", "--quiet"]
    hash_and_u = [lambda report: report["image"]["hash"], lambda report: f"{report['load']['imbalance']:.3f}"]
    faults = [*faults_of_report(folder, "ring", hash_and_u, "render", SCENES / "spheres.nff", *SMALL, "--pes", 48, *image),
              *faults_of_report(folder, "torus", hash_and_u, "render", SCENES / "planes.nff", "--size", 16, "--lanes", 4, "--machine", "torus", *image),
              *faults_of_report(folder, "verify", [lambda report: report["devices"][0]["checks"][0]["name"]], "verify", "--only", "machine mapping")]
    raya("explore", SCENES / "spheres.nff", *SMALL, "-o", folder / "explorer.html")
    faults += faults_of_page(folder / "explorer.html", ["spheres.nff"])
    if (Path(RAYA).parent / "python").is_dir():
        raya("study", "fig8", "--size", 17, "-q", "-o", folder / "study")
        faults += faults_of_page(folder / "study/index.html", ["fig8"])
    print("\n".join(faults) or "the pages: as expected")
    return 1 if faults else 0


if __name__ == "__main__":
    BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    if BROWSER is None:
        print("skipped: no Chromium (tools/setup --browser)")
        sys.exit(77)
    with tempfile.TemporaryDirectory() as scratch:
        sys.exit(main(Path(scratch)))
