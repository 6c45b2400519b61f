"""The matrix of tools/portability as text: kinds of cells, rows that --root and --arch saved, and docs/portability.md."""
import datetime, re
from pathlib import Path

import ci_reports
from portability_roots import preset_of

ROOT = Path(__file__).resolve().parent.parent
LAYERS = ["number", "geometry", "machine", "image"]
CHECKS = LAYERS + ["vectors", "renders", "defects", "build"]
ROOT_CHECKS = ["tests", "package"]  # only with --root, with PoCL
PAGE = ROOT / "docs" / "portability.md"


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


def write_page(origin, version, rows, notes, unavailable):
    """Replaces the rows and details of this origin in docs/portability.md, and unless `unavailable` is None the line of what is not available."""
    head, _, matrix = PAGE.read_text().partition("| implementation |")
    old = matrix.splitlines()
    rows += [row for row in (line[2:-2].split(" | ") for line in old[2:] if line.startswith("| ")) if origin_of(row[0]) != origin]
    notes += [line for line in old if line.startswith("- ") and origin_of(line[2:]) != origin]
    if unavailable is None:
        unavailable = "".join(line for line in old if line.startswith("Not available: "))
    versions = dict(part.split(": ", 1) for part in re.search(r"Rows of (.+)\.\n", head)[1].split("; "))
    versions[origin] = f"{version}, {datetime.date.today()}"
    order = ["here", *sorted(versions, key=lambda name: (preset_of(name) is not None, name))].index
    head = re.sub(r"Rows of .+", f"Rows of {'; '.join(f'{name}: {versions[name]}' for name in sorted(versions, key=order))}.", head)
    matrix = markdown(sorted(rows, key=lambda row: order(origin_of(row[0]))), sorted(notes, key=lambda line: order(origin_of(line[2:]))), unavailable,
                      CHECKS + ROOT_CHECKS)
    PAGE.write_text(head + matrix)
