"""The cells of tools/portability's matrix: known failures, and the cells as Markdown, JUnit XML and rows of docs/verify.md."""
import argparse, dataclasses, datetime, re
import xml.etree.ElementTree as xml
from pathlib import Path

import programs
from portability_roots import preset_of

ROOT = Path(__file__).resolve().parent.parent
LAYERS = ["number", "geometry", "machine", "image"]
CHECKS = LAYERS + ["vectors", "renders", "defects", "build"]
ROOT_CHECKS = ["tests", "package"]  # only with --root, with PoCL
PAGE = ROOT / "docs" / "verify.md"


@dataclasses.dataclass
class Cell:
    """A check of an implementation. seconds: wall time; cpu_s: processor time, including children; notes: details of the verdict."""
    implementation: str
    check: str
    verdict: str = "FAIL"
    seconds: float = 0
    cpu_s: float = 0
    notes: list = dataclasses.field(default_factory=list)

    @property
    def name(self):
        return f"{self.implementation}, {self.check}"

    @property
    def kind(self):
        """right, FAIL, undecided, XFAIL (failed as expected) or XPASS (passed unexpectedly)."""
        marked = [kind for kind in ("FAIL", "XFAIL", "XPASS") if self.verdict.startswith(kind)]
        return marked[0] if marked else "undecided" if self.verdict in ("too slow", "-") else "right"

    @property
    def failed(self):
        return self.kind in ("FAIL", "XPASS")

    def judge(self, expected):
        """Marks the verdict with X if `expected` lists the cell; the first pattern that matches counts."""
        why = next((why for _, pattern, why in expected if self.kind != "undecided" and name_matches(self.name, pattern)), None)
        if why and self.kind == "right":
            self.notes.append(f"passed, but --expect lists it as failing ({why}): {self.verdict}")
            self.verdict = f"XPASS {self.verdict}"
        elif why:
            self.notes.append(f"{self.verdict} (expected: {why})")
            self.verdict = f"X{self.verdict}"


def name_matches(name, pattern):
    """Returns true if the name contains the pattern, in which * stands for any text."""
    return re.search(".*".join(map(re.escape, pattern.split("*"))), name) is not None


def read_expected_failures(path):
    """Reads lines PATTERN | REASON | LINK, the link being optional; # starts a comment line. Returns [("FILE:LINE", pattern, reason and link)]. For
    argparse."""
    failures = []
    for number, line in enumerate(argparse.FileType()(path), 1):
        fields = [field.strip() for field in line.split("|")]
        if not line.strip() or line.strip().startswith("#"):
            continue
        if not 2 <= len(fields) <= 3 or not fields[0] or not fields[1]:
            raise argparse.ArgumentTypeError(f"{path}:{number}: expected PATTERN | REASON or PATTERN | REASON | LINK")
        failures.append((f"{path}:{number}", fields[0], ", ".join(filter(None, fields[1:]))))
    return failures


def by_implementation(cells):
    """Returns {implementation: {check: cell}}."""
    found = {}
    for cell in cells:
        found.setdefault(cell.implementation, {})[cell.check] = cell
    return found


def without_right_cell(cells):
    """Returns the implementations without a cell that is right or failed as expected."""
    return [name for name, own in by_implementation(cells).items() if not any(cell.kind in ("right", "XFAIL") for cell in own.values())]


def junit_report(name, cells):
    """Returns JUnit XML with a test suite for each implementation. Expected failures are skipped test cases, unexpected passes are failures."""
    def clean(text):
        return re.sub("[^\t\n\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]", " ", text)  # XML 1.0 does not allow other characters

    root = xml.Element("testsuites", name=name)
    for implementation, own in by_implementation(cells).items():
        own = list(own.values())
        suite = xml.SubElement(root, "testsuite", name=clean(implementation), tests=str(len(own)), failures=str(sum(c.failed for c in own)), errors="0",
                               skipped=str(sum(c.kind in ("undecided", "XFAIL") for c in own)), time=f"{sum(c.seconds for c in own):.3f}")
        for cell in own:
            case = xml.SubElement(suite, "testcase", classname=name, name=clean(cell.name), time=f"{cell.seconds:.3f}")
            if cell.kind != "right":
                message = cell.notes[-1] if cell.kind.startswith("X") else cell.verdict
                found = xml.SubElement(case, "failure" if cell.failed else "skipped", message=clean(message))
                found.text = clean("\n".join(cell.notes)) if cell.failed else None
    xml.indent(root)
    return xml.tostring(root, encoding="unicode", xml_declaration=True) + "\n"


def matrix(devices, cells, checks, unavailable):
    """Returns the matrix as Markdown. devices: {implementation: (device, version and driver)}; unavailable: a line, or an empty text."""
    rows = [[name, *devices[name], *(own[check].verdict if check in own else "" for check in checks), f"{sum(c.cpu_s for c in own.values()):.0f}"]
            for name, own in by_implementation(cells).items()]
    notes = [f"- {cell.name}: " + " / ".join(note.splitlines()) for cell in cells for note in cell.notes]
    kinds = [cell.kind for cell in cells]
    counts = [f"{kinds.count(kind)} {kind}" for kind in ("right", "FAIL", "undecided", "XFAIL", "XPASS") if kind in kinds or not kind.startswith("X")]
    remark = f" No right cell: {', '.join(without_right_cell(cells))}." if without_right_cell(cells) else ""
    parts = [programs.markdown(["implementation", "device", "version, driver", *checks, "CPU s"], rows).rstrip(), "Details:" if notes else "",
             "\n".join(notes), unavailable, f"{len(cells)} cells: {', '.join(counts)}.{remark}\n"]
    return "\n\n".join(part for part in parts if part)


def write_page(origin, version, devices, cells):
    """Replaces the rows of an origin at the end of docs/verify.md: a Debian release or an architecture; "" for the system that runs this."""
    def origin_of(row):
        return (re.match(r"(\w+): ", row[0]) or ["", ""])[1]

    text, _, table = PAGE.read_text().partition("| implementation |")
    program, rows = f"{re.search('commit (.{8})', version)[1]}, {datetime.date.today()}", []
    for name, own in by_implementation(cells).items():
        driver = (re.search(r"driver ([^,|]+)", devices[name][1]) or ["", devices[name][1]])[1].strip()
        others = [cell for cell in own.values() if cell.kind != "right"]
        reasons = {found[1] for cell in others for note in cell.notes if (found := re.search(r"\(expected: (.*)\)", note))}
        rows.append([f"{origin}: {name}" if origin else name, driver, f"{len(own) - len(others)} of {len(own)}",
                     "; ".join([f"{cell.check}: {cell.kind}" for cell in others] + sorted(reasons)), f"{sum(c.cpu_s for c in own.values()):.0f}", program])
    rows += [row for row in (line[2:-2].split(" | ") for line in table.splitlines()[2:]) if origin_of(row) != origin]
    rows.sort(key=lambda row: (origin_of(row) != "", preset_of(origin_of(row)) is not None, origin_of(row)))
    PAGE.write_text(text + programs.markdown(["implementation", "driver", "right", "other cells", "CPU s", "program"], rows))
