"""Fig. 3 of Yoshitani & Yamazaki: time against the number of divisions

Into how many voxels should one machine cut the space of so many objects?

- One PE of grande in fp32, {size} x {size} pixels, primary and shadow rays; every ray walks through the grid.
- {kind}
- Tests count an object again in each voxel that it shares with others on the way of a ray.
"""
import numpy as np
import raya
from raya.lab import Claim, Comparison, Page, Plot, Table, papers, series_by, study, verdict
from raya.lab.laboratory import TESTS
from raya.lab.voxels import near_cube, powers, run_in_one_pe, swept

DIVISIONS = powers(8192)
COLUMNS = ("scene", "divisions", "A x B x C", "copies", "rays", "tests", "steps", "tests a ray", "steps a ray",
           "modelled (s)", "measured (ms)", "measured, median (ms)", "objects", "voxels of an object")
NOTICED = 1.02  # times as much: not the same
# Name, column, and what its minimum is called.
SUBJECTS = {"modelled": ("Modelled time against divisions", "modelled time of a T805 (s)", "modelled (s)",
                         "least modelled time"),
            "tests": ("Intersection tests against divisions", "intersection tests", "tests", "fewest tests"),
            "measured": ("Measured time against divisions", "measured time (ms)", "measured (ms)",
                         "least measured time")}


@study("divisions")
def divisions(lab, scenes):
    size, from_paper = lab.size(96), not scenes
    even = [raya.generate.uniform(n, near_cube(n)).renamed(f"{n} objects") for n in (64, 256, 512, 1024)]
    cases = [{"scene": scene, "cut": near_cube(count)} for scene in scenes or even for count in DIVISIONS]
    rows = swept(cases, lambda scene, cut: run_in_one_pe(lab, scene, size, cut, runs=5), COLUMNS)
    by_scene = [some for _, some in rows.groupby("scene", sort=False)]
    settings = [some[["scene", "objects"]].iloc[0].to_dict() for some in by_scene]
    findings = [finding_of_optimum(name, by_scene) for name in SUBJECTS]
    findings += [finding_of_loss(by_scene), finding_of_rise(by_scene), finding_of_parts(list(by_scene[-1]["run"]))]
    most = by_scene[-1]
    if from_paper:
        falls = {name: fall_of(most, name) for name in SUBJECTS}
        findings.insert(0, "1024 objects at 32 divisions, beside 1024: the time of Yoshitani & Yamazaki is "
                        f"{papers.DIVISIONS_FALL:.1f} times as long, ours {falls['modelled']:.1f} times modelled and "
                        f"{falls['measured']:.1f} times measured; the tests are {falls['tests']:.1f} times as many, "
                        "beside their \"about 1/5\".")
    shown = rows.drop(columns=["cut", "objects", "voxels of an object", "run"])
    return Page({"size": size, "bounces": 0, "format": "fp32", "scenes": settings}, findings,
                comparisons_of(by_scene, from_paper), claims_of(by_scene) if from_paper else [],
                [Table("divisions", "Each number of objects and divisions", shown)],
                [Plot(f"divisions-{name}", title, "divisions", label, series_by(rows, "scene", "divisions", column),
                      "xy") for name, (title, label, column, _) in SUBJECTS.items()],
                ["Yoshitani & Yamazaki print two times, of one unnamed machine and 1024 objects; here are tests, "
                 "steps, modelled and measured times for 14 numbers of divisions and four of objects, and what the "
                 "best division is worth."],
                clock="two kinds that never share an axis. Modelled: the events that were counted, at what each takes "
                "a T805 at 25 MHz, 40 ns a cycle (data sheet of the IMS T805, SGS-Thomson 1996), the making of packets "
                "among them; no message. Measured: tracing on this device, minimum and median of five samples after a "
                "warm-up, each of renders that take 20 ms together.", beside=papers.TP,
                words={"kind": "64 to 1024 matt spheres, one in each of as many voxels of a cube. Our grid cuts the "
                       "box of the spheres, which is a little smaller than that cube: some spheres lie across its "
                       "planes."
                       if from_paper else "The scenes that were named. A x B x C as near to a cube as powers of two "
                       "allow, whatever the box."})


def least(some, name):
    return some.loc[some[SUBJECTS[name][2]].idxmin()]


def at_objects(some):
    """The row of as many divisions as objects; None where that was not tried."""
    found = some[some["divisions"] == some["objects"]]
    return found.iloc[0] if len(found) else None


def over_least(some, row, name):
    return row[SUBJECTS[name][2]] / least(some, name)[SUBJECTS[name][2]]


def fall_of(some, name):
    """The figure at 32 divisions over that at 1024."""
    figures = some.set_index("divisions")[SUBJECTS[name][2]]
    return figures[papers.FEW_DIVISIONS] / figures[papers.MANY_DIVISIONS]


