"""Scenes as heavy as the paper's

What are the times of Tables 2 to 4, on one clock, for scenes that are as uneven and as expensive as that of Fig. 6?

- Source: Kohata & Ito 1993, abstract and Tables 2, 3 and 4.
- {scenes} scenes at {size} x {size} on {pes} PEs of the SPA, a PE for each column. The default scenes are those of `raya generate cluster`,
  seeds {seeds}: seven spheres above a floor, one light.
- The generator was calibrated, in the mean of many seeds, on u(0) = 1.58, on 17 % of the pixels recomputed, and on some 1,520 budget
  cycles a pixel, which follow from the printed 64,800 ms of one PE (see scenes/README.md). No other figure was calibrated, u(16) included.
- Each figure of Kohata & Ito is of one picture. It is reproduced if it lies in the prediction interval of the scenes (see Fig. 8).
- Output: cluster.csv has a row for each scene: u at p = 0 and 16, pixels recomputed (%), budget cycles a pixel, modelled times (ms).
"""
import pandas as pd
import raya
from raya.lab import (Claim, Comparison, Page, Plot, Series, Table, estimate, papers, prediction_text, range_text,
                      study, verdict_by_prediction)
from raya.lab.laboratory import VIEWS
from raya.lab.spa import CLOCK, FACTOR, offset_times, spa_ms

# Figures to compare: name, unit, column, the paper's figure, its place, whether it is derived. The generator was calibrated on CALIBRATED only.
CALIBRATED = [("u(0)", "", "u(0)", papers.IMBALANCE_0, "Table 3", True),
          ("pixels recomputed", "%", "recomputed (%)", 50 * (papers.RECOMPUTED_MIN + papers.RECOMPUTED_MAX),
           "Table 4", True),
          ("1 PE: compute", "ms", "1 PE: compute (ms)", papers.ONE_PE_COMPUTE_MS, "Table 2", False)]
FREE = [("u(16)", "", "u(16)", papers.IMBALANCE_16, "Table 3", True),
        ("speed-up, p = 16", "", "speed-up", papers.SPEEDUP_16, "abstract", False),
        ("ray tracing, p = 16", "ms", "ray tracing, p = 16 (ms)", papers.TRACE_16_MS, "Table 3", False),
        ("with the filter, p = 0", "ms", "with the filter, p = 0 (ms)", papers.FILTERED_0_MS, "Table 3", False),
        ("with the filter, p = 16", "ms", "with the filter, p = 16 (ms)", papers.FILTERED_16_MS, "Table 3", False),
        ("total, p = 0 over p = 16", "", "gain", papers.FILTERED_0_MS / papers.FILTERED_16_MS, "Table 3", True),
        ("supersampling alone, p = 0", "ms", "supersampling alone, p = 0 (ms)", papers.SUPERSAMPLE_0_MS, "Table 4",
         False),
        ("supersampling alone, p = 16", "ms", "supersampling alone, p = 16 (ms)", papers.SUPERSAMPLE_16_MS, "Table 4",
         False)]


def row_of(lab, scene, size):
    costs = lab.costs(scene, size, "supersample")
    filtered, supersampled = (offset_times(costs, size, method) for method in ("filter", "supersample"))
    near, far = filtered.iloc[0], filtered.iloc[16 % size]
    alone = supersampled["smooth_ms"] + supersampled["supersample_ms"]
    total = int(costs.trace.sum())
    return {"scene": scene.name, "u(0)": near["imbalance"], "u(16)": far["imbalance"],
            "recomputed (%)": 100 * costs.recomputed / size**2, "cycles a pixel": total / size**2,
            "1 PE: compute (ms)": FACTOR * spa_ms(total), "ray tracing, p = 0 (ms)": near["trace_ms"],
            "ray tracing, p = 16 (ms)": far["trace_ms"], "with the filter, p = 0 (ms)": near["total_ms"],
            "with the filter, p = 16 (ms)": far["total_ms"], "supersampling alone, p = 0 (ms)": alone[0],
            "supersampling alone, p = 16 (ms)": alone[16 % size]}


def claim_of(figure, rows):
    what, unit, column, paper, place, _ = figure
    digits, of_scenes = 3 if paper < 10 else 0, rows[column]
    return Claim(papers.SPA, place, f"{what}: {paper:.{digits}f}{' ' if unit else ''}{unit}.",
                 verdict_by_prediction(paper, of_scenes),
                 f"Our mean over {len(rows)} scenes is {estimate(of_scenes).text(digits)}; the figure of another scene lies in "
                 f"{prediction_text(of_scenes, digits)} with 95 %.")


@study("cluster")
def cluster(lab, scenes):
    size, own = lab.size(256), not scenes
    family = scenes or [raya.generate.cluster(seed).renamed(f"cluster, seed {seed}") for seed in range(1, VIEWS + 1)]
    table = pd.DataFrame([row_of(lab, scene, size) for scene in family])
    rows = table.assign(gain=table["with the filter, p = 0 (ms)"] / table["with the filter, p = 16 (ms)"],
                        **{"speed-up": table["1 PE: compute (ms)"] / table["ray tracing, p = 16 (ms)"]})
    in_paper = own and size == 256

    def comparison(figure):
        what, unit, column, paper, _, derived = figure
        mean, remark = estimate(rows[column]), "not calibrated" if not own else "calibrated" if figure in CALIBRATED else "free"
        return Comparison(what, unit, paper if in_paper else None, mean.mean,
                          f"{remark}; {range_text(rows[column])} of single scenes", derived, mean.half)

    seeds = f"1..{VIEWS}"
    paper = [Series("Kohata & Ito, from their tables", [papers.IMBALANCE_0], [papers.IMBALANCE_16], "paper")]
    return Page({"scenes": len(rows), "size": size, "pes": size, "factor": FACTOR, **({"seeds": seeds} if own else {})},
                [f"Over {len(rows)} scenes u(16), on which nothing was calibrated, is {estimate(rows['u(16)']).text()} in "
                 f"the mean and {range_text(rows['u(16)'])} in single scenes; p = 16 is {estimate(rows['gain']).text(2)} "
                 "times as fast in total as p = 0, filter included."],
                [comparison(figure) for figure in CALIBRATED + FREE],
                [claim_of(figure, rows) for figure in FREE] if in_paper else [],
                [Table("cluster", "Each scene", table, on_page=False)],
                [Plot("cluster", "Imbalance of each scene, column split and cyclic mapping", "u(0)", "u(16)",
                      [Series("scenes", rows["u(0)"], rows["u(16)"], "points")] + (paper if in_paper else []))],
                ["This study has a family of scenes instead of a single fitted scene, so that the printed figures can be compared with a mean "
                 "and its interval."], clock=CLOCK, placeholders={"seeds": seeds}, compared_with=papers.SPA)
