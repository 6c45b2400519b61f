#!/usr/bin/python3
"""Compares the results of `raya study` with recorded results.

    compare_golden.py OUT GOLDEN [STUDY...]     OUT: folder of `raya study -o`; GOLDEN: folder with the recorded *.csv;
                                                STUDY: names of studies (default: all recorded tables)

Figures except measured times must agree to 1 part in 10^9, half widths of intervals to 1 in 10^6. golden_names.csv lists the columns and
cells that were renamed after the recording. Verdicts are not compared, because their rules are newer than the recording.
Prints the differences and the number of compared figures. Exit codes: 0 equal; 1 a difference.
"""
import csv
import math
import re
import sys
from pathlib import Path

FIGURES, INTERVALS = 1e-9, 1e-6  # relative tolerances
# Columns of measured times and rates whose name does not contain "measured": {pattern of file names: pattern of column names}.
MEASURED = {
    r"accel(-growth|-scenes)?": r".*\(ms\)|.*\(ns\)|.*\(s\)|time( \+-)?|samples",
    r"formats": r".*\(ms\)|.*times.*",
    r"ranks": r"half.*|fastest.*|array|time.*|speed-up",
    r"ranks-(all|here)": r".*\((ms|%)\)|speed-up|.*measured.*|remark|cores",
    r"ranks-messages": r".*\(us\)",
    r"ranks-networks": r"alpha.*|beta.*|source",
    r"simgrid": r".*\(s\)",
}


def rows_of(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.reader(file))


RENAMED = dict(rows_of(Path(__file__).with_name("golden_names.csv"))[1:])  # {[FILE/]recorded text: current text}


def renamed(text, stem):
    return RENAMED.get(f"{stem}/{text}", RENAMED.get(text, text))


def same(current, recorded, tolerance):
    try:
        a, b = float(current), float(recorded)
    except ValueError:
        return current == recorded
    return a == b or math.isclose(a, b, rel_tol=tolerance, abs_tol=1e-12) or (math.isnan(a) and math.isnan(b))


def is_measured(stem, column):
    if "measured" in column:
        return True
    return any(re.fullmatch(file, stem) and re.fullmatch(columns, column) for file, columns in MEASURED.items())


def compare_table(current, recorded, stem):
    """Returns (number of figures compared, number of figures skipped, list of differences). stem: file name of the table without extension."""
    if current[0] != recorded[0]:
        return 0, 0, [f"{stem}: columns {current[0]} instead of {recorded[0]}"]
    if len(current) != len(recorded):
        return 0, 0, [f"{stem}: {len(current) - 1} rows instead of {len(recorded) - 1}"]
    compared = skipped = 0
    differences = []
    for number, (a, b) in enumerate(zip(current[1:], recorded[1:]), 1):
        # Skips rows of Embree: its reciprocals, and therefore the origins of secondary rays, depend on the processor.
        if any(cell.startswith("measured") or cell == "Embree" for cell in b):
            skipped += len(b)
            continue
        for column, x, y in zip(recorded[0], a, b):
            if is_measured(stem, column):
                skipped += 1
                continue
            compared += 1
            if not same(x, y, INTERVALS if "+-" in column else FIGURES):
                differences.append(f"{stem}, row {number}, {column}: {x} instead of {y}")
    return compared, skipped, differences


def main(out, golden, wanted):
    compared = skipped = 0
    differences = []
    for path in sorted(golden.glob("*.csv")):
        if wanted and not any(path.stem == study or path.stem.startswith(study + "-") for study in wanted):
            continue
        if not (out / path.name).exists():
            differences.append(f"{path.name}: no such file")
            continue
        golden_rows = [[renamed(cell, path.stem) for cell in row] for row in rows_of(path)]
        table_compared, table_skipped, table_differences = compare_table(rows_of(out / path.name), golden_rows, path.stem)
        compared, skipped, differences = compared + table_compared, skipped + table_skipped, differences + table_differences
    for line in differences:
        print(line)
    print(f"{compared} figures compared, {skipped} measured ones skipped, {len(differences)} differences")
    return 1 if differences else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3:]))
