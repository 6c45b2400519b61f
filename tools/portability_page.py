"""The matrix of tools/portability as text: kinds of cells, JUnit XML, rows that --root and --arch saved, and their table in docs/verify.md."""
import dataclasses, datetime, re
import xml.etree.ElementTree as xml
from pathlib import Path

from portability_roots import preset_of

ROOT = Path(__file__).resolve().parent.parent
LAYERS = ["number", "geometry", "machine", "image"]
CHECKS = LAYERS + ["vectors", "renders", "defects", "build"]
ROOT_CHECKS = ["tests", "package"]  # only with --root, with PoCL
PAGE = ROOT / "docs" / "verify.md"


@dataclasses.dataclass
class Case:
    """A cell as a test case. outcome: PASS, FAIL, SKIP, XFAIL (failed as expected) or XPASS (passed unexpectedly); result: one line; details: lines."""
    suite: str
    name: str
    seconds: float
    outcome: str
    result: str
    details: str


def name_matches(name, pattern):
    """Returns true if the name contains the pattern, in which * stands for any text."""
    return re.search(".*".join(map(re.escape, pattern.split("*"))), name) is not None


def read_expected_failures(path):
    """Reads lines PATTERN | REASON | LINK, the link being optional; # starts a comment line. Returns [("FILE:LINE", pattern, reason and link)]. Raises
    ValueError with file and line."""
    failures = []
    for number, line in enumerate(path.read_text().splitlines(), 1):
        fields = [field.strip() for field in line.split("|")]
        if not line.strip() or line.strip().startswith("#"):
            continue
        if not 2 <= len(fields) <= 3 or not fields[0] or not fields[1]:
            raise ValueError(f"{path}:{number}: expected PATTERN | REASON or PATTERN | REASON | LINK")
        failures.append((f"{path}:{number}", fields[0], ", ".join(filter(None, fields[1:]))))
    return failures


def unmatched(failures, names):
    """Returns a warning for each pattern that matches none of the names."""
    return [f'{place}: "{pattern}" matches no check' for place, pattern, _ in failures if not any(name_matches(name, pattern) for name in names)]


def judge(name, check, seconds, verdict, details, expected):
    """Returns the cell as a Case, and its verdict, with X before it if `expected` lists the cell; the first pattern that matches counts."""
    outcome = {"right": "PASS", "FAIL": "FAIL", "undecided": "SKIP"}[cell_kind(verdict)]
    case = Case(name, f"{name}, {check}", seconds, outcome, verdict, details)
    why = next((why for _, pattern, why in expected if outcome != "SKIP" and name_matches(case.name, pattern)), None)
    if why and outcome == "PASS":
        case.outcome, case.result, verdict = "XPASS", f"passed, but --expect lists it as failing ({why}): {verdict}", f"XPASS {verdict}"
    elif why:
        case.outcome, case.result, verdict = "XFAIL", f"{verdict} (expected: {why})", f"X{verdict}"
    return case, verdict


def xml_text(text):
    """Returns the text without the control characters that XML 1.0 does not allow."""
    return re.sub("[^\t\n\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]", " ", text)


def junit_report(name, cases):
    """Returns JUnit XML with a test suite for each Case.suite. Expected failures are skipped test cases, unexpected passes are failures."""
    root = xml.Element("testsuites", name=name)
    for suite in dict.fromkeys(case.suite for case in cases):
        own = [case for case in cases if case.suite == suite]
        failures, skipped = (sum(case.outcome in kinds for case in own) for kinds in (("FAIL", "XPASS"), ("SKIP", "XFAIL")))
        element = xml.SubElement(root, "testsuite", name=xml_text(suite), tests=str(len(own)), failures=str(failures), errors="0",
                                 skipped=str(skipped), time=f"{sum(case.seconds for case in own):.3f}")
        for case in own:
            one = xml.SubElement(element, "testcase", classname=name, name=xml_text(case.name), time=f"{case.seconds:.3f}")
            if case.outcome in ("FAIL", "XPASS"):
                xml.SubElement(one, "failure", message=xml_text(case.result)).text = xml_text(case.details)
            elif case.outcome in ("SKIP", "XFAIL"):
                xml.SubElement(one, "skipped", message=xml_text(case.result))
    xml.indent(root)
    return xml.tostring(root, encoding="unicode", xml_declaration=True) + "\n"


def cell_kind(verdict):
    """Returns the kind of a cell: right, FAIL, undecided, XFAIL or XPASS."""
    marked = [kind for kind in ("FAIL", "XFAIL", "XPASS") if verdict.startswith(kind)]
    return marked[0] if marked else "undecided" if verdict in ("too slow", "-") else "right"


