"""Tests and steps per ray in uniform grids, compared with Havran & Sixta 1999

Does raya's grid need as many tests and steps as the grid of Havran & Sixta on the same scenes?

- Source: Havran & Sixta 1999, uniform grids with 3D-DDA; scenes balls and lattice of SPD (Haines 1987).
- One PE of raya's machine grande in fp32, {size} x {size} rays through pixel corners{spd}. Ray trees have depth {depth}, counting the eye ray, as SPD
  prescribes. The grid divides the bounding box of the whole scene.
- Rays: all eye, reflected, refracted and shadow rays, also those that miss the bounding box. Tests: of any ray with spheres, polygons and cylinders.
  Steps: voxels that rays enter, including the first one of each ray. Walks: rays that enter the bounding box.
- Possible differences: raya has no mailboxing, so a ray tests an object in each voxel that contains it; a shadow ray ends at the first
  object found that blocks the light; objects are registered with a margin for rounding errors. We do not know what Havran & Sixta do in
  these cases, nor whether they count the first voxel.
- Output: havran.csv has a row for each scene and grid: entries of objects in voxel lists beyond the first one (copies), counts of rays, tests and
  steps, and the measured time of a render (ms).
"""
import math

import pandas as pd
import raya
from raya.lab import Comparison, Page, Plot, Series, Table, papers, series_by, study
from raya.lab.voxels import run_cases, run_in_one_pe

BOUNCES, SPD_SIZE = 4, 513  # BOUNCES: SPD's depth of 5, without the eye ray
COLUMNS = ("scene", "A x B x C", "copies", "tests", "steps", "measured (ms)")


@study("havran", measures=True)
def havran(lab, scenes):
    size = lab.size(257)  # every second of SPD's 513 pixel corners along a side
    own = [raya.generate.balls(4).renamed("balls"), raya.generate.lattice(12).renamed("lattice")]
    published_grids = {name: [grid for scene, grid in papers.UNIFORM_GRIDS if scene == name] for name in ("balls", "lattice")}
    cases = [{"scene": scene, "grid": grid} for scene in scenes or own
             for grid in published_grids.get(scene.name, published_grids["lattice"])]
    table = run_cases(cases, lambda scene, grid: run_in_one_pe(lab, scene, size, grid, BOUNCES, "corners"), COLUMNS)
    rows = pd.DataFrame([row_of(*some) for some in zip(table["run"], table["grid"])])
    kinds = {"primary": "eye rays", "reflected": "reflected", "refracted": "refracted", "shadow": "shadow rays",
             "walks": "walks"}
    rays = pd.DataFrame([{name: run["result"].events[kind] for kind, name in kinds.items()} for run in table["run"]])
    table = table.drop(columns=["grid", "run"]).join(rays)
    table["tests a walk"], table["steps a walk"] = (table[name] / table["walks"] for name in ("tests", "steps"))
    table = table[["scene", "A x B x C", "copies", *rays.columns, "tests", "steps", "tests a walk", "steps a walk",
                   "measured (ms)"]]
    known = rows.dropna(subset="their tests")
    published = [Series("Havran & Sixta", known["their steps"], known["their tests"], "paper")] if len(known) else []
    return Page({"size": size, "bounces": BOUNCES, "sampling": "corners", "format": "fp32"},
                [finding_of(known, what) for what in ("tests", "steps")],
                [Comparison(f"{row['scene']} {row['sides']}: {what} per ray", "", row[f"their {what}"], row[what], remark) for _, row in rows.iterrows()
                 for what, remark in (("tests", ""), ("steps", f"{row['beyond']:.2f} without the first voxel of each walk"))],
                tables=[Table("havran", "Counts for each scene and grid", table)],
                plots=[Plot("havran", "Tests per ray against steps per ray", "steps per ray", "tests per ray",
                            series_by(rows, "scene", "steps", "tests", style="points") + published, "xy")],
                compared_with=papers.GRID,
                placeholders={"spd": "" if size == SPD_SIZE else " (SPD: 513 x 513)", "depth": BOUNCES + 1})


def row_of(run, grid):
    tests, steps = papers.UNIFORM_GRIDS.get((run["scene"], grid), (math.nan, math.nan))
    return {"scene": run["scene"], "sides": run["A x B x C"], "tests": run["tests a ray"], "steps": run["steps a ray"],
            "beyond": (run["steps"] - run["result"].events["walks"]) / run["rays"], "their tests": tests, "their steps": steps}


def finding_of(known, what):
    if not len(known):
        return f"{what.capitalize()} per ray: Havran & Sixta published no figures for these grids."
    ratios = ", ".join(f"{row[what] / row[f'their {what}']:.2f} ({row['scene']} {row['sides']})"
                       for _, row in known.iterrows())
    return f"{what.capitalize()} per ray are {ratios} times those of Havran & Sixta."
