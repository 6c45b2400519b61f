"""From 16 PEs to one for each pixel

How far do static mappings go, and does it take two dimensions beyond a PE for each column?

- {scene} at {size} x {size} on {fewest} to {most} PEs of the SPA, doubling; first pass.
- Where there are more PEs than columns, PEs share a slot: its rows go to them in turn (cyclic fold) or in runs (block
  fold).
- p = sqrt(P) or W / sqrt(P): the former up to a PE for each column, the latter beyond, where the rows of a PE lie P / W
  apart and the same square spacing takes a smaller offset. All rounded.
- Upper bound: all cycles / max(mean load, largest pixel). "Keeps up": {close} % of the 2-D mapping's efficiency or
  more.
"""
import numpy as np
import pandas as pd
import raya
from raya.lab import Claim, Comparison, Page, Plot, Series, Table, estimate, one_of, papers, study, verdict
from raya.lab.mappings import squarest_grid

HALF, CLOSE, VIEWS = 0.5, 0.9, 8
GRID = "2-D, A x B PEs"
FIXED, ROOT, LIKE = "p = 16", "p = sqrt(P)", "p = sqrt(P) or W / sqrt(P)"
# Rounded. Where P > W the rows of a PE lie P / W apart; its next pixel lies sqrt(W W / P) to the side for W / sqrt(P).
OFFSETS = {FIXED: lambda w, p: 16, ROOT: lambda w, p: round(p**0.5), LIKE: lambda w, p: round(min(p**0.5, w / p**0.5)),
           "column split": lambda w, p: 0}
PLAIN = [*OFFSETS, GRID, "random"]  # with the cyclic fold, or without any
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
    scene, side = one_of(scenes), lab.size(1024)
    ensemble = lab.ensemble(scene, side, "none", VIEWS)
    image = ensemble.picture.trace
    rows = efficiencies(image)
    of_views = [efficiencies(view.trace) for view in ensemble.views]
    between = (rows["P"] > side) & (rows["P"] < side * side)
    largest = int(image.max()) * image.size / int(image.sum())  # pixel, in mean pixels
    halves = pd.DataFrame([half_of(name, rows) for name in ["upper bound", *PLAIN, *FOLDED]])
    texts = [f"{name}: {pes or 'none'}" for name, pes, _ in halves[1:1 + len(PLAIN)].itertuples(index=False)]
    means = means_of(of_views)
    return Page({"scene": scene.name, "size": side, "pes": rows["P"].tolist(), "offset": 16 % side, "seed": 1,
                 "views": len(of_views)},
                [f"PEs up to which half of the array's power or more is used: {'; '.join(texts)}; whole pixels, "
                 f"however given out: {halves.iloc[0, 1]}.",
                 finding_of_2d(rows[between]), finding_of_resonance(rows[between], side),
                 f"The largest pixel costs {largest:.1f} times the mean one, so no distribution of whole pixels gains "
                 f"more than {side * side / largest:.0f} times; that is what a PE for each pixel gives whatever the "
                 f"mapping, an efficiency of {1 / largest:.3f}."],
                comparisons_of(rows, side, side * side / largest),
                [claim_of_2d(rows["P"][between], of_views)] if len(of_views) > 1 else [],
                [Table("scale-half", "Where each falls under an efficiency of 50 %", halves),
                 Table("scale", "Efficiency for each number of PEs", rows),
                 Table("scale-views", "Efficiency for each number of PEs, mean of the pictures", means, on_page=False)],
                plots_of(rows, means, len(of_views)),
                ["Kohata & Ito end at a PE for each column. Here arrays go on to a PE for each pixel, next to the "
                 "bound that no distribution of whole pixels passes."],
                words={"fewest": rows["P"].min(), "most": rows["P"].max(), "close": f"{100 * CLOSE:.0f}"},
                beside=papers.SPA)


def half_of(name, rows):
    """The last P up to which the efficiency is 50 % or more, and the speed-up there; 0: never."""
    some = rows[(rows[name] >= HALF).cummin()]
    pes, efficiency = some[["P", name]].iloc[-1] if len(some) else (0, 0.0)
    return {"mapping": name, "50 % or more up to P": int(pes), "speed-up there": efficiency * pes}


