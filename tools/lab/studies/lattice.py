"""Offsets greater than sqrt(P)

Do all offsets greater than sqrt(P) = {reference} balance the load worse, as Kohata & Ito say?

- Source: Kohata & Ito 1993, section on the cyclic mapping.
- Ensemble: {ensemble}, {size} x {size} pixels on {pes} PEs of the SPA, one PE per column; first pass.
- The pixels of a PE form a lattice. The length of its shortest vector is the smallest distance between two pixels of one PE. If it is short, a PE
  owns many pixels of one expensive region. Distances do not wrap at the image's edges; wrapping does not change the shortest vector.
- Each offset is compared with p = {reference}, whose shortest vector has {length} pixels, within the same picture. The mirror image of this offset,
  p = {mirror}, is in no group.
- Output: lattice.csv has a row for each offset p: length of the shortest vector (pixels), mean load imbalance u = (max load - mean load) / mean
  load with half the width of its 95 % interval (+-), and mean rank by u (1: lowest u). lattice-chosen.csv has the rows of interest.
"""
import numpy as np
import pandas as pd
import raya
from raya.lab import Comparison, Page, Plot, Series, Table, bonferroni_confidence, controlled, estimate, estimates, judged, lowest, papers, study
from scipy.stats import rankdata, spearmanr

EQUAL = 0.01  # best-is-n and beyond-is-worse: mean u that differ by at most this are equal, 1 % of the time if every PE had the mean load
MAX_CORRELATION = -0.5  # the shortest vector "predicts" u if their rank correlation is at most this


def shortest_square(offset, side):
    """Returns the squared length, in pixels squared, of the shortest vector of the lattice with the basis (p, 1) and (W, 0), in (columns, rows), for an
    offset p and an image of W = side columns."""
    rows = np.arange(1, side + 1)  # after `side` rows a slot is back in its first column
    right = rows * offset % side
    return int((rows**2 + np.minimum(right, side - right)**2).min())


def shares_blocks(offset, side, n):
    """Returns true if no PE owns two or more pixels of an n x n block, wherever the block lies in the image."""
    return n <= side and all(min(rows * offset % side, side - rows * offset % side) >= n for rows in range(1, n))


@study("lattice", prepare=lambda lab, scenes: lab.ensemble(scenes, lab.size(256)))
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
    means, half_widths = estimates(u, families)
    rows = pd.DataFrame({
        "p": range(size), "shortest vector (pixels)": np.sqrt(squares), "mean u": means,
        "+-": half_widths, "mean rank": rankdata(u, axis=1).mean(0),
        **{f"u, {name}": some.mean(0) for name, some in of_family.items()},
        "n x n blocks shared": ["yes" if shares_blocks(p, size, n) else "no" for p in range(size)]})
    wins = (u < u[:, n:n + 1]).sum(0)
    best = int(rows["mean u"].idxmin())
    chosen = list(dict.fromkeys([0, n, *longer, *as_long, best]))
    table = rows.loc[chosen, ["p", "shortest vector (pixels)", "mean u", "+-", "mean rank"]].rename(
        columns={"mean rank": f"mean rank of {size}"})
    table[f"pictures better than p = {n}"] = wins[chosen]
    correlations = [spearmanr(np.sqrt(squares), one)[0] for one in u]
    mean = rows["mean u"]
    comparisons = [Comparison(f"mean u, p = {n}", "", None, mean[n], half_width=rows["+-"][n]),
                   Comparison("lowest mean u of all offsets", "", None, mean[best], f"p = {best}",
                              half_width=rows["+-"][best])]
    for vector, offsets in (("shortest vector longer", longer), ("shortest vector as long", as_long)):
        comparisons += [Comparison(f"number of offsets beyond {n}, {vector}", "", None, len(offsets), ", ".join(map(str, offsets))),
                        Comparison(f"... of these with a lower mean u than p = {n}", "", None, int((mean[offsets] < mean[n]).sum()),
                                   "Kohata & Ito: beyond sqrt(P) only the direction of the bias changes")]
    comparisons.append(Comparison("rank correlation of u and shortest vector", "", None, float(np.mean(correlations)), "mean of the pictures"))
    return Page({"size": size, "pes": size, "reference": n, "pictures": len(u)},
                findings_of(rows, u, families, n, longer, as_long, correlations, squares),
                comparisons,
                claims_of(u, ensemble, rows, n, beyond, ensemble.control_u(size)) if n * n == size and not scenes else [],
                [Table("lattice-chosen", f"p = 0, p = {n}, offsets with shortest vectors as long or longer, and the best of all",
                       table), Table("lattice", "Shortest vector and u of each offset", rows, on_page=False)],
                [*plots_of(rows, n, longer, as_long, len(u))],
                [f"The lattice of an offset predicts its mean u: the rank correlation of the mean u with the length of the shortest vector is "
                 f"{spearmanr(np.sqrt(squares), rows['mean u'])[0]:.2f}."],
                placeholders={"ensemble": ensemble.description, "length": f"{squares[n]**0.5:.2f}", "mirror": size - n}, compared_with=papers.SPA)


