"""The result of a study as plain data, from which document.py writes the study's files and its part of the document."""
import numbers
import re
from dataclasses import dataclass, field, replace
from typing import Optional

import numpy as np
import pandas as pd
from raya.lab.claims import undecided_claims


@dataclass
class Table:
    """A table. Column names include the unit: 'load (cycles)'. A missing value is nan."""

    name: str  # file name of the CSV without extension
    title: str
    rows: pd.DataFrame  # or any argument of pandas.DataFrame(), such as a list of dicts
    on_page: bool = True  # False: a long table, written to the CSV only

    def __post_init__(self):
        self.rows = pd.DataFrame(self.rows)
        if self.rows.empty or not self.rows.columns.is_unique:
            raise ValueError(f"table {self.name}: has no rows, or two columns with the same name")


@dataclass
class Series:
    label: str
    x: list
    y: list
    style: str = "line"  # line, points, steps, paper
    half_widths: list = field(default_factory=list)  # of the 95 % confidence intervals of y

    def __post_init__(self):
        try:
            self.x, self.y = ([float(value) for value in values] for values in (self.x, self.y))
            self.half_widths = np.nan_to_num([float(half) for half in self.half_widths]).tolist()
        except (TypeError, ValueError) as error:
            raise ValueError(f"series {self.label}: {error}") from None
        if len(self.y) != len(self.x) or len(self.half_widths) not in (0, len(self.x)):
            raise ValueError(f"series {self.label}: x, y and half_widths differ in length: {len(self.x)}, {len(self.y)}, {len(self.half_widths)}")


def series_by(rows, label, x, y, half=None, style="line"):
    """Returns a list with a Series for each value of column `label`, in order of first occurrence. x, y, half: names of the columns of the points and
    of the half widths of their intervals."""
    return [Series(str(value), group[x], group[y], style, group[half] if half else [])
            for value, group in rows.groupby(label, sort=False)]


@dataclass
class Plot:
    name: str  # file name of SVG and PNG without extension
    title: str
    x_label: str
    y_label: str
    series: list
    log: str = ""  # logarithmic axes: "", "x", "y" or "xy"
    x_names: list = field(default_factory=list)  # names of the positions 1, 2, ... on the x axis; empty: numbers


@dataclass
class Picture:
    name: str  # file name of the PNG without extension
    title: str
    words: str  # alternative text for readers who do not see the picture
    png: bytes


@dataclass
class Comparison:
    """One of our figures (`ours`) and the same figure in the paper (`paper`; None if the paper does not have it), both in `unit`."""

    what: str  # name of the figure
    unit: str
    paper: Optional[float]
    ours: float
    remark: str = ""
    derived: bool = False  # the paper's figure follows by arithmetic from printed figures
    half_width: Optional[float] = None  # of the 95 % confidence interval of `ours`

    def __post_init__(self):
        if self.paper is not None and np.isnan(self.paper):
            self.paper = None
        if not isinstance(self.ours, numbers.Real) or np.isnan(self.ours):
            raise ValueError(f"comparison '{self.what}': our figure is {self.ours!r}, not a number")


def with_paper(in_paper, comparisons):
    """Returns the comparisons. in_paper: the study uses the paper's scene and size; if false, the paper's figures are removed."""
    return comparisons if in_paper else [replace(comparison, paper=None) for comparison in comparisons]


@dataclass
class Page:
    """The result of a study. A study's run() sets the members up to `compared_with`; describe() and the program set the others."""

    settings: dict  # values of {names} in the prose; the JSON report contains them
    findings: list = field(default_factory=list)  # sentences, the most important one first
    comparisons: list = field(default_factory=list)
    claims: list = field(default_factory=list)  # of Judgement, as returned by judged()
    tables: list = field(default_factory=list)
    plots: list = field(default_factory=list)
    news: list = field(default_factory=list)  # sentences on results that go beyond the papers
    pictures: list = field(default_factory=list)
    clock: str = ""  # how the times on the page are modelled or measured
    placeholders: dict = field(default_factory=dict)  # values of {names} in the prose that are not settings
    compared_with: str = ""  # authors and year of the paper whose figures `comparisons` contains; empty for several papers
    name: str = ""
    title: str = ""
    question: str = ""
    method: list = field(default_factory=list)
    run: dict = field(default_factory=dict)

    def describe(self, name, prose):
        """Sets title, question and method from a study's prose: its first line, the paragraph after it, and the items of its list. {names} are
        replaced by settings and placeholders. Raises ValueError for an unknown {name}, for a name with a path, and for two files with the same name."""
        self.name = name
        self.claims = self.claims and [*self.claims, *undecided_claims(name, self.claims)]
        try:
            prose = prose.format_map({**self.settings, **self.placeholders})
        except KeyError as error:
            raise ValueError(f"study {name}: its docstring has {{{error.args[0]}}}, which is not a setting: add it to Page's settings or "
                             "placeholders") from None
        head, *items = re.split(r"^- ", prose, flags=re.MULTILINE)
        self.title, _, question = head.strip().partition("\n")
        self.question, *self.method = (" ".join(text.split()) for text in (question, *items))
        for kind in (self.tables, self.plots + self.pictures):
            names = [output.name for output in kind]
            for wrong in (one for one in names if not re.fullmatch(r"\w[\w .+-]*", one)):
                raise ValueError(f"study {name}: a table, plot or picture is named {wrong!r}; use letters, digits, - and _")
            if len(names) != len(set(names)):
                raise ValueError(f"study {name}: two files have the same name: {', '.join(sorted(names))}")
        return self


def format_value(value):
    """Returns a number as text for a page, with five significant digits."""
    if isinstance(value, str):
        return value
    if value is None or (isinstance(value, float) and np.isnan(value)):
        return "-"
    if isinstance(value, (int, np.integer)):
        return str(value)
    if value == 0:
        return "0"
    return f"{value:.0f}" if 1e4 <= abs(value) < 1e15 else f"{value:.5g}"
