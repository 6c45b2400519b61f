#!/usr/bin/env python3
"""Tests tools/mutants: the mutations of some lines, damaged results, and a sample of 2 committed mutants.

    test_mutants.py BUILD [--seed N]      BUILD: the build folder. Prints the seed of the sample (default: random).
"""
import importlib.machinery, importlib.util, random, subprocess, sys, tempfile
from pathlib import Path

sys.dont_write_bytecode = True
ROOT = Path(__file__).resolve().parent.parent.parent
TOOL = ROOT / "tools" / "mutants"
LINES = {
    "    if (a < b && c[i] != 0) x += 2;": {
        ("comparison", "    if (a <= b && c[i] != 0) x += 2;"), ("comparison", "    if (a > b && c[i] != 0) x += 2;"),
        ("operator", "    if (a < b || c[i] != 0) x += 2;"), ("index", "    if (a < b && c[1 + i] != 0) x += 2;"),
        ("comparison", "    if (a < b && c[i] == 0) x += 2;"), ("constant", "    if (a < b && c[i] != 1) x += 2;"),
        ("operator", "    if (a < b && c[i] != 0) x -= 2;"), ("constant", "    if (a < b && c[i] != 0) x += 3;"),
        ("constant", "    if (a < b && c[i] != 0) x += 1;")},
    "    *to = &from->x;": {("statement", "    ;")},
    "    count_event(t, RAYA_LIT, lit);": {("statement", "    ;")},
    "    return 0.5f * x;": {("constant", "    return 1.0f * x;"), ("operator", "    return 0.5f + x;")},
    "const real* a,": set(),
}


def load_tool():
    loader = importlib.machinery.SourceFileLoader("mutants", str(TOOL))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("mutants", loader))
    loader.exec_module(module)
    return module


def check(right, what):
    if not right:
        sys.exit(f"FAILED: {what}")


def check_lines(tool):
    for line, expected in LINES.items():
        found = set(tool.mutants_of_line(line))
        check(found == expected, f"mutants of '{line}': {sorted(found ^ expected)}")
    check(tool.with_line("a\n  b\nb\n", 3, "b", "c") == "a\n  b\nc\n", "the nearest line")
    lists = tool.make_candidates(500, 1)
    check(lists == tool.make_candidates(500, 1) and lists != tool.make_candidates(500, 2), "the seed selects the mutants")
    files = {mutants[0][0] for mutants in lists}
    kernels = {str(path.relative_to(ROOT / "kernels")) for path in tool.KERNELS.rglob("*.cl*") if "example" not in path.parts}
    check(kernels - files <= {"geometry/ray.clh"}, f"files without mutant: {kernels - files}")


def check_sample(build, seed):
    command = [str(TOOL), "--build", build, "--sample", "2", "--seed", str(seed)]
    done = subprocess.run(command, capture_output=True, text=True)
    print(done.stdout)
    check(done.returncode == 0, f"{' '.join(command)}: exit code {done.returncode}: {done.stderr}")
    check("of 2 mutants" in done.stdout, "the sample's last line")


def check_lost(tool, build):
    """A mutant that verify does not detect, but that the results have as detected, gives exit code 1."""
    path = tool.KERNELS / "shading" / "light.clh"
    line = next(line for line in path.read_text().splitlines() if line.startswith("//"))
    with tempfile.TemporaryDirectory() as folder:
        results = Path(folder) / "results.csv"
        results.write_text(",".join(tool.FIELDS) + "\n")
        with results.open("a", newline="") as out:
            tool.csv.DictWriter(out, tool.FIELDS).writerow({"file": "shading/light.clh", "line": 1, "kind": "operator", "original": line,
                                                           "mutant": "// no change of code", "detected_by": "quick", "check": "x"})
        done = subprocess.run([str(TOOL), "--build", build, "--sample", "1", "--results", str(results)], capture_output=True, text=True)
        check(done.returncode == 1, f"a mutant that is not detected: exit code {done.returncode}: {done.stdout}{done.stderr}")


def main():
    build = sys.argv[1]
    seed = int(sys.argv[3]) if len(sys.argv) > 3 else random.randrange(1 << 32)
    print(f"seed {seed}", flush=True)
    tool = load_tool()
    check_lines(tool)
    check_lost(tool, build)
    check_sample(build, seed)


if __name__ == "__main__":
    main()
