#!/usr/bin/env python3
"""Draws the plots of a study from the JSON file that `raya study` writes.

    tools/plot.py FILE.json...    NAME.svg and NAME.png of every plot in FILE, beside it

`raya study` holds this script within itself and does the same after each study. The same file gives the same bytes
under the same matplotlib. An SVG says in words what it shows and holds the figures of its points, for the document of
all studies (host/study/html_figure.hpp, host/study/document/plots.js). All plots of a file appear, each whole, or none
does. Exit code 1: a file cannot be drawn, with the reason; 3: no matplotlib.
"""
import sys

sys.path[:] = [folder for folder in sys.path if folder]  # read from stdin: the user's folder may hold a json.py

import io
import json
import math
import os
import re
import textwrap
from xml.sax.saxutils import escape, quoteattr

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
    "legend.fontsize": 11, "legend.frameon": False, "svg.fonttype": "none", "svg.hashsalt": "raya",
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


def half_widths_of(plot, series):
    """Of the 95 % intervals, 0 where none is known; empty where no point has one."""
    halves = [0.0 if math.isnan(value) else value
              for value in numbers({"half_widths": series.get("half_widths", [])}, "half_widths", plot["name"])]
    if halves and len(halves) != len(series["y"]):
        raise PlotError(f"plot '{plot['name']}', series '{series['label']}': {len(halves)} half widths")
    return halves


def draw_intervals(axes, plot, points, halves, colour):
    """As bars; as a band along a line of many points. On a logarithmic axis what reaches down to 0 ends in the plot."""
    x, y, half = zip(*((x, y, h) for (x, y), h in zip(points, halves) if is_shown(plot, x, y)))
    above = [value for value, h in zip(y, half) for value in (value, value - h) if value > 0]
    floor = min(above) / 2 if plot["log_y"] else -math.inf
    low = [max(value - h, floor) for value, h in zip(y, half)]
    if len(x) > FEW:
        axes.fill_between(x, low, [value + h for value, h in zip(y, half)], color=colour, alpha=0.25, linewidth=0)
    else:
        axes.errorbar(x, y, yerr=[[value - end for value, end in zip(y, low)], half], fmt="none", ecolor=colour,
                      elinewidth=1.2, capsize=3)


def draw_series(axes, plot):
    """Returns of every series x and y, and the line that stands for it in the legend."""
    drawn, lines, kinds = [], [], {True: 0, False: 0}
    for series in plot["series"]:
        x, y = points_of(plot, series)
        paper = series["style"] == "paper"
        look = look_of(series["style"], kinds[paper], len(x))
        lines += axes.plot(x, y, **look)
        kinds[paper] += 1
        halves = half_widths_of(plot, series)
        if any(is_shown(plot, *at) for at in zip(x, y)) and any(halves):
            draw_intervals(axes, plot, list(zip(x, y)), halves, look["color"])
        drawn.append((x, y))
    return drawn, lines


def ink_of(axes, plot, drawn):
    """Places that lines and points cover, in points of an inch on the figure."""
    places = []
    for x, y in drawn:
        shown = [at for at in zip(x, y) if is_shown(plot, *at)] or [(1, 1)]
        at = axes.transData.transform(shown) * 72 / axes.figure.dpi
        places += [tuple(a + (b - a) * i / 16) for a, b in zip(at, at[1:]) for i in range(16)] + [tuple(at[-1])]
    return places


def free_side(places, at, text):
    """Of the four sides of a point that on which a text covers the least, as its offset from there."""
    def covered(side):
        left = side[0] if side[0] > 0 else side[0] - 6.5 * len(text)
        return sum(left <= x - at[0] <= left + 6.5 * len(text) and side[1] - 2 <= y - at[1] <= side[1] + 11
                   for x, y in places)
    return min(((11, 5), (-11, 5), (11, -14), (-11, -14)), key=covered)