def claims_of(u, ensemble, rows, n, beyond, control_u):
    families = ensemble.families
    beyond = [p for p in beyond if p < len(rows) - n]  # larger offsets are the mirror images of smaller ones than n
    confidence = bonferroni_confidence(len(beyond))
    differences = [estimate(u[:, p] - u[:, n], families, confidence) for p in beyond]
    worse, better = sum(d.low > 0 for d in differences), sum(d.high < 0 for d in differences)
    mean = estimate(u[:, beyond].mean(1) - u[:, n], families)
    shared = rows["n x n blocks shared"] == "yes"
    return [judged("blocks-shared", None, "",
                   f"Counted for n = {n}: with p = {n}, no n x n block has two pixels of one PE. This holds for {shared.sum()} offsets: "
                   f"{', '.join(map(str, rows['p'][shared]))}."),
            controlled("beyond-is-worse", lambda of: lowest(u[:, beyond] - of[:, None], EQUAL, families), u[:, n], control_u,
                       ensemble.description,
                   f"Of the {len(beyond)} offsets from {n + 1} to {len(rows) - n - 1}, {worse} have a higher mean u than p = {n} and {better} a "
                   f"lower one, with 95 % "
                   f"confidence in all differences together. The mean of u(p) - u({n}) over these offsets is {mean.text(4)}; of "
                       f"{sum(abs(d.mean) + d.half <= EQUAL for d in differences)} offsets, u differs from that of p = {n} by at most {EQUAL}.")]


def findings_of(rows, u, families, n, longer, as_long, correlations, squares):
    mean, size = rows["mean u"], len(rows)

    def group(offsets, vector):
        if not offsets:
            return f"No offset beyond {n} has a shortest vector {vector} that of p = {n}."
        return (f"Offsets beyond {n} with a shortest vector {vector} that of p = {n}: {len(offsets)}, of which "
                f"{(mean[offsets] < mean[n]).sum()} have a lower mean u than p = {n}; the mean u of the group is {mean[offsets].mean():.4f}.")

    both, verdict_text = longer + as_long, "So no offset greater than sqrt(P) has a lattice as good."
    if both:
        gain = estimate(u[:, both].mean(1) - u[:, n], families)
        how = ("these offsets are better on the whole" if gain.high < 0 else "these offsets are worse on the whole" if gain.low > 0 else
               "the difference is not significant")
        verdict_text = f"Over both groups the mean of u(p) - u({n}) in the same picture is {gain.text(4)}: {how}."
    spread = (f"The mean u of p = {n} is {estimate(u[:, n], families).text(4)}. {group(longer, 'longer than')} {group(as_long, 'as long as')} "
              f"{verdict_text}")
    best = mean.idxmin()
    rest = [p for p in range(n + 1, size - n) if squares[p] < squares[n]]
    low, high = min(correlations), max(correlations)
    how = ("the shortest vector predicts u in every picture" if high <= MAX_CORRELATION else
           "the shortest vector predicts u in no picture" if low > MAX_CORRELATION else
           "the shortest vector predicts u in some pictures only")
    half = squares[n]**0.5 / 2
    is_long = np.sqrt(squares) >= half
    long_correlation = np.mean([spearmanr(np.sqrt(squares[is_long]), picture_u[is_long])[0] for picture_u in u])
    return [spread,
            f"The best of all {size} offsets is p = {best} with a mean u of {mean[best]:.4f}. Its largest load (1 + mean u) is "
            f"{100 * (1 - (1 + mean[best]) / (1 + mean[n])):.1f} % below that of p = {n}. The mean rank of p = {n} among all offsets is "
            f"{rows['mean rank'][n]:.1f}.",
            f"Of the {len(rest)} offsets from {n + 1} to {size - n - 1} whose shortest vector is shorter than that of p = {n}, "
            f"{(mean[rest] > mean[n]).sum()} have a higher mean u than p = {n}.",
            f"Over all offsets, the rank correlation of u with the length of the shortest vector is {low:.2f} to {high:.2f}, by picture: {how} "
            f"(correlation at most {MAX_CORRELATION}). Over the offsets with a shortest vector of {half:.1f} pixels or more, the mean "
            f"correlation is {long_correlation:.2f}."]


def plots_of(rows, n, longer, as_long, pictures):
    groups = {f"beyond {n}, longer vector than p = {n}": longer, f"beyond {n}, vector as long": as_long, f"p = {n}": [n]}
    for name, title, x, x_label, style in (
            ("lattice", "Load imbalance against the smallest distance between two pixels of a PE",
             "shortest vector (pixels)", "shortest vector of the lattice (pixels)", "points"),
            ("lattice-offsets", "Load imbalance against the offset", "p", "offset p (pixels)", "line")):
        points = [Series(label, group_rows[x], group_rows["mean u"], "points", group_rows["+-"]) for label, offsets in groups.items()
                  for group_rows in [rows.loc[offsets]]]
        yield Plot(name, title, x_label, f"load imbalance u, mean of {pictures} pictures",
                   [Series("every offset", rows[x], rows["mean u"], style), *points], "y")
