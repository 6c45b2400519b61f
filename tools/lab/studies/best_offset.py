"""The best offset for a scene

Which offset of the cyclic mapping renders this image fastest, communication included?

- Source: Kohata & Ito 1993, section on the cyclic mapping: offsets 0..sqrt(P) are enough; on n x n PEs p = n^2 equals p = 0.
- Time of an offset (modelled ms, at the SPA's rates): the busiest PE's computing in the first pass and in supersampling, the arithmetic of the
  filter or of the comparison of neighbours, and the minimum number of rotations that bring the neighbouring pixels. The scene's broadcast and the
  transfer of the image are excluded, because they take the same time for every offset.
- Numbers of PEs P: one per image column, 256 and 64. If P is smaller than the number of columns, PE i owns the columns i, i + P, ... of row 0
  (cyclic fold). sqrt(P) is rounded. All PEs have enough memory for the pixels that rotate on the ring; the SPA's have it only for few pixels per PE.
- Image size: that of the scene if it is square, smaller if the scene has so many objects that rendering would take minutes; --size overrides it.
- {search} choose the offset: that with the shortest time over these views, the smallest of equally fast ones. {evaluation} evaluate it; times are
  compared within the same view. So the result holds for the scene and not only for one picture. The study recommends the chosen offset if the
  evaluation shows that it is faster than p = sqrt(P), otherwise p = sqrt(P).
- The claim is tested on the scene families of study fig8: seeds {claim_search} on choose, seeds {claim_evaluation} on evaluate.
- Output: best-offset-views.csv, best-offset.csv and best-offset-all.csv (every offset). Times are in ms, u is (max load - mean load) / mean
  load, and "takes longer" is in % of the chosen offset's time.
"""
import pandas as pd
from raya.lab import Comparison, Page, Plot, Series, Table, below, estimate, every, first_scene, judged, papers, study
from raya.lab.laboratory import SEEDS, format_for
from raya.lab.spa import CLOCK, FACTOR, FACTORS, default_size, offset_times

VIEWS, MAX_LOSS = 20, 1  # number of views that choose an offset, and of views that evaluate it; bound of the claim root-is-enough, %
METHODS = ("none", "filter", "supersample")


def total_times(ensemble, pes, antialias):
    """Returns an array [picture, offset] of modelled times (ms)."""
    return ensemble.map(lambda costs: offset_times(costs, pes, antialias)["total_ms"])


class Choice:
    """Times of all offsets for one scene, one number of PEs and one anti-aliasing method, and the offsets chosen from them."""

    def __init__(self, scene, size, pes, antialias, picture, search, evaluation):
        self.scene, self.size, self.pes, self.antialias = scene.name, size, pes, antialias
        self.root = round(pes**0.5) % size
        self.times = offset_times(picture, pes, antialias)
        self.chosen_by, self.judged_by = (total_times(one, pes, antialias) for one in (search, evaluation))  # [view, offset]
        total = self.times["total_ms"]
        self.best, self.best_near = (self.times.loc[candidates.idxmin()] for candidates in (total, total[:self.root + 1]))
        sums = self.chosen_by.sum(0)
        self.chosen, self.chosen_near = int(sums.argmin()), int(sums[:self.root + 1].argmin())
        self.time = estimate(self.judged_by[:, self.chosen])
        # The best offsets with the clock factors FACTORS, without repetitions.
        self.factors = ", ".join(dict.fromkeys(
            str((self.times["ring_ms"] + f / FACTOR * (total - self.times["ring_ms"])).idxmin()) for f in FACTORS))

    method = property(lambda c: "without anti-aliasing" if c.antialias == "none" else f"with --antialias {c.antialias}")

    def longer(self, offset, confidence=0.95):
        """Returns an estimate of the % by which an offset takes longer than the chosen offset, from the views of judged_by."""
        return estimate(100 * (self.judged_by[:, offset] / self.judged_by[:, self.chosen] - 1), None, confidence)

    def loss(self, ms):
        return 100 * (ms / self.best["total_ms"] - 1) if self.best["total_ms"] > 0 else 0


