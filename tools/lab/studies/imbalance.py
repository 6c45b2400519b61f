"""Figs 8 and 13 of Kohata & Ito 1993: the imbalance u of each offset, in one picture and in many, and the lattice of each offset."""
import numpy as np
import pandas as pd
import raya
from raya.lab import (Comparison, Page, Plot, Series, Table, above, bonferroni_confidence, estimate, estimates, every,
                      first_scene, judged, papers, range_text, study)
from raya.lab.mappings import shortest_square

U_AND_PICTURES = """
- u = (max load - mean load) / mean load, from one cost image. The load of a PE is the sum of its pixels' modelled cycles. u needs no
  clock.
- {ensemble}. The camera of a view keeps its distance; its direction is uniform on the sphere between 5 and 75 degrees above its target.
- Offsets are compared within the same pictures. A mean is that of the families' means; its interval contains the variation within
  the families, and the table of the families the variation between them."""

PROSE_8 = """Fig. 8: imbalance against the offset

Which offset of the cyclic mapping spreads the load best?

- Source: Kohata & Ito 1993, Fig. 8; u(0) and u(16) are derived from Table 3.
- {size} x {size} pixels on {pes} PEs of the SPA, a PE for each column; first pass. The picture of the plots is {scene}.""" + U_AND_PICTURES + """
- Output: fig8.csv has a row for each offset p: u of the picture; mean u of the ensemble, +- the half width of its 95 % interval; least and
  largest u of the ensemble; shortest vector of the lattice (pixels). fig8-near.csv has the offsets 0..n, n = sqrt(P)."""

PROSE_13 = """Fig. 13: imbalance against the offset in supersampling

Does the offset that suits the first pass suit supersampling as well?

- Source: Kohata & Ito 1993, Fig. 13.
- {size} x {size} pixels on {pes} PEs of the SPA, a PE for each column; supersampling, without the first pass. The picture of the plots is
  {scene}.""" + U_AND_PICTURES + """
- Output: fig13.csv and fig13-near.csv, with the columns of fig8.csv."""

GOOD_FRACTION, UNEVEN = 0.9, 0.5  # bounds of the claims good-at-8 and contours-uneven


def page_of(name, lab, scenes, first_pass):
    scene, size = first_scene(scenes), lab.size(256)
    antialias, image_of = ("none", lambda costs: costs.trace) if first_pass else ("supersample", lambda costs: costs.supersample)
    offsets, n = range(size), round(size**0.5)  # n: the offset that the paper calls the best
    ensemble = lab.ensemble(scenes, size, antialias)
    u = raya.imbalances(image_of(lab.costs(scene, size, antialias)), size, offsets)
    picture_u = ensemble.map(lambda costs: raya.imbalances(image_of(costs), size, offsets))  # [picture, offset]
    means = estimates(picture_u, ensemble.families)
    best = (picture_u <= picture_u[:, :n + 1].min(1, keepdims=True)).sum(0)
    rows = pd.DataFrame({
        "p": offsets, "u": u, "mean u": [m.mean for m in means], "+-": [m.half for m in means],
        "least u": picture_u.min(0), "largest u": picture_u.max(0), f"best of 0..{n} (pictures)": best,
        "shortest vector (pixels)": [shortest_square(p, size)**0.5 for p in offsets]})
    in_paper, near = first_pass and papers.is_papers(scene.name, size), rows[:n + 1]
    phase = "first pass" if first_pass else "supersampling without the first pass"
    return Page({"scene": scene.name, "size": size, "pes": size, "pictures": len(picture_u)},
                findings_of(u, picture_u, ensemble.families, means, n),
                comparisons_of(rows, picture_u, n, in_paper),
                claims_of(picture_u, ensemble, n, first_pass) if not scenes else [],
                [Table(f"{name}-near", f"Offsets 0..{n}: the picture's u and that of {len(picture_u)} pictures", near),
                 Table(name, "Imbalance for each offset", rows, on_page=False),
                 table_of_families(name, picture_u, ensemble.families, n)],
                plots_of(name, scene.name, phase, rows, near, len(picture_u), in_paper),
                placeholders={"ensemble": ensemble.description}, compared_with=papers.SPA)


