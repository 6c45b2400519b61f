"""The best offset for a scene

Which offset of the cyclic mapping renders this image fastest, communication included?

- Source: Kohata & Ito 1993, section on the cyclic mapping: offsets 0..sqrt(P) are enough; on n x n PEs p = n^2 equals p = 0.
- Time of an offset (modelled ms): the busiest PE's cycles in the first pass and in supersampling, the arithmetic of the filter or the
  comparison, and the rotations that bring the neighbours' pixels by the shortest route, at the SPA's rates. Broadcast and image transfer
  are excluded, because they take the same time for every offset.
- Arrays: a PE for each column, 256 PEs and 64 PEs; cyclic fold; sqrt(P) is rounded. PEs have enough memory for the shares that circulate on
  the ring; the SPA's PEs have enough only for small shares.
- Size: that of the scene if it is square, a smaller one if the scene has so many objects that rendering would take minutes; --size overrides
  it. Of equally fast offsets the study names the smallest.
- {views} random views, as in Fig. 8 (fewer for many objects), show what holds for the scene and not only for one picture. The views of odd
  seeds choose the offsets; the views of even seeds judge them, compared within the same view.
- The offsets 0..sqrt(P) are enough if in all cases together the best of them takes at most {rule} % longer than the best of all offsets.
  They are not enough if it takes longer in one case.
- Output: best-offset-views.csv, best-offset.csv and best-offset-all.csv (every offset). Times are in ms, u is (max load - mean load) / mean
  load, and "takes longer" is in % of the chosen offset's time.
"""
import numpy as np
import pandas as pd
import raya
from raya.lab import (Claim, Comparison, Page, Plot, Series, Table, bonferroni_confidence, estimate, papers, study,
                      verdict)
from raya.lab.laboratory import format_for
from raya.lab.spa import CLOCK, FACTOR, FACTORS, default_size, offset_times

VIEWS, MAX_LOSS = 40, 1  # number of views; our limit: maximum loss in % of an offset that counts as good enough
METHODS = ("none", "filter", "supersample")


class Choice:
    """Times of all offsets for one scene, one number of PEs and one anti-aliasing method, and the offsets chosen from them."""

    def __init__(self, scene, size, pes, antialias, ensemble):
        self.scene, self.size, self.pes, self.antialias = scene.name, size, pes, antialias
        self.root = round(pes**0.5) % size
        self.times = offset_times(ensemble.picture, pes, antialias)
        ms = np.array([offset_times(view, pes, antialias)["total_ms"] for view in ensemble.views])  # [view, offset]
        self.chosen_by, self.judged_by = ms[0::2], ms[1::2]  # seeds 1, 3, ... choose the offset; seeds 2, 4, ... judge it
        total = self.times["total_ms"]
        self.best, self.best_near = (self.times.loc[some.idxmin()] for some in (total, total[:self.root + 1]))
        sums = self.chosen_by.sum(0)
        self.chosen, self.chosen_near = int(sums.argmin()), int(sums[:self.root + 1].argmin())
        self.time = estimate(self.judged_by[:, self.chosen])
        # The best offset for each factor of the clock.
        self.factors = ", ".join(dict.fromkeys(
            str((self.times["ring_ms"] + f / FACTOR * (total - self.times["ring_ms"])).idxmin()) for f in FACTORS))

    method = property(lambda c: "without anti-aliasing" if c.antialias == "none" else f"with --antialias {c.antialias}")

    def longer(self, offset, confidence=0.95):
        """By how many % an offset takes longer than the chosen offset, in the views of judged_by."""
        return estimate(100 * (self.judged_by[:, offset] / self.judged_by[:, self.chosen] - 1), confidence)

    def loss(self, ms):
        return 100 * (ms / self.best["total_ms"] - 1) if self.best["total_ms"] > 0 else 0


