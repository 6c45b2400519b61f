"""Figs 7 and 12 of Kohata & Ito 1993: the load of each PE divided by the mean load, in the first pass and in supersampling."""
import numpy as np
import pandas as pd
import raya
from raya.lab import (Claim, Comparison, Page, Plot, Series, Table, costs_of_pass, estimate, papers, range_text, study,
                      verdict, with_paper)
from raya.lab.laboratory import VIEWS_PROSE

PROSE = """{figure}

{question}

- Source: Kohata & Ito 1993, {source}.
- {scene} at {size} x {size} on {pes} PEs of the SPA, a PE for each column; {phase}.
- The load of a PE is the sum of the modelled cycles that the kernels counted for its pixels, divided by the mean load of all PEs. It
  needs no clock.""" + VIEWS_PROSE + """
- Output: {csv} has a row for each PE: its load in the picture (cycles) with p = 0 and p = 16, and its load / mean load, mean of the views, +-
  the half width of the 95 % interval."""

FLAT_LIMIT = 0.1  # our limit: in a flat distribution, the loads of middle and sides differ by at most this fraction of the mean load


def relative_loads(image, offset):
    """The load of each PE divided by the mean load; 1 for all PEs if there is no load."""
    loads = raya.loads(image, offset=offset)
    return loads / loads.mean() if loads.any() else np.ones(len(loads))


def middle_and_sides(loads):
    """Mean load of the middle quarter of the PEs, and mean load of the first and last eighth together. loads: [..., PE]."""
    eighth, middle = loads.shape[-1] // 8, loads.shape[-1] // 2
    sides = (loads[..., :eighth].mean(-1) + loads[..., loads.shape[-1] - eighth:].mean(-1)) / 2
    return loads[..., middle - eighth:middle + eighth].mean(-1), sides


def page_of(name, lab, scenes, first):
    settings, picture, views = costs_of_pass(lab, scenes, first)
    scene, size = settings["scene"], settings["size"]
    offsets = (0, 16 % size)
    own = [relative_loads(picture, p) for p in offsets]
    of_views = [np.array([relative_loads(view, p) for view in views]) for p in offsets]  # [view, PE]
    u = np.transpose([raya.imbalances(view, size, offsets) for view in views])  # [offset, view]
    own_u = raya.imbalances(picture, size, offsets)
    rows = pd.DataFrame({"PE": range(size), "p = 0 (cycles)": raya.loads(picture, offset=0),
                         "p = 16 (cycles)": raya.loads(picture, offset=offsets[1])})
    for label, some in zip(("p = 0", "p = 16"), of_views):
        means = [estimate(column) for column in some.T]
        rows[f"{label}, mean of views"], rows[f"{label}, +-"] = [m.mean for m in means], [m.half for m in means]
    place, phase = ("Fig. 7", "first pass") if first else ("Fig. 12", "supersampling alone")
    return Page({**settings, "offsets": list(offsets)}, findings_of(own, own_u, u),
                comparisons_of(own_u, u, first and papers.is_papers(scene, size)), claims_of(place, of_views),
                [Table(name, "Load of each PE", rows, on_page=False)],
                plots_of(name, scene, phase, rows, own, len(views)),
                ["Kohata & Ito show one image. Many views of a scene separate the effect of the mapping from that of the picture."],
                compared_with=papers.SPA,
                placeholders={"figure": f"{place}: load of each PE{'' if first else ' in supersampling'}", "phase": phase, "csv": f"{name}.csv",
                              "source": f"{place}; u(0) and u(16) are derived from Table 3" if first else place,
                              "question": "How is the work of one image spread over the PEs, by columns and by the cyclic mapping?"
                              if first else "Is the extra work of supersampling spread as evenly as the first pass?"})


def findings_of(own, own_u, u):
    (middle, sides), mean_u = middle_and_sides(own[0]), [estimate(some) for some in u]
    return [f"In the picture, with the column split, the PEs of the middle quarter carry {middle:.2f} times the mean load and "
            f"those of the quarter at the sides {sides:.2f} times. With p = 16 the PE with the least load carries "
            f"{own[1].min():.2f} times the mean and the PE with the most {1 + own_u[1]:.2f} times.",
            f"Over {len(u[0])} views u is {mean_u[0].text()} with the column split ({range_text(u[0])}) and {mean_u[1].text()} "
            f"with p = 16 ({range_text(u[1])})."]


def comparisons_of(own_u, u, in_paper):
    figures = papers.IMBALANCE_0, papers.IMBALANCE_16
    remarks = ("our scene is calibrated on it: see scenes/README.md", papers.IMBALANCE_16_ROUNDING) if in_paper else ("", "")
    mean_u = [estimate(some) for some in u]
    own = [Comparison(f"u({p})", "", *some, True) for p, *some in zip((0, 16), figures, own_u, remarks)]
    return with_paper(in_paper, own + [Comparison(f"u({p}), mean of views", "", figure, mean.mean, "", True, mean.half)
                                       for p, figure, mean in zip((0, 16), figures, mean_u)])


def claims_of(place, of_views):
    columns, cyclic = (estimate(np.subtract(*middle_and_sides(some))) for some in of_views)
    over = f"Over {len(of_views[0])} views a PE of the middle quarter carries "
    return [Claim(papers.SPA, place, "With p = 0 the load has a hump in the middle.",
                  verdict(columns.low > 0, columns.high <= 0),
                  f"{over}{columns.text(2)} mean loads more than one of the quarter at the sides."),
            Claim(papers.SPA, place, "With p = 16 the load is flat.",
                  verdict(cyclic.low >= -FLAT_LIMIT and cyclic.high <= FLAT_LIMIT, cyclic.high < -FLAT_LIMIT or cyclic.low > FLAT_LIMIT),
                  f"{over}{cyclic.text(2)} mean loads more than one of the quarter at the sides; within {FLAT_LIMIT} counts as flat.")]


def plots_of(name, scene, phase, rows, own, views):
    some = rows[rows["PE"] % max(len(rows) // 64, 1) == 0]
    labels, mean_line = ("p = 0, column split", "p = 16, cyclic mapping"), Series("mean", [0, len(rows) - 1], [1, 1])
    return [Plot(name, f"Load of each PE, {scene}, {phase}", "PE", "load / mean load",
                 [Series(label, rows["PE"], one) for label, one in zip(labels, own)] + [mean_line]),
            Plot(f"{name}-views", f"Load of each PE, {phase}, mean of {views} views", "PE", "load / mean load",
                 [Series(label, some["PE"], some[f"{p}, mean of views"], half_widths=some[f"{p}, +-"])
                  for label, p in zip(labels, ("p = 0", "p = 16"))] + [mean_line])]


@study("fig7", prose=PROSE, one_scene=True)
def fig7(lab, scenes):
    return page_of("fig7", lab, scenes, first=True)


@study("fig12", prose=PROSE, one_scene=True)
def fig12(lab, scenes):
    return page_of("fig12", lab, scenes, first=False)
