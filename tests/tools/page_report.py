"""Helpers for tests of pages: reads and replaces the report that is embedded in a page; makes a report of tools/gpu_day."""
import json, re, subprocess
from pathlib import Path

REPORT = re.compile(r'(<pre id="report"[^>]*>)(.*?)(</pre>)', re.S)
# Text that a page must escape: closing tags, scripts, event handlers, entities, placeholders of the page's template, line separators.
HOSTILE = ("</pre></script></template></title><script>window.hit = 1</script><img src=x onerror='window.hit = 1'><svg onload='window.hit = 1'>"
           "&lt;&amp;&#60;{{style.css}}{{report}}<!--<![CDATA[ \u2028\u2029\u0000'\"`${window.hit = 1}`\\ javascript:window.hit=1//")


def report_of(html):
    return json.loads(REPORT.search(html)[2])


def with_report(html, report):
    """Returns the page with its report replaced. The JSON is escaped as in host/report/page/page.cpp."""
    text = json.dumps(report, indent=2, ensure_ascii=False)
    for sign in "<>&":
        text = text.replace(sign, f"\\u{ord(sign):04x}")
    return REPORT.sub(lambda found: found[1] + text + found[3], html)


def values_of(value, predicate):
    """Yields (container, key) of every value in a report for which predicate(value) is true."""
    for key in value if isinstance(value, dict) else range(len(value)):
        if predicate(value[key]):
            yield value, key
        if isinstance(value[key], (dict, list)):
            yield from values_of(value[key], predicate)


def gpu_day(raya, folder):
    """Makes a report of tools/gpu_day with steps that are right, wrong, late or impossible on this machine. Returns (report.json, page.html)."""
    steps = Path(folder, "steps")
    steps.mkdir(parents=True)
    # (step, "STAGE SECONDS VERDICT", output)
    for name, code, text in [("devices", "1 0 right", "$ raya devices\nGPU"), ("verify-quick", "1 12 exit code 4", "$ raya verify --quick\nGPU (maker, driver 1)\nFAIL  grid \"a\\b\""),
                             ("goal-spheres-group32", "5 3 right", "$ raya bench\ntrace  fp32  1  32  5120.5  5"), ("hash-ring-cones-fp32", "3 1 late", "not started"),
                             ("ranks", "5 0 not here: no mpirun", None)]:
        Path(steps, name + ".code").write_text(code + "\n")
        if text is not None:
            Path(steps, name + ".txt").write_text(text + "\n")
    Path(folder, "stage-1").touch()
    tool = Path(__file__).resolve().parents[2] / "tools" / "gpu_day"
    subprocess.run([tool, "--out", folder, "--raya", raya], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)  # exit code 4: a step is wrong
    return Path(folder, "report.json"), Path(folder, "page.html")
