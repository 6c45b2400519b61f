"""Finding a ray's nearest hit: all objects, a grid, a BVH

From how many objects on is a grid or a BVH faster than testing all objects, which of the two is faster, and how does time grow with the
number of objects?

- Source: none of the papers. The study measures this computer. The scenes balls are SPD's (Haines 1987); `tools/peers` compares with Embree.
- Renderer: raya's machine `grande` (the SPA's ring without its memory limit) in fp32, {size} x {size} pixels, each PE with a tile of {tile} x {tile},
  {bounces} bounces; `--accel` none, grid (default number of voxels) or bvh. The study fails if two of these methods give different images.
- Scenes: {scenes}
- The time of a render (ms) starts with the packed scene and ends with the image; it excludes building kernels, grid and BVH. A sample is the
  mean of as many renders as take 20 ms. The methods are timed in turn, up to {rounds} times each, but not again after {sampling_s} s of samples.
- A render without an accelerator is skipped if its predicted time exceeds {max_render_s} s: the number of rays times the number of objects times
  the time of one test in the last scene that was rendered without an accelerator.
- Counts: a test is an intersection test of any ray with any object; a step is a voxel or BVH node that a ray enters; memory (KB) is that of the
  scene with its grid or BVH on one PE. Build (ms) is measured: the time to make the grid or BVH on the host.
- Scenes that differ only in their seed form a group; figures are means over the group. The ratio of two methods' times is averaged over the scenes
  of a group, or over the turns if the group is a single scene. A method counts as faster if the 95 % interval of the mean ratio excludes 1 (if
  there is only one ratio: if it is not 1).
- Growth: the exponent e in time per ray = c n^e, and in tests per ray = c n^e, for n objects: a least-squares fit of the logarithms for each seed
  over the scenes of {min_fitted} or more objects.
- Output: accel.csv has a row for each group of scenes and method, accel-scenes.csv one for each scene and method (words have 32 bits),
  accel-growth.csv the exponents. Columns +- are half widths of 95 % intervals.
"""
import math
from functools import partial

import numpy as np
import pandas as pd
import raya
from raya.lab import Page, Plot, Table, estimate, first_from, fitted_exponent, mean_seconds, series_by, study
from raya.lab.laboratory import rays_of, tests_of

NONE, GRID, BVH = "none", "grid", "bvh"
BOUNCES, ROUNDS, MAX_RENDER_S, SAMPLING_S, SEEDS = 4, 5, 30, 10, 5
MIN_FITTED_OBJECTS = 100  # minimum number of objects of a scene that the fit uses
USER_SCENES = "named"
# {member of a row: column of the table}; a row has the figures of one scene and one method.
EACH = {**{name: name for name in ("scene", "seed", "objects", "method", "rays", "tests", "steps")}, "best": "best (ms)",
        "median": "median (ms)", "samples": "samples", "build": "build (ms)", "scene_words": "scene words",
        "accel_words": "accelerator words"}


# (series, group, seed, function that makes the scene)
OWN_SCENES = [*(("balls", f"balls {level}", 0, partial(raya.generate.balls, level)) for level in range(1, 7)),
              *(("random", f"random {count}", seed, partial(raya.generate.random, count, seed))
                for count in (10, 100, 1_000, 10_000, 100_000) for seed in range(1, SEEDS + 1))]


class Method:
    """One scene with one method, ready to be timed. `seconds`: the timing samples; `turns`: the shortest time of each turn (ms)."""

    def __init__(self, name, turn, hash="", **figures):
        self.name, self.turn, self.hash, self.figures, self.seconds, self.turns = name, turn, hash, figures, [], []


def raya_method(lab, scene, size, name):
    tile = math.gcd(size, 16)
    options = dict(machine="grande", format="fp32", size=size, pes=size, mapping=f"tiles:{tile}x{tile}",
                   bounces=BOUNCES, accel=name)
    first = lab.render(scene, **options)
    e, words = first.events, first.report["accel"].get("words", 0)
    return Method(name, lambda: [mean_seconds(lambda: lab.render(scene, **options).render_s)], first.hash, rays=rays_of(e), tests=tests_of(e),
                  steps=e["steps"], scene_words=first.job_words - words, accel_words=words, build=1e3 * first.accel_s)


