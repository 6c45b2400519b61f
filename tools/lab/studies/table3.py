"""Table 3: ray tracing with the 3 x 3 filter

How long does the filter take? A larger offset balances the load better, but increases the distance between neighbours on the ring.

- Source: Kohata & Ito 1993, Tables 3 and 4, sections on the cyclic mapping and on anti-aliasing.
- {scene} at {size} x {size} pixels on {pes} PEs of the SPA, a PE for each column, is rendered and filtered over the ring for three offsets.
  The renders count the rotations and the words that they move.
- The time of filtering has three parts: its arithmetic; 0.3125 ms for each rotation (its words at the links' rate, and a synchronisation); and
  1.375 ms for the set-up of an exchange. All three are derived from the times of p = 0 and 16 in Tables 3 and 4 [D], so the times of filtering at
  these offsets do not test the clock. The time at p = 8 is a prediction.
- Our scene is not that of Kohata & Ito, which is not published. Only ratios of times and the times of filtering can be compared.
- The times of the other offsets follow from the pixels' costs and the shortest routes between neighbours. The renders confirm these routes.
- Output: table3.csv has a row for each rendered offset, table3-offsets.csv a row for every offset p, with rotations and modelled times (ms).
  table3-factors.csv has the conclusions for each factor of the clock.
"""
import pandas as pd
from raya.lab import Comparison, Page, Plot, Series, Table, counted, estimate, judged, papers, study, with_paper
from raya.lab.laboratory import SPA, format_for
from raya.lab.spa import CLOCK, FACTOR, FACTORS, smoothing_runs
from raya.lab.studies.cluster import matched_times, series_of_matched


def at_factor(runs, factor):
    """Returns the figures that the conclusions use, for one factor of the clock model."""
    rows, near = runs.rows(factor), runs.times(factor)[:17]
    first, last = rows.iloc[0], rows.iloc[-1]
    saved, lost = first["trace"] - last["trace"], last["filtering"] - first["filtering"]
    return {"factor": factor, "total, p = 0 (ms)": first["filtered"], "total, p = 16 (ms)": last["filtered"],
            "p = 0 over p = 16": first["filtered"] / last["filtered"], "p = 16 saves (ms)": saved,
            "and costs (ms)": lost, "pays": "yes" if saved > lost else "no",
            "best of 0..16": int(near["offset"][near["total_ms"].idxmin()])}


@study("table3", one_scene=True)
def table3(lab, scenes):
    runs = smoothing_runs(lab, scenes, "filter")
    rows, times, in_paper = runs.rows(), runs.times(), papers.is_papers(runs.scene.name, runs.size)
    near, matched = times[:17], matched_times(lab, "filter") if in_paper and not scenes else []
    factors = pd.DataFrame([at_factor(runs, f) for f in sorted([*FACTORS, FACTOR])])
    shown = rows[["p", "rotations", "communication", "filter", "trace", "filtered"]].set_axis(
        ["p", "rotations", "communication (ms)", "filter (ms)", "ray tracing (ms)", "total (ms)"], axis=1)
    offsets = times[["offset", "rotations", "ring_ms", "smooth_ms", "trace_ms", "total_ms"]].set_axis(
        shown.columns, axis=1)
    made = "the clock is derived from the printed time"
    figures = [("ray tracing", "trace", (papers.TRACE_0_MS, None, papers.TRACE_16_MS), ("", "", "")),
               ("filtering", "filtering", (papers.FILTER_0_MS, None, papers.FILTER_16_MS), (made, "", made)),
               ("total", "filtered", (papers.FILTERED_0_MS, None, papers.FILTERED_16_MS), ("", "", ""))]
    comparisons = [Comparison(f"p = {row['p']:.0f}: {what}", "ms", printed[i], row[column], remarks[i])
                   for i, row in rows.iterrows() for what, column, printed, remarks in figures]
    first, last = rows.iloc[0], rows.iloc[-1]
    comparisons += [
        Comparison("filter's arithmetic", "ms", papers.FILTER_ARITHMETIC_MS, first["filter"], "the clock's factor is derived from it", derived=True),
        Comparison("set-up of an exchange", "ms", None, SPA["setup_ms"], "from Table 4: 2 - 2 x 0.3125 ms; part of filtering"),
        Comparison("total at p = 0 / at p = 16", "", papers.FILTERED_0_MS / papers.FILTERED_16_MS, first["filtered"] / last["filtered"],
                   "depends little on the clock", derived=True)]
    return Page({"scene": runs.scene.name, "size": runs.size, "pes": runs.size, "format": format_for(runs.scene),
                 "factor": FACTOR},
                findings_of(runs, rows, near, factors), with_paper(in_paper, comparisons),
                claims_of(matched, rows, near) if in_paper and not scenes else [],
                [Table("table3", "Ray tracing and filter, for each rendered offset", shown),
                 Table("table3-factors", "The conclusions for each factor of the clock", factors),
                 Table("table3-offsets", "Ray tracing and filter, for every offset", offsets, on_page=False)],
                [plot_of(runs, False, in_paper), plot_of(runs, True, in_paper, matched)],
                clock=CLOCK, compared_with=papers.SPA)


