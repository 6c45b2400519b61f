"""Fig. 3 of Yoshitani & Yamazaki: time against the number of divisions

Into how many voxels should one machine divide space, for a given number of objects?

- Source: Yoshitani & Yamazaki, about 1995, Fig. 3 and conclusion. Their number of divisions is the number of voxels.
- One PE of raya's machine grande in fp32, {size} x {size} pixels, primary and shadow rays. Every ray traverses a grid of A x B x C voxels.
- {kind}
- A ray that enters several voxels with the same object tests the object in each of them: raya has no mailboxing.
- Output: divisions.csv has a row for each scene and number of divisions. copies: number of entries in the voxels' object lists, minus one per
  object; steps: number of voxels that rays enter; modelled time in s, measured time in ms.
"""
import numpy as np
import raya
from raya.lab import Comparison, Page, Plot, Table, above, below, estimate, every, judged, next_value_within, papers, range_text, series_by, study, under
from raya.lab.laboratory import tests_of
from raya.lab.voxels import near_cube, powers_of_two, run_cases, run_in_one_pe, sides_text, with_spheres

DIVISIONS = powers_of_two(8192)
OBJECTS = (64, 256, 512, 1024)
COLUMNS = ("scene", "divisions", "A x B x C", "copies", "rays", "tests", "steps", "tests a ray", "steps a ray",
           "modelled (s)", "measured (ms)", "measured, median (ms)", "objects", "voxels of an object")
DIFFERENCE_RATIO = 1.02  # ratio of two figures above which they count as different
# {subject: (title of the plot, label of its y axis, column of the table, name of its minimum)}
SUBJECTS = {"modelled": ("Modelled time against divisions", "modelled time of a T805 (s)", "modelled (s)",
                         "minimum of the modelled time"),
            "tests": ("Intersection tests against divisions", "intersection tests", "tests", "minimum of the tests"),
            "measured": ("Measured time against divisions", "measured time (ms)", "measured (ms)",
                         "minimum of the measured time")}


@study("divisions", measures=True)
def divisions(lab, scenes):
    size, from_paper = lab.size(96), not scenes
    even = [raya.generate.uniform(n, near_cube(n)).renamed(f"{n} objects") for n in OBJECTS]
    cases = [{"scene": scene, "cut": near_cube(count)} for scene in scenes or even for count in DIVISIONS]
    rows = run_cases(cases, lambda scene, cut: run_in_one_pe(lab, scene, size, cut, runs=5), COLUMNS)
    by_scene = [scene_rows for _, scene_rows in rows.groupby("scene", sort=False)]
    settings = [scene_rows[["scene", "objects"]].iloc[0].to_dict() for scene_rows in by_scene]
    findings = [finding_of_optimum(name, by_scene) for name in SUBJECTS]
    rises = ", ".join(f"{one['modelled (s)'].iloc[-1] / one['modelled (s)'].min():.2f} ({one['scene'].iloc[0]})" for one in by_scene)
    findings.append(f"At {DIVISIONS[-1]} divisions the modelled time is {rises} times its minimum.")
    largest_scene = by_scene[-1]
    if from_paper:
        falls = {name: fall_of(largest_scene, name) for name in SUBJECTS}
        findings.insert(0, "1024 objects with 32 divisions, compared with 1024 divisions: the time of Yoshitani & Yamazaki is "
                        f"{papers.DIVISIONS_FALL:.1f} times as long, our modelled time {falls['modelled']:.1f} times, our "
                        f"measured time {falls['measured']:.1f} times. We count {falls['tests']:.1f} times as many tests; "
                        "theirs fall to \"about 1/5\" from 32 to 1024 divisions.")
    shown = rows.drop(columns=["cut", "objects", "voxels of an object", "run"])
    comparisons = []
    if from_paper:
        comparisons = [Comparison(f"{name}, 32 divisions / 1024 divisions, 1024 objects", "", paper,
                                  fall_of(by_scene[-1], name.split()[0]), remark, name != "tests")
                       for name, paper, remark in (("modelled time", papers.DIVISIONS_FALL, "a T805's"),
                                                   ("measured time", papers.DIVISIONS_FALL, "this device's"),
                                                   ("tests", papers.TESTS_FALL, "Yoshitani & Yamazaki: \"about 1/5\""))]
    for name, (*_, optimum) in SUBJECTS.items():
        for scene_rows in by_scene:
            best = row_of_minimum(scene_rows, name)
            paper = best["objects"] if from_paper and name != "measured" else None
            comparisons.append(Comparison(f"{optimum}, {best['scene']}", "divisions", paper, best["divisions"],
                                          best["A x B x C"]))
    return Page({"size": size, "bounces": 0, "format": "fp32", "scenes": settings}, findings,
                comparisons, claims_of(lab, size) if from_paper else [],
                [Table("divisions", "Each number of objects and divisions", shown)],
                [Plot(f"divisions-{name}", title, "divisions", label, series_by(rows, "scene", "divisions", column),
                      "xy") for name, (title, label, column, _) in SUBJECTS.items()],
                clock="two kinds, on separate axes. Modelled: the counted events at their cost on a T805 at 25 MHz, 40 ns a cycle "
                "(data sheet of the IMS T805, SGS-Thomson 1996), including the creation of packets, without messages. Measured: tracing on "
                "this device, minimum and median of five samples after a warm-up; a sample is the mean of as many renders as take "
                "20 ms.", compared_with=papers.TP,
                placeholders={"kind": "64 to 1024 matt spheres, one in each of 64 to 1024 equal cells of a cube. The grid divides the "
                              "bounding box of the spheres, which is a little smaller than the cube, so some spheres straddle voxels."
                              if from_paper else "The scenes of the command line. A, B and C are as nearly equal as powers of two "
                              "allow, whatever the shape of the bounding box."})


