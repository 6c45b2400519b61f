"""Figs 8 and 13 of Kohata & Ito 1993: the imbalance u of each offset, in one picture and in many views, and the lattice of each offset."""
import numpy as np
import pandas as pd
import raya
from raya.lab import (Claim, Comparison, Page, Plot, Series, Table, bonferroni_confidence, costs_of_pass, estimate,
                      papers, prediction_text, range_text, study, verdict, verdict_by_prediction)
from raya.lab.laboratory import VIEWS_PROSE
from raya.lab.mappings import shortest_square

U_AND_VIEWS = """
- u = (max load - mean load) / mean load, from one cost image. The load of a PE is the sum of its pixels' modelled cycles. u needs no
  clock.""" + VIEWS_PROSE

PROSE_8 = """Fig. 8: imbalance against the offset

Which offset of the cyclic mapping spreads the load best?

- Source: Kohata & Ito 1993, Fig. 8; u(0) and u(16) are derived from Table 3.
- {scene} at {size} x {size} on {pes} PEs of the SPA, a PE for each column; first pass.""" + U_AND_VIEWS + """
- Offsets are compared within the same views. "Best" is reproduced if every other offset of 0..n is worse, all {tests} differences
  together with 95 % (Bonferroni); it is not reproduced if one offset is better with that certainty.
- A figure of Kohata & Ito for one picture is reproduced if it lies in the 95 % prediction interval of the views. The interval comes from
  order statistics, for any distribution: 2.5 % of pictures lie below it and 2.5 % above. A figure outside it is not reproduced.
- Output: fig8.csv has a row for each offset p: u of the picture; mean u of the views, +- the half width of its 95 % interval; least and largest u
  of the views; shortest vector of the lattice (pixels). fig8-near.csv has the offsets 0..n, n = sqrt(P)."""

PROSE_13 = """Fig. 13: imbalance against the offset in supersampling

Does the offset that suits the first pass suit supersampling as well?

- Source: Kohata & Ito 1993, Fig. 13.
- {scene} at {size} x {size} on {pes} PEs of the SPA, a PE for each column; supersampling, without the first pass.""" + U_AND_VIEWS + """
- Offsets are compared within the same views, all {tests} differences together with 95 % (Bonferroni).
- Output: fig13.csv and fig13-near.csv, with the columns of fig8.csv."""

GOOD_FRACTION = 0.9  # our limit: a balance is good if its gain over p = 0 is at least this fraction of the gain of the best offset of 0..n


def page_of(name, lab, scenes, first):
    settings, picture, views = costs_of_pass(lab, scenes, first)
    scene, size = settings["scene"], settings["size"]
    offsets, n = range(size), round(size**0.5)  # n: the offset that the paper calls the best
    u = raya.imbalances(picture, size, offsets)
    of_views = np.array([raya.imbalances(view, size, offsets) for view in views])  # [view, offset]
    means = [estimate(column) for column in of_views.T]
    best = (of_views <= of_views[:, :n + 1].min(1, keepdims=True)).sum(0)
    rows = pd.DataFrame({
        "p": offsets, "u": u, "mean u": [m.mean for m in means], "+-": [m.half for m in means],
        "least u": of_views.min(0), "largest u": of_views.max(0), f"best of 0..{n} (views)": best,
        "shortest vector (pixels)": [shortest_square(p, size)**0.5 for p in offsets]})
    in_paper = first and papers.is_papers(scene, size)
    near, place = rows[:n + 1], "Fig. 8" if first else "Fig. 13"
    claims = claims_of(place, of_views, means, n, first, in_paper)
    return Page(settings, findings_of(u, means, n, claims[1].why, len(views)),
                comparisons_of(rows, of_views, n, in_paper), claims,
                [Table(f"{name}-near", f"Offsets 0..{n}: the picture's u and that of {len(views)} views", near),
                 Table(name, "Imbalance for each offset", rows, on_page=False)],
                plots_of(name, scene, "first pass" if first else "supersampling alone", rows, near, len(views),
                         in_paper),
                ["Kohata & Ito plot u for one picture. The best offset changes from view to view. Means over many views, with "
                 "intervals, show the effect of the offset itself."],
                placeholders={"tests": n}, compared_with=papers.SPA)


