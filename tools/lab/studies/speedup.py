"""Fig. 9: speed-up against the number of PEs

How many times faster than one PE do P PEs compute an image?

- Source: Kohata & Ito 1993, abstract, Fig. 9 and the text next to it, Table 3.
- Images of {size} x {size} pixels, without antialiasing, on every number of PEs of the SPA from 1 to {pes}. "The picture" is the scene {scene}.
- Speed-up = sum of the loads of all PEs / largest load. A load is the modelled computing time of a PE in cycles, without transfers.
- The ensemble has {ensemble}. A mean of the ensemble is the mean of the families' means.
- For fewer than 256 PEs, Kohata & Ito print neither the offset nor the pixels of each PE. We show p = 0, 16 and round(sqrt(P)). A slot has one
  pixel of each line and moves p pixels to the right from line to line. With the cyclic fold a PE has every P-th slot, with the block fold
  neighbouring slots.
- Kohata & Ito quote speed-ups that the makers of CAP and the Pixel Machine measured for other scenes, and state that Fig. 9 is close to them. The
  claims compare the SPA's speed-ups with these. In the 2-D mapping of both machines, each of A x A PEs has every A-th pixel of every A-th line.
- Output: fig9.csv has a row for each number of PEs P, and a column with the speed-up for each offset and fold. fig9-squares.csv has the square
  numbers and the powers of two, fig9-views.csv means of the ensemble and half widths of 95 % intervals, fig9-sizes.csv other image sizes.
"""
import numpy as np
import pandas as pd
import raya
from raya.lab import (CONTROLS, Comparison, Page, Plot, Series, Table, above, controlled, estimate, estimates, every, first_scene, papers, study, with_paper,
                      within)

OFFSET = 16  # the paper's offset for 256 PEs
HIGH = 0.8  # minimum efficiency by the rules of the claims proportional, few-processors and finer-images
CLOSE, SIMILAR = 0.1, 0.05  # maximum relative difference by the rules of the claims near-cap and near-pixel-machine; like-2d
POWERS = [2**k for k in range(1, 9)]
FINER_VIEWS = 54  # number of pictures in each of the ensembles at 512 x 512 and 1024 x 1024
COLUMNS = {"p = 0": lambda pes: 0 * pes, "p = 16": lambda pes: 0 * pes + OFFSET,
           "p = round(sqrt(P))": lambda pes: np.rint(np.sqrt(pes)).astype(int)}


def speedups(image, pes, fold="cyclic"):
    """Returns {name of an offset: speed-ups on each number of PEs in `pes`}."""
    return {name: raya.speedups(image, pes, offsets(pes) % image.shape[1], fold) for name, offsets in COLUMNS.items()}


def tabulate_speedups(image):
    """Returns (table of the speed-ups on 1 .. W PEs, {A: speed-up on A x A PEs})."""
    pes = np.arange(1, image.shape[1] + 1)
    rows = pd.DataFrame({"P": pes})
    for fold in ("cyclic", "block"):
        for name, values in speedups(image, pes, fold).items():
            rows[f"{name}, {fold} fold"] = values
    sides = range(1, int(len(pes)**0.5) + 1)
    return rows, {a: image.sum() / raya.loads(image, mapping=f"grid:{a}x{a}").max() for a in sides}


def ensembles_of_sizes(lab):
    return [lab.ensemble([], side, views=None if side == 256 else FINER_VIEWS) for side in (256, 512, 1024)]


def prepare(lab, scenes):
    lab.ensemble(scenes, lab.size(256))
    if lab.size(256) == 256 and not scenes:
        ensembles_of_sizes(lab)