def means_of(of_views):
    table = {"P": of_views[0]["P"], "upper bound": np.mean([v["upper bound"] for v in of_views], axis=0)}
    for name in PLAIN:
        estimates = [estimate(column) for column in np.array([v[name] for v in of_views]).T]
        table[name], table[f"{name}, +-"] = [e.mean for e in estimates], [e.half for e in estimates]
    return pd.DataFrame(table)


def finding_of_2d(between):
    kept = {name: between["P"][between[name] >= CLOSE * between[GRID]].tolist()
            for name in (FIXED, ROOT, LIKE, "column split", "random")}
    best = max((FIXED, ROOT, LIKE), key=lambda name: len(kept[name]))
    if len(kept[best]) == len(between):
        need = f"So it does not take 2-D, but it takes \"the like\": {best}, its rows shared, is enough."
    elif not kept[best]:
        need = "So it does take 2-D, as Kohata & Ito say."
    else:
        need = f"So it does not always take 2-D: {best} does for P = {', '.join(map(str, kept[best]))}."
    counts = "; ".join(f"{name}: {len(pes)}" for name, pes in kept.items())
    return (f"More PEs than pixels a side, where Kohata & Ito ask for 2-D \"or the like\": of {len(between)} such "
            f"arrays 2-D is kept up with on ({counts}). {need}")


def finding_of_resonance(between, side):
    """With s = P / W rows from one row of a PE to its next, p shifts these by s p columns: not at all for multiples of
    W."""
    lost = {name: [str(p) for p in between["P"] if p % side == 0 and p // side * OFFSETS[name](side, p) % side == 0]
            for name in (FIXED, ROOT, LIKE)}
    words = [f"{name} for P = {', '.join(pes)}" for name, pes in lost.items() if pes]
    if not words:
        return "No offset here falls back to the column split where PEs share the rows of a slot."
    return ("Where PEs share the rows of a slot, an offset can cancel out: P / W rows further on the shift is a "
            f"multiple of W, and the load is the column split's. So it is with {'; '.join(words)}.")


def claim_of_2d(between, of_views):
    """2-D is needed where no cyclic mapping keeps up on any array of more PEs than columns; not where one does on
    all."""
    over = {name: [estimate([v[name][i] / v[GRID][i] for v in of_views]) for i in between.index]
            for name in (FIXED, ROOT, LIKE)}
    none = all(e.high < CLOSE for estimates in over.values() for e in estimates)
    lows = {name: min(e.low for e in estimates) for name, estimates in over.items()}
    best = max(lows, key=lows.get) if max(lows.values()) > 0 else FIXED
    worst = min(range(len(between)), key=lambda i: over[best][i].mean)
    return Claim(papers.SPA, "conclusions", "More PEs than pixels a side need 2-D or the like.",
                 verdict(none, lows[best] >= CLOSE),
                 f"Over {len(of_views)} pictures, on {len(between)} arrays of more PEs than columns, the best of the "
                 f"cyclic mappings is {best}, its rows shared: at worst {over[best][worst].text(2)} of the 2-D "
                 f"mapping's efficiency, on {between.iloc[worst]} PEs; it keeps up with {CLOSE} or more.")


def comparisons_of(rows, side, most):
    row = rows[rows["P"] * 2 > side].iloc[0]
    return [Comparison(f"efficiency on {row['P']:.0f} PEs, {name}", "", None, row[name]) for name in PLAIN] + [
        Comparison("largest speed-up there can be", "", None, most, "all cycles / those of the largest pixel")]


def plots_of(rows, means, pictures):
    def lines(names, times=1):
        return [Series(name, rows["P"], rows[name] * times) for name in names]

    both = [name + fold for name in (FIXED, LIKE, "column split") for fold in ("", ", block fold")]
    return [Plot("scale", "Efficiency against the number of PEs, cyclic fold", "PEs", "efficiency",
                 lines(["upper bound", *PLAIN]), "x"),
            Plot("scale-folds", "Efficiency against the number of PEs, both folds", "PEs", "efficiency", lines(both),
                 "x"),
            Plot("scale-speedup", "Speed-up against the number of PEs, cyclic fold", "PEs", "speed-up",
                 lines(["upper bound", *PLAIN], rows["P"]), "xy"),
            Plot("scale-views", f"Efficiency against the number of PEs, mean of {pictures} pictures", "PEs",
                 "efficiency", [Series(name, means["P"], means[name], half_widths=means[f"{name}, +-"])
                                for name in PLAIN], "x")]
