"""Offsets beyond sqrt(P)

Is every offset beyond sqrt(P) = {reference} worse, as Kohata & Ito say?

- Source: Kohata & Ito 1993, section on the cyclic mapping.
- {ensemble}, at {size} x {size} on {pes} PEs of the SPA, a PE for each column; first pass.
- The pixels of a PE form a lattice. Its shortest vector, the smallest distance between two pixels of one PE, limits how well an offset
  can spread expensive regions. Distances are measured in the image and do not wrap at its edges; with wrapping the shortest vector is the same.
- Offsets are compared with p = {reference}, whose shortest vector has {length} pixels. The mirror image of this offset, p = {mirror}, is in no group.
  Differences are taken within the same picture.
- Output: lattice.csv has a row for each offset p: length of the shortest vector (pixels), mean u = (max load - mean load) / mean load with
  the half width of its 95 % interval, mean rank of the offset by u. lattice-chosen.csv has the rows of interest.
"""
import numpy as np
import pandas as pd
import raya
from raya.lab import (Comparison, Page, Plot, Series, Table, above, bonferroni_confidence, counted, estimate, estimates, every, judged,
                      papers, study)
from raya.lab.mappings import shares_blocks, shortest_square
from scipy.stats import rankdata, spearmanr

MAX_CORRELATION = -0.5  # the shortest vector counts as a predictor of u if their rank correlation is at most this


@study("lattice")
def lattice(lab, scenes):
    size = lab.size(256)
    ensemble = lab.ensemble(scenes, size)
    families = ensemble.families
    u = ensemble.map(lambda costs: raya.imbalances(costs.trace, size, range(size)))  # [picture, offset]
    of_family = {name: u[np.array(families) == name] for name in dict.fromkeys(families)}
    n = round(size**0.5)
    squares = np.array([shortest_square(p, size) for p in range(size)])
    beyond = [p for p in range(n + 1, size) if p != size - n]
    longer = [p for p in beyond if squares[p] > squares[n]]
    as_long = [p for p in beyond if squares[p] == squares[n]]
    means = estimates(u, families)
    rows = pd.DataFrame({
        "p": range(size), "shortest vector (pixels)": np.sqrt(squares), "mean u": [m.mean for m in means],
        "+-": [m.half for m in means], "mean rank": rankdata(u, axis=1).mean(0),
        **{f"u, {name}": some.mean(0) for name, some in of_family.items()},
        "n x n blocks shared": ["yes" if shares_blocks(p, size, n) else "no" for p in range(size)]})
    wins = (u < u[:, n:n + 1]).sum(0)
    best = int(rows["mean u"].idxmin())
    chosen = list(dict.fromkeys([0, n, *longer, *as_long, best]))
    table = rows.loc[chosen, ["p", "shortest vector (pixels)", "mean u", "+-", "mean rank"]].rename(
        columns={"mean rank": f"mean rank of {size}"})
    table[f"pictures better than p = {n}"] = wins[chosen]
    correlations = [spearmanr(np.sqrt(squares), one)[0] for one in u]
    return Page({"size": size, "pes": size, "reference": n, "pictures": len(u)},
                findings_of(rows, u, families, n, longer, as_long, correlations, squares),
                comparisons_of(rows, n, longer, as_long, correlations), claims_of(u, ensemble, rows, n, beyond) if n * n == size and not scenes else [],
                [Table("lattice-chosen", f"p = 0, p = {n}, offsets with as long or longer vectors, and the best of all",
                       table), Table("lattice", "Every offset", rows, on_page=False)],
                [*plots_of(rows, n, longer, as_long, len(u))],
                [f"The lattice of an offset predicts its balance: of the offsets beyond {n}, the {len(longer)} with longer shortest vectors have a mean u "
                 f"of {rows['mean u'][longer].mean():.4f}, p = {n} has {rows['mean u'][n]:.4f}."] if len(longer) else [],
                placeholders={"ensemble": ensemble.description, "length": f"{squares[n]**0.5:.2f}", "mirror": size - n}, compared_with=papers.SPA)


def claims_of(u, ensemble, rows, n, beyond):
    families = ensemble.families
    confidence = bonferroni_confidence(len(beyond))
    differences = [estimate(u[:, p] - u[:, n], families, confidence) for p in beyond]
    worse, better = sum(d.low > 0 for d in differences), sum(d.high < 0 for d in differences)
    mean = estimate(u[:, beyond].mean(1) - u[:, n], families)
    shared = rows["n x n blocks shared"] == "yes"
    return [judged("blocks-shared", counted(shared[n]), "",
                   f"Counted for n = {n}: no block has two pixels of one PE with p = {n}. This holds for {shared.sum()} offsets: "
                   f"{', '.join(map(str, rows['p'][shared]))}."),
            judged("beyond-is-worse", every(above(u[:, p] - u[:, n], 0, families) for p in beyond), ensemble.description,
                   f"Of {len(beyond)} offsets beyond n, all together at 95 %, {worse} are worse than p = {n} and {better} are better. Their "
                   f"mean u is {mean.text(4)} above that of p = {n}.")]


