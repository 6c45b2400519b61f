"""Draws the plots of a page as SVG and PNG. The same plot gives the same bytes with the same version of matplotlib."""
import io
import math
import re
import textwrap
from html import escape

import matplotlib
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, LogLocator, MaxNLocator, NullFormatter, NullLocator
from raya.lab.page import format_value

# The colour-blind safe palette of M. Okabe and K. Ito, without yellow, which is faint on white.
COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000"]
PAPER_COLOURS = ["#000000", "#8b1a1a", "#1a3a8b", "#1a5e1a"]
DASHES = ["-", (0, (6, 2)), (0, (1.5, 1.5)), (0, (7, 2, 1.5, 2)), (0, (3, 1.5, 1, 1.5, 1, 1.5))]
MARKERS = ["o", "s", "^", "v", "P", "X", "d", "<", ">"]
MAX_MARKERS = 40  # lines with at most MAX_MARKERS points have markers and error bars; longer ones show intervals as a band

STYLE = {
    "axes.axisbelow": True, "axes.edgecolor": "#555555", "axes.formatter.use_mathtext": True,
    "axes.formatter.useoffset": False, "axes.formatter.limits": (-4, 6), "axes.grid": True, "axes.labelsize": 12,
    "axes.spines.right": False, "axes.spines.top": False, "axes.titlelocation": "left", "axes.titlesize": 13,
    "axes.titleweight": "bold", "axes.titlepad": 12, "font.size": 11, "grid.color": "#dddddd", "grid.linewidth": 0.7,
    "legend.fontsize": 11, "legend.frameon": False, "svg.fonttype": "none", "svg.hashsalt": "raya",
    "xtick.labelsize": 11, "ytick.labelsize": 11,
}


def escape_dollars(text):
    """Escapes dollar signs, which start formulas in matplotlib."""
    return str(text).replace("$", r"\$")


def line_options(style, number, count):
    """Returns matplotlib's options for series `number`, which has `count` points. Colours, dashes and markers repeat with different periods, so that
    series with the same colour differ in dash or marker."""
    colour, dash, marker = (cycle[number % len(cycle)] for cycle in (COLOURS, DASHES, MARKERS))
    if style in ("line", "steps"):
        options = {"color": colour, "linestyle": dash, "linewidth": 1.7 if count <= 100 else 1.3}
        if style == "steps":
            return {**options, "drawstyle": "steps-mid"}
        return {**options, "marker": marker if count <= MAX_MARKERS else "", "markersize": 5}
    if style == "points":
        return {"color": colour, "linestyle": "", "marker": marker, "markersize": 6 if count <= 100 else 3}
    return {"color": PAPER_COLOURS[number % len(PAPER_COLOURS)], "linestyle": "", "marker": "D", "markersize": 11,
            "markerfacecolor": "none", "markeredgewidth": 2, "zorder": 5}


def is_shown(plot, x, y):
    """Returns true if the point is finite and above zero on every logarithmic axis."""
    return math.isfinite(x + y) and (x > 0 or "x" not in plot.log) and (y > 0 or "y" not in plot.log)


def draw_intervals(axes, plot, series, colour):
    """Draws the intervals as error bars; above MAX_MARKERS points, as a band. On a logarithmic axis, intervals that reach 0 are clipped at half
    of the lowest positive value."""
    points = [(x, y, h) for x, y, h in zip(series.x, series.y, series.half_widths) if is_shown(plot, x, y)]
    if not points:
        return
    x, y, half = (np.array(values) for values in zip(*points))
    positive = np.concatenate([y, y - half])
    floor = positive[positive > 0].min() / 2 if "y" in plot.log else -math.inf
    low = np.maximum(y - half, floor)
    if len(x) > MAX_MARKERS:
        axes.fill_between(x, low, y + half, color=colour, alpha=0.25, linewidth=0)
    else:
        axes.errorbar(x, y, yerr=[y - low, half], fmt="none", ecolor=colour, elinewidth=1.2, capsize=3)


def legend_text(series):
    """Returns the label of a series. It includes up to four values of a paper, because labels next to the points would cover the curves."""
    values = ", ".join(f"{y:.3g}" if y < 1000 else f"{y:.0f}" for y in series.y) if series.style == "paper" and len(series.y) <= 4 else ""
    return textwrap.fill(escape_dollars(f"{series.label}: {values}" if values else series.label), 24)


def power_of_ten(value, _):
    if value <= 0:
        return ""
    exponent = math.floor(math.log10(value) + 1e-9)
    digit = round(value / 10**exponent)
    return f"$10^{{{exponent}}}$" if digit == 1 else rf"${digit}\times10^{{{exponent}}}$"


