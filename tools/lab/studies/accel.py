"""Finding a ray's nearest hit: all objects, a grid, a BVH

From how many objects on does a grid or a BVH pay, which of them, and how does time grow with the objects?

- The ring machine `grande` in fp32, global memory, {size} x {size} pixels in tiles of {tile} x {tile}, {bounces}
  bounces; `--accel` none, grid (of raya's own choice of voxels) and bvh. Every way gives the same image, bit for bit;
  that is checked.
- {scenes}
- Time: a whole render from packed scene to image, without building kernels, grid or BVH; a sample is the mean of as
  many renders as take 20 ms. All ways of a scene take turns, up to {rounds}, and one that has had {enough} s of samples
  takes no further; minimum and median of the samples.
- Without an accelerator, a render that would take longer than {bearable} s is left out: predicted from the scene's rays
  and objects, at what a test took in the scene before.
- Counted: tests, of a ray of any kind with an object; steps, voxels that rays enter, or nodes of the BVH; memory, what
  a PE holds of the scene and of grid or BVH. Build is measured: to make the grid or BVH, on the host.
- Where several scenes differ in their seed alone, a figure is their mean. A ratio of two ways is taken in each scene,
  then the mean; of a single scene, in each turn. A way counts as faster where the whole interval says so; after a
  single turn, where the ratio does.
- Growth: the exponent of objects in what a ray takes, by least squares of logarithms over scenes of {fitted} objects
  and more, for each seed.
- Embree 3: the same rays (tools/embree) on all cores, the faster of asking ray by ray and sixteen in step; its loop
  over the picture alone, three pictures a turn. Where rays differ by more than one in a thousand there is no ratio.
"""
import math

import numpy as np
import pandas as pd
import raya
from raya.lab import Estimate, Page, Plot, Table, estimate, fitted_exponent, sampled, series_by, study
from raya.lab.laboratory import rays_of, tests_of
from raya.lab.programs import beside_raya, output_of

NONE, GRID, BVH, EMBREE = "none", "grid", "bvh", "Embree"
BOUNCES, ROUNDS, BEARABLE_S, ENOUGH_S, PEER_SAMPLES, SEEDS = 4, 5, 30, 10, 3, 5
FITTED_FROM, SAME_WORK = 100, 1e-3  # objects; of the rays
NAMED = "named"
# Members of a row of each scene and way that are shown, under names.
EACH = {**{name: name for name in ("scene", "seed", "objects", "way", "rays", "tests", "steps")}, "best": "best (ms)",
        "median": "median (ms)", "samples": "samples", "build": "build (ms)", "scene_words": "scene words",
        "accel_words": "accelerator words"}


def own_scenes():
    """(series, group, seed, a function that makes the scene)"""
    for level in range(1, 7):
        yield "balls", f"balls {level}", 0, lambda level=level: raya.generate.balls(level)
    for count in (10, 100, 1_000, 10_000, 100_000):
        for seed in range(1, SEEDS + 1):
            yield "random", f"random {count}", seed, lambda count=count, seed=seed: raya.generate.random(count, seed)


class Way:
    """One scene in one way, and the seconds of its samples."""

    def __init__(self, name, turn, **figures):
        self.name, self.turn, self.figures, self.seconds, self.turns = name, turn, figures, [], []


def raya_way(lab, scene, size, name):
    tile = math.gcd(size, 16)
    options = dict(machine="grande", format="fp32", size=size, pes=size, mapping=f"tiles:{tile}x{tile}",
                   bounces=BOUNCES, accel=name)
    first = lab.render(scene, **options)
    e, words = first.events, first.report["accel"].get("words", 0)
    way = Way(name, lambda: [sampled(lambda: lab.render(scene, **options).render_s)],
              rays=rays_of(e), tests=tests_of(e), steps=e["steps"], scene_words=first.job_words - words,
              accel_words=words, build=1e3 * first.accel_s)
    way.hash = first.hash
    return way