def measure(lab, size, scenes):
    """Measures all methods on all scenes. Returns (table with a row for each scene and method, names of the scenes that are not rendered without an
    accelerator)."""
    rows, skipped, test_s = [], [], 1e-9  # test_s: seconds per object test; a low estimate until the first measurement
    for series, group, seed, make in scenes:
        scene = make()
        methods = [raya_method(lab, scene, size, name) for name in (GRID, BVH)]
        predicted = test_s * methods[0].figures["rays"] * scene.objects
        if predicted > MAX_RENDER_S:
            skipped.append(f"{group} ({scene.objects} objects, about {predicted:.0f} s)")
        else:
            methods.insert(0, raya_method(lab, scene, size, NONE))
        for method in methods[1:]:
            if method.hash != methods[0].hash or method.figures["rays"] != methods[0].figures["rays"]:
                raise raya.DeviceError(f"{group}: --accel {method.name} and {methods[0].name} give different images, {method.hash} and "
                                       f"{methods[0].hash}: an error of the device or its compiler; run `raya verify`")
        for turn in range(ROUNDS):
            for method in methods:
                if turn == 0 or sum(method.seconds) < SAMPLING_S:
                    seconds = method.turn()
                    method.seconds += seconds
                    method.turns.append(1e3 * min(seconds))
        for method in methods:
            if method.name == NONE:
                test_s = min(method.seconds) / (method.figures["rays"] * scene.objects)
            rows.append({"series": series, "scene": group, "seed": seed, "objects": scene.objects, "method": method.name,
                         **method.figures, "best": 1e3 * min(method.seconds), "median": 1e3 * np.median(method.seconds),
                         "samples": len(method.seconds), "turns": method.turns})
    return pd.DataFrame(rows), skipped


def ratios(rows, method, other):
    """Returns {group, objects, times: Estimate of the ratio of two methods' times} for each group; uses the scenes rendered with both."""
    found = []
    both = rows[rows["method"] == method].merge(rows[rows["method"] == other], on=["series", "scene", "seed", "objects"], suffixes=("", " of other"))
    for group, scene_pairs in both.groupby("scene", sort=False):
        times = scene_pairs["best"] / scene_pairs["best of other"]
        if len(scene_pairs) == 1:
            times = [x / y for x, y in zip(scene_pairs["turns"].iloc[0], scene_pairs["turns of other"].iloc[0])]
        found.append({"group": group, "objects": scene_pairs["objects"].iloc[0], "times": estimate(times)})
    return found


def text_of(e):
    mean, half = (f"{value:.2f}" if value < 100 else f"{value:.0f}" for value in (e.mean, e.half))
    return mean if np.isnan(e.half) else f"{mean} +- {half}"


def ratios_text(ratio_list):
    return ", ".join(f"{text_of(ratio['times'])} ({ratio['group']})" for ratio in ratio_list)


@study("accel", measures=True)
def accel(lab, scenes):
    size = lab.size(256)
    measured_scenes = [(USER_SCENES, s.name, 0, lambda s=s: s) for s in scenes] if scenes else OWN_SCENES
    runs, skipped = measure(lab, size, measured_scenes)
    rows, growth = rows_of(runs), growth_of(runs)
    series = [(name, one) for name, one in runs.groupby("series", sort=False)]
    findings = [*(finding_of_threshold(one, name) for name, one in series), finding_of_faster(runs, GRID, BVH)]
    findings += [f"Not rendered without an accelerator: {', '.join(skipped)}."] if skipped else []
    each = runs[list(EACH)].fillna(0).astype(
        {name: int for name in ("tests", "steps", "scene_words", "accel_words")}).rename(columns=EACH)
    tables = [Table("accel", "Each number of objects and method", rows.drop(columns=["series"])),
              Table("accel-scenes", "Each scene and method", each, on_page=False)]
    tables += [Table("accel-growth", "Exponent of the number of objects in the time per ray and in the tests per ray", growth)] if len(growth) else []
    style = "points" if (rows["series"] == USER_SCENES).any() else "line"

    def plot(name, title, label, series_rows, lines, column):
        return Plot(name, title, "objects", label, series_by(series_rows, lines, "objects", column, style=style), "xy")

    counted = rows.assign(line=lambda r: r["series"] + ", " + r["method"])
    plots = [plot(f"accel-{series}", f"Time against the number of objects: {series}", "shortest time of a render (ms)", series_rows,
                  "method", "best (ms)") for series, series_rows in rows.groupby("series", sort=False)] + [
         plot("accel-tests", "Tests per ray against the number of objects", "tests per ray", counted, "line", "tests a ray"),
         plot("accel-memory", "Memory of a PE against the number of objects", "scene with grid or BVH (KB)", counted,
              "line", "memory (KB)")]
    return Page({"size": size, "bounces": BOUNCES, "rounds": ROUNDS, "format": "fp32"}, findings, tables=tables,
                plots=plots, placeholders={
                    "tile": math.gcd(size, 16), "sampling_s": SAMPLING_S, "max_render_s": MAX_RENDER_S, "min_fitted": MIN_FITTED_OBJECTS,
                    "scenes": "those of the command line." if scenes else "SPD's balls, where each level has nine times as many "
                    "spheres as the previous level; and spheres at random positions in a cube, some of them mirrors, with several "
                    "seeds for each number of spheres."})


