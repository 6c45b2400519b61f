"""Tests and steps a ray in uniform grids, beside Havran & Sixta 1999

Does our grid do what others' grids do on the same scenes?

- One PE of grande in fp32, {size} x {size} rays through pixel corners{spd}, tree depth {depth} with the eye ray as 1,
  as SPD has it. The grid cuts the box of the whole scene.
- A ray: every eye, reflected, refracted and shadow ray, whether it meets the box or not. Tests: with spheres, polygons
  and cylinders, of any ray. Steps: voxels that rays enter, the first one among them.
- Where ours may differ: no mailbox, so that an object in several voxels on a ray's way is tested in each; a shadow ray
  ends at the first object that is found to hide the light; objects are registered with a margin for rounding. What
  Havran & Sixta do in each of these, and whether they count the first voxel, is not known to us.
"""
import math

import pandas as pd
import raya
from raya.lab import Comparison, Page, Plot, Series, Table, papers, series_by, study
from raya.lab.voxels import run_in_one_pe, swept

BOUNCES, SPD_SIZE = 4, 513  # the eye ray is depth 1 of 5
COLUMNS = ("scene", "A x B x C", "copies", "tests", "steps", "measured (ms)")


def grids_for(name):
    """Those published for the scene, or cubes as fine as those for lattice."""
    known = [grid for scene, grid in papers.UNIFORM_GRIDS if scene == name]
    return known or [(20, 20, 20), (44, 44, 44)]


@study("havran")
def havran(lab, scenes):
    size = lab.size(257)  # every other corner of SPD's 513
    own = [raya.generate.balls(4).renamed("balls"), raya.generate.lattice(12).renamed("lattice")]
    cases = [{"scene": scene, "grid": grid} for scene in scenes or own for grid in grids_for(scene.name)]
    table = swept(cases, lambda scene, grid: run_in_one_pe(lab, scene, size, grid, BOUNCES, "corners"), COLUMNS)
    rows = pd.DataFrame([row_of(*some) for some in zip(table["run"], table["grid"])])
    kinds = {"primary": "eye rays", "reflected": "reflected", "refracted": "refracted", "shadow": "shadow rays",
             "walks": "walks"}
    rays = pd.DataFrame([{name: run.events[kind] for kind, name in kinds.items()} for run in table["run"]])
    table = table.drop(columns=["grid", "run"]).join(rays)
    table["tests a walk"], table["steps a walk"] = (table[name] / table["walks"] for name in ("tests", "steps"))
    table = table[["scene", "A x B x C", "copies", *rays.columns, "tests", "steps", "tests a walk", "steps a walk",
                   "measured (ms)"]]
    known = rows.dropna(subset="their tests")
    published = [Series("Havran & Sixta", known["their steps"], known["their tests"], "paper")] if len(known) else []
    return Page({"size": size, "bounces": BOUNCES, "sampling": "corners", "format": "fp32"},
                [*(finding_of(known, what) for what in ("tests", "steps")),
                 *(finding_of_finer(a, b) for (_, a), (_, b) in zip(rows.iterrows(), rows[1:].iterrows())
                   if a["scene"] == b["scene"])],
                [c for _, row in rows.iterrows() for c in comparisons_of(row)],
                tables=[Table("havran", "What was counted", table)],
                plots=[Plot("havran", "Tests against steps a ray", "steps a ray", "tests a ray",
                            series_by(rows, "scene", "steps", "tests", style="points") + published, "xy")],
                beside=papers.GRID,
                words={"spd": "" if size == SPD_SIZE else " (SPD: 513 x 513)", "depth": BOUNCES + 1})


def row_of(run, grid):
    tests, steps = papers.UNIFORM_GRIDS.get((run.scene, grid), (math.nan, math.nan))
    return {"scene": run.scene, "sides": run.sides, "tests": run.tests_per_ray, "steps": run.steps_per_ray,
            "beyond": (run.steps - run.events["walks"]) / run.rays, "their tests": tests, "their steps": steps}


def comparisons_of(row):
    name = f"{row['scene']} {row['sides']}"
    yield Comparison(f"{name}: tests a ray", "", row["their tests"], row["tests"])
    yield Comparison(f"{name}: steps a ray", "", row["their steps"], row["steps"],
                     f"{row['beyond']:.2f} without the first voxel of each walk")


def finding_of(known, what):
    if not len(known):
        return f"{what.capitalize()} a ray: none were published for these grids."
    ratios = ", ".join(f"{row[what] / row[f'their {what}']:.2f} ({row['scene']} {row['sides']})"
                       for _, row in known.iterrows())
    return f"{what.capitalize()} a ray are {ratios} times those that Havran & Sixta publish."


def finding_of_finer(coarse, fine):
    """What a finer grid of one scene does, in ours and in theirs: free of how a ray or a test is counted."""
    tests, steps, *others = (f"{fine[name] / coarse[name]:.2f}" for name in ("tests", "steps", "their tests",
                                                                             "their steps"))
    theirs = "" if "nan" in others else f"; theirs to {others[0]} and {others[1]}"
    return (f"{fine['scene']}, from {coarse['sides']} to {fine['sides']} voxels: tests fall to {tests}, steps grow to "
            f"{steps} times{theirs}.")
