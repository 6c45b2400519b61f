#!/usr/bin/env python3
"""Draws the plots of a study from the JSON file that `raya study` writes.

    tools/plot.py FILE.json...    NAME.svg and NAME.png of every plot in FILE, beside it

`raya study` holds this script within itself and does the same after each study. The same file gives the same bytes
under the same matplotlib. All plots of a file appear, each whole, or none does. Exit code 1: a file cannot be drawn,
with the reason; 3: no matplotlib.
"""
import sys

sys.path[:] = [folder for folder in sys.path if folder]  # read from stdin: the user's folder may hold a json.py

import json
import math
import os
import textwrap

os.environ.pop("MPLBACKEND", None)  # one that is not installed would stop the import

try:
    import matplotlib
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib.patheffects import withStroke
    from matplotlib.ticker import FixedLocator, LogLocator, NullFormatter, NullLocator
except Exception as problem:  # broken ones raise more than ImportError
    print(f"plot.py: no matplotlib ({problem}): install python3-matplotlib", file=sys.stderr)
    sys.exit(3)

# M. Okabe and K. Ito's colours, told apart by colour-blind readers too; without yellow, which is faint on white.
COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000"]
PAPER_COLOURS = ["#000000", "#8B1A1A", "#1A3A8B", "#1A5E1A"]
DASHES = ["-", (0, (6, 2)), (0, (1.5, 1.5)), (0, (7, 2, 1.5, 2)), (0, (3, 1.5, 1, 1.5, 1, 1.5))]  # fewer than colours
MARKERS = ["o", "s", "^", "v", "P", "X", "d", "<", ">"]
FEW = 40  # points of a line that are marked one by one, so that one sees where it was computed
HALO = [withStroke(linewidth=3, foreground="white")]  # keeps text readable across a line
LEGEND_WIDTH = 24  # characters

STYLE = {
    "axes.axisbelow": True, "axes.edgecolor": "#555555", "axes.formatter.use_mathtext": True,
    "axes.formatter.useoffset": False, "axes.formatter.limits": (-4, 6), "axes.grid": True, "axes.labelsize": 12,
    "axes.spines.right": False, "axes.spines.top": False, "axes.titlelocation": "left", "axes.titlesize": 13,
    "axes.titleweight": "bold", "axes.titlepad": 12, "font.size": 11, "grid.color": "#dddddd", "grid.linewidth": 0.7,
    "legend.fontsize": 11, "legend.frameon": False, "svg.hashsalt": "raya",
    "xtick.labelsize": 11, "ytick.labelsize": 11,
}


class PlotError(Exception):
    """What is wrong with a file, in words."""


def plain(text):
    """Text in which a dollar is a dollar and no formula."""
    return str(text).replace("$", r"\$")


def numbers(series, axis, where):
    try:
        values = [float(value) for value in series[axis]]  # "inf" and "nan" are strings in JSON
    except (TypeError, ValueError) as problem:
        raise PlotError(f"{where}: {axis}: {problem}") from None
    return [value if math.isfinite(value) else math.nan for value in values]


def points_of(plot, series):
    where = f"plot '{plot['name']}', series '{series['label']}'"
    x, y = numbers(series, "x", where), numbers(series, "y", where)
    if len(x) != len(y):
        raise PlotError(f"{where}: {len(x)} x and {len(y)} y")
    return x, y


def look_of(style, number, count):
    """How the number-th series of its kind is drawn; in colour and in shape no two are alike."""
    colour = COLOURS[number % len(COLOURS)]
    dash = DASHES[number % len(DASHES)]
    marker = MARKERS[number % len(MARKERS)]
    if style in ("line", "steps"):
        look = {"color": colour, "linestyle": dash, "linewidth": 1.7 if count <= 100 else 1.3}
        if style == "steps":
            return {**look, "drawstyle": "steps-mid"}
        return {**look, "marker": marker if count <= FEW else "", "markersize": 5}
    if style == "points":
        return {"color": colour, "linestyle": "", "marker": marker, "markersize": 6 if count <= 100 else 3}
    if style == "paper":
        return {"color": PAPER_COLOURS[number % len(PAPER_COLOURS)], "linestyle": "", "marker": "D", "markersize": 11,
                "markerfacecolor": "none", "markeredgewidth": 2, "zorder": 5}
    raise PlotError(f"no style '{style}': there are line, points, steps, paper")


def draw_series(axes, plot):
    """Returns x and y of every series."""
    drawn, kinds = [], {True: 0, False: 0}
    for series in plot["series"]:
        x, y = points_of(plot, series)
        paper = series["style"] == "paper"
        axes.plot(x, y, **look_of(series["style"], kinds[paper], len(x)))
        kinds[paper] += 1
        drawn.append((x, y))
    return drawn


def name_paper_points(axes, plot, drawn):
    """Writes the paper's figures beside their points, where they are few."""
    papers = [points for series, points in zip(plot["series"], drawn) if series["style"] == "paper"]
    if sum(len(x) for x, _ in papers) > 8:
        return
    share = axes.transData + axes.transAxes.inverted()  # 0..1 from side to side
    for x, y in papers:
        for at in zip(x, y):
            if not is_shown(plot, *at):
                continue
            on_right = share.transform(at)[0] > 0.85  # then its text stands on the left
            axes.annotate(f"{at[1]:.5g}", at, xytext=(-11 if on_right else 11, 5), textcoords="offset points",
                          ha="right" if on_right else "left", zorder=6, path_effects=HALO)


