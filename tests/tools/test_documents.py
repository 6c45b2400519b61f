#!/usr/bin/env python3
"""Checks the documents: targets of links and files named by their path exist (also those that
comments name), paragraphs are short, the outputs printed in README.md equal raya's outputs, the paper's numbers equal
its data, and the version is the same in all files for citation.

  test_documents.py RAYA           RAYA: the program, which runs the examples of README.md in the project's folder, except LONG
  test_documents.py RAYA --long    only the examples LONG, which build many kernels

Exit codes: 0 no fault; 1 a fault.
"""
import re, subprocess, sys, tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
GENERATED = {"performance.md", "verdicts.md", "artifact.md"}  # tools write these
PAPER = "paper.md"  # its paragraphs are those of a paper; comments behind its numbers name their data
LONG = re.compile(r"build/raya (verify|bench) ")
MAX_WORDS, MAX_CELL_WORDS, MAX_COLUMNS = 80, 30, 120
# Lines with measured figures, and the parts of these lines that differ between machines and runs: times, rates, lanes, sizes of binaries, the name
# of the device. All other lines are compared exactly.
MEASURED_LINES = re.compile(r"time |PASS |trace |ring/|torus/|.*: \d+ checks passed")
MEASURED = re.compile(r"\d+(\.\d+)?(?= s\b| Mrays/s\b)|(?<= on ).*(?= \()|^.*(?=: \d+ checks)|(?<=\s)\d+\.\d+|\b\d+ lanes?\b|(?<=\s)\d+(?=\s+\d)|(?<=\s)\d{2,3}$")


def documents(*patterns):
    listing = ["git", "ls-files", "--cached", "--others", "--exclude-standard", *(patterns or ["*.md"])]
    names = subprocess.run(listing, cwd=ROOT, capture_output=True, text=True, check=True)
    return [ROOT / name for name in names.stdout.split("\n") if name and (ROOT / name).is_file()]


def anchors(text):
    """Returns the anchors of a page's headings, as GitHub makes them."""
    headings = re.findall(r"^#+ (.*)$", text, re.M)
    return {re.sub(r"[^\w\- ]", "", re.sub(r"[`*]", "", heading).lower()).replace(" ", "-") for heading in headings}


def broken_links(page, text):
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if re.match(r"[a-z]+://|mailto:", target):
            continue
        file, _, anchor = target.partition("#")
        target_file = page if not file else page.parent / file
        if not target_file.exists():
            yield f"{page.relative_to(ROOT)}: {target} does not exist"
        elif anchor and target_file.suffix == ".md" and anchor not in anchors(target_file.read_text()):
            yield f"{page.relative_to(ROOT)}: {target} has no such heading"


def missing_files(page, text):
    """Yields a fault for each source file that a document or a comment names by its path and that does not exist."""
    for path in sorted(set(re.findall(r"(?<![\w/.])(?:host|kernels|tests|tools)/[\w/]+\.(?:cpp|hpp|clh?|py|sh)\b", text))):
        if "NAME" not in path and not (ROOT / path).exists():  # NAME.cpp is a placeholder in a recipe
            yield f"{page}: {path} does not exist"


def long_texts(page, text):
    name = page.relative_to(ROOT)
    prose = re.sub(r"^( {4,}|\t).*$", "", text, flags=re.M)  # without code
    items = re.split(r"\n\s*\n|\n(?=\s*(?:[-*]|\d+\.) )", prose)
    for item in items:
        rows = [line for line in item.splitlines() if line.startswith("|")]
        words = " ".join(line for line in item.splitlines() if not line.startswith(("|", "#"))).split()
        if len(words) > MAX_WORDS:
            yield f"{name}: {len(words)} words in one paragraph: {' '.join(words[:8])} ..."
        for cell in (cell for row in rows for cell in re.split(r"(?<!\\)\|", row)):
            if len(cell.split()) > MAX_CELL_WORDS:
                yield f"{name}: {len(cell.split())} words in one cell: {' '.join(cell.split()[:8])} ..."
    for number, line in enumerate(text.splitlines(), 1):
        if len(line) > MAX_COLUMNS and not line.startswith(("|", "    ")) and "](" not in line:
            yield f"{name}:{number}: {len(line)} columns"


def masked(line):
    """Returns the line with its measured parts replaced by "#"."""
    return re.sub(r"\s+", " ", MEASURED.sub("#", line) if MEASURED_LINES.match(line) else line).strip()