def ensembles_of(lab, scene=None):
    """Returns the ensembles that choose and evaluate an offset: views of a scene, or pictures of the scene families for the claim."""
    if scene is None:
        return [lab.ensemble([], papers.SIZE, "supersample", part=part) for part in (0, 2)]
    return [lab.ensemble([scene], lab.size(default_size(scene)), "supersample", VIEWS, part=part) for part in (0, 2)]


def numbers_of_pes(size):
    return [size] + [pes for pes in (256, 64) if pes != size and pes <= size * size]


def prepare(lab, scenes):
    for scene in scenes or [first_scene([]), None]:
        ensembles_of(lab, scene)


@study("best-offset", prepare=prepare)
def best_offset(lab, scenes):
    by_scene, scene_settings = [], []
    for scene in scenes or [first_scene([])]:
        size = lab.size(default_size(scene))
        picture, ensembles = lab.costs(scene, size, "supersample"), ensembles_of(lab, scene)
        by_scene.append([Choice(scene, size, pes, method, picture, *ensembles) for pes in numbers_of_pes(size) for method in METHODS])
        scene_settings.append({"scene": scene.name, "size": size, "format": format_for(scene), "fold": "cyclic"})
    all_choices = [choice for choices in by_scene for choice in choices]
    search_seeds, evaluation_seeds = (f"from {lab.seed + part * SEEDS}" for part in (0, 2))
    return Page({"scenes": scene_settings, "factor": FACTOR, "views": 2 * VIEWS, "rule": MAX_LOSS},
                [*map(finding_of_best, by_scene), *map(finding_of_views, all_choices)],
                [Comparison(f"best p, {c.pes} PEs, {c.antialias}", "", None, int(c.best["offset"]),
                            f"u of the first pass is {c.best['imbalance']:.3f}; Kohata & Ito's p = sqrt(P) is {c.root}")
                 for c in by_scene[0]],
                [claim_of_enough(lab)] if not scenes else [], tables_of(all_choices),
                [plot for number, choices in enumerate(by_scene, 1) for plot in plots_of(choices, number)],
                clock=CLOCK, placeholders={
                    "search": f"{VIEWS} views with seeds {search_seeds}", "evaluation": f"{VIEWS} other views with seeds {evaluation_seeds}",
                    "claim_search": search_seeds, "claim_evaluation": evaluation_seeds})


def finding_of_best(choices):
    """Returns a sentence with the recommended offset for each anti-aliasing method, on the largest array."""
    first = choices[0]
    texts = []
    for c in (c for c in choices if c.pes == first.pes):
        gain = c.longer(c.root)
        better = c.chosen != c.root and gain.low > 0
        texts.append(f"--offset {c.chosen if better else c.root} {c.method} " + (
            f"(p = {c.root} takes {gain.text(1)} % longer)" if better else "(the evaluation shows no faster one)"))
    return f"For {first.scene} at {first.size} x {first.size} pixels on {first.pes} PEs use {', '.join(texts)}."


def finding_of_views(c):
    picture = int(c.best["offset"])
    near, root, zero, of_picture = (c.longer(offset).text(1) for offset in (c.chosen_near, c.root, 0, picture))
    return (f"{c.scene}, {c.pes} PEs, {c.method}: {len(c.chosen_by)} views choose p = {c.chosen}, and p = {c.chosen_near} of the offsets "
            f"0..sqrt(P). In {len(c.judged_by)} other views p = {c.chosen} takes {c.time.text(1)} ms; p = {c.chosen_near} takes {near} % longer, "
            f"p = sqrt(P) = {c.root} {root} %, p = 0 {zero} %, and p = {picture}, the best for the scene's own view, {of_picture} %.")


