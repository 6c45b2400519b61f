"""Checks that the numbers in the text of the paper equal its data.

    python3 docs/paper/check_numbers.py [--against DIR]

In paper.md a comment follows each number of a result: 0.088<!--[offsets-256|P=256 & mapping=p = sqrt(P)|mean u]-->. It is an expression of cells
[FILE|COLUMN=VALUE & ...|COLUMN] of data/FILE.csv; FILE is STUDY-SIZE of a study with --size, or the table of a study with its default size. The text
must equal the value, rounded to the digits of the text (a percentage: 100 times the value).
--against DIR: also prints each value from the tables in DIR, the output folder of `raya study`, such as that of a short run.
Exit codes: 0 all numbers are equal; 1 a number differs, or has no comment; 2 bad comment.
"""
import csv
import math
import re
import sys
from functools import cache
from pathlib import Path

HERE = Path(__file__).parent
NUMBER = re.compile(r"(?P<number>-?[\d,]*\d(?:\.\d+)?)(?P<percent> %)?<!--(?P<expression>.*?)-->", re.S)
CELL = re.compile(r"\[([^|\]]+)\|([^|\]]+)\|([^\]]+)\]")
BARE = re.compile(r"\d+\.\d+|\d+ %")  # a decimal number or a percentage, which must have a comment


@cache
def table(file):
    with file.open(newline="") as lines:
        return list(csv.DictReader(lines))


def cell(file, condition, column):
    """Returns the number in a column of the one row that fulfils the condition; infinity for "never"."""
    wanted = dict(part.strip().split("=", 1) for part in condition.split("&"))
    rows = [row for row in table(file) if all(row[key.strip()] == value.strip() for key, value in wanted.items())]
    if len(rows) != 1:
        raise ValueError(f"{file.name}: {len(rows)} rows with {condition}, not one")
    return math.inf if rows[0][column] == "never" else float(rows[0][column])


def value_of(expression, file_of):
    """Returns the value of an expression of cells, + - * / ( ) and numbers. file_of: function(name of a table) -> path."""
    text = CELL.sub(lambda match: f"({cell(file_of(match[1]), match[2], match[3])!r})".replace("inf", "1e999"), expression)
    if not re.fullmatch(r"[\d\s.()+\-*/e]*", text):
        raise ValueError(f"not an expression of cells: {expression}")
    return eval(text, {"__builtins__": {}})


def main(arguments):
    against = Path(arguments[1]) if arguments[:1] == ["--against"] else None
    text = (HERE / "paper.md").read_text()
    wrong = checked = 0
    for match in NUMBER.finditer(text):
        line = text.count("\n", 0, match.start()) + 1
        written, digits = match["number"].replace(",", ""), len(match["number"].partition(".")[2])
        try:
            value = value_of(match["expression"], lambda name: HERE / "data" / f"{name}.csv") * (100 if match["percent"] else 1)
        except (OSError, KeyError, ValueError, SyntaxError) as error:
            print(f"paper.md:{line}: {match['expression']}: {error!r}")
            return 2
        checked += 1
        if float(f"{value:.{digits}f}") != float(written):
            print(f"paper.md:{line}: {match['number']}, but the data has {value:.{digits + 2}f}")
            wrong += 1
        if against:
            try:
                other = value_of(match["expression"], lambda name: against / f"{re.sub('-[0-9]+$', '', name)}.csv")
                print(f"paper.md:{line}: {match['number']}{match['percent'] or ''}: {against} has {other * (100 if match['percent'] else 1):.{digits + 1}f}")
            except (OSError, KeyError, ValueError) as error:
                print(f"paper.md:{line}: {match['number']}: not in {against}: {error}")
    results = re.sub(r"```.*?```", "", NUMBER.sub("", text.partition("# Results")[2].partition("# Limits")[0]), flags=re.S)
    for match in BARE.finditer(results):
        print(f"paper.md: {match[0]} in Results has no comment: ...{results[max(0, match.start() - 50):match.end() + 20]!r}")
        wrong += 1
    print(f"{checked} numbers of paper.md checked, {wrong} wrong")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