def ask_embree(program, nff, size):
    """({way: (rays, seconds)}, seconds of the build)"""
    words = [program, "/dev/stdin", f"{size}x{size}", str(BOUNCES), "centres", str(PEER_SAMPLES)]
    ways, build = {}, math.nan
    for line in output_of(words, "embree_peer", input=nff).splitlines():
        name, *words = line.split()
        if name == "build":
            build = float(words[0])
        elif name != "mean":
            ways[name] = int(words[0]), [float(word) for word in words[1:]]
    return ways, build


def embree_way(scene, size, failures, group):
    program = beside_raya("embree_peer")
    if not program:
        return None
    try:
        ways, build = ask_embree(program, scene.nff, size)
    except ValueError as error:
        failures.append(f"{group}: {error}")
        return None
    fastest = min(ways, key=lambda way: min(ways[way][1]))
    unknown = dict.fromkeys(("tests", "steps", "scene_words", "accel_words"), math.nan)
    return Way(EMBREE, lambda: ask_embree(program, scene.nff, size)[0][fastest][1], rays=ways[fastest][0],
               build=1e3 * build, **unknown)


def measure(lab, size, scenes):
    """(a row of each scene and way, scenes not rendered without an accelerator, failures of Embree)"""
    rows, left_out, failures, test_s = [], [], [], 1e-9  # a cautious guess until a test is measured
    for series, group, seed, make in scenes:
        scene = make()
        ways = [raya_way(lab, scene, size, name) for name in (GRID, BVH)]
        predicted = test_s * ways[0].figures["rays"] * scene.objects
        if predicted > BEARABLE_S:
            left_out.append(f"{group} ({scene.objects} objects, about {predicted:.0f} s)")
        else:
            ways.insert(0, raya_way(lab, scene, size, NONE))
        for way in ways[1:]:
            if way.hash != ways[0].hash or way.figures["rays"] != ways[0].figures["rays"]:
                raise raya.DeviceError(f"{group}: --accel {way.name} gives another image than {ways[0].name}: "
                                       f"{way.hash} and {ways[0].hash}; the device or its compiler is wrong")
        peer = embree_way(scene, size, failures, group)
        ways += [peer] if peer else []
        for turn in range(ROUNDS):
            for way in ways:
                if turn == 0 or sum(way.seconds) < ENOUGH_S:
                    some = way.turn()
                    way.seconds += some
                    way.turns.append(1e3 * min(some))
        for way in ways:
            if way.name == NONE:
                test_s = min(way.seconds) / (way.figures["rays"] * scene.objects)
            rows.append({"series": series, "scene": group, "seed": seed, "objects": scene.objects, "way": way.name,
                         **way.figures, "best": 1e3 * min(way.seconds), "median": 1e3 * np.median(way.seconds),
                         "samples": len(way.seconds), "turns": way.turns})
    return pd.DataFrame(rows), left_out, failures


def pairs(rows, way, other):
    """A row of each scene in both ways, and whether these have traced the same rays."""
    both = rows[rows["way"] == way].merge(rows[rows["way"] == other], on=["series", "scene", "seed", "objects"],
                                          suffixes=("", " of other"))
    rays = both[["rays", "rays of other"]]
    return both.assign(same=rays.max(axis=1) - rays.min(axis=1) <= SAME_WORK * rays.min(axis=1))


def ratios(rows, way, other):
    """The time of one way over another's, of every group that has scenes in both with the same rays."""
    found = []
    for group, some in pairs(rows, way, other).query("same").groupby("scene", sort=False):
        times = some["best"] / some["best of other"]
        if len(some) == 1:
            times = [x / y for x, y in zip(some["turns"].iloc[0], some["turns of other"].iloc[0])]
        found.append({"group": group, "objects": some["objects"].iloc[0], "times": estimate(times)})
    return found


def text_of(e):
    mean, half = (f"{value:.2f}" if value < 100 else f"{value:.0f}" for value in (e.mean, e.half))
    return mean if np.isnan(e.half) else f"{mean} +- {half}"


def ratios_text(some):
    return ", ".join(f"{text_of(one['times'])} ({one['group']})" for one in some)