def table_of_families(name, picture_u, families, n):
    names = list(dict.fromkeys(families))
    rows = [{"family": family, "pictures": families.count(family),
             **{f"u({p})": picture_u[np.array(families) == family, p].mean() for p in (0, n // 2, 3 * n // 4, n)},
             f"best of 0..{n}": int(picture_u[np.array(families) == family, :n + 1].mean(0).argmin())} for family in names]
    return Table(f"{name}-families", "Mean u of each family, and the offset with the lowest mean", rows)


def against_n(picture_u, families, n, confidence=0.95):
    """Returns estimates of u(p) - u(n) for p = 0..n - 1, in the same picture."""
    return [estimate(picture_u[:, p] - picture_u[:, n], families, confidence) for p in range(n)]


def best_sentence(picture_u, families, n):
    differences = against_n(picture_u, families, n, bonferroni_confidence(n))
    worse, better = ([p for p, d in enumerate(differences) if sign * d.low_or_mean > 0 and sign * d.high_or_mean > 0] for sign in (1, -1))
    means = picture_u[:, :n + 1].mean(0)
    lowest = int(means.argmin())
    plateau = [p for p in range(n + 1) if p not in worse]
    gap = estimate(picture_u[:, lowest] - picture_u[:, n], families)
    return (f"The lowest mean u of 0..{n} is that of p = {lowest}; it differs from that of p = {n} by {gap.text(4)}. With all {n} differences "
            f"together at 95 %, {len(worse)} offsets are worse than p = {n} and {len(better)} better; p = "
            f"{', '.join(map(str, plateau))} cannot be distinguished from it or are better. p = {n} is the best of 0..{n} in "
            f"{(picture_u[:, n] <= picture_u[:, :n + 1].min(1)).sum()} of {len(picture_u)} pictures.")


def claims_of(picture_u, ensemble, n, first_pass):
    families, about = ensemble.families, ensemble.description
    gain = picture_u[:, 0] - picture_u[:, n]
    text = f"u falls by {estimate(gain, families).text()} from p = 0 to p = {n} in the same picture."
    if not first_pass:
        uneven = picture_u[:, 0]
        return [judged("contours-uneven", above(uneven, UNEVEN, families), about, f"Mean u(0) is {estimate(uneven, families).text()}."),
                judged("supersampling-balances", above(gain, 0, families), about, text)]
    worse = every(above(picture_u[:, p] - picture_u[:, n], 0, families) for p in range(n))
    best = picture_u[:, :n + 1].min(1)
    gains = picture_u[:, 0] - best
    half = picture_u[:, 0] - picture_u[:, n // 2]
    return [judged("cyclic-reduces", above(gain, 0, families), about, text),
            judged("best-is-n", worse, about, best_sentence(picture_u, families, n)),
            judged("good-at-8", above(half - GOOD_FRACTION * gains, 0, families), about,
                   f"From p = 0 u falls by {estimate(half, families).text()} with p = {n // 2}, and by {estimate(gains, families).text()} with the "
                   f"best offset of 0..{n}.")]


def findings_of(u, picture_u, families, means, n):
    half, best = 8 % len(u), 16 % len(u)  # the offsets p = 8 and p = 16 of the paper
    return [f"Over {len(picture_u)} pictures u is {means[0].text()} at p = 0, {means[half].text()} at p = 8 and "
            f"{means[best].text()} at p = 16.",
            best_sentence(picture_u, families, n),
            f"In the picture u is {u[0]:.3f} at p = 0, {u[half]:.3f} at p = 8 and {u[best]:.3f} at p = 16. The best of the "
            f"offsets 0..{n} is p = {u[:n + 1].argmin()}, u = {u[:n + 1].min():.3f}; the best of all {len(u)} is p = "
            f"{u.argmin()}, u = {u.min():.3f}. {(u < u[best]).sum()} offsets are better than p = 16."]


def comparisons_of(rows, picture_u, n, in_paper):
    printed = {0: (papers.IMBALANCE_0, "our scene is calibrated on it: see scenes/README.md"),
               8: (None, 'the paper: "already good"'), 16: (papers.IMBALANCE_16, papers.IMBALANCE_16_ROUNDING)}
    comparisons = []
    for p, (figure, remark) in printed.items():
        row, single = rows.iloc[p % len(rows)], picture_u[:, p % len(rows)]
        comparisons += [Comparison(f"u({p}) of the picture", "", figure if in_paper else None, row["u"], remark if in_paper else "", derived=True),
                        Comparison(f"u({p}), mean of the ensemble", "", None, row["mean u"], f"{range_text(single)} of single pictures",
                                   half_width=row["+-"])]
    for offset_rows, paper in ((rows[:n + 1], 16), (rows, None)):
        what = f"best p of 0..{n}" if paper else f"best p of all {len(rows)}"
        for column, more in (("u", ", picture"), ("mean u", ", mean of the ensemble")):
            best = offset_rows[column].idxmin()
            comparisons.append(Comparison(what + more, "", paper if in_paper else None, int(best), f"u = {offset_rows[column][best]:.3f}"))
    return comparisons


def plots_of(name, scene, phase, rows, near, pictures, in_paper):
    mean, few = f"mean of {pictures} pictures", rows[rows["p"] % 4 == 0]
    paper = [Series("Kohata & Ito, from their tables", [0, 16], [papers.IMBALANCE_0, papers.IMBALANCE_16], "paper")] * in_paper
    return [Plot(name, f"Imbalance against the offset, {phase}", "offset p (pixels)", "u",
                 [Series(mean, near["p"], near["mean u"], half_widths=near["+-"]),
                  Series(f"{scene}, one picture", near["p"], near["u"]),
                  Series("least of the pictures", near["p"], near["least u"]),
                  Series("largest of the pictures", near["p"], near["largest u"])] + paper),
            Plot(f"{name}-all", f"Imbalance against every offset, {phase}", "offset p (pixels)", "u",
                 [Series(mean, rows["p"], rows["mean u"]),
                  Series("its interval, every fourth", few["p"], few["mean u"], "points", few["+-"]),
                  Series(f"{scene}, one picture", rows["p"], rows["u"])] + paper, log="y")]


@study("fig8", prose=PROSE_8, one_scene=True)
def fig8(lab, scenes):
    return page_of("fig8", lab, scenes, first_pass=True)


@study("fig13", prose=PROSE_13, one_scene=True)
def fig13(lab, scenes):
    return page_of("fig13", lab, scenes, first_pass=False)