def kinds_of(row):
    """Returns the kinds of the cells that ran."""
    return [cell_kind(verdict) for verdict in row[3:-1] if verdict]


def without_right_cell(rows):
    """Returns the names of implementations without a cell that is right or failed as expected."""
    return [row[0] for row in rows if not {"right", "XFAIL"} & set(kinds_of(row))]


def summary_line(rows):
    kinds = [kind for row in rows for kind in kinds_of(row)]
    counts = {kind: kinds.count(kind) for kind in ("right", "FAIL", "undecided", "XFAIL", "XPASS") if kind in kinds or not kind.startswith("X")}
    remark = f" No right cell: {', '.join(without_right_cell(rows))}." if without_right_cell(rows) else ""
    return f"{len(kinds)} cells: {', '.join(f'{count} {kind}' for kind, count in counts.items())}.{remark}\n"


def expected_failures(release):
    """Returns the file that lists the known failures of a Debian's implementations; it need not exist."""
    return ROOT / "tests" / "portability" / f"expect_{release}.txt"


def note_line(name, check, text):
    return f"- {name}, {check}: " + " / ".join(text.splitlines())


def rows_of_root(release, saved, checks):
    """Returns the rows of the matrix, and the notes, from the results that --root saved."""
    rows, notes, file = [], [], expected_failures(release)
    expected = read_expected_failures(file) if file.exists() else []
    for name, device in saved["devices"].items():
        verdicts, seconds = dict.fromkeys(checks, ""), 0
        for check in checks:
            verdict, used, texts = saved["cells"].get(f"{name}, {check}", ["", 0, []])
            if not verdict:
                continue
            case, verdicts[check] = judge(name, check, 0, verdict, "", expected)
            seconds += used
            notes += [note_line(f"{release}: {name}", check, text) for text in texts + ([case.result] if case.outcome.startswith("X") else [])]
        rows.append([f"{release}: {name}", *(device or ("no device", "")), *verdicts.values(), f"{seconds:.0f}"])
    return rows, notes


def markdown(rows, notes, unavailable, checks):
    """Returns the matrix. notes: lines; unavailable: a line, or an empty text."""
    head = ["implementation", "device", "version, driver", *checks, "CPU s"]
    lines = ["| " + " | ".join(cells) + " |" for cells in [head, ["---"] * len(head), *rows]]
    parts = ["\n".join(lines), "Details:" if notes else "", "\n".join(notes), unavailable, summary_line(rows)]
    return "\n\n".join(part for part in parts if part)


def origin_of(name):
    """Returns the Debian release or architecture of a row, "RELEASE: IMPLEMENTATION"; "here" for the system on which --write ran."""
    return (re.match(r"(\w+): ", name) or ["", "here"])[1]


def page_row(row, notes):
    """Returns the row of docs/verify.md for a row of the matrix: name, driver, right cells, other cells with their reasons, processor seconds."""
    name, _, version, *cells, seconds = row
    driver = (re.search(r"driver ([^,|]+)", version) or ["", version])[1]
    kinds = kinds_of(row)
    others = [f"{check}: {cell_kind(cell)}" for check, cell in zip(CHECKS + ROOT_CHECKS, cells) if cell and cell_kind(cell) != "right"]
    reasons = {found[1] for note in notes if re.match(f"- {re.escape(name)}, \\w+: ", note) and (found := re.search(r"\(expected: (.*)\)", note))}
    return [name, driver.strip(), f"{kinds.count('right')} of {len(kinds)}", "; ".join(others + sorted(reasons)), seconds]


def write_page(origin, version, rows, notes):
    """Replaces the rows of this origin at the end of docs/verify.md."""
    text, _, table = PAGE.read_text().partition("| implementation |")
    old = [line[2:-2].split(" | ") for line in table.splitlines()[2:]]
    program = f"{re.search('commit (.{8})', version)[1]}, {datetime.date.today()}"
    rows = [[*page_row(row, notes), program] for row in rows] + [row for row in old if origin_of(row[0]) != origin]
    head = ["implementation", "driver", "right", "other cells", "CPU s", "program"]
    names = sorted({origin_of(row[0]) for row in rows} - {"here"}, key=lambda name: (preset_of(name) is not None, name))
    rows.sort(key=lambda row: ["here", *names].index(origin_of(row[0])))
    PAGE.write_text(text + "".join(f"| {' | '.join(row)} |\n" for row in [head, ["---"] * len(head), *rows]))
