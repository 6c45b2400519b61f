"""Fig. 9: speed-up against the number of PEs

How many times faster do P PEs compute the image than one?

- Source: Kohata & Ito 1993, abstract, Fig. 9 and the text next to it, Table 3.
- {scene} at {size} x {size} on 1 to {pes} PEs of the SPA, every number; first pass.
- Speed-up = sum of all loads / largest load, from one cost image: modelled computing, without transfers.
- {views} views of the same scene, seeds {view_seeds}, as in Fig. 8, are computed in addition to the picture.
- A speed-up of one picture (229, 3.86) is reproduced under the rule of Fig. 8; "60 or more" is reproduced if the interval of the mean
  begins at 60 or above.
- Kohata & Ito do not say which offset they used for fewer than 256 PEs, nor which PE then has which columns. The plots show p = 16 and
  p = round(sqrt(P)), with both folds.
- The mapping of CAP and the Pixel Machine: A x A PEs, each with every A-th pixel of every A-th line. Kohata & Ito quote measurements of
  those machines; here their mapping has the same scene as the others.
- Output: fig9.csv has a row for each number of PEs P and a column with the speed-up of each offset and fold; fig9-squares.csv, fig9-views.csv
  (means of the views, half widths of 95 % intervals) and fig9-sizes.csv (other image sizes).
"""
import numpy as np
import pandas as pd
import raya
from raya.lab import (Claim, Comparison, Page, Plot, Series, Table, bonferroni_confidence, estimate, first_scene,
                      papers, prediction_text, study, verdict, verdict_by_prediction, with_paper)

OFFSET = 16  # the paper's offset for 256 PEs
COLUMNS = {"p = 0": lambda pes: 0 * pes, "p = 16": lambda pes: 0 * pes + OFFSET,
           "p = round(sqrt(P))": lambda pes: np.rint(np.sqrt(pes)).astype(int)}


def speedups(image, pes, fold="cyclic"):
    """{name of an offset: speed-up on each number of PEs}"""
    return {name: raya.speedups(image, pes, offsets(pes) % image.shape[1], fold)
            for name, offsets in COLUMNS.items()}


def tabulate_speedups(image):
    """Returns (table of the speed-ups on 1 .. W PEs, {A: speed-up on A x A PEs})."""
    pes = np.arange(1, image.shape[1] + 1)
    rows = pd.DataFrame({"P": pes})
    for fold in ("cyclic", "block"):
        for name, values in speedups(image, pes, fold).items():
            rows[f"{name}, {fold} fold"] = values
    sides = range(1, int(len(pes)**0.5) + 1)
    return rows, {a: image.sum() / raya.loads(image, mapping=f"grid:{a}x{a}").max() for a in sides}


