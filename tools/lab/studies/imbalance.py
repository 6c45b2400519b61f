"""Figs 8 and 13 of Kohata & Ito 1993: the load imbalance u at each offset, of one picture and of many pictures."""
import numpy as np
import pandas as pd
import raya
from raya.lab import (Comparison, Page, Plot, Series, Table, above, bonferroni_confidence, controlled, estimate, estimates, first_scene, judged, lowest,
                      papers, range_text, study)
from raya.lab.studies.lattice import EQUAL, shortest_square

U_AND_PICTURES = """
- The load of a PE is the sum of the modelled cycles of its pixels. The load imbalance u = (max load - mean load) / mean load needs no clock rate.
- Ensemble: {ensemble}. In all families but cluster, whose camera is fixed, the camera keeps its distance and looks at its target from a random
  direction, 5 to 75 degrees above it.
- All offsets are applied to the same pictures. A mean is the mean of the families' means. Its 95 % interval contains the variation within the
  families; the table of the families shows the variation between them."""

PROSE_8 = """Fig. 8: load imbalance against the offset

Which offset p of the cyclic mapping spreads the load best?

- Source: Kohata & Ito 1993, Fig. 8. We derived the paper's u(0) and u(16) from the times in its Tables 2 and 3.
- {size} x {size} pixels on {pes} PEs of the SPA, one PE per column; first pass. The single picture is scene {scene}.""" + U_AND_PICTURES + """
- Output: fig8.csv has a row for each offset p: u of the single picture; mean u of the ensemble and half the width of its interval (+-); least and
  largest u of the ensemble; shortest distance of two pixels of one PE. fig8-near.csv has only the offsets 0..n, n = sqrt(P) for P PEs."""

PROSE_13 = """Fig. 13: load imbalance against the offset in supersampling

Does the offset that balances the first pass best also balance supersampling?

- Source: Kohata & Ito 1993, Fig. 13.
- {size} x {size} pixels on {pes} PEs of the SPA, one PE per column. The loads are those of supersampling, without the first pass. The
  single picture is scene {scene}.""" + U_AND_PICTURES + """
- Output: fig13.csv and fig13-near.csv, with the columns of fig8.csv."""

GOOD_FRACTION, UNEVEN = 0.9, 0.5  # good-at-8: minimum fraction of the best fall of u; contours-uneven: minimum mean u(0)


