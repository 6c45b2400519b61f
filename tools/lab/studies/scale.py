"""From 16 PEs to one for each pixel

Up to how many PEs do static mappings scale, and is a two-dimensional mapping necessary beyond a PE for each column?

- Source: Kohata & Ito 1993, conclusions.
- {scene} at {size} x {size} on {fewest} to {most} PEs of the SPA, doubling; first pass.
- If there are more PEs than columns, several PEs share a slot: they take its rows in turn (cyclic fold) or in runs (block fold).
- p = sqrt(P) or W / sqrt(P), for an image of W columns: sqrt(P) up to a PE for each column, W / sqrt(P) beyond, where the rows of a PE are P / W
  apart and a smaller offset gives the same square spacing. All offsets are rounded.
- Upper bound: all cycles / max(mean load, largest pixel). A mapping "keeps up" if it has at least {close} % of the 2-D mapping's
  efficiency.
- Output: scale.csv and scale-views.csv have a row for each number of PEs P and a column with the efficiency (mean load / largest load) of each
  mapping; scale-half.csv has the largest P with an efficiency of at least 50 %.
"""
import numpy as np
import pandas as pd
import raya
from raya.lab import Claim, Comparison, Page, Plot, Series, Table, estimate, first_scene, papers, study, verdict
from raya.lab.mappings import squarest_grid

HALF_EFFICIENCY, KEEPS_UP, VIEWS = 0.5, 0.9, 8  # KEEPS_UP: our limit, minimum fraction of the 2-D mapping's efficiency
GRID = "2-D, A x B PEs"
FIXED, ROOT, ADAPTED = "p = 16", "p = sqrt(P)", "p = sqrt(P) or W / sqrt(P)"
# Offsets, rounded to integers. If P > W, consecutive rows of a PE are P / W rows apart. With p = W / sqrt(P), a PE's next pixel is
# sqrt(W W / P) pixels to the side.
OFFSETS = {FIXED: lambda w, p: 16, ROOT: lambda w, p: round(p**0.5), ADAPTED: lambda w, p: round(min(p**0.5, w / p**0.5)),
           "column split": lambda w, p: 0}
PLAIN = [*OFFSETS, GRID, "random"]  # mappings with the cyclic fold, and those without a fold
FOLDED = [f"{name}, block fold" for name in OFFSETS]


def options_of(name, side, pes):
    if name == GRID:
        return {"mapping": "grid:{}x{}".format(*squarest_grid(pes))}
    if name == "random":
        return {"mapping": "random:1", "pes": pes}
    fold = "block" if name in FOLDED else "cyclic"
    return {"offset": OFFSETS[name.removesuffix(", block fold")](side, pes) % side, "fold": fold, "pes": pes}


def efficiencies(image):
    side, total, rows = len(image), int(image.sum()), []
    for pes in 2 ** np.arange(4, 2 * int(np.log2(side)) + 1):
        row = {"P": pes, "upper bound": total / raya.lower_bound(image, pes) / pes}
        for name in PLAIN + FOLDED:
            loads = raya.loads(image, **options_of(name, side, int(pes)))
            row[name] = loads.mean() / loads.max()
        rows.append(row)
    return pd.DataFrame(rows)


@study("scale", one_scene=True)
def scale(lab, scenes):
    scene, side = first_scene(scenes), lab.size(1024)
    ensemble = lab.ensemble(scene, side, "none", VIEWS)
    image = ensemble.picture.trace
    rows = efficiencies(image)
    of_views = [efficiencies(view.trace) for view in ensemble.views]
    between = (rows["P"] > side) & (rows["P"] < side * side)
    largest = int(image.max()) * image.size / int(image.sum())  # cost of the most expensive pixel / mean cost of a pixel
    halves = pd.DataFrame([half_of(name, rows) for name in ["upper bound", *PLAIN, *FOLDED]])
    texts = [f"{name}: {pes or 'none'}" for name, pes, _ in halves[1:1 + len(PLAIN)].itertuples(index=False)]
    means = means_of(of_views)
    return Page({"scene": scene.name, "size": side, "pes": rows["P"].tolist(), "offset": 16 % side, "seed": 1,
                 "views": len(of_views)},
                [f"Numbers of PEs up to which the efficiency is at least 50 %: {'; '.join(texts)}; for any distribution of whole "
                 f"pixels: {halves.iloc[0, 1]}.",
                 finding_of_2d(rows[between]), finding_of_resonance(rows[between], side),
                 f"The largest pixel costs {largest:.1f} times the mean one, so no distribution of whole pixels has a speed-up of more "
                 f"than {side * side / largest:.0f}. A PE for each pixel reaches it with every mapping, at an efficiency of "
                 f"{1 / largest:.3f}."],
                comparisons_of(rows, side, side * side / largest),
                [claim_of_2d(rows["P"][between], of_views)] if len(of_views) > 1 else [],
                [Table("scale-half", "Numbers of PEs up to which the efficiency is at least 50 %", halves),
                 Table("scale", "Efficiency for each number of PEs", rows),
                 Table("scale-views", "Efficiency for each number of PEs, mean of the pictures", means, on_page=False)],
                plots_of(rows, means, len(of_views)),
                ["Kohata & Ito stop at a PE for each column. This study extends the arrays to a PE for each pixel, and shows the "
                 "upper bound of any distribution of whole pixels."],
                placeholders={"fewest": rows["P"].min(), "most": rows["P"].max(), "close": f"{100 * KEEPS_UP:.0f}"},
                compared_with=papers.SPA)