def choices_of(lab, scene):
    size = lab.size(default_size(scene))
    ensemble = lab.ensemble(scene, size, "supersample", VIEWS)
    numbers = [size] + [pes for pes in (256, 64) if pes != size and pes <= size * size]
    return [Choice(scene, size, pes, method, ensemble) for pes in numbers for method in METHODS]


@study("best-offset")
def best_offset(lab, scenes):
    some = scenes or [raya.example("centre")]
    by_scene = [choices_of(lab, scene) for scene in some]
    every = [choice for choices in by_scene for choice in choices]
    first = by_scene[0]
    named = [{"scene": choices[0].scene, "size": choices[0].size, "format": format_for(scene), "fold": "cyclic"}
             for choices, scene in zip(by_scene, some)]
    return Page({"scenes": named, "factor": FACTOR, "views": VIEWS, "rule": MAX_LOSS},
                [*map(finding_of_best, by_scene), *map(finding_of_views, every), *map(finding_of_choice, every)],
                [Comparison(f"best p, {c.pes} PEs, {c.antialias}", "", None, int(c.best["offset"]),
                            f"u of the first pass {c.best['imbalance']:.3f}; sqrt(P), Kohata & Ito's, is p = {c.root}")
                 for c in first],
                [claim_of_enough(first), claim_of_square(first)], tables_of(every),
                [plot for number, choices in enumerate(by_scene, 1) for plot in plots_of(choices, number)],
                ["Kohata & Ito discuss balance against communication without figures. This study computes the fastest offset for each "
                 "number of PEs and each anti-aliasing method, and how the clock's uncertainty changes it."],
                clock=CLOCK)


def finding_of_best(choices):
    first = choices[0]
    answer = ", ".join(f"--offset {c.best['offset']:.0f} {c.method}" for c in choices if c.pes == first.pes)
    return f"Use {answer}: {first.scene} at {first.size} x {first.size} pixels on {first.pes} PEs."


def finding_of_views(c):
    picture = int(c.best["offset"])
    near, root, zero, own = (c.longer(offset).text(1) for offset in (c.chosen_near, c.root, 0, picture))
    return (f"{c.scene}, {c.pes} PEs, {c.method}: one half of {len(c.chosen_by) + len(c.judged_by)} views chooses p = {c.chosen}, which "
            f"takes {c.time.text(1)} ms in the other half. There p = {c.chosen_near}, the best of 0..sqrt(P), takes {near} % longer, "
            f"p = {c.root} {root} %, p = 0 {zero} %, and p = {picture}, the best for the scene's own picture, {own} %.")


def finding_of_choice(c):
    total, root, zero = c.best["total_ms"], c.times["total_ms"][c.root], c.times["total_ms"][0]
    near = (f"no offset above sqrt(P) = {c.root} is faster" if c.best_near["offset"] == c.best["offset"] else
            f"the best of 0..sqrt(P) is p = {c.best_near['offset']:.0f}, {c.loss(c.best_near['total_ms']):.1f} % "
            "slower")
    of_root = "" if c.root == c.best["offset"] else f"p = {c.root} takes {c.loss(root):.1f} % longer, "
    ring = 100 * c.best["ring_ms"] / total if total > 0 else 0
    return (f"{c.scene}, {c.pes} PEs, {c.method}: p = {c.best['offset']:.0f} takes {total:.1f} ms, {ring:.1f} % of it "
            f"on the ring, u of the first pass {c.best['imbalance']:.3f}; {near}; {of_root}p = 0 takes "
            f"{c.loss(zero):.1f} % longer; the best offset for factors of 1 to 8: p = {c.factors}.")


def claim_of_enough(choices):
    near = [c.longer(c.chosen_near, bonferroni_confidence(len(choices))) for c in choices]
    more, none = sum(e.low > MAX_LOSS for e in near), sum(e.high <= MAX_LOSS for e in near)
    return Claim(papers.SPA, "section on the cyclic mapping",
                 "Offsets of 0..sqrt(P) are enough, communication with neighbours considered.",
                 verdict(none == len(near), more > 0),
                 f"In {none} of {len(near)} cases (numbers of PEs and anti-aliasing methods) the best of 0..sqrt(P) takes with "
                 f"certainty at most {MAX_LOSS} % longer than the best of all, in {more} cases longer than that.")


