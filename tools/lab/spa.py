"""Modelled times of the SPA on one clock, and how sure it is: CLOCK tells."""
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pandas as pd
import raya
from raya.lab import papers
from raya.lab.laboratory import SPA, format_for, one_of

ROUNDING = 0.5  # ms: the tables print whole ones
FACTORS = list(range(1, 9))


def spa_ms(cycles):
    """Milliseconds of a PE for so many modelled cycles, without a factor."""
    return cycles * SPA["cycle_ns"] * 1e-6


FILTER_BUDGET_MS = spa_ms(raya.filter_cycles(papers.SIZE))
# 9 - 2 and 19 - 12 ms: each of the four is rounded, and both differences are met.
FACTOR, FACTOR_LEAST, FACTOR_MOST = ((papers.FILTER_ARITHMETIC_MS + off) / FILTER_BUDGET_MS
                                     for off in (0, -2 * ROUNDING, 2 * ROUNDING))
CLOCK = (f"modelled, one clock: the budget's cycles of 100 ns times {FACTOR:.2f} ({FACTOR_LEAST:.2f} .. "
         f"{FACTOR_MOST:.2f} by rounding), which is the filter's factor, 7 ms [D] over what the budget gives it and of "
         "no scene; rotations, exchanges and transfers at the rates of the real machine. Nothing is fitted to a scene. "
         "That the factor holds for ray tracing too is an assumption: conclusions are shown for factors of 1 to 8.")


def host_model():
    """What a call of the host takes, (least, most), from printed ms: of 2 and 34 rotations, of 256 x 256 x 3 words."""
    few, many = 2, 34
    few_ms, many_ms, image_ms = (np.array([value - ROUNDING, value + ROUNDING]) for value in
                                 (papers.EXCHANGE_0_MS, papers.EXCHANGE_16_MS, papers.IMAGE_MS))
    # few_ms = setup + 2 r and many_ms = setup + 34 r give setup = (34 few_ms - 2 many_ms) / 32.
    setup = (many * few_ms - few * many_ms[::-1]) / (many - few)
    rotation = (many_ms - few_ms[::-1]) / (many - few)
    rate = 3e3 * papers.SIZE**2 / (image_ms - setup[::-1])[::-1]
    return {"setup_ms": tuple(setup), "rotation_ms": tuple(rotation), "words_per_s": tuple(rate)}


@dataclass
class SpaRun:
    """An image made on PEs of the SPA, or on the same PEs without a limit of memory where the scene does not fit."""

    result: raya.Result
    report: dict

    def time(self, factor=FACTOR):
        """The report's modelled_ms with computing times a factor, and the set-up of exchanges."""
        t = dict(self.report["modelled_ms"])
        more = (factor - 1) * t["compute"]
        setup = papers.EXCHANGE_SETUP_MS if self.rotations else 0
        t.update(compute=factor * t["compute"], filter=factor * t["filter"], compare=factor * t["compare"],
                 communication=t["communication"] + setup, total=t["total"] + more + setup)
        return t

    @property
    def rotations(self):
        return self.report["communication"]["rotations"]


def run_on_spa(lab, scene, size, pes, offset, antialias="none"):
    options = dict(size=size, pes=pes, offset=offset, antialias=antialias, format=format_for(scene), accel="none",
                   cost=True)
    try:
        result = lab.render(scene, machine="spa", **options)
    except raya.DoesNotFit:
        result = lab.render(scene, machine="grande", bounces=SPA["bounces"], **options)
    return SpaRun(result, result.report)


def offset_times(costs, pes, antialias, factor=FACTOR):
    """Modelled ms of every offset, cyclic fold: offset, imbalance, trace_ms, smooth_ms, supersample_ms, ring_ms,
    rotations, total_ms. Broadcast and gather are not in it: they take the same for every offset."""
    times = pd.DataFrame(raya.offset_times(costs.trace, pes, antialias,
                                           costs.supersample if antialias == "supersample" else None))
    times[["trace_ms", "smooth_ms", "supersample_ms"]] *= factor
    if antialias != "none":
        times["ring_ms"] += papers.EXCHANGE_SETUP_MS
    times["total_ms"] = times["trace_ms"] + times["smooth_ms"] + times["supersample_ms"] + times["ring_ms"]
    return times


@dataclass
class SmoothingRuns:
    """A scene smoothed with a PE for each column: the offsets 0, 8 and 16 rendered, every one from their costs."""

    scene: raya.Scene
    size: int
    antialias: str
    runs: dict  # by offset: SpaRun
    costs: object

    def rows(self, factor=FACTOR):
        """A row of each offset that was rendered; times in ms."""
        all_rows = []
        for p, run in self.runs.items():
            t, load = run.time(factor), run.report["load"]
            last = load["supersample" if self.antialias == "supersample" else "trace"]
            row = {"p": p, "rotations": run.rotations, "communication": t["communication"], "filter": t["filter"],
                   "compare": t["compare"], "trace": factor * spa_ms(load["trace"]["max"]),
                   "supersample": factor * spa_ms(last["max"]), "u": last["imbalance"]}
            row["filtering"] = row["filter"] + row["communication"]
            row["filtered"] = row["trace"] + row["filtering"]
            row["alone"] = row["compare"] + row["supersample"]
            row["with_first"] = row["alone"] + row["trace"]
            all_rows.append(row)
        return pd.DataFrame(all_rows)

    def times(self, factor=FACTOR):
        return offset_times(self.costs, self.size, self.antialias, factor)

    @property
    def recomputed(self):
        """Share of the pixels."""
        report = list(self.runs.values())[-1].report
        return report["antialias"].get("recomputed_pixels", 0) / self.size**2


def smoothing_runs(lab, scenes, antialias):
    scene, size = one_of(scenes), lab.size(256)
    runs = {p % size: run_on_spa(lab, scene, size, size, p % size, antialias) for p in (0, 8, 16)}
    costs = list(runs.values())[-1].result.costs
    return SmoothingRuns(scene, size, antialias, runs, SimpleNamespace(**{"supersample": costs["trace"], **costs}))


def usual_size(scene):
    """Pixels a side in which a scene's offsets are compared: its own where it is square, else 256; halved while the
    scene's objects would make it take minutes."""
    square = scene.width == scene.height and 16 <= scene.width <= 4096
    size = scene.width if square else 256
    while size // 2 >= 64 and size * size * scene.objects > 2**30:
        size //= 2
    return size
