"""Modelled times of the SPA (Kohata & Ito 1993), all with the same clock model. The text CLOCK describes the model and its uncertainty."""
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pandas as pd
import raya
from raya.lab import papers
from raya.lab.laboratory import SPA, first_scene, format_for

ROUNDING = 0.5  # ms: the tables print whole milliseconds
FACTORS = list(range(1, 9))  # factors of the clock for which conclusions are shown


FACTOR = SPA["cycle_factor"]
# The filter's arithmetic takes 9 - 2 = 19 - 12 = 7 ms (Tables 3 and 4); each of these four times is rounded to 1 ms.
FACTOR_MIN, FACTOR_MAX = (FACTOR * (1 + rounding_ms / papers.FILTER_ARITHMETIC_MS) for rounding_ms in (-2 * ROUNDING, 2 * ROUNDING))
CLOCK = (f"modelled (docs/architecture.md). Computing time = cycles of the instruction budget x 100 ns x the clock's factor of {FACTOR:.2f} "
         f"({FACTOR_MIN:.2f} .. {FACTOR_MAX:.2f} by the rounding of printed times). The factor is the 7 ms of the filter's arithmetic [D] "
         "divided by its time by the budget. Rotations, exchanges and transfers have rates from printed times. Nothing is fitted to a "
         "scene. We assume that the factor also holds for ray tracing, and show conclusions for factors of 1 to 8.")


def spa_ms(cycles):
    """Returns the milliseconds in which a PE executes modelled cycles, without the clock's factor."""
    return cycles * SPA["cycle_ns"] * 1e-6


def host_model():
    """Returns the (minimum, maximum) of the host model's set-up of a call (ms), rotation (ms), and words per second. Follows from the printed
    times of 2 and 34 rotations (Table 4) and of a transfer of 256 x 256 x 3 words (Table 2), each rounded to 1 ms."""
    few, many = 2, 34
    few_ms, many_ms, image_ms = (np.array([value - ROUNDING, value + ROUNDING]) for value in
                                 (papers.EXCHANGE_0_MS, papers.EXCHANGE_16_MS, papers.IMAGE_MS))
    # few_ms = setup + 2 r and many_ms = setup + 34 r give setup = (34 few_ms - 2 many_ms) / 32.
    setup = (many * few_ms - few * many_ms[::-1]) / (many - few)
    rotation = (many_ms - few_ms[::-1]) / (many - few)
    rate = 3e3 * papers.SIZE**2 / (image_ms - setup[::-1])[::-1]
    return setup, rotation, rate


def time_of(result, factor=FACTOR):
    """Returns the modelled_ms of a result's report, computed with this factor of the clock."""
    t, ratio = dict(result.report["modelled_ms"]), factor / FACTOR
    t["total"] += (ratio - 1) * t["compute"]
    for part in ("compute", "filter", "compare"):
        t[part] *= ratio
    return t


def run_on_spa(lab, scene, size, pes, offset, antialias="none"):
    """Renders on PEs of the SPA; if the scene does not fit into them, without their memory limit. Returns the result."""
    options = dict(size=size, pes=pes, offset=offset, antialias=antialias, format=format_for(scene), accel="none", split=1,
                   cost=True)
    try:
        return lab.render(scene, machine="spa", **options)
    except raya.DoesNotFit:
        return lab.render(scene, machine="grande", bounces=SPA["bounces"], **options)


def offset_times(costs, pes, antialias, factor=FACTOR):
    """Returns a data frame of modelled times with the cyclic fold, one row per offset: offset, imbalance, trace_ms, smooth_ms (filter or comparison),
    supersample_ms, ring_ms (exchange), rotations, total_ms. Broadcast and gather are excluded: their times are the same for every offset."""
    times = pd.DataFrame(raya.offset_times(costs.trace, pes, antialias,
                                           costs.supersample if antialias == "supersample" else None))
    times[["trace_ms", "smooth_ms", "supersample_ms"]] *= factor / FACTOR
    times["total_ms"] = times["trace_ms"] + times["smooth_ms"] + times["supersample_ms"] + times["ring_ms"]
    return times


@dataclass
class SmoothingRuns:
    """Anti-aliased renders of a scene with a PE for each column, at offsets 0, 8 and 16. times() computes the times of all offsets from `costs`."""

    scene: raya.Scene
    size: int
    antialias: str
    runs: dict  # {offset: raya.Result}
    costs: object  # cost images `trace` and `supersample`, as in Costs

    def rows(self, factor=FACTOR):
        """Returns a data frame with a row for each rendered offset; times in ms."""
        all_rows = []
        for p, run in self.runs.items():
            t, load = time_of(run, factor), run.report["load"]
            last_load = load["supersample" if self.antialias == "supersample" else "trace"]
            all_rows.append({"p": p, "rotations": run.report["communication"]["rotations"], "communication": t["communication"],
                             "filter": t["filter"], "compare": t["compare"], "trace": factor * spa_ms(load["trace"]["max"]),
                             "supersample": factor * spa_ms(last_load["max"]), "u": last_load["imbalance"]})
        rows = pd.DataFrame(all_rows)
        rows["filtering"], rows["alone"] = rows["filter"] + rows["communication"], rows["compare"] + rows["supersample"]
        return rows.assign(filtered=rows["trace"] + rows["filtering"], with_first=rows["alone"] + rows["trace"])

    def times(self, factor=FACTOR):
        return offset_times(self.costs, self.size, self.antialias, factor)

    @property
    def recomputed(self):
        """Fraction of the pixels that were supersampled, 0..1."""
        return list(self.runs.values())[-1].report["antialias"].get("recomputed_pixels", 0) / self.size**2


def smoothing_runs(lab, scenes, antialias):
    scene, size = first_scene(scenes), lab.size(256)
    runs = {p % size: run_on_spa(lab, scene, size, size, p % size, antialias) for p in (0, 8, 16)}
    costs = list(runs.values())[-1].costs
    return SmoothingRuns(scene, size, antialias, runs, SimpleNamespace(**{"supersample": costs["trace"], **costs}))


def default_size(scene):
    """Returns the default pixels per side of the study best-offset: the scene's image size if it is square, else 256. Halves the size while pixels x
    objects exceed 2^30, because larger renders take minutes."""
    square = scene.width == scene.height and 16 <= scene.width <= 4096
    size = scene.width if square else 256
    while size // 2 >= 64 and size * size * scene.objects > 2**30:
        size //= 2
    return size