def comparisons_of(by_scene, from_paper):
    all_of = []
    if from_paper:
        all_of = [Comparison(f"32 over 1024 divisions, 1024 objects: {name}", "", paper,
                             fall_of(by_scene[-1], name.split()[0]), remark, name != "tests")
                  for name, paper, remark in (("modelled time", papers.DIVISIONS_FALL, "a T805's"),
                                              ("measured time", papers.DIVISIONS_FALL, "this device's"),
                                              ("tests", papers.TESTS_FALL, "Yoshitani & Yamazaki: \"about 1/5\""))]
    for name, (*_, optimum) in SUBJECTS.items():
        for some in by_scene:
            best = least(some, name)
            paper = best["objects"] if from_paper and name != "measured" else None
            all_of.append(Comparison(f"{optimum}, {best['scene']}", "divisions", paper, best["divisions"],
                                     best["A x B x C"]))
    return all_of


def finding_of_optimum(name, by_scene):
    best = [least(some, name) for some in by_scene]
    equal = sum(b["divisions"] == b["objects"] for b in best)
    last = sum(b["divisions"] == some["divisions"].iloc[-1] for b, some in zip(best, by_scene))
    more = f"; {last} at the last division tried, so it may lie beyond" if last else ""
    where = ", ".join(f"{b['divisions']} for {b['scene']}" for b in best)
    return (f"{SUBJECTS[name][3].capitalize()}: at divisions {where}; divisions = objects is it for {equal} of "
            f"{len(best)}{more}.")


def finding_of_loss(by_scene):
    tried = [(some, row) for some in by_scene for row in [at_objects(some)] if row is not None]
    if not tried:
        return "No scene here was cut into as many voxels as it has objects."
    times = ", ".join(f"{over_least(some, row, 'modelled'):.2f} ({row['scene']})" for some, row in tried)
    tests = ", ".join(f"{over_least(some, row, 'tests'):.2f}" for some, row in tried)
    voxels = ", ".join(f"{row['voxels of an object']:.2f}" for _, row in tried)
    return (f"Divisions = objects takes {times} times the least modelled time and {tests} times the fewest tests; an "
            f"object then lies in {voxels} voxels.")


def finding_of_rise(by_scene):
    rises = ", ".join(f"{over_least(some, some.iloc[-1], 'modelled'):.2f} "
                      f"({some['scene'].iloc[0]})" for some in by_scene)
    return f"At {by_scene[0]['divisions'].iloc[-1]} divisions the modelled time is {rises} times the least."


def finding_of_parts(runs):
    """Fewer tests come with more steps, and what rays and hits take stays."""
    at = [run for run in runs if run.voxels in (papers.FEW_DIVISIONS, papers.MANY_DIVISIONS)] + [runs[-1]]

    def shares(events):
        return ", ".join(f"{100 * raya.t805_ms({e: run.events[e] for e in events}) / raya.t805_ms(run.events):.0f}"
                         for run in at)

    return (f"{runs[0].scene}: at {', '.join(str(run.voxels) for run in at)} divisions, tests take {shares(TESTS)} % "
            f"of the modelled time, walking from voxel to voxel {shares(('walks', 'steps'))} %; an object lies in "
            f"{runs[-1].voxels_of_object:.1f} voxels at the last.")


def claims_of(by_scene):
    near, fifth, paper = 1.25, (4, 6), papers.DIVISIONS_FALL  # what counts as the same time, as "about 1/5"
    modelled, measured, tests = (fall_of(by_scene[-1], name) for name in ("modelled", "measured", "tests"))

    def claim(place, words, seen, why, contrary=None):
        return Claim(papers.TP, place, words, verdict(seen, not seen if contrary is None else contrary), why)

    def least_at_objects(name):
        rows = [(some, at_objects(some)) for some in by_scene]
        return all(row is not None and over_least(some, row, name) <= NOTICED for some, row in rows)

    def why_optimum(name):
        return (f"{finding_of_optimum(name, by_scene)} {finding_of_loss(by_scene)} Within 2 % it would count as the "
                "least.")

    rises = all(over_least(some, some.iloc[-1], "modelled") > NOTICED for some in by_scene)
    falls = [over_least(some, some.iloc[0], "modelled") for some in by_scene]
    are_near = [max(fall / paper, paper / fall) <= near for fall in (modelled, measured)]
    texts = ", ".join(f"{fall:.1f} ({some['scene'].iloc[0]})" for fall, some in zip(falls, by_scene))
    return [claim("Fig. 3", "Time falls until there are as many divisions as objects, then it rises.",
                  least_at_objects("modelled") and rises, f"{why_optimum('modelled')} {finding_of_rise(by_scene)}"),
            claim("Fig. 3", "It falls the more, the more objects there are.", bool((np.diff(falls) >= 0).all()),
                  f"From one division to the least modelled time: {texts} times less."),
            claim("Fig. 3", "1024 objects take 313 s with 32 divisions and 60 s with 1024, 5.2 times less.",
                  all(are_near), f"{modelled:.2f} times less modelled, {measured:.2f} measured; a quarter more or less "
                  "would do.", not any(are_near)),
            claim("Fig. 3", "The tests fall to about 1/5 from 32 to 1024 divisions, 1024 objects.",
                  fifth[0] <= tests <= fifth[1], f"They fall to 1 / {tests:.1f}; 1/4 to 1/6 would do."),
            claim("conclusion", "The tests are fewest where there are as many divisions as objects.",
                  least_at_objects("tests"), why_optimum("tests"))]
