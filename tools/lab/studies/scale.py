"""From 16 PEs to one PE per pixel

Up to how many PEs do static mappings scale, and is a two-dimensional mapping necessary if there are more PEs than columns?

- Source: Kohata & Ito 1993, conclusions.
- Scene {scene}, {size} x {size} pixels, on {fewest} to {most} PEs of the SPA (powers of two); first pass.
- If P, the number of PEs, is greater than W, the number of columns, P / W PEs share each slot of the cyclic mapping. They own its rows in
  turn (cyclic fold) or in runs (block fold).
- The offset "p = sqrt(P) or W / sqrt(P)" is sqrt(P) if P <= W. If P > W, the rows of a PE are P / W apart, and p = W / sqrt(P) shifts its
  pixel by sqrt(P) columns from one of its rows to the next. All offsets are rounded.
- Ensemble: {ensemble}. The first table and most plots show {scene} only.
- Upper bound of the speed-up: sum of all costs / max(mean load, highest cost of a pixel). A mapping "keeps up" with the 2-D mapping if
  its efficiency is at least {close} % of that of the 2-D mapping.
- Output: scale.csv and scale-views.csv have a row for each number of PEs P and a column with the efficiency (mean load / largest load) of
  each mapping; scale-half.csv has the largest P up to which the efficiency is at least 50 %.
"""
import numpy as np
import pandas as pd
import raya
from raya.lab import Comparison, Page, Plot, Series, Table, estimate, estimates, first_scene, judged, papers, study

HALF_EFFICIENCY, KEEPS_UP, VIEWS = 0.5, 0.9, 18  # KEEPS_UP: minimum of efficiency / efficiency of the 2-D mapping
GRID = "2-D, A x B PEs"
FIXED, ROOT, ADAPTED = "p = 16", "p = sqrt(P)", "p = sqrt(P) or W / sqrt(P)"
# Offsets, rounded to integers. If P > W, consecutive rows of a PE are P / W rows apart. With p = W / sqrt(P), the PE's pixel in its next
# row is (P / W) p = sqrt(P) columns to the right.
OFFSETS = {FIXED: lambda w, p: 16, ROOT: lambda w, p: round(p**0.5), ADAPTED: lambda w, p: round(min(p**0.5, w / p**0.5)),
           "column split": lambda w, p: 0}
PLAIN = [*OFFSETS, GRID, "random"]  # mappings with the cyclic fold, and those without a fold
FOLDED = [f"{name}, block fold" for name in OFFSETS]


def squarest_grid(pes):
    """Returns the 2-D mapping that is nearest to a square: A rows of B PEs, where A is the largest divisor of `pes` that is at most sqrt(pes)."""
    rows = max(a for a in range(1, int(pes**0.5) + 1) if pes % a == 0)
    return f"grid:{rows}x{pes // rows}"


def efficiencies(image):
    side, total, rows = len(image), int(image.sum()), []
    for pes in [2**k for k in range(4, 2 * int(np.log2(side)) + 1)]:
        options = {GRID: {"mapping": squarest_grid(pes)}, "random": {"mapping": "random:1", "pes": pes}}
        for name, offset in OFFSETS.items():
            options[name] = {"offset": offset(side, pes) % side, "pes": pes}
            options[f"{name}, block fold"] = {**options[name], "fold": "block"}
        loads = {name: raya.loads(image, **options[name]) for name in PLAIN + FOLDED}
        rows.append({"P": pes, "upper bound": total / raya.lower_bound(image, pes) / pes, **{name: one.mean() / one.max() for name, one in loads.items()}})
    return pd.DataFrame(rows)