def claim_of_enough(lab):
    search, evaluation = ensembles_of(lab)
    families, tests, tests_of_5, texts = evaluation.families, [], [], []
    for pes in numbers_of_pes(papers.SIZE):
        for method in METHODS:
            chosen_by, judged_by = (total_times(one, pes, method) for one in (search, evaluation))
            sums, root = chosen_by.sum(0), round(pes**0.5)
            near, chosen = int(sums[:root + 1].argmin()), int(sums.argmin())
            loss = 100 * (judged_by[:, near] / judged_by[:, chosen] - 1)
            tests.append(below(loss, MAX_LOSS, families, 2))
            tests_of_5.append(below(100 * (judged_by[:, 5] / judged_by[:, chosen] - 1), MAX_LOSS, families, 2))
            texts.append(f"{pes} PEs, {method}: p = {near} takes {estimate(loss, families).text(2)} % longer than p = {chosen}")
    return judged("root-is-enough", every(tests), f"chosen by {search.description}; evaluated with other seeds", "; ".join(texts) + ".", {"p = 5": every(tests_of_5)})


def tables_of(choices):
    views, best, offsets = [], [], []
    for c in choices:
        head, time, t = {"scene": c.scene, "PEs": c.pes, "anti-aliasing": c.antialias}, c.time, c.times
        views.append({**head, "best p": c.chosen, "time (ms)": time.mean, "time, +- (ms)": time.half,
                      "best p of 0..sqrt(P)": c.chosen_near})
        for name, offset in (("best p of 0..sqrt(P)", c.chosen_near), ("p = sqrt(P)", c.root), ("p = 0", 0)):
            longer = c.longer(offset)
            views[-1].update({f"{name} takes longer (%)": longer.mean, f"{name}, +- (%)": longer.half})
        best.append({"scene": c.scene, "size": c.size, "PEs": c.pes, "anti-aliasing": c.antialias,
                     "best p": int(c.best["offset"]), "best p, factors 1 to 8": c.factors,
                     "time (ms)": c.best["total_ms"], "time on the ring (ms)": c.best["ring_ms"], "u, first pass": c.best["imbalance"],
                     "best p of 0..sqrt(P)": int(c.best_near["offset"]), "best p of 0..sqrt(P), time (ms)": c.best_near["total_ms"],
                     "best p of 0..sqrt(P), u": c.best_near["imbalance"], "p = sqrt(P) (ms)": c.times["total_ms"][c.root],
                     "p = 0 (ms)": c.times["total_ms"][0]})
        offsets.append(pd.DataFrame({**head, "p": t["offset"], "u, first pass": t["imbalance"],
                                     "first pass (ms)": t["trace_ms"], "neighbours' arithmetic (ms)": t["smooth_ms"],
                                     "supersampling (ms)": t["supersample_ms"], "rotations": t["rotations"],
                                     "ring (ms)": t["ring_ms"], "total (ms)": t["total_ms"]}))
    return [Table("best-offset-views", "Offsets chosen by half of the views, evaluated in the other half", views),
            Table("best-offset", "Best offsets for the scene's own view, modelled", best),
            Table("best-offset-all", "Every offset", pd.concat(offsets, ignore_index=True), on_page=False)]


def plots_of(choices, number):
    """Yields a plot for each number of PEs, with a line for each anti-aliasing method and a point at its best offset."""
    for pes in dict.fromkeys(c.pes for c in choices):
        series = []
        for c in (c for c in choices if c.pes == pes):
            series += [Series("no anti-aliasing" if c.antialias == "none" else c.antialias, c.times["offset"],
                              c.times["total_ms"]),
                       Series(f"its best: p = {c.best['offset']:.0f}", [c.best["offset"]], [c.best["total_ms"]],
                              "points")]
        yield Plot(f"best-offset-{number}-{pes}pes", f"Time against the offset: {c.scene} at {c.size} x {c.size} on {pes} PEs",
                   "offset p (pixels)", "computing and rotations (modelled ms)", series, "y")