def row_of_minimum(scene_rows, name):
    return scene_rows.loc[scene_rows[SUBJECTS[name][2]].idxmin()]


def fall_of(scene_rows, name):
    """Returns the figure at 32 divisions divided by the figure at 1024 divisions."""
    figures = scene_rows.set_index("divisions")[SUBJECTS[name][2]]
    return figures[papers.FEW_DIVISIONS] / figures[papers.MANY_DIVISIONS]


def finding_of_optimum(name, by_scene):
    best = [row_of_minimum(scene_rows, name) for scene_rows in by_scene]
    equal = sum(b["divisions"] == b["objects"] for b in best)
    last = sum(b["divisions"] == scene_rows["divisions"].iloc[-1] for b, scene_rows in zip(best, by_scene))
    more = f"; for {last} it is the largest number tried, so the minimum may lie beyond" if last else ""
    where = ", ".join(f"{b['divisions']} for {b['scene']}" for b in best)
    return (f"The {SUBJECTS[name][3]} lies at these numbers of divisions: {where}. This is the number of objects for {equal} of "
            f"{len(best)} scenes{more}.")


RADII, VIEWS = (0.5, 1.0, 1.5, 2.0), 8  # layouts of the claims: radii relative to the even scene; random views of each
TOLERANCE = 0.2  # of the claims tests-to-a-fifth and time-to-a-fifth


def layouts_of(lab, size, count):
    """Returns {"tests", "time": array [layout, division of DIVISIONS]} of evenly spread spheres with several radii from several views. Modelled
    time of a T805, ms."""
    figures = {"tests": [], "time": []}
    for i, factor in enumerate(RADII):
        even = raya.generate.uniform(count, near_cube(count))
        scene = with_spheres(even, lambda one: f"{' '.join(one[:3])} {float(one[3]) * factor:.9g}", f"{even.name}, radii x {factor:g}")
        for seed in range(lab.seed + i * VIEWS, lab.seed + (i + 1) * VIEWS):
            view = scene.random_view(seed)
            events = [lab.render(view, machine="grande", format="fp32", size=size, pes=1, offset=0, bounces=0,
                                 accel=f"grid:{sides_text(near_cube(n))}").events for n in DIVISIONS]
            figures["tests"].append([tests_of(e) for e in events])
            figures["time"].append([raya.t805_ms(e) for e in events])
    return {name: np.array(rows, float) for name, rows in figures.items()}


def claims_of(lab, size):
    layouts, radii = {count: layouts_of(lab, size, count) for count in OBJECTS}, [factor for factor in RADII for _ in range(VIEWS)]
    about = f"{len(RADII)} radii of evenly spread spheres, {VIEWS} views of each, seeds {lab.seed}..{lab.seed + len(RADII) * VIEWS - 1}"

    def at(name, count, divisions):
        return layouts[count][name][:, DIVISIONS.index(divisions)]

    def ratios(name, count, divisions, by):
        return at(name, count, divisions) / at(name, count, by)

    def texts(by_count, digits=2):
        return ", ".join(f"{estimate(values, radii if len(values) == len(radii) else None).text(digits)} ({count})" for count, values in by_count.items())

    def fall(name):
        return ratios(name, OBJECTS[-1], papers.FEW_DIVISIONS, papers.MANY_DIVISIONS)

    half, double = ({n: ratios("time", n, int(n * factor), n) for n in OBJECTS} for factor in (0.5, 2))
    excess = {n: at("tests", n, n) / layouts[n]["tests"].min(1) for n in OBJECTS}
    gain = {n: ratios("time", n, 1, n) for n in OBJECTS}
    def of_radius(values, factor):
        return values[np.array(radii) == factor]

    by_radius = "; ".join(f"{texts({n: of_radius(values, factor) for n, values in excess.items()})} for radii x {factor:g}" for factor in RADII)
    return [judged("time-falls-then-rises", under({f"{n} objects": every(above(by[n], 1, radii) for by in (half, double)) for n in OBJECTS}), about,
                   "Modelled time / time with divisions = objects (number of objects in brackets): "
                   f"{texts(half)} with half as many divisions, {texts(double)} with twice as many."),
            judged("more-objects-gain-more", every(above(gain[n] - gain[m], 0, radii) for m, n in zip(OBJECTS, OBJECTS[1:])), about,
                   f"Modelled time without division / time with divisions = objects: {texts(gain, 1)}."),
            judged("tests-to-a-fifth", next_value_within(papers.TESTS_FALL, fall("tests"), TOLERANCE, 1), about,
                   f"The tests fall by a factor of {estimate(fall('tests'), radii).text(1)}, {range_text(fall('tests'), 1)} for single layouts."),
            judged("time-to-a-fifth", next_value_within(papers.DIVISIONS_FALL, fall("time"), TOLERANCE, 1), about,
                   f"The modelled time falls by a factor of {estimate(fall('time'), radii).text(1)}, {range_text(fall('time'), 1)} for single "
                   "layouts."),
            judged("tests-fewest-at-objects", under({f"{n} objects, radii x {factor:g}": below(of_radius(values, factor), DIFFERENCE_RATIO, digits=2)
                                                     for factor in RADII for n, values in excess.items()}), about,
                   f"Tests with divisions = objects / minimum of the tests: {by_radius}.")]