def name_paper_points(axes, plot, drawn):
    """Writes the paper's figures beside their points, where they are few."""
    papers = [points for series, points in zip(plot["series"], drawn) if series["style"] == "paper"]
    if sum(len(x) for x, _ in papers) > 8:
        return
    places, share = ink_of(axes, plot, drawn), axes.transData + axes.transAxes.inverted()  # 0..1 from side to side
    for x, y in papers:
        for at in zip(x, y):
            if not is_shown(plot, *at):
                continue
            text = f"{at[1]:.3g}" if at[1] < 1000 else f"{at[1]:.0f}"
            side = free_side(places, axes.transData.transform(at) * 72 / axes.figure.dpi, text)
            on_right = side[0] < 0 or share.transform(at)[0] > 0.85  # then its text stands on the left
            axes.annotate(text, at, xytext=(-11 if on_right else 11, side[1]), textcoords="offset points",
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


def draw_legend(axes, lines, labels):
    """On the right of the data, never over it."""
    if not any(labels):
        return
    labels = [" " + label if label.startswith("_") else label for label in labels]  # matplotlib would leave it out
    axes.legend(lines, labels, loc="upper left", bbox_to_anchor=(1.01, 1), borderaxespad=0, handlelength=2.6)


def draw(plot):
    labels = legend_labels(plot)
    lines = sum(label.count("\n") + 1 for label in labels)
    figure = Figure(figsize=(9, max(5.2, 0.24 * lines)), layout="constrained")  # inches: 900 pixels wide at 100 an inch
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    drawn, handles = draw_series(axes, plot)
    points = [at for x, y in drawn for at in zip(x, y)]
    shown = [at for at in points if is_shown(plot, *at)]
    set_axes(axes, plot, shown)
    axes.set_title(textwrap.fill(plain(plot["title"]), 76))
    draw_legend(axes, handles, labels)
    hidden = len(points) - len(shown)
    if hidden:
        figure.text(0.01, 0.01, f"{hidden} point{'s' if hidden > 1 else ''} without a place on these axes "
                    "(infinite, or not above 0 on a logarithmic one)", fontsize=9, color="#555555", va="bottom")
    figure.get_layout_engine().set(w_pad=0.12, h_pad=0.08, rect=(0, 0.035, 1, 0.965) if hidden else (0, 0, 1, 1))
    figure.draw_without_rendering()  # fixes the layout, by which texts find their side
    figure.set_layout_engine("none")  # and stays: SVG and PNG look alike, and are drawn in half the time
    name_paper_points(axes, plot, drawn)
    return figure


def point_texts(axes, plot, series, points):
    """Of each point on the axes: x, y, half width, and where it lies in hundredths of the width and of the height."""
    to_figure = axes.transData + axes.figure.transFigure.inverted()
    halves = half_widths_of(plot, series) or [0.0] * len(points)
    for (x, y), half in zip(points, halves):
        if is_shown(plot, x, y):
            left, up = to_figure.transform((x, y))
            yield f"{x:.6g},{y:.6g},{half:.2g},{100 * left:.2f},{100 - 100 * up:.2f}"


def data_of(figure, plot):
    """What a document's script reads when a reader points at the plot: every point with its place."""
    axes = figure.axes[0]
    texts = [f'<g class="data" data-x={quoteattr(plot["x_label"])} data-y={quoteattr(plot["y_label"])}>']
    for series in plot["series"]:
        points = zip(*points_of(plot, series))
        texts.append(f'<g data-label={quoteattr(str(series["label"]))} '
                     f'data-points="{" ".join(point_texts(axes, plot, series, list(points)))}"/>')
    return "\n".join(texts) + "\n</g>\n"


def described(svg, figure, plot):
    """The drawing with what it shows in words, and with names that no other drawing on a page has."""
    name = f"plot-{plot['name']}"
    svg = re.sub(r"<metadata>.*?</metadata>", "", svg, flags=re.DOTALL)
    svg = re.sub(r'(\bid="|href="#|url\(#)', rf"\g<1>{name}-", svg)
    svg = svg.replace("*{stroke", f"#{name} *{{stroke")  # a style for all elements is for those of the drawing
    svg = svg.replace("<svg ", f'<svg id="{name}" role="img" aria-labelledby="{name}-title" '
                      f'aria-describedby="{name}-desc" ', 1)
    head = svg.index(">", svg.index("<svg ")) + 1
    words = (f'\n<title id="{name}-title">{escape(plot["title"])}</title>'
             f'\n<desc id="{name}-desc">{escape(plot.get("description", ""))}</desc>')
    end = svg.rindex("</svg>")
    return svg[:head] + words + svg[head:end] + data_of(figure, plot) + svg[end:]


def files_of(figure, plot):
    """(extension, bytes) of its files."""
    svg, png = io.BytesIO(), io.BytesIO()
    figure.savefig(svg, format="svg", metadata={"Date": None})
    figure.savefig(png, format="png", dpi=160, metadata={"Software": None})
    return ("svg", described(svg.getvalue().decode(), figure, plot).encode()), ("png", png.getvalue())


def save(plots, folder):
    """Writes all to temporary names, then renames them."""
    written = []
    try:
        for plot in plots:
            for kind, content in files_of(draw(plot), plot):
                target = os.path.join(folder, f"{plot['name']}.{kind}")
                temporary = os.path.join(folder, f".raya-{os.getpid()}-{len(written)}.tmp")
                written.append((temporary, target))
                with open(temporary, "wb") as file:
                    file.write(content)
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
            save(plots, os.path.dirname(file))
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
