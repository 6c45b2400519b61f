"""Offsets beyond sqrt(P)

Is every offset beyond sqrt(P) = {reference} worse, as Kohata & Ito say?

- Source: Kohata & Ito 1993, section on the cyclic mapping.
- {labels} at {size} x {size} on {pes} PEs of the SPA, a PE for each column; first pass. Views have the seeds 1, 2, ..., as in Fig. 8:
  {pictures} pictures.
- The pixels of a PE form a lattice. Its shortest vector, the smallest distance between two pixels of one PE, limits how well an offset
  can spread expensive regions. Distances are measured in the image and do not wrap at its edges; with wrapping the shortest vector is the same.
- Offsets are compared with p = {reference}, whose shortest vector has {length} pixels. Its mirror, p = {mirror}, is in no group.
  Differences are taken within the same picture.
- "0..n is enough" is reproduced if no offset beyond n gains 0.02 of the mean load, all together with 95 % (Bonferroni).
- Output: lattice.csv has a row for each offset p: length of the shortest vector (pixels), mean u = (max load - mean load) / mean load with
  the half width of its 95 % interval, mean rank. lattice-chosen.csv has the rows of interest.
"""
import numpy as np
import pandas as pd
import raya
from raya.lab import (Claim, Comparison, Page, Plot, Series, Table, bonferroni_confidence, estimate, papers, study,
                      verdict)
from raya.lab.laboratory import VIEWS
from raya.lab.mappings import shares_blocks, shortest_square
from raya.lab.studies.images import paper_like_scenes
from scipy.stats import rankdata, spearmanr

NEGLIGIBLE_GAIN = 0.02  # our limit: a gain up to this fraction of the mean load is negligible
OTHER_VIEWS = 16  # number of views of each scene, except the first scene, which has the views of Fig. 8
MAX_CORRELATION = -0.5  # the shortest vector counts as a predictor of u if their rank correlation is at most this
DEFAULT_SCENES = "centre", "mirrors", "glass", "random-12", "random-30"


@study("lattice")
def lattice(lab, scenes):
    size = lab.size(256)
    some = scenes or [s for s in paper_like_scenes() if s.name in DEFAULT_SCENES]
    views = {s.name: lab.ensemble(s, size, "none", VIEWS if i == 0 else OTHER_VIEWS).views for i, s in enumerate(some)}
    of_scene = {name: np.array([raya.imbalances(view.trace, size, range(size)) for view in all_of])
                for name, all_of in views.items()}
    u = np.concatenate(list(of_scene.values()))  # [picture, offset]
    n = round(size**0.5)
    squares = np.array([shortest_square(p, size) for p in range(size)])
    beyond = [p for p in range(n + 1, size) if p != size - n]
    longer = [p for p in beyond if squares[p] > squares[n]]
    as_long = [p for p in beyond if squares[p] == squares[n]]
    means = [estimate(column) for column in u.T]
    rows = pd.DataFrame({
        "p": range(size), "shortest vector (pixels)": np.sqrt(squares), "mean u": [m.mean for m in means],
        "+-": [m.half for m in means], "mean rank": rankdata(u, axis=1).mean(0),
        **{f"u, {name}": some.mean(0) for name, some in of_scene.items()},
        "n x n blocks shared": ["yes" if shares_blocks(p, size, n) else "no" for p in range(size)]})
    wins = (u < u[:, n:n + 1]).sum(0)
    best = int(rows["mean u"].idxmin())
    chosen = list(dict.fromkeys([0, n, *longer, *as_long, best]))
    table = rows.loc[chosen, ["p", "shortest vector (pixels)", "mean u", "+-", "mean rank"]].rename(
        columns={"mean rank": f"mean rank of {size}"})
    table[f"pictures better than p = {n}"] = wins[chosen]
    correlations = [spearmanr(np.sqrt(squares), one)[0] for one in u]
    labels = ", ".join(f"{name} ({len(some)} views)" for name, some in views.items())
    return Page({"scenes": list(views), "size": size, "pes": size, "reference": n, "pictures": len(u),
                 "views": [len(some) for some in views.values()]},
                findings_of(rows, u, n, longer, as_long, correlations, squares),
                comparisons_of(rows, n, longer, as_long, correlations),
                [claim_of_blocks(rows, n)] + ([claim_of_enough(u, means, n)] if len(u) > 1 else []),
                [Table("lattice-chosen", f"p = 0, p = {n}, offsets with as long or longer vectors, and the best of all",
                       table), Table("lattice", "Every offset", rows, on_page=False)],
                [*plots_of(rows, n, longer, as_long, len(u))],
                ["Kohata & Ito do not use the lattice of an offset. The lattice predicts which offsets beyond sqrt(P) spread the load as "
                 "well as sqrt(P), and why the others do not."],
                placeholders={"labels": labels, "length": f"{squares[n]**0.5:.2f}", "mirror": size - n}, compared_with=papers.SPA)


def claim_of_blocks(rows, n):
    shared = rows["n x n blocks shared"] == "yes"
    own = shared[n] and n * n == len(rows)
    return Claim(papers.SPA, "section on the cyclic mapping",
                 "With p = n on n x n PEs every n x n block is shared by all PEs, a pixel each.", verdict(own, not own),
                 f"Counted for n = {n}: the PEs {'do' if own else 'do not'} share every n x n block in this way. For {shared.sum()} "
                 f"offsets no such block has two pixels of one PE: {', '.join(map(str, rows['p'][shared]))}.")