def claim_of_square(choices):
    cases = equal = 0
    for c in choices:
        square = c.root * c.root
        if square == c.pes and square < len(c.times):
            ms = np.concatenate([[c.times["total_ms"]], c.chosen_by, c.judged_by])
            cases, equal = cases + len(ms), equal + (ms[:, square] == ms[:, 0]).sum()
    return Claim(papers.SPA, "section on the cyclic mapping", "On n x n PEs p = n^2 is the same as p = 0.",
                 verdict(cases > 0 and equal == cases, equal < cases),
                 f"Offsets n^2 and 0 take the same time in {equal} of {cases} cases (pictures and anti-aliasing methods), for the "
                 "numbers n x n of PEs at which n^2 is less than the image's width.")


def tables_of(every):
    views, best, offsets = [], [], []
    for c in every:
        head = {"scene": c.scene, "PEs": c.pes, "anti-aliasing": c.antialias}
        time, near, root, zero = (c.time, c.longer(c.chosen_near), c.longer(c.root), c.longer(0))
        views.append({**head, "best p": c.chosen, "time (ms)": time.mean, "time, +- (ms)": time.half,
                      "best p of 0..sqrt(P)": c.chosen_near, "it takes longer (%)": near.mean, "it, +- (%)": near.half,
                      "p = sqrt(P) takes longer (%)": root.mean, "p = sqrt(P), +- (%)": root.half,
                      "p = 0 takes longer (%)": zero.mean, "p = 0, +- (%)": zero.half})
        best.append({"scene": c.scene, "size": c.size, "PEs": c.pes, "anti-aliasing": c.antialias,
                     "best p": int(c.best["offset"]), "best p, factors 1 to 8": c.factors,
                     "time (ms)": c.best["total_ms"], "of it ring (ms)": c.best["ring_ms"],
                     "u, first pass": c.best["imbalance"], "best p of 0..sqrt(P)": int(c.best_near["offset"]),
                     "its time (ms)": c.best_near["total_ms"], "its u": c.best_near["imbalance"],
                     "p = sqrt(P) (ms)": c.times["total_ms"][c.root], "p = 0 (ms)": c.times["total_ms"][0]})
        t = c.times
        offsets.append(pd.DataFrame({**head, "p": t["offset"], "u, first pass": t["imbalance"],
                                     "first pass (ms)": t["trace_ms"], "neighbours' arithmetic (ms)": t["smooth_ms"],
                                     "supersampling (ms)": t["supersample_ms"], "rotations": t["rotations"],
                                     "ring (ms)": t["ring_ms"], "total (ms)": t["total_ms"]}))
    return [Table("best-offset-views", "Offsets chosen by one half of the views, judged in the other half", views),
            Table("best-offset", "Best offsets, modelled", best),
            Table("best-offset-all", "Every offset", pd.concat(offsets, ignore_index=True), on_page=False)]


def plots_of(choices, number):
    """A plot for each number of PEs, with a line for each anti-aliasing method; the best offset is marked."""
    for pes in dict.fromkeys(c.pes for c in choices):
        series = []
        for c in (c for c in choices if c.pes == pes):
            series += [Series("no anti-aliasing" if c.antialias == "none" else c.antialias, c.times["offset"],
                              c.times["total_ms"]),
                       Series(f"its best: p = {c.best['offset']:.0f}", [c.best["offset"]], [c.best["total_ms"]],
                              "points")]
        yield Plot(f"best-offset-{number}-{pes}pes", f"{c.scene} at {c.size} x {c.size} on {pes} PEs",
                   "offset p (pixels)", "computing and rotations (modelled ms)", series, "y")