@study("accel")
def accel(lab, scenes):
    size = lab.size(256)
    some = [(NAMED, s.name, 0, lambda s=s: s) for s in scenes] if scenes else own_scenes()
    runs, left_out, failures = measure(lab, size, some)
    rows, growth = rows_of(runs), growth_of(runs)
    series = [(name, one) for name, one in runs.groupby("series", sort=False)]
    findings = [*(finding_of_paying(one, name) for name, one in series), finding_of_two(runs, GRID, BVH),
                *(finding_of_growth(growth, one) for one in (growth["scenes"].unique() if len(growth) else [])),
                *(finding_of_memory(one) for _, one in series)]
    findings += [f"Not rendered without an accelerator: {', '.join(left_out)}."] if left_out else []
    findings += findings_of_embree(runs, failures)
    each = runs[list(EACH)].fillna(0).astype(
        {name: int for name in ("tests", "steps", "scene_words", "accel_words")}).rename(columns=EACH)
    tables = [Table("accel", "Each number of objects and way", rows.drop(columns=["series"])),
              Table("accel-scenes", "Each scene and way", each, on_page=False)]
    tables += [Table("accel-growth", "Exponent of objects in what a ray takes", growth)] if len(growth) else []
    return Page({"size": size, "bounces": BOUNCES, "rounds": ROUNDS, "format": "fp32"}, findings, tables=tables,
                plots=plots_of(rows), words={
                    "tile": math.gcd(size, 16), "enough": ENOUGH_S, "bearable": BEARABLE_S, "fitted": FITTED_FROM,
                    "scenes": "The scenes that were named." if scenes else "SPD's balls, each level nine times the "
                    "spheres of the one before; and spheres scattered at random over a cube, some of them mirrors, "
                    "several seeds of each number."})


def rows_of(runs):
    """The mean of the scenes of each group and way."""
    rows = []
    for (series, group, way), some in runs.groupby(["series", "scene", "way"], sort=False):
        tests, steps, best = map(estimate, (some["tests"] / some["rays"], some["steps"] / some["rays"], some["best"]))
        rows.append({"series": series, "scene": group, "objects": some["objects"].iloc[0], "way": way,
                     "scenes": len(some), "tests a ray": tests.mean, "tests +-": tests.half, "steps a ray": steps.mean,
                     "steps +-": steps.half, "best (ms)": best.mean, "best +- (ms)": best.half,
                     "median (ms)": some["median"].mean(),
                     "a ray (ns)": (1e6 * some["best"] / some["rays"]).mean(),
                     "build (ms)": math.nan if way == NONE else some["build"].mean(),
                     "memory (KB)": 4 * (some["scene_words"] + some["accel_words"]).mean() / 1024})
    return pd.DataFrame(rows)


def growth_of(runs):
    rows = []
    for (series, way), some in runs[runs["objects"] >= FITTED_FROM].groupby(["series", "way"], sort=False):
        if series == NAMED or some["objects"].nunique() < 2:
            continue
        lines = [line for _, line in some.groupby("seed", sort=False)]
        time, tests = (estimate([fitted_exponent(line["objects"], line[what] / line["rays"]) for line in lines])
                       for what in ("best", "tests"))
        rows.append({"scenes": series, "way": way, "from (objects)": some["objects"].min(),
                     "to (objects)": some["objects"].max(), "time": time.mean, "time +-": time.half,
                     "tests": tests.mean, "tests +-": tests.half})
    return pd.DataFrame(rows)


def pays_from(some, way):
    """From how many objects on the other way pays, in scenes that differ in their number of objects."""
    start = len(some)
    while start > 0 and some[start - 1]["times"].least > 1:
        start -= 1
    if start == len(some):
        return f"{way} is not shown to pay at {some[-1]['objects']} objects"
    return f"{way} pays from {some[start]['objects']} objects on{', the fewest tried' if start == 0 else ''}"