def set_log_axis(axes, name, values):
    """Puts at most about nine ticks at powers of two if all values are such powers; else ticks at powers of ten, and also at 2 and 5 times each power
    if the range is small."""
    axis, by_two = getattr(axes, f"{name}axis"), len(set(values)) > 2 and all(math.frexp(value)[0] == 0.5 for value in values)
    getattr(axes, f"set_{name}scale")("log", base=2 if by_two else 10, nonpositive="mask")
    low, high = (min(values), max(values)) if values else (1, 10)
    if not values:  # without values, automatic limits fail on a logarithmic axis
        getattr(axes, f"set_{name}lim")(low, high)
    if by_two:
        first, last = (math.frexp(value)[1] - 1 for value in (low, high))
        axis.set_major_locator(FixedLocator([2.0**n for n in range(first, last + 1, (last - first) // 9 + 1)]))
        axis.set_minor_locator(NullLocator())
        as_power = last > 14 or first < -3
        axis.set_major_formatter(lambda value, _: f"$2^{{{round(math.log2(value))}}}$" if as_power else f"{value:g}")
    else:
        axis.set_major_locator(LogLocator(base=10, subs=(1, 2, 5) if high / low < 300 else (1,), numticks=12))
        axis.set_minor_formatter(NullFormatter())
        axis.set_major_formatter((lambda value, _: f"{value:g}") if 1e-4 < low <= high < 1e5 else power_of_ten)


def set_axes(axes, plot, points):
    """Sets scales and labels. The y axis starts at 0 if the lowest value is at most half of the highest."""
    axes.set_xlabel(escape_dollars(plot.x_label))
    axes.set_ylabel(escape_dollars(plot.y_label))
    x, y = zip(*points) if points else ((), ())
    for name, values in (("x", x), ("y", y)):
        if name in plot.log:
            set_log_axis(axes, name, values)
    if plot.x_names:
        axes.set_xticks(range(1, len(plot.x_names) + 1), map(escape_dollars, plot.x_names), rotation=35, ha="right")
    elif "x" not in plot.log and all(value == int(value) for value in x):
        axes.xaxis.set_major_locator(MaxNLocator("auto", steps=[1, 2, 2.5, 5, 10], integer=True))
    if y and "y" not in plot.log and 0 <= min(y) <= max(y) / 2:
        axes.set_ylim(bottom=0)


def draw(plot):
    """Returns matplotlib's figure of the plot."""
    labels = [legend_text(series) for series in plot.series]
    lines = sum(label.count("\n") + 1 for label in labels)
    figure = Figure(figsize=(9, max(5.2, 0.24 * lines)), layout="constrained")  # inches: 900 pixels wide at 100 an inch
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    handles, series_counts = [], {True: 0, False: 0}  # {is the series the paper's?: number of series drawn so far}
    for series in plot.series:
        paper = series.style == "paper"
        options = line_options(series.style, series_counts[paper], len(series.x))
        series_counts[paper] += 1
        handles += axes.plot(series.x, [value if math.isfinite(value) else math.nan for value in series.y], **options)
        if any(series.half_widths):
            draw_intervals(axes, plot, series, options["color"])
    points = [point for series in plot.series for point in zip(series.x, series.y)]
    shown_points = [point for point in points if is_shown(plot, *point)]
    set_axes(axes, plot, shown_points)
    axes.set_title(textwrap.fill(escape_dollars(plot.title), 76))
    if any(labels):  # to the right of the data; matplotlib omits labels that begin with "_"
        axes.legend(handles, [" " + text if text.startswith("_") else text for text in labels], loc="upper left",
                    bbox_to_anchor=(1.01, 1), borderaxespad=0, handlelength=2.6)
    hidden = len(points) - len(shown_points)
    if hidden:
        figure.text(0.01, 0.01, f"{hidden} point{'s' if hidden > 1 else ''} not shown "
                    "(infinite, or not above 0 on a logarithmic axis)", fontsize=9, color="#555555", va="bottom")
    figure.get_layout_engine().set(w_pad=0.12, h_pad=0.08, rect=(0, 0.035, 1, 0.965) if hidden else (0, 0, 1, 1))
    figure.draw_without_rendering()  # fixes the layout, so that SVG and PNG agree
    figure.set_layout_engine("none")
    return figure


def range_of(values):
    finite = [value for value in values if math.isfinite(value)]
    if not finite:
        return "without a finite value"
    low, high = min(finite), max(finite)
    return f"at {format_value(low)}" if low == high else f"from {format_value(low)} to {format_value(high)}"


def description(plot):
    """Returns the text description of a plot, for readers who do not see it."""
    def axis(label, name, values):
        return f"{label}{', logarithmic' if name in plot.log else ''}, {range_of(values)}"

    series = "; ".join(f"{s.label}: {len(s.y)} point{'' if len(s.y) == 1 else 's'}, {range_of(s.y)}"
                       f"{', with 95 % intervals' if any(s.half_widths) else ''}" for s in plot.series)
    return (f"Horizontal axis: {axis(plot.x_label, 'x', [x for s in plot.series for x in s.x])}. "
            f"Vertical axis: {axis(plot.y_label, 'y', [y for s in plot.series for y in s.y])}. Series: {series}.")


def with_description(svg, plot):
    """Returns the SVG with its title and description, and with ids that are unique on a page."""
    name = f"plot-{plot.name}"
    svg = re.sub(r"<metadata>.*?</metadata>", "", svg, flags=re.DOTALL)
    svg = re.sub(r'(\bid="|href="#|url\(#)', rf"\g<1>{name}-", svg)
    svg = svg.replace("*{stroke", f"#{name} *{{stroke")  # confines the style to this drawing
    svg = svg.replace("<svg ", f'<svg id="{name}" role="img" aria-labelledby="{name}-title" '
                      f'aria-describedby="{name}-desc" ', 1)
    head = svg.index(">", svg.index("<svg ")) + 1
    return (f'{svg[:head]}\n<title id="{name}-title">{escape(plot.title)}</title>\n'
            f'<desc id="{name}-desc">{escape(description(plot))}</desc>{svg[head:]}')


def files_of(plot):
    """Returns {'svg': bytes, 'png': bytes}: the plot as files."""
    with matplotlib.rc_context(STYLE):
        figure, svg, png = draw(plot), io.BytesIO(), io.BytesIO()
        figure.savefig(svg, format="svg", metadata={"Date": None})
        figure.savefig(png, format="png", dpi=160, metadata={"Software": None})
    return {"svg": with_description(svg.getvalue().decode(), plot).encode(), "png": png.getvalue()}