def findings_of(rows, u, families, n, longer, as_long, correlations, squares):
    mean, size = rows["mean u"], len(rows)

    def group(offsets, vector):
        if not offsets:
            return f"none has a shortest vector {vector}"
        return (f"{len(offsets)} have a shortest vector {vector}; {(mean[offsets] < mean[n]).sum()} of these have a lower mean "
                f"u than p = {n}, and their mean is {mean[offsets].mean():.4f}")

    both, verdict_text = longer + as_long, "So no offset beyond sqrt(P) is better."
    if both:
        gain = estimate(u[:, both].mean(1) - u[:, n], families)
        how = ("they are better on the whole" if gain.high < 0 else "they are worse on the whole" if gain.low > 0 else
               "there is no significant difference")
        verdict_text = f"In the same picture their mean u is {gain.text(4)} above that of p = {n}: {how}."
    spread = (f"u of p = {n} is {estimate(u[:, n], families).text(4)}. Of the offsets beyond {n}, {group(longer, f'longer than that of p = {n}')}; "
              f"{group(as_long, 'as long')}. {verdict_text}")
    best = mean.idxmin()
    rest = [p for p in range(n + 1, size - n) if squares[p] < squares[n]]
    low, high = min(correlations), max(correlations)
    how = ("in every picture the shortest vector predicts u" if high <= MAX_CORRELATION else
           "in no picture does the shortest vector predict u" if low > MAX_CORRELATION else
           "the shortest vector predicts u in some pictures only")
    half = squares[n]**0.5 / 2
    is_long = np.sqrt(squares) >= half
    long_correlation = np.mean([spearmanr(np.sqrt(squares[is_long]), picture_u[is_long])[0] for picture_u in u])
    return [spread,
            f"The best of all {size} is p = {best}, mean u = {mean[best]:.4f}: its largest load is "
            f"{100 * (1 - (1 + mean[best]) / (1 + mean[n])):.1f} % below that of p = {n}, which has a mean rank of "
            f"{rows['mean rank'][n]:.1f}.",
            f"Of the {len(rest)} offsets from {n + 1} to {size - n - 1} with a shorter vector, "
            f"{(mean[rest] > mean[n]).sum()} are worse than p = {n}.",
            f"Rank correlation of u with the shortest vector over all offsets: {low:.2f} to {high:.2f}; {how} "
            f"(predicts: {MAX_CORRELATION} or below). Over the offsets with a shortest vector of {half:.1f} pixels or more the mean "
            f"correlation is {long_correlation:.2f}."]


def comparisons_of(rows, n, longer, as_long, correlations):
    mean, best = rows["mean u"], int(rows["mean u"].idxmin())
    comparisons = [Comparison(f"mean u, p = {n}", "", None, mean[n], half_width=rows["+-"][n]),
                   Comparison("lowest mean u of all offsets", "", None, mean[best], f"p = {best}",
                              half_width=rows["+-"][best])]
    for vector, offsets in (("longer vector", longer), ("as long", as_long)):
        comparisons += [Comparison(f"offsets beyond {n}, {vector}", "", None, len(offsets), ", ".join(map(str, offsets))),
                        Comparison(f"... better than p = {n}", "", None, int((mean[offsets] < mean[n]).sum()),
                                   "Kohata & Ito: beyond sqrt(P) only the direction of the bias turns")]
    return comparisons + [Comparison("rank correlation of u and shortest vector", "", None, float(np.mean(correlations)),
                                     "mean of the pictures")]


def plots_of(rows, n, longer, as_long, pictures):
    groups = {f"beyond {n}, longer vector": longer, f"beyond {n}, as long": as_long, f"p = {n}": [n]}
    for name, title, x, x_label, style in (
            ("lattice", "Imbalance against the shortest distance between two pixels of a PE",
             "shortest vector (pixels)", "shortest vector of the lattice (pixels)", "points"),
            ("lattice-offsets", "Imbalance against the offset", "p", "offset p (pixels)", "line")):
        points = [Series(label, group_rows[x], group_rows["mean u"], "points", group_rows["+-"]) for label, offsets in groups.items()
                  for group_rows in [rows.loc[offsets]]]
        yield Plot(name, title, x_label, f"u, mean of {pictures} pictures",
                   [Series("every offset", rows[x], rows["mean u"], style), *points], "y")