def page_of(name, lab, scenes, first_pass):
    scene, size = first_scene(scenes), lab.size(256)
    antialias, image_of = ("none", lambda costs: costs.trace) if first_pass else ("supersample", lambda costs: costs.supersample)
    offsets, n = range(size), round(size**0.5)  # n: the offset that the paper calls the best
    ensemble = lab.ensemble(scenes, size, antialias)
    u = raya.imbalances(image_of(lab.costs(scene, size, antialias)), size, offsets)
    picture_u = ensemble.map(lambda costs: raya.imbalances(image_of(costs), size, offsets))  # [picture, offset]
    means, half_widths = estimates(picture_u, ensemble.families)
    best = (picture_u <= picture_u[:, :n + 1].min(1, keepdims=True)).sum(0)
    rows = pd.DataFrame({
        "p": offsets, "u": u, "mean u": means, "+-": half_widths,
        "least u": picture_u.min(0), "largest u": picture_u.max(0), f"best of 0..{n} (pictures)": best,
        "shortest vector (pixels)": [shortest_square(p, size)**0.5 for p in offsets]})
    of_families = [{"family": family, "pictures": len(one), **{f"u({p})": one[:, p].mean() for p in (0, n // 2, 3 * n // 4, n)},
                    f"best of 0..{n}": int(one[:, :n + 1].mean(0).argmin())}
                   for family in dict.fromkeys(ensemble.families) for one in [picture_u[np.array(ensemble.families) == family]]]
    in_paper, near = first_pass and papers.is_papers(scene.name, size), rows[:n + 1]
    phase = "first pass" if first_pass else "supersampling without the first pass"
    p8, p16 = 8 % size, 16 % size
    zero, eight, sixteen = (estimate(picture_u[:, p], ensemble.families).text() for p in (0, p8, p16))
    findings = [f"The mean u of {len(picture_u)} pictures is {zero} at p = 0, {eight} at p = 8 and {sixteen} at p = 16.",
                best_sentence(picture_u, ensemble.families, n),
                f"In the single picture, u is {u[0]:.3f} at p = 0, {u[p8]:.3f} at p = 8 and {u[p16]:.3f} at p = 16. The best of the "
                f"offsets 0..{n} is p = {u[:n + 1].argmin()} with u = {u[:n + 1].min():.3f}; the best of all {len(u)} offsets is p = "
                f"{u.argmin()} with u = {u.min():.3f}. {(u < u[p16]).sum()} offsets have a lower u than p = 16."]
    return Page({"scene": scene.name, "size": size, "pes": size, "pictures": len(picture_u)},
                findings, comparisons_of(rows, picture_u, n, in_paper),
                claims_of(picture_u, ensemble, n, first_pass, ensemble.control_u(size, image_of)) if not scenes else [],
                [Table(f"{name}-near", f"Load imbalance u at the offsets 0..{n}: {scene.name}, and {len(picture_u)} pictures", near),
                 Table(name, "Load imbalance u at each offset", rows, on_page=False),
                 Table(f"{name}-families", "Mean u of each family at four offsets, and the offset with the lowest mean u", of_families)],
                plots_of(name, scene.name, phase, rows, near, len(picture_u), in_paper),
                placeholders={"ensemble": ensemble.description}, compared_with=papers.SPA)


def best_sentence(picture_u, families, n):
    # u(p) - u(n) for each p = 0..n - 1, within the same picture
    differences = [estimate(picture_u[:, p] - picture_u[:, n], families, bonferroni_confidence(n)) for p in range(n)]
    worse, better = ([p for p, d in enumerate(differences) if sign * d.low_or_mean > 0 and sign * d.high_or_mean > 0] for sign in (1, -1))
    means = picture_u[:, :n + 1].mean(0)
    lowest = int(means.argmin())
    plateau = [p for p in range(n + 1) if p not in worse]
    gap = estimate(picture_u[:, lowest] - picture_u[:, n], families)
    return (f"Of the offsets 0..{n}, p = {lowest} has the lowest mean u; this mean minus that of p = {n} is {gap.text(4)}. With 95 % confidence "
            f"in all {n} differences together, {len(worse)} offsets have a higher mean u than p = {n}, and {len(better)} a lower one. The mean u "
            f"is not significantly higher than that of p = {n} for p = {', '.join(map(str, plateau))}. p = {n} has the lowest u of 0..{n} in "
            f"{(picture_u[:, n] <= picture_u[:, :n + 1].min(1)).sum()} of {len(picture_u)} pictures.")


def claims_of(picture_u, ensemble, n, first_pass, control_u):
    families, about = ensemble.families, ensemble.description
    text = f"From p = 0 to p = {n}, u of the same picture falls by {estimate(picture_u[:, 0] - picture_u[:, n], families).text()} in the mean."

    def falls(u):
        return above(picture_u[:, 0] - u, 0, families)

    def best(u):
        differences = picture_u[:, :n + 1] - u[:, None]
        return lowest(differences[:, differences.any(0)], EQUAL, families)  # without the mapping itself

    def good(u):
        return above(picture_u[:, 0] - u - GOOD_FRACTION * gains, 0, families)

    if not first_pass:
        u_0 = picture_u[:, 0]
        return [judged("contours-uneven", above(u_0, UNEVEN, families), about, f"The mean of u(0) is {estimate(u_0, families).text()}."),
                controlled("supersampling-balances", falls, picture_u[:, n], control_u, about, text)]
    gains = picture_u[:, 0] - picture_u[:, :n + 1].min(1)
    half = picture_u[:, 0] - picture_u[:, n // 2]
    return [controlled("cyclic-reduces", falls, picture_u[:, n], control_u, about, text),
            controlled("best-is-n", best, picture_u[:, n], control_u, about, best_sentence(picture_u, families, n)),
            controlled("good-at-8", good, picture_u[:, n // 2], control_u, about,
                   f"Compared with p = 0, the mean u is lower by {estimate(half, families).text()} with p = {n // 2}, and by "
                   f"{estimate(gains, families).text()} with the best offset of 0..{n} for each picture.")]


def comparisons_of(rows, picture_u, n, in_paper):
    printed = {0: (papers.IMBALANCE_0, "our scene is calibrated to this value: see scenes/README.md"),
               8: (None, "the paper calls the distribution with p = 8 good, too"), 16: (papers.IMBALANCE_16, papers.IMBALANCE_16_ROUNDING)}
    comparisons = []
    for p, (figure, remark) in printed.items():
        row, p_u = rows.iloc[p % len(rows)], picture_u[:, p % len(rows)]
        comparisons += [Comparison(f"u({p}) of the single picture", "", figure if in_paper else None, row["u"], remark * in_paper, derived=True),
                        Comparison(f"u({p}), mean of the ensemble", "", None, row["mean u"], f"range over the pictures: {range_text(p_u)}",
                                   half_width=row["+-"])]
    for offset_rows, paper in ((rows[:n + 1], 16), (rows, None)):
        what = f"p with the lowest u, of 0..{n}" if paper else f"p with the lowest u, of all {len(rows)}"
        for column, more in (("u", ", single picture"), ("mean u", ", mean of the ensemble")):
            best = offset_rows[column].idxmin()
            source = f"the paper's: {paper}; " if paper and in_paper else ""
            comparisons.append(Comparison(what + more, "", None, int(best), f"{source}u = {offset_rows[column][best]:.3f}"))
    return comparisons


def plots_of(name, scene, phase, rows, near, pictures, in_paper):
    mean, few = f"mean of {pictures} pictures", rows[rows["p"] % 4 == 0]
    paper = [Series("Kohata & Ito, derived from their tables", [0, 16], [papers.IMBALANCE_0, papers.IMBALANCE_16], "paper")] * in_paper
    return [Plot(name, f"Load imbalance against the offset, {phase}", "offset p (pixels)", "load imbalance u",
                 [Series(mean, near["p"], near["mean u"], half_widths=near["+-"]),
                  Series(f"{scene}, one picture", near["p"], near["u"]),
                  Series("lowest u of a picture", near["p"], near["least u"]),
                  Series("highest u of a picture", near["p"], near["largest u"])] + paper, log="y"),
            Plot(f"{name}-all", f"Load imbalance against every offset, {phase}", "offset p (pixels)", "load imbalance u",
                 [Series(mean, rows["p"], rows["mean u"]),
                  Series("95 % interval of the mean, every fourth p", few["p"], few["mean u"], "points", few["+-"]),
                  Series(f"{scene}, one picture", rows["p"], rows["u"])] + paper, log="y")]


@study("fig8", prose=PROSE_8, one_scene=True, prepare=lambda lab, scenes: lab.ensemble(scenes, lab.size(256)))
def fig8(lab, scenes):
    return page_of("fig8", lab, scenes, first_pass=True)


@study("fig13", prose=PROSE_13, one_scene=True, prepare=lambda lab, scenes: lab.ensemble(scenes, lab.size(256), "supersample"))
def fig13(lab, scenes):
    return page_of("fig13", lab, scenes, first_pass=False)