@study("scale", one_scene=True, prepare=lambda lab, scenes: lab.ensemble(scenes, lab.size(1024), views=VIEWS))
def scale(lab, scenes):
    scene, side = first_scene(scenes), lab.size(1024)
    ensemble, image = lab.ensemble(scenes, side, views=VIEWS), lab.costs(scene, side).trace
    rows = efficiencies(image)
    view_tables = [efficiencies(costs.trace) for costs in ensemble.pictures]
    between = (rows["P"] > side) & (rows["P"] < side * side)
    largest = int(image.max()) * image.size / int(image.sum())  # cost of the most expensive pixel / mean cost of a pixel
    halves = []  # the largest P up to which the efficiency of a mapping is at least 50 % (0: none), and the speed-up for this P
    for name in ["upper bound", *PLAIN, *FOLDED]:
        efficient = rows[(rows[name] >= HALF_EFFICIENCY).cummin()]
        pes, efficiency = efficient[["P", name]].iloc[-1] if len(efficient) else (0, 0.0)
        halves.append({"mapping": name, "50 % or more up to P": int(pes), "speed-up there": efficiency * pes})
    halves = pd.DataFrame(halves)
    half = rows[rows["P"] * 2 > side].iloc[0]
    texts = [f"{name}: {pes or 'none'}" for name, pes, _ in halves[1:1 + len(PLAIN)].itertuples(index=False)]
    means = pd.DataFrame({"P": rows["P"], "upper bound": np.mean([v["upper bound"] for v in view_tables], axis=0)})
    for name in PLAIN:
        means[name], means[f"{name}, +-"] = estimates([v[name] for v in view_tables], ensemble.families)

    def lines(names, times=1):
        return [Series(name, rows["P"], rows[name] * times) for name in names]

    both = [name + fold for name in (FIXED, ADAPTED, "column split") for fold in ("", ", block fold")]
    plots = [Plot("scale", "Efficiency against the number of PEs, cyclic fold", "number of PEs", "efficiency",
                  lines(["upper bound", *PLAIN]), "x"),
             Plot("scale-folds", "Efficiency against the number of PEs, both folds", "number of PEs", "efficiency", lines(both),
                  "x"),
             Plot("scale-speedup", "Speed-up against the number of PEs, cyclic fold", "number of PEs", "speed-up",
                  lines(["upper bound", *PLAIN], rows["P"]), "xy"),
             Plot("scale-views", f"Efficiency against the number of PEs, mean of {len(view_tables)} pictures", "number of PEs",
                  "efficiency", [Series(name, means["P"], means[name], half_widths=means[f"{name}, +-"])
                                 for name in PLAIN], "x")]
    return Page({"scene": scene.name, "size": side, "pes": rows["P"].tolist(), "offset": 16 % side, "seed": 1,
                 "views": len(view_tables)},
                [f"Number of PEs up to which the efficiency is at least 50 %: {'; '.join(texts)}; upper bound for all mappings that give "
                 f"each pixel to one PE: {halves.iloc[0, 1]}.",
                 finding_of_2d(rows[between]),
                 f"The most expensive pixel costs {largest:.1f} times the mean, so no mapping that gives each pixel to one PE has a speed-up of "
                 f"more than {side * side / largest:.0f}. With a PE for each pixel every mapping has this speed-up, at an efficiency of "
                 f"{1 / largest:.3f}."],
                [*(Comparison(f"efficiency on {half['P']:.0f} PEs, {name}", "", None, half[name]) for name in PLAIN),
                 Comparison("upper bound of the speed-up", "", None, side * side / largest,
                            "cycles of all pixels / cycles of the most expensive pixel")],
                [claim_of_2d(rows["P"][between], view_tables, ensemble)] if not scenes else [],
                [Table("scale-half", "Number of PEs up to which the efficiency is at least 50 %", halves),
                 Table("scale", "Efficiency for each number of PEs", rows),
                 Table("scale-views", "Efficiency for each number of PEs, mean of the ensemble", means, on_page=False)],
                plots,
                [f"At {side} x {side} pixels, p = 16 has an efficiency of at least 50 % up to {halves.iloc[1, 1]} PEs. No mapping that gives each "
                 f"pixel to one PE has it beyond {halves.iloc[0, 1]} PEs."],
                placeholders={"ensemble": ensemble.description, "fewest": rows["P"].min(), "most": rows["P"].max(), "close": f"{100 * KEEPS_UP:.0f}"},
                compared_with=papers.SPA)


def finding_of_2d(between):
    kept = {name: between["P"][between[name] >= KEEPS_UP * between[GRID]].tolist()
            for name in (FIXED, ROOT, ADAPTED, "column split", "random")}
    best = max((FIXED, ROOT, ADAPTED), key=lambda name: len(kept[name]))
    if len(kept[best]) == len(between):
        need = f"So a 2-D mapping is not necessary: the cyclic mapping with {best}, in which several PEs share a slot, is enough."
    elif not kept[best]:
        need = "So a 2-D mapping is necessary, as Kohata & Ito say."
    else:
        need = f"So a 2-D mapping is not always necessary: {best} is enough for P = {', '.join(map(str, kept[best]))}."
    counts = "; ".join(f"{name}: {len(pes)}" for name, pes in kept.items())
    return (f"For more PEs than columns Kohata & Ito propose a 2-D mapping \"or the like\". Of {len(between)} numbers of PEs greater than W, each "
            f"mapping keeps up with the 2-D mapping for this many: {counts}. {need}")


def claim_of_2d(between, view_tables, ensemble):
    """Judges the claim that a 2-D mapping is necessary for more PEs than columns. between: the numbers of PEs above the number of columns."""
    ratios_to_2d = {name: np.array([[v[name][i] / v[GRID][i] for i in between.index] for v in view_tables]) for name in (FIXED, ROOT, ADAPTED)}
    best = [max(ratios_to_2d, key=lambda name, i=i: ratios_to_2d[name][:, i].mean()) for i in range(len(between))]  # for each array
    ratios = np.array([ratios_to_2d[name][:, i] for i, name in enumerate(best)])  # [array, view]
    worst = int(ratios.mean(1).argmin())
    return judged("beyond-a-side", None, ensemble.description,
                  f"For {len(between)} numbers of PEs above the number of columns, the best cyclic mapping is {', '.join(dict.fromkeys(best))}. Its "
                  f"efficiency / that of 2-D is lowest for {between.iloc[worst]} PEs: {estimate(ratios[worst], ensemble.families).text(2)}.")
