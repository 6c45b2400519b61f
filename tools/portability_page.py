"""The matrix of tools/portability as text: kinds of cells, rows that --root and --arch saved, and their table in docs/verify.md."""
import datetime, re
from pathlib import Path

import ci_reports
from portability_roots import preset_of

ROOT = Path(__file__).resolve().parent.parent
LAYERS = ["number", "geometry", "machine", "image"]
CHECKS = LAYERS + ["vectors", "renders", "defects", "build"]
ROOT_CHECKS = ["tests", "package"]  # only with --root, with PoCL
PAGE = ROOT / "docs" / "verify.md"


def judge(name, check, seconds, verdict, details, expected):
    """Returns the cell as a ci_reports.Case, and its verdict, with X before it if `expected` lists the cell."""
    outcome = {"right": "PASS", "FAIL": "FAIL", "undecided": "SKIP"}[cell_kind(verdict)]
    case = ci_reports.Case(name, f"{name}, {check}", seconds, outcome, verdict, details)
    ci_reports.apply_expectations(case, expected)
    return case, {"XFAIL": "X", "XPASS": "XPASS "}.get(case.outcome, "") + verdict


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
    expected = ci_reports.read_expected_failures(file) if file.exists() else []
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