def claims_of(matched, rows, near):
    ratio = [times["total_ms"][0] / times["total_ms"][16] for times in matched]
    same = (rows["rotations"] == 2 * (rows["p"] + 1)).all()
    rises = near["rotations"].is_monotonic_increasing
    counted_text = ", ".join(f"{r} for p = {p}" for r, p in zip(rows["rotations"], rows["p"]))
    claims = [judged("rotations", counted(same), "", f"Rotations counted: {counted_text}."),
              judged("small-p-communicates-less", None, "",
                     f"Rotations of an exchange: {near['rotations'].iloc[0]} at p = 0 to {near['rotations'].iloc[-1]} at "
                     f"p = {near['offset'].iloc[-1]}, {'never fewer than for a smaller p' if rises else 'at some p fewer than for a smaller one'}.")]
    if len(ratio) > 1:
        claims.append(judged("filter-total", None, f"{len(ratio)} matched scenes (study cluster)",
                             f"The total at p = 0 is {estimate(ratio).text(2)} times that at p = 16. This ratio exceeds 2 in "
                             f"{sum(r > 2 for r in ratio)} of {len(ratio)} scenes. The paper prints 662 and 302 ms, a ratio of "
                             f"{papers.FILTERED_0_MS / papers.FILTERED_16_MS:.2f}."))
    return claims


def findings_of(runs, rows, near, factors):
    at, (first, last) = at_factor(runs, FACTOR), rows["p"].iloc[[0, -1]]
    saved, lost, pays = at["p = 16 saves (ms)"], at["and costs (ms)"], factors["pays"] == "yes"
    how = "for every factor" if pays.all() else "for some factors" if pays.any() else "for no factor"
    best = near.loc[near["total_ms"].idxmin()]
    return [f"Compared with p = {first}, p = {last} takes {lost:.1f} ms more for rotations and "
            f"{'saves' if saved >= 0 else 'loses'} {abs(saved):.0f} ms of ray tracing, so it "
            f"{'pays' if saved > lost else 'does not pay'} with the filter. It pays {how} of the clock from 1 to 8.",
            f"Of the offsets 0..{len(near) - 1} p = {best['offset']:.0f} has the shortest total, {best['total_ms']:.1f} ms; ray "
            f"tracing alone is shortest at p = {near['trace_ms'].idxmin()}. With factors of the clock from 1 to 8 the total is shortest at "
            f"p = {', '.join(map(str, factors['best of 0..16'].unique()))}.",
            "The filter's arithmetic takes 1.08 ms by the instruction budget and 7 ms by Tables 3 and 4 [D]. The paper does not print the "
            "filter's program, so the clock's factor, 7 / 1.08, also contains costs that are not in the budget."]


def plot_of(runs, with_tracing, in_paper, matched=()):
    series = series_of_matched(f"{len(matched)} scenes matched to the paper's u(0) and 64,800 ms", matched, ["total_ms"])
    for factor in (1, FACTOR, 8):
        t = runs.times(factor)[:17]
        y = t["total_ms"] if with_tracing else t["ring_ms"] + t["smooth_ms"]
        series.append(Series(f"{runs.scene.name}, clock's factor {factor:.3g}", t["offset"], y))
    name, title, printed = (
        ("table3-total", "Ray tracing and filter", [papers.FILTERED_0_MS, papers.FILTERED_16_MS]) if with_tracing else
        ("table3-filter", "Filtering", [papers.FILTER_0_MS, papers.FILTER_16_MS]))
    if in_paper:
        series.append(Series("Kohata & Ito", [0, 16], printed, "paper"))
    return Plot(name, f"{title} against the offset", "offset p (pixels)", "time (modelled ms)", series)