def claims_of(place, of_views, means, n, first, in_paper):
    gain = estimate(of_views[:, 0] - of_views[:, n])
    differences = [estimate(of_views[:, p] - of_views[:, n], bonferroni_confidence(n)) for p in range(n)]
    worse, better = sum(d.low > 0 for d in differences), sum(d.high < 0 for d in differences)
    lowest, best = min(range(n + 1), key=lambda p: means[p].mean), of_views[:, :n + 1].min(1)
    gains, single = of_views[:, 0] - best, of_views[:, n]
    half = estimate(np.divide(of_views[:, 0] - of_views[:, n // 2], gains, out=np.ones_like(gains), where=gains > 0))
    claims = [("The cyclic mapping with p = n balances better than p = 0.", verdict(gain.low > 0, gain.high <= 0),
               f"u falls by {gain.text()} from p = 0 to p = {n} in the same view, {len(of_views)} views."),
              ("Of the offsets 0..n on n x n PEs p = n gives the best balance.", verdict(worse == n, better > 0),
               f"Over {len(of_views)} views mean u is {means[n].text()} at p = {n}; the lowest of 0..{n} is that of p "
               f"= {lowest}, {means[lowest].text()}. Of the {n} other offsets {worse} are worse than p = {n} and "
               f"{better} are better with certainty; p = {n} is the best of 0..{n} in {(single <= best).sum()} of "
               f"{len(of_views)} views.")]
    if first:
        claims.append(("The balance is already good at p = 8, half of n.", verdict(half.low >= GOOD_FRACTION, half.high < GOOD_FRACTION),
                       f"p = {n // 2} gains {half.text(2)} of what the best of 0..n gains over p = 0; a part of {GOOD_FRACTION} or more counts "
                       "as good."))
    if in_paper:
        claims.append(("u is 0.118 at p = 16 (derived from Table 3).", verdict_by_prediction(papers.IMBALANCE_16, single),
                       f"Over {len(single)} views u(16) is {means[n].text()} in the mean and {range_text(single)} in single views; "
                       f"the figure of one more picture lies in {prediction_text(single)} with 95 %."))
    return [Claim(papers.SPA, place, *claim) for claim in claims]


def findings_of(u, means, n, why_best, views):
    half, best = 8 % len(u), 16 % len(u)  # the offsets p = 8 and p = 16 of the paper
    return [f"Over {views} views u is {means[0].text()} at p = 0, {means[half].text()} at p = 8 and "
            f"{means[best].text()} at p = 16.",
            why_best,
            f"In the picture u is {u[0]:.3f} at p = 0, {u[half]:.3f} at p = 8 and {u[best]:.3f} at p = 16. The best of the "
            f"offsets 0..{n} is p = {u[:n + 1].argmin()}, u = {u[:n + 1].min():.3f}; the best of all {len(u)} is p = "
            f"{u.argmin()}, u = {u.min():.3f}. {(u < u[best]).sum()} offsets are better than p = 16."]


def comparisons_of(rows, of_views, n, in_paper):
    known = {0: (papers.IMBALANCE_0, "our scene is calibrated on it: see scenes/README.md"),
             8: (None, 'the paper: "already good"'), 16: (papers.IMBALANCE_16, papers.IMBALANCE_16_ROUNDING)}
    all_of = []
    for p, (figure, remark) in known.items():
        row, single = rows.iloc[p % len(rows)], of_views[:, p % len(rows)]
        paper = figure if in_paper else None
        all_of += [Comparison(f"u({p})", "", paper, row["u"], remark if in_paper else "", derived=True),
                   Comparison(f"u({p}), mean of views", "", paper, row["mean u"],
                              f"{range_text(single)} of single views", derived=True, half_width=row["+-"])]
    for some, paper in ((rows[:n + 1], 16), (rows, None)):
        what = f"best p of 0..{n}" if paper else f"best p of all {len(rows)}"
        for column, more in (("u", ""), ("mean u", ", mean of views")):
            best = some[column].idxmin()
            all_of.append(Comparison(what + more, "", paper if in_paper else None, int(best),
                                     f"u = {some[column][best]:.3f}"))
    return all_of


def plots_of(name, scene, phase, rows, near, views, in_paper):
    mean, few = f"mean of {views} views", rows[rows["p"] % 4 == 0]
    paper = [Series("Kohata & Ito, from their tables", [0, 16], [papers.IMBALANCE_0, papers.IMBALANCE_16],
                    "paper")] * in_paper
    return [Plot(name, f"Imbalance against the offset, {phase}", "offset p (pixels)", "u",
                 [Series(mean, near["p"], near["mean u"], half_widths=near["+-"]),
                  Series(f"{scene}, one picture", near["p"], near["u"]),
                  Series("least of the views", near["p"], near["least u"]),
                  Series("largest of the views", near["p"], near["largest u"])] + paper),
            Plot(f"{name}-all", f"Imbalance against every offset, {phase}", "offset p (pixels)", "u",
                 [Series(mean, rows["p"], rows["mean u"]),
                  Series("its interval, every fourth", few["p"], few["mean u"], "points", few["+-"]),
                  Series(f"{scene}, one picture", rows["p"], rows["u"])] + paper, log="y")]


@study("fig8", prose=PROSE_8, one_scene=True)
def fig8(lab, scenes):
    return page_of("fig8", lab, scenes, first=True)


@study("fig13", prose=PROSE_13, one_scene=True)
def fig13(lab, scenes):
    return page_of("fig13", lab, scenes, first=False)