def claim_of_enough(u, means, n):
    """Compares every offset beyond n with the best of 0..n; a gain up to NEGLIGIBLE_GAIN is negligible."""
    near = int(np.argmin([m.mean for m in means[:n + 1]]))
    beyond = range(n + 1, len(means))
    gains = [estimate(u[:, p] - u[:, near], bonferroni_confidence(len(beyond))) for p in beyond]
    best = min(beyond, key=lambda p: means[p].mean)
    better = sum(g.high < 0 for g in gains)
    return Claim(papers.SPA, "section on the cyclic mapping",
                 "Offsets beyond n = sqrt(P) only turn the direction of the bias, so 0..n is enough.",
                 verdict(all(g.low >= -NEGLIGIBLE_GAIN for g in gains), any(g.high < -NEGLIGIBLE_GAIN for g in gains)),
                 f"Over {len(u)} pictures the best of 0..n is p = {near}, mean u {means[near].text()}; the best beyond "
                 f"is p = {best}, {means[best].text()}. Of {len(beyond)} offsets beyond n {better} are better than the "
                 f"best of 0..n with certainty; a gain up to {NEGLIGIBLE_GAIN} counts as negligible.")


def findings_of(rows, u, n, longer, as_long, correlations, squares):
    mean, size = rows["mean u"], len(rows)

    def group(offsets, vector):
        if not offsets:
            return f"none has a shortest vector {vector}"
        return (f"{len(offsets)} have a shortest vector {vector}; {(mean[offsets] < mean[n]).sum()} of these have a lower mean "
                f"u than p = {n}, and their mean is {mean[offsets].mean():.4f}")

    both, verdict_text = longer + as_long, "So no offset beyond sqrt(P) is better."
    if both:
        gain = estimate(u[:, both].mean(1) - u[:, n])
        how = ("they are better on the whole" if gain.high < 0 else "they are worse on the whole" if gain.low > 0 else
               "there is no significant difference")
        verdict_text = f"In the same picture their mean u is {gain.text(4)} above that of p = {n}: {how}."
    spread = (f"Of the offsets beyond {n} (u = {estimate(u[:, n]).text(4)}), {group(longer, 'longer than its own')}; "
              f"{group(as_long, 'as long')}. {verdict_text}")
    best = mean.idxmin()
    rest = [p for p in range(n + 1, size - n) if squares[p] < squares[n]]
    low, high = min(correlations), max(correlations)
    how = ("in every picture the shortest vector predicts u" if high <= MAX_CORRELATION else
           "in no picture does the shortest vector predict u" if low > MAX_CORRELATION else
           "the shortest vector predicts u in some pictures only")
    half = squares[n]**0.5 / 2
    some = np.sqrt(squares) >= half
    of_some = np.mean([spearmanr(np.sqrt(squares[some]), one[some])[0] for one in u])
    return [spread,
            f"The best of all {size} is p = {best}, mean u = {mean[best]:.4f}: its largest load is "
            f"{100 * (1 - (1 + mean[best]) / (1 + mean[n])):.1f} % below that of p = {n}, which has a mean rank of "
            f"{rows['mean rank'][n]:.1f}.",
            f"Of the {len(rest)} offsets from {n + 1} to {size - n - 1} with a shorter vector, "
            f"{(mean[rest] > mean[n]).sum()} are worse than p = {n}.",
            f"Rank correlation of u with the shortest vector over all offsets: {low:.2f} to {high:.2f}; {how} "
            f"(predicts: {MAX_CORRELATION} or below). Over the offsets with a shortest vector of {half:.1f} pixels or more the mean "
            f"correlation is {of_some:.2f}."]


def comparisons_of(rows, n, longer, as_long, correlations):
    mean, best = rows["mean u"], int(rows["mean u"].idxmin())
    all_of = [Comparison(f"mean u, p = {n}", "", None, mean[n], half_width=rows["+-"][n]),
              Comparison("lowest mean u of all offsets", "", None, mean[best], f"p = {best}",
                         half_width=rows["+-"][best])]
    for vector, offsets in (("longer vector", longer), ("as long", as_long)):
        all_of += [Comparison(f"offsets beyond {n}, {vector}", "", None, len(offsets), ", ".join(map(str, offsets))),
                   Comparison(f"... better than p = {n}", "", None, int((mean[offsets] < mean[n]).sum()),
                              "Kohata & Ito: beyond sqrt(P) only the direction of the bias turns")]
    return all_of + [Comparison("rank correlation of u and shortest vector", "", None, float(np.mean(correlations)),
                                "mean of the pictures")]


def plots_of(rows, n, longer, as_long, pictures):
    groups = {f"beyond {n}, longer vector": longer, f"beyond {n}, as long": as_long, f"p = {n}": [n]}
    for name, title, x, x_label, style in (
            ("lattice", "Imbalance against the shortest distance between two pixels of a PE",
             "shortest vector (pixels)", "shortest vector of the lattice (pixels)", "points"),
            ("lattice-offsets", "Imbalance against the offset", "p", "offset p (pixels)", "line")):
        points = [Series(label, some[x], some["mean u"], "points", some["+-"]) for label, offsets in groups.items()
                  for some in [rows.loc[offsets]]]
        yield Plot(name, title, x_label, f"u, mean of {pictures} pictures",
                   [Series("every offset", rows[x], rows["mean u"], style), *points], "y")