def power_of_ten(value, _):
    if value <= 0:
        return ""
    exponent = math.floor(math.log10(value) + 1e-9)
    digit = round(value / 10**exponent)
    return f"$10^{{{exponent}}}$" if digit == 1 else rf"${digit}\times10^{{{exponent}}}$"


def mark_powers_of_two(axis, values):
    """Marks at 9 of them at most, the lowest first. All marks of an axis are written in one way."""
    first, last = (math.frexp(value)[1] - 1 for value in (min(values), max(values)))
    axis.set_major_locator(FixedLocator([2.0**n for n in range(first, last + 1, (last - first) // 9 + 1)]))
    axis.set_minor_locator(NullLocator())
    as_power = last > 14 or first < -3
    axis.set_major_formatter(lambda value, _: f"$2^{{{round(math.log2(value))}}}$" if as_power else f"{value:g}")


def mark_powers_of_ten(axis, values):
    """And 2 and 5 times each where there are few of them."""
    low, high = (min(values), max(values)) if values else (1, 10)
    axis.set_major_locator(LogLocator(base=10, subs=(1, 2, 5) if high / low < 300 else (1,), numticks=12))
    axis.set_minor_formatter(NullFormatter())
    axis.set_major_formatter((lambda value, _: f"{value:g}") if 1e-4 < low <= high < 1e5 else power_of_ten)


def set_log_axis(axes, name, values):
    by_two = len(set(values)) > 2 and all(math.frexp(value)[0] == 0.5 for value in values)
    set_scale = axes.set_xscale if name == "x" else axes.set_yscale
    set_scale("log", base=2 if by_two else 10, nonpositive="mask")
    if not values:  # then autoscaling has nothing to go by
        (axes.set_xlim if name == "x" else axes.set_ylim)(1, 10)
    mark = mark_powers_of_two if by_two else mark_powers_of_ten
    mark(axes.xaxis if name == "x" else axes.yaxis, values)


def is_shown(plot, x, y):
    """Infinite points have no place on a plot, nor have those at or below zero on a logarithmic axis."""
    return math.isfinite(x + y) and (x > 0 or not plot["log_x"]) and (y > 0 or not plot["log_y"])


def set_axes(axes, plot, shown):
    """Scales, labels, and a zero on the y axis where the figures reach down towards it."""
    axes.set_xlabel(plain(plot["x_label"]))
    axes.set_ylabel(plain(plot["y_label"]))
    x, y = zip(*shown) if shown else ((), ())
    for name, values in (("x", x), ("y", y)):
        if plot["log_" + name]:
            set_log_axis(axes, name, values)
    if y and not plot["log_y"] and 0 <= min(y) <= max(y) / 2:
        axes.set_ylim(bottom=0)


def legend_labels(plot):
    return [textwrap.fill(plain(series["label"]), LEGEND_WIDTH) for series in plot["series"]]


def draw_legend(axes, labels):
    """On the right of the data, never over it."""
    if not any(labels):
        return
    labels = [" " + label if label.startswith("_") else label for label in labels]  # matplotlib would leave it out
    axes.legend(axes.get_lines(), labels, loc="upper left", bbox_to_anchor=(1.01, 1), borderaxespad=0, handlelength=2.6)


def draw(plot):
    labels = legend_labels(plot)
    lines = sum(label.count("\n") + 1 for label in labels)
    figure = Figure(figsize=(9, max(5.2, 0.24 * lines)), layout="constrained")  # inches: 900 pixels wide at 100 an inch
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    drawn = draw_series(axes, plot)
    points = [at for x, y in drawn for at in zip(x, y)]
    shown = [at for at in points if is_shown(plot, *at)]
    set_axes(axes, plot, shown)
    axes.set_title(textwrap.fill(plain(plot["title"]), 76))
    draw_legend(axes, labels)
    hidden = len(points) - len(shown)
    if hidden:
        figure.text(0.01, 0.01, f"{hidden} point{'s' if hidden > 1 else ''} without a place on these axes "
                    "(infinite, or not above 0 on a logarithmic one)", fontsize=9, color="#555555", va="bottom")
    figure.get_layout_engine().set(w_pad=0.12, h_pad=0.08, rect=(0, 0.035, 1, 0.965) if hidden else (0, 0, 1, 1))
    figure.draw_without_rendering()  # fixes the layout, by which texts find their side
    figure.set_layout_engine("none")  # and stays: SVG and PNG look alike, and are drawn in half the time
    name_paper_points(axes, plot, drawn)
    return figure


def save(figures, folder):
    """Writes all to temporary names, then renames them."""
    written = []
    try:
        for name, figure in figures:
            for kind, metadata in (("svg", {"Date": None}), ("png", {"Software": None})):
                target = os.path.join(folder, f"{name}.{kind}")
                temporary = os.path.join(folder, f".raya-{os.getpid()}-{len(written)}.tmp")
                written.append((temporary, target))
                figure.savefig(temporary, format=kind, dpi=160, metadata=metadata)
        for temporary, target in written:
            os.replace(temporary, target)
    finally:
        for temporary, _ in written:
            if os.path.exists(temporary):
                os.remove(temporary)


def main(files):
    for file in files:
        try:
            with open(file, encoding="utf-8") as text:
                plots = json.load(text)["plots"]
            save([(plot["name"], draw(plot)) for plot in plots], os.path.dirname(file))
        except KeyError as problem:
            sys.exit(f"plot.py: {file}: no {problem} in it")
        except (PlotError, OSError, ValueError, TypeError) as problem:
            sys.exit(f"plot.py: {file}: {problem}")


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    matplotlib.rcdefaults()  # the user's own settings would change the plots
    matplotlib.rcParams.update(STYLE)
    main(sys.argv[1:])