def rows_of(runs):
    """Returns means over the scenes of each group and method."""
    rows = []
    for (series, group, method), group_rows in runs.groupby(["series", "scene", "method"], sort=False):
        tests, steps, best = map(estimate, (group_rows["tests"] / group_rows["rays"], group_rows["steps"] / group_rows["rays"], group_rows["best"]))
        rows.append({"series": series, "scene": group, "objects": group_rows["objects"].iloc[0], "method": method,
                     "scenes": len(group_rows), "tests a ray": tests.mean, "tests +-": tests.half, "steps a ray": steps.mean,
                     "steps +-": steps.half, "best (ms)": best.mean, "best +- (ms)": best.half,
                     "median (ms)": group_rows["median"].mean(),
                     "a ray (ns)": (1e6 * group_rows["best"] / group_rows["rays"]).mean(),
                     "build (ms)": math.nan if method == NONE else group_rows["build"].mean(),
                     "memory (KB)": 4 * (group_rows["scene_words"] + group_rows["accel_words"]).mean() / 1024})
    return pd.DataFrame(rows)


def growth_of(runs):
    rows = []
    for (series, method), method_rows in runs[runs["objects"] >= MIN_FITTED_OBJECTS].groupby(["series", "method"], sort=False):
        if series == USER_SCENES or method_rows["objects"].nunique() < 2:
            continue
        lines = [line for _, line in method_rows.groupby("seed", sort=False)]
        time, tests = (estimate([fitted_exponent(line["objects"], line[what] / line["rays"]) for line in lines])
                       for what in ("best", "tests"))
        rows.append({"scenes": series, "method": method, "from (objects)": method_rows["objects"].min(),
                     "to (objects)": method_rows["objects"].max(), "time": time.mean, "time +-": time.half,
                     "tests": tests.mean, "tests +-": tests.half})
    return pd.DataFrame(rows)


def faster_from(ratio_list, method):
    """Returns part of a sentence: from how many objects on a method is faster than testing all objects. ratio_list: in ascending order of
    objects."""
    objects = [ratio["objects"] for ratio in ratio_list]
    first = first_from(objects, [ratio["times"].low_or_mean > 1 for ratio in ratio_list])
    if first is None:
        return f"{method} is not measurably faster at {objects[-1]} objects"
    return f"{method} is faster from {first} objects on{' (the smallest number tried)' if first == objects[0] else ''}"


def finding_of_threshold(runs, series):
    bvh_ratios, grid_ratios = ratios(runs, NONE, BVH), ratios(runs, NONE, GRID)
    if not bvh_ratios:
        return f"{series}: no scene was rendered without an accelerator."
    if series == USER_SCENES:
        return (f"Without an accelerator a render takes {ratios_text(bvh_ratios)} times as long as with bvh, {ratios_text(grid_ratios)} times as "
                "long as with grid.")
    return (f"{series}: compared with testing all objects, {faster_from(bvh_ratios, BVH)}, {faster_from(grid_ratios, GRID)}. At "
            f"{bvh_ratios[-1]['objects']} objects, testing all objects takes {text_of(bvh_ratios[-1]['times'])} times as long as bvh and "
            f"{text_of(grid_ratios[-1]['times'])} times as long as grid.")


def finding_of_faster(runs, method, other):
    """Returns a sentence that counts the groups in which `other` is faster and those in which it is slower than `method`."""
    ratio_list = ratios(runs, method, other)
    faster, slower = (sum(holds) for holds in zip(*((e.low_or_mean > 1, e.high_or_mean < 1) for e in (ratio["times"] for ratio in ratio_list))))
    rest = len(ratio_list) - faster - slower
    return (f"{other} is faster than {method} in {faster} of {len(ratio_list)} groups of scenes and slower in {slower}"
            f"{f'; in {rest} the difference is not significant' if rest else ''}. Time of {method} / time of {other}: {ratios_text(ratio_list)}.")