def examples(text):
    """Yields (command, printed lines) of each block that starts with "    $ build/raya"."""
    for block in re.findall(r"(?:^    .*\n)+", text, re.M):
        lines = [line[4:] for line in block.splitlines()]
        if lines[0].startswith("$ build/raya"):
            yield lines[0][2:], lines[1:]


def stale_counts(verify_output):
    """Yields a fault if docs/verify.md does not name the number of images that --quick renders."""
    printed = len(re.findall(r"^PASS  image\.", verify_output, re.M))
    named = re.search(r"(\d+) images", (ROOT / "docs/verify.md").read_text())
    if not named or int(named[1]) != printed:
        yield f"docs/verify.md: states {named[0] if named else 'no number of images'}, but raya verify --quick renders {printed} images"


def wrong_examples(raya, text, is_long=False):
    with tempfile.TemporaryDirectory() as folder:
        for command, printed in examples(text):
            if bool(LONG.match(command)) != is_long:
                continue
            arguments = command.replace("-o centre.png", f"-o {folder}/centre.png").split()[1:]
            run = subprocess.run([raya, *arguments], cwd=ROOT, capture_output=True, text=True)
            if run.returncode:
                yield f"README.md: {command}: exit code {run.returncode}: {run.stderr}"
                continue
            lines = {masked(line.replace(folder + "/", "")) for line in run.stdout.splitlines()}
            if " verify " in command:
                yield from stale_counts(run.stdout)
            yield from (f"README.md: {command} does not print: {line}" for line in printed if masked(line) not in lines)


def wrong_citations():
    """Yields a fault of the files for citation, or of the paper's numbers."""
    version = re.search(r"project\(raya VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text())[1]
    for name, pattern in (("CITATION.cff", r"^version: (\S+)$"), ("codemeta.json", r'"version": "(.*?)"'), (".zenodo.json", r'"version": "(.*?)"')):
        found = re.search(pattern, (ROOT / name).read_text(), re.M)
        if not found or found[1] != version:
            yield f"{name}: version {found and found[1]}, not {version}"
    checked = subprocess.run([sys.executable, "-B", ROOT / "docs/paper/check_numbers.py"], capture_output=True, text=True)
    if checked.returncode or int(checked.stdout.split()[0]) < 50:
        yield checked.stdout + checked.stderr
    if subprocess.run([ROOT / "tools/artifact", "--appendix"], capture_output=True).stdout != (ROOT / "docs/artifact.md").read_bytes():
        yield "docs/artifact.md: not what tools/artifact --appendix prints"


def main():
    raya = str(Path(sys.argv[1]).resolve())
    readme = (ROOT / "README.md").read_text()
    if "--long" in sys.argv:
        faults = list(wrong_examples(raya, readme, True))
        print("\n".join(faults) or "the long examples: as in README.md")
        return bool(faults)
    faults = []
    for page in documents():
        text = page.read_text()
        faults += broken_links(page, text)
        if page.name not in GENERATED | {PAPER}:
            faults += long_texts(page, text)
    for file in documents("*.md", "*.dot", "host/*.[ch]pp", "host/*.js", "kernels/*.cl", "kernels/*.clh", "kernels/*.h", "tests/mutants/*.txt"):
        if file.name != "CHANGELOG.md":
            faults += missing_files(file.relative_to(ROOT), file.read_text())
    faults += wrong_citations()
    bad = broken_links(ROOT / "README.md", "[a](docs/none.md)"), missing_files("a", "`host/none.cpp`"), long_texts(ROOT / "README.md", "word " * 81)
    if not all(map(list, bad)):
        faults.append("test_documents.py: does not detect a broken link, a missing file or a long paragraph")
    faults += wrong_examples(raya, readme)
    wrong = "    $ build/raya devices\n    a device that nobody has\n"
    readings = [masked(f"{name}: {count} checks passed, 0 failed in {count}.5 s") for name, count in (("cpu", 64), ("Intel(R) Xeon(R)", 64), ("cpu", 65))]
    if masked("load u = 0.180") == masked("load u = 0.181") or readings[0] != readings[1] or readings[0] == readings[2] or not list(wrong_examples(raya, wrong)) or not list(stale_counts("PASS  image a\n")):
        faults.append("test_documents.py: an example with another output passes")
    print("\n".join(faults) or f"{len(documents())} pages, {len(list(examples(readme)))} examples: no fault")
    return bool(faults)


if __name__ == "__main__":
    sys.exit(main())