@study("fig9", one_scene=True)
def fig9(lab, scenes):
    scene, size = first_scene(scenes), lab.size(256)
    ensemble = lab.ensemble(scene, size)
    picture = ensemble.picture.trace
    sizes = [picture] + [lab.costs(scene, side).trace for side in ((512, 1024) if size == 256 else ())]
    rows, grids = tabulate_speedups(picture)
    views = [tabulate_speedups(view.trace) for view in ensemble.views]
    means = pd.DataFrame({"P": rows["P"]})
    for name in COLUMNS:
        estimates = [estimate(one) for one in np.array([v[f"{name}, cyclic fold"] for v, _ in views]).T]
        means[name], means[f"{name}, +-"] = [e.mean for e in estimates], [e.half for e in estimates]
    in_paper = papers.is_papers(scene.name, size)
    more = len(grids) // 2 * 2
    ratios, fewer = zip(*((g[more] / g[more // 2], g[more // 2]) for _, g in views))
    sides = pd.DataFrame([row for image in sizes for row in rows_of_size(image)])
    return Page({"scene": scene.name, "size": size, "pes": size, "offset": OFFSET % size, "views": len(views),
                 "view_seeds": f"1..{len(views)}"},
                findings_of(rows, grids, sides, in_paper),
                with_paper(in_paper, comparisons_of(rows, grids, means.iloc[-1], ratios, fewer, more)),
                claims_of(views) if in_paper else [], tables_of(rows, grids, means, sides),
                plots_of(rows, grids, means, in_paper),
                ["Kohata & Ito plot one picture. This study has every number of PEs, two folds, and many views with intervals."],
                compared_with=papers.SPA)


def rows_of_size(image):
    side = image.shape[1]
    pes = 2 ** np.arange(int(np.log2(side)) + 1)
    for i, p in enumerate(pes):
        one = {name: values[i] for name, values in speedups(image, pes).items()}
        yield {"side (pixels)": side, "P": p, **one, "its efficiency": one["p = round(sqrt(P))"] / p}


def tables_of(rows, grids, means, sides):
    p = rows["P"]
    square = p.isin([a * a for a in grids])
    some = rows[(p > 1) & (square | (p & (p - 1) == 0) | (p % 100 == 0))]
    squares = pd.DataFrame({"P": some["P"], "A x A, 2-D": some["P"].map({a * a: s for a, s in grids.items()}),
                            "p = 0": some["p = 0, cyclic fold"], "p = 16": some["p = 16, cyclic fold"],
                            "p = sqrt(P)": some["p = round(sqrt(P)), cyclic fold"]})
    order = ["P"] + [f"{name}, {fold} fold" for name in COLUMNS for fold in ("cyclic", "block")]
    return [Table("fig9-squares", "Speed-up of the picture on square numbers of PEs and powers of two, cyclic fold",
                  squares),
            Table("fig9-views", "Speed-up, mean of the views", means, on_page=False),
            Table("fig9", "Speed-up of the picture for each number of PEs", rows[order], on_page=False),
            Table("fig9-sizes", "One PE to one for each column, cyclic fold, one picture of each size", sides)]


def comparisons_of(rows, grids, mean, ratios, fewer, more):
    last, half, pes = rows.iloc[-1], more // 2, f"speed-up on {len(rows)} PEs, "
    ratio, few = estimate(ratios), estimate(fewer)
    return [Comparison(pes + "p = 16", "", papers.SPEEDUP_16, last["p = 16, cyclic fold"],
                       "the paper's is printed in its abstracts"),
            Comparison(pes + "p = 16, mean of views", "", papers.SPEEDUP_16, mean["p = 16"], "", False,
                       mean["p = 16, +-"]),
            Comparison(pes + "p = 0", "", papers.SPEEDUP_0, last["p = 0, cyclic fold"],
                       "our scene, centre at 256 x 256, is calibrated on the paper's u(0)", derived=True),
            Comparison(pes + "p = 0, mean of views", "", papers.SPEEDUP_0, mean["p = 0"], derived=True,
                       half_width=mean["p = 0, +-"]),
            Comparison(f"CAP's mapping, {more} x {more} PEs over {half} x {half}", "", papers.CAP_RATIO,
                       grids[more] / grids[half], "the paper's is from the makers of CAP, with another scene"),
            Comparison("... mean of views", "", papers.CAP_RATIO, ratio.mean, half_width=ratio.half),
            Comparison(f"Pixel Machine's mapping, {half} x {half} PEs", "", papers.PIXEL_MACHINE_SPEEDUP,
                       grids[half], "the paper's: 60 or more, from the makers, with another scene"),
            Comparison("... mean of views ", "", papers.PIXEL_MACHINE_SPEEDUP, few.mean, half_width=few.half)]


def claims_of(views):
    """Claims for the paper's configuration: 256 PEs, views of the scene that resembles the paper's."""
    def of(column):
        return np.array([rows[f"{column}, cyclic fold"] for rows, _ in views])  # [view, P - 1]

    pes = [p for p in (2**k for k in range(5, 20)) if 2 * OFFSET <= p <= len(views[0][0])]
    gains = [estimate((of("p = 16") - of("p = 0"))[:, p - 1], bonferroni_confidence(len(pes))) for p in pes]
    ratios, grids = [g[16] / g[8] for _, g in views], [g[8] for _, g in views]

    def why(values, what):
        return (f"{what} {estimate(values).text(2)} in the mean of {len(values)} views; the figure of another picture lies in "
                f"{prediction_text(values, 2)} with 95 %.")

    last_16, last_0, few = of("p = 16")[:, -1], of("p = 0")[:, -1], estimate(grids)
    gain_texts = ", ".join(f"{g.text(1)} on {p} PEs" for g, p in zip(gains, pes))
    return [Claim(papers.SPA, "abstract", "256 PEs compute 229 times faster than one with p = 16.",
                  verdict_by_prediction(papers.SPEEDUP_16, last_16), why(last_16, "Ours is")),
            Claim(papers.SPA, "Table 3", "256 PEs compute 99.2 times faster than one with p = 0 (derived).",
                  verdict_by_prediction(papers.SPEEDUP_0, last_0), why(last_0, "Ours is")),
            Claim(papers.SPA, "Fig. 9", "With p = 16 the speed-up is above that with p = 0.",
                  verdict(all(g.low > 0 for g in gains), any(g.high <= 0 for g in gains)),
                  f"Gain in speed-up of p = 16 over p = 0 in the same view, all intervals together with 95 %: {gain_texts}. On powers "
                  "of two up to 16 PEs both are the same mapping."),
            Claim(papers.SPA, "text next to Fig. 9", "256 PEs of CAP are 3.86 times faster than 64, according to its makers.",
                  verdict_by_prediction(papers.CAP_RATIO, ratios), why(ratios, "CAP's mapping on our scene gives")),
            Claim(papers.SPA, "text next to Fig. 9",
                  "64 nodes of the Pixel Machine are 60 or more times faster than one, according to its makers.",
                  verdict(few.low >= papers.PIXEL_MACHINE_SPEEDUP, few.high < papers.PIXEL_MACHINE_SPEEDUP),
                  why(grids, "The Pixel Machine's mapping on our scene gives"))]


def findings_of(rows, grids, sides, in_paper):
    w, half = len(rows), len(rows) // 2
    p16, p0, root = (rows[f"{name}, cyclic fold"] for name in ("p = 16", "p = 0", "p = round(sqrt(P))"))
    whole = f"On {w} PEs p = 16 gives {p16[w - 1]:.1f} times and p = 0 {p0[w - 1]:.1f} times"
    if in_paper:
        ratio = p16[w - 1] / papers.SPEEDUP_16
        how = "more than" if ratio > 1.02 else "less than" if ratio < 0.98 else "within 2 % of"
        whole += f"; the former is {how} the {papers.SPEEDUP_16} of Kohata & Ito's abstract"
    worst = sides.loc[sides["its efficiency"].idxmin()]
    columns = sides[sides["P"] == sides["side (pixels)"]]
    sized = (f"With a PE for each column and p = round(sqrt(P)) images of "
             f"{', '.join(map(str, sides['side (pixels)'].unique()))} pixels a side gain "
             + ", ".join(f"{s:.0f} times on {p} PEs" for s, p in zip(columns["p = round(sqrt(P))"], columns["P"])) +
             ": the array can grow to one PE for each column, as Kohata & Ito conclude. The lowest efficiency of "
             f"powers of two up to there is {worst['its efficiency']:.2f}, on {worst['P']:.0f} PEs at "
             f"{worst['side (pixels)']:.0f} x {worst['side (pixels)']:.0f}.")
    best = p16[half:w - 1].max()
    gain = 100 * (best / p16[half - 1] - 1)
    a = max(a for a in grids if a * a < w)
    stairs = (f"Whole columns cause steps: with {half + 1} to {w - 1} PEs some PE still has two of the {w} columns, and p = 16 "
              f"gains {f'at most {gain:.1f} %' if gain > 0.5 else 'nothing'} over {half} PEs; on {a * a} PEs it gives "
              f"{p16[a * a - 1]:.1f} times, {a} x {a} PEs in two dimensions {grids[a]:.1f} times.")
    mean = {c: (rows[c] / rows["P"]).mean() for c in rows.columns[1:]}

    def better(name):
        c, b = mean[f"{name}, cyclic fold"], mean[f"{name}, block fold"]
        return "the cyclic fold" if c > b else "the block fold" if b > c else "none"

    folds = (f"Mean efficiency over all P: column split {mean['p = 0, cyclic fold']:.3f} with the cyclic fold and "
             f"{mean['p = 0, block fold']:.3f} with the block fold, p = 16 {mean['p = 16, cyclic fold']:.3f} and "
             f"{mean['p = 16, block fold']:.3f}; the better fold is {better('p = 0')} for the column split and "
             f"{better('p = 16')} for p = 16.")
    offset = (f"p = round(sqrt(P)) is better than p = 16 for {(root > p16)[1:].sum()} of {w - 1} numbers of PEs, mean "
              f"efficiency {mean['p = round(sqrt(P)), cyclic fold']:.3f} against {mean['p = 16, cyclic fold']:.3f}")
    idle = rows["P"][(rows["P"] > 1) & (p16 == p0)]
    if len(idle):
        offset += f"; p = 16 gives the same as the column split for P = {', '.join(map(str, idle))}"
    return [whole + ".", sized, stairs, folds, offset + "."]


def plots_of(rows, grids, means, in_paper):
    pes, w = rows["P"], len(rows)
    squares = [a * a for a in grids]
    paper = [Series("Kohata & Ito, p = 0 and 16", [w, w], [papers.SPEEDUP_0, papers.SPEEDUP_16], "paper"),
             Series("Pixel Machine, its own scene, 60 or more", [64], [papers.PIXEL_MACHINE_SPEEDUP], "paper")]
    some = means[(pes % 8 == 0) | (pes == w)]
    labels = {"p = 16": "p = 16", "p = round(sqrt(P))": "p = round(sqrt(P))", "p = 0": "p = 0, column split"}
    folds = [Series(f"{name}, {fold} fold", pes, rows[f"{name}, {fold} fold"] / pes)
             for name in ("p = 16", "p = 0") for fold in ("cyclic", "block")]
    return [Plot("fig9", "Speed-up against the number of PEs, cyclic fold", "PEs", "speed-up",
                 [Series("ideal", pes, pes),
                  *(Series(label, pes, rows[f"{name}, cyclic fold"]) for name, label in labels.items()),
                  Series("2-D, A x A PEs", squares, grids.values(), "points"), *(paper if in_paper else [])]),
            Plot("fig9-views", "Speed-up against the number of PEs, mean of the views", "PEs", "speed-up",
                 [Series(label, some["P"], some[name], half_widths=some[f"{name}, +-"])
                  for name, label in labels.items()]),
            Plot("fig9-folds", "Efficiency against the number of PEs, both folds", "PEs", "efficiency",
                 folds + [Series("2-D, A x A PEs", squares, np.divide([*grids.values()], squares), "points")])]