def finding_of_paying(runs, series):
    tree, grid = ratios(runs, NONE, BVH), ratios(runs, NONE, GRID)
    if not tree:
        return f"{series}: nothing was rendered without an accelerator."
    if series == NAMED:
        return (f"Without an accelerator the scenes that were named take {ratios_text(tree)} times as long as with "
                f"bvh, {ratios_text(grid)} times as long as with grid.")
    return (f"{series}: against testing all objects, {pays_from(tree, BVH)}, {pays_from(grid, GRID)}; at "
            f"{tree[-1]['objects']} objects none takes {text_of(tree[-1]['times'])} times as long as bvh, "
            f"{text_of(grid[-1]['times'])} times as long as grid.")


def finding_of_two(runs, way, other):
    """Which of two ways is the faster, over all groups."""
    some = ratios(runs, way, other)
    if not some:
        return f"No scene has a ratio of {way} to {other}."
    faster, slower = (sum(holds) for holds in zip(*((e.least > 1, e.most < 1) for e in (one["times"] for one in some))))
    rest = len(some) - faster - slower
    return (f"{other} is faster than {way} in {faster} of {len(some)}, slower in {slower}"
            f"{f', not to be separated in {rest}' if rest else ''}; time of {way} over {other}: {ratios_text(some)}.")


def finding_of_growth(growth, series):
    some = growth[growth["scenes"] == series]
    exponents = ", ".join(f"{Estimate(row['time'], row['time +-'], None).text(2)} ({row['way']}, "
                          f"{row['from (objects)']} to {row['to (objects)']} objects)" for _, row in some.iterrows())
    tens = ", ".join(f"{10**row['time']:.2f} ({row['way']})" for _, row in some.iterrows())
    return (f"{series}: what a ray takes grows as the objects to the power of {exponents}; ten times the objects take "
            f"{tens} times as long.")


def finding_of_memory(runs):
    """Of the most objects of a series: what grid and BVH take, and how long to make them."""
    made = runs[runs["way"].isin([GRID, BVH])]
    group = made["scene"][made["objects"].idxmax()]
    texts, scene = [], 0
    for way, some in made[made["scene"] == group].groupby("way", sort=False):
        count, build = some["objects"].iloc[0], some["build"].mean()
        scene = 4 * some["scene_words"].mean() / count
        texts.append(f"{way} takes {4 * some['accel_words'].mean() / count:.1f} bytes an object and is made in "
                     f"{build:.3g} ms, the time of {build / some['best'].mean():.2g} renders")
    return f"{group}: {', '.join(texts)}; the scene itself takes {scene:.1f} bytes an object."


def findings_of_embree(runs, failures):
    if not beside_raya("embree_peer"):
        return ["Embree was not measured: no program embree_peer lies beside raya; `tools/peers --setup` installs "
                "Embree, then cmake's target embree_peer makes it."]
    findings = [finding_of_two(runs, EMBREE, BVH)] if (runs["way"] == EMBREE).any() else []
    others = pairs(runs, EMBREE, BVH).query("not same")
    if len(others):
        names = ", ".join(f"{o['scene']} (seed {o['seed']})" if o["seed"] else o["scene"] for _, o in others.iterrows())
        findings.append(f"Embree traces more or fewer rays by over one in a thousand, and has no ratio, in {names}.")
    return findings + ([f"Embree was not measured in {'; '.join(failures)}."] if failures else [])


def plots_of(rows):
    style = "points" if (rows["series"] == NAMED).any() else "line"

    def plot(name, title, label, some, lines, column):
        return Plot(name, title, "objects", label, series_by(some, lines, "objects", column, style=style), "xy")

    counted = rows[rows["way"] != EMBREE].assign(line=lambda r: r["series"] + ", " + r["way"])
    return [plot(f"accel-{series}", f"Time against the number of objects: {series}", "best time of a render (ms)", some,
                 "way", "best (ms)") for series, some in rows.groupby("series", sort=False)] + [
        plot("accel-tests", "Tests a ray against the number of objects", "tests a ray", counted, "line", "tests a ray"),
        plot("accel-memory", "What a PE holds against the number of objects", "scene with grid or BVH (KB)", counted,
             "line", "memory (KB)")]