@study("fig9", one_scene=True, prepare=prepare)
def fig9(lab, scenes):
    scene, size = first_scene(scenes), lab.size(256)
    ensemble, picture = lab.ensemble(scenes, size), lab.costs(scene, size).trace
    sizes = [picture] + [lab.costs(scene, side).trace for side in ((512, 1024) if size == 256 else ())]
    rows, grids = tabulate_speedups(picture)
    tables = [tabulate_speedups(costs.trace) for costs in ensemble.pictures]
    means = pd.DataFrame({"P": rows["P"]})
    for name in COLUMNS:
        means[name], means[f"{name}, +-"] = estimates([table[f"{name}, cyclic fold"] for table, _ in tables], ensemble.families)
    in_paper = papers.is_papers(scene.name, size)
    large_side = len(grids) // 2 * 2
    grid_ratios, half_side_speedups = zip(*((g[large_side] / g[large_side // 2], g[large_side // 2]) for _, g in tables))
    sides = []  # for each image size a row for each power of two of PEs
    for image in sizes:
        powers = 2 ** np.arange(int(np.log2(image.shape[1])) + 1)
        sides.append(pd.DataFrame({"side (pixels)": image.shape[1], "P": powers, **speedups(image, powers)}))
    sides = pd.concat(sides, ignore_index=True)
    sides["its efficiency"] = sides["p = round(sqrt(P))"] / sides["P"]
    p = rows["P"]
    square = p.isin([a * a for a in grids])
    some = rows[(p > 1) & (square | (p & (p - 1) == 0) | (p % 100 == 0))]
    squares = pd.DataFrame({"P": some["P"], "A x A, 2-D": some["P"].map({a * a: s for a, s in grids.items()}),
                            "p = 0": some["p = 0, cyclic fold"], "p = 16": some["p = 16, cyclic fold"],
                            "p = sqrt(P)": some["p = round(sqrt(P)), cyclic fold"]})
    order = ["P"] + [f"{name}, {fold} fold" for name in COLUMNS for fold in ("cyclic", "block")]
    shown = [Table("fig9-squares", "Speed-up of the picture on square numbers and powers of two of PEs, cyclic fold",
                   squares),
             Table("fig9-views", "Speed-up, mean of the ensemble", means, on_page=False),
             Table("fig9", "Speed-up of the picture for each number of PEs", rows[order], on_page=False),
             Table("fig9-sizes", "Speed-up of the scene at each image size, on 1 PE up to one for each column, cyclic fold", sides)]
    return Page({"scene": scene.name, "size": size, "pes": size, "offset": OFFSET % size, "pictures": len(tables)},
                findings_of(rows, sides, in_paper),
                with_paper(in_paper, comparisons_of(rows, grids, means.iloc[-1], grid_ratios, half_side_speedups, large_side, ensemble.families))
                + (comparisons_of_machines(lab, scene, size) if in_paper else []),
                claims_of(lab, tables, ensemble, control_speedups(ensemble)) if size == 256 and not scenes else [], shown,
                plots_of(rows, grids, means, in_paper),
                placeholders={"ensemble": ensemble.description}, compared_with=papers.SPA)


def comparisons_of(rows, grids, mean, grid_ratios, half_side_speedups, large_side, families):
    last, half_side, pes = rows.iloc[-1], large_side // 2, f"speed-up on {len(rows)} PEs, "
    ratio, half_side_speedup = estimate(grid_ratios, families), estimate(half_side_speedups, families)
    return [Comparison(pes + "p = 16, picture", "", papers.SPEEDUP_16, last["p = 16, cyclic fold"],
                       "229 is printed in the paper's abstracts"),
            Comparison(pes + "p = 16, mean of the ensemble", "", None, mean["p = 16"], "", False, mean["p = 16, +-"]),
            Comparison(pes + "p = 0, picture", "", papers.SPEEDUP_0, last["p = 0, cyclic fold"],
                       "our scene, centre at 256 x 256, is matched to the paper's u(0)", derived=True),
            Comparison(pes + "p = 0, mean of the ensemble", "", None, mean["p = 0"], half_width=mean["p = 0, +-"]),
            Comparison(f"CAP's mapping: speed-up on {large_side}^2 PEs / on {half_side}^2 PEs", "", papers.CAP_RATIO,
                       ratio.mean, "mean of the ensemble; the makers of CAP measured another scene", half_width=ratio.half),
            Comparison(f"Pixel Machine's mapping: speed-up on {half_side}^2 PEs", "", papers.PIXEL_MACHINE_SPEEDUP, half_side_speedup.mean,
                       "mean of the ensemble; the makers measured 60 or more for another scene", half_width=half_side_speedup.half)]


def comparisons_of_machines(lab, scene, size):
    """Compares the makers' speed-ups with ratios of our modelled times of their machines, which include the transfer of the scene."""
    def ratio(machine, few, many):
        totals = [lab.render(scene, machine=machine, mapping=f"grid:{a}x{a}", size=size).report["modelled_ms"]["total"] for a in (few, many)]
        return totals[0] / totals[1]

    remark = "the picture; modelled time, transfer of the scene included (`raya machines` lists the rates and their sources)"
    return [Comparison("machine cap: time on 64 cells / on 256", "", papers.CAP_RATIO, ratio("cap", 8, 16), remark),
            Comparison("machine pixel-machine: time on 1 node / on 64", "", papers.PIXEL_MACHINE_SPEEDUP, ratio("pixel-machine", 1, 8), remark)]


def control_speedups(ensemble):
    """Returns {control: {P: speed-up of each picture}} for powers of two."""
    u = {pes: ensemble.control_u(pes) for pes in POWERS}
    return {name: {pes: pes / (1 + u[pes][name]) for pes in POWERS} for name in CONTROLS}


def claims_of(lab, tables, ensemble, controls):
    """Judges the paper's claims on numbers of PEs (sections 3.3, 4.2 and 6), for images of 256 x 256 pixels."""
    families, about = ensemble.families, ensemble.description

    def speedups_on(name, fold="cyclic"):
        return np.array([table[f"{name}, {fold} fold"] for table, _ in tables])  # [picture, P - 1]

    def text(values, digits=2):
        return estimate(values, families).text(digits)

    cyclic, block = speedups_on("p = 16"), speedups_on("p = 16", "block")
    on_grid = np.array([g[16] for _, g in tables])
    pes = np.arange(2, 257)
    folds = np.stack([cyclic, block])[:, :, 1:] / pes  # [fold, picture, P - 2]
    efficiency = np.where(folds[0].mean(0) >= folds[1].mean(0), folds[0], folds[1])
    worst = int(efficiency.mean(0).argmin())
    low_count = (efficiency.mean(0) < HIGH).sum()
    tested = {pes: cyclic[:, pes - 1] for pes in POWERS}
    on_16 = speedups_on("p = 0")[:, 15]
    ensembles = ensembles_of_sizes(lab)
    efficiencies_by_size = [one.map(lambda costs: 1 / (1 + raya.imbalances(costs.trace, costs.trace.shape[1], [round(costs.trace.shape[1]**0.5)])[0]))
                            for one in ensembles]
    finer_controls = {name: [1 / (1 + u[name]) for u in map(lambda one: one.control_u(one.pictures[0].trace.shape[1]), ensembles)] for name in CONTROLS}

    def rule(low, high, value_of):
        return lambda speedups: within(value_of(speedups), low, high, families)

    def proportional(speedups):
        return every(above(speedups[pes] / pes, HIGH, families) for pes in POWERS)

    def finer(efficiencies):
        return every(above(values, HIGH, one.families) for values, one in zip(efficiencies, ensembles))

    return [controlled("like-2d", rule(1 - SIMILAR, 1 + SIMILAR, lambda s: s[256] / on_grid), tested, controls, about,
                       f"Speed-up with p = 16 / speed-up of 16 x 16 PEs in two dimensions: {text(tested[256] / on_grid, 3)}. The mean speed-ups are "
                       f"{text(tested[256], 1)} and {text(on_grid, 1)}."),
            controlled("proportional", proportional, {pes: pes * efficiency[:, pes - 2] for pes in POWERS}, controls, about,
                   f"On powers of two the mean efficiency is at least {min(efficiency[:, p - 2].mean() for p in POWERS):.2f}. On other numbers of "
                   f"PEs the speed-up rises in steps, as PEs own whole columns: the mean efficiency is below {HIGH} for {low_count} of 255 numbers "
                   f"of PEs; the lowest is {text(efficiency[:, worst])} at P = {pes[worst]}, where no mapping of whole columns exceeds "
                   f"{256 / (pes[worst] * -(-256 // pes[worst])):.2f}."),
            controlled("near-cap", rule(papers.CAP_RATIO * (1 - CLOSE), papers.CAP_RATIO * (1 + CLOSE), lambda s: s[256] / s[64]), tested, controls, about,
                       f"Speed-up of the SPA on 256 PEs / on 64 PEs: {text(tested[256] / tested[64])}."),
            controlled("near-pixel-machine", rule(papers.PIXEL_MACHINE_SPEEDUP * (1 - CLOSE), papers.PIXEL_MACHINE_SPEEDUP * (1 + CLOSE), lambda s: s[64]),
                       tested, controls, about, f"Speed-up of the SPA on 64 PEs: {text(tested[64])}."),
            controlled("few-processors", lambda s: above(s[16] / 16, HIGH, families), {16: on_16}, controls, about,
                       f"Efficiency of the column split on 16 PEs: {text(on_16 / 16, 3)}."),
            controlled("finer-images", finer, efficiencies_by_size, finer_controls,
                   f"{about}; {FINER_VIEWS} pictures each at 512 x 512 and 1024 x 1024",
                   "Efficiency at 256, 512 and 1024 pixels a side: "
                   + ", ".join(estimate(values, one.families).text(3) for values, one in zip(efficiencies_by_size, ensembles)) + ".")]


def findings_of(rows, sides, in_paper):
    w = len(rows)
    p16, p0 = (rows[f"{name}, cyclic fold"] for name in ("p = 16", "p = 0"))
    whole = f"On {w} PEs the speed-up of the picture is {p16[w - 1]:.1f} with p = 16 and {p0[w - 1]:.1f} with p = 0"
    if in_paper:
        ratio = p16[w - 1] / papers.SPEEDUP_16
        how = "more than" if ratio > 1.02 else "less than" if ratio < 0.98 else "within 2 % of"
        whole += f"; with p = 16 it is {how} the {papers.SPEEDUP_16} of Kohata & Ito's abstract"
    worst = sides.loc[sides["its efficiency"].idxmin()]
    columns = sides[sides["P"] == sides["side (pixels)"]]
    sized = (f"With a PE for each column and p = round(sqrt(P)), images of "
             f"{', '.join(map(str, sides['side (pixels)'].unique()))} pixels a side have a speed-up of "
             + ", ".join(f"{s:.0f} on {p} PEs" for s, p in zip(columns["p = round(sqrt(P))"], columns["P"])) +
             ": the array can grow to one PE for each column, as Kohata & Ito conclude. The lowest efficiency on "
             f"1, 2, 4, ... PEs, up to one for each column, is {worst['its efficiency']:.2f}, on {worst['P']:.0f} PEs at "
             f"{worst['side (pixels)']:.0f} x {worst['side (pixels)']:.0f}.")
    return [whole + ".", sized]


def plots_of(rows, grids, means, in_paper):
    pes, w = rows["P"], len(rows)
    squares = [a * a for a in grids]
    paper = [Series("Kohata & Ito, p = 0 and 16", [w, w], [papers.SPEEDUP_0, papers.SPEEDUP_16], "paper"),
             Series("Pixel Machine, scene of its makers, at least", [64], [papers.PIXEL_MACHINE_SPEEDUP], "paper")]
    some = means[(pes % 8 == 0) | (pes == w)]
    labels = {"p = 16": "p = 16", "p = round(sqrt(P))": "p = round(sqrt(P))", "p = 0": "p = 0, column split"}
    folds = [Series(f"{name}, {fold} fold", pes, rows[f"{name}, {fold} fold"] / pes)
             for name in ("p = 16", "p = 0") for fold in ("cyclic", "block")]
    return [Plot("fig9", "Speed-up of the picture against the number of PEs, cyclic fold", "PEs", "speed-up",
                 [Series("ideal", pes, pes),
                  *(Series(label, pes, rows[f"{name}, cyclic fold"]) for name, label in labels.items()),
                  Series("2-D, A x A PEs", squares, grids.values(), "points"), *(paper if in_paper else [])]),
            Plot("fig9-views", "Speed-up against the number of PEs, mean of the ensemble", "PEs", "speed-up",
                 [Series("ideal", pes, pes), *(Series(label, some["P"], some[name], half_widths=some[f"{name}, +-"])
                                               for name, label in labels.items()), *(paper[:1] if in_paper else [])]),
            Plot("fig9-folds", "Efficiency of the picture against the number of PEs, both folds", "PEs", "efficiency",
                 folds + [Series("2-D, A x A PEs", squares, np.divide([*grids.values()], squares), "points")])]