def half_of(name, rows):
    """(largest P up to which the efficiency is at least 50 %, speed-up for this P); 0 if there is no such P."""
    some = rows[(rows[name] >= HALF_EFFICIENCY).cummin()]
    pes, efficiency = some[["P", name]].iloc[-1] if len(some) else (0, 0.0)
    return {"mapping": name, "50 % or more up to P": int(pes), "speed-up there": efficiency * pes}


def means_of(of_views):
    table = {"P": of_views[0]["P"], "upper bound": np.mean([v["upper bound"] for v in of_views], axis=0)}
    for name in PLAIN:
        estimates = [estimate(column) for column in np.array([v[name] for v in of_views]).T]
        table[name], table[f"{name}, +-"] = [e.mean for e in estimates], [e.half for e in estimates]
    return pd.DataFrame(table)


def finding_of_2d(between):
    kept = {name: between["P"][between[name] >= KEEPS_UP * between[GRID]].tolist()
            for name in (FIXED, ROOT, ADAPTED, "column split", "random")}
    best = max((FIXED, ROOT, ADAPTED), key=lambda name: len(kept[name]))
    if len(kept[best]) == len(between):
        need = f"So 2-D is not necessary: a mapping \"or the like\" is enough, {best}, with shared rows."
    elif not kept[best]:
        need = "So 2-D is necessary, as Kohata & Ito say."
    else:
        need = f"So 2-D is not always necessary: {best} is enough for P = {', '.join(map(str, kept[best]))}."
    counts = "; ".join(f"{name}: {len(pes)}" for name, pes in kept.items())
    return (f"For more PEs than pixels a side Kohata & Ito ask for 2-D \"or the like\". Of {len(between)} such arrays, the number on "
            f"which a mapping keeps up with 2-D is: {counts}. {need}")


def finding_of_resonance(between, side):
    """Sentence on offsets that have no effect. The next row of a PE is s = P / W rows further on, where the offset shifts the PE's pixel by s p
    columns. If s p is a multiple of W, the pixel stays in its column."""
    lost = {name: [str(p) for p in between["P"] if p % side == 0 and p // side * OFFSETS[name](side, p) % side == 0]
            for name in (FIXED, ROOT, ADAPTED)}
    texts = [f"{name} for P = {', '.join(pes)}" for name, pes in lost.items() if pes]
    if not texts:
        return "No offset here has the load of the column split where PEs share the rows of a slot."
    return ("Where PEs share the rows of a slot, an offset can cancel out: if the shift after P / W rows is a multiple of W, the load "
            f"is that of the column split. This happens with {'; '.join(texts)}.")


def claim_of_2d(between, of_views):
    """Verdict on the claim that a 2-D mapping is necessary, for arrays with more PEs than columns: reproduced if a cyclic mapping is about as
    fast as 2-D on none of them, not reproduced if one is on all of them."""
    over = {name: [estimate([v[name][i] / v[GRID][i] for v in of_views]) for i in between.index]
            for name in (FIXED, ROOT, ADAPTED)}
    none = all(e.high < KEEPS_UP for estimates in over.values() for e in estimates)
    lows = {name: min(e.low for e in estimates) for name, estimates in over.items()}
    best = max(lows, key=lows.get) if max(lows.values()) > 0 else FIXED
    worst = min(range(len(between)), key=lambda i: over[best][i].mean)
    return Claim(papers.SPA, "conclusions", "More PEs than pixels a side need 2-D or the like.",
                 verdict(none, lows[best] >= KEEPS_UP),
                 f"Over {len(of_views)} pictures, on {len(between)} arrays with more PEs than columns, the best of the "
                 f"cyclic mappings is {best}, with shared rows. It has at least {over[best][worst].text(2)} of the 2-D "
                 f"mapping's efficiency (on {between.iloc[worst]} PEs); {KEEPS_UP} or more counts as keeping up.")


def comparisons_of(rows, side, most):
    row = rows[rows["P"] * 2 > side].iloc[0]
    return [Comparison(f"efficiency on {row['P']:.0f} PEs, {name}", "", None, row[name]) for name in PLAIN] + [
        Comparison("upper bound of the speed-up", "", None, most, "all cycles / those of the largest pixel")]


def plots_of(rows, means, pictures):
    def lines(names, times=1):
        return [Series(name, rows["P"], rows[name] * times) for name in names]

    both = [name + fold for name in (FIXED, ADAPTED, "column split") for fold in ("", ", block fold")]
    return [Plot("scale", "Efficiency against the number of PEs, cyclic fold", "PEs", "efficiency",
                 lines(["upper bound", *PLAIN]), "x"),
            Plot("scale-folds", "Efficiency against the number of PEs, both folds", "PEs", "efficiency", lines(both),
                 "x"),
            Plot("scale-speedup", "Speed-up against the number of PEs, cyclic fold", "PEs", "speed-up",
                 lines(["upper bound", *PLAIN], rows["P"]), "xy"),
            Plot("scale-views", f"Efficiency against the number of PEs, mean of {pictures} pictures", "PEs",
                 "efficiency", [Series(name, means["P"], means[name], half_widths=means[f"{name}, +-"])
                                for name in PLAIN], "x")]
