"""Table 4: supersampling

What does supersampling cost, and what do the computation times of Kohata & Ito include?

- Source: Kohata & Ito 1993, Table 4 and section on anti-aliasing.
- {scene} at {size} x {size} on {pes} PEs of the SPA, a PE for each column; rendered and supersampled for three offsets: threshold 0.125,
  four points half a pixel along the axes.
- First reading of the paper: computation is the busiest PE's comparisons and new rays. Second reading: the busiest PE of the first pass
  is added, as PEs wait for each other between the passes.
- The model of communication is derived as in Table 3, two figures from four printed ones, so these times do not test it.
- Our scene is not that of Kohata & Ito (see Table 2): only ratios of computation can be compared, not its milliseconds.
- Output: table4.csv has a row for each rendered offset, table4-offsets.csv one for every offset p: rotations, modelled times (ms), u = (max load -
  mean load) / mean load. "phase alone": comparison and supersampling, without the first pass.
"""
import numpy as np
from raya.lab import Comparison, Page, Plot, Series, Table, above, counted, estimate, judged, papers, study, with_paper
from raya.lab.laboratory import format_for
from raya.lab.spa import CLOCK, FACTOR, offset_times, run_on_spa, smoothing_runs
from raya.lab.studies.cluster import matched_times, series_of_matched

LIKE_FILTER = 0.25  # bound of the claim comparison-like-filter
PRINTED_RATIO = papers.SUPERSAMPLE_0_MS / papers.SUPERSAMPLE_16_MS  # [D]


@study("table4", one_scene=True)
def table4(lab, scenes):
    runs = smoothing_runs(lab, scenes, "supersample")
    rows, times = runs.rows(), runs.times()
    filtered = [run_on_spa(lab, runs.scene, runs.size, runs.size, p, "filter") for p in runs.runs]
    in_paper = papers.is_papers(runs.scene.name, runs.size)
    first, last = rows.iloc[0], rows.iloc[-1]
    shown = rows[["p", "rotations", "communication", "compare", "supersample", "u", "trace", "alone", "with_first"]]
    shown = shown.set_axis(["p", "rotations", "communication (ms)", "comparison (ms)", "supersampling (ms)", "u",
                            "first pass (ms)", "phase alone (ms)", "with first pass (ms)"], axis=1)
    offsets = times[["offset", "rotations", "ring_ms", "smooth_ms", "supersample_ms", "trace_ms", "total_ms"]].set_axis(
        ["p", "rotations", "communication (ms)", "comparison (ms)", "supersampling (ms)", "first pass (ms)",
         "total (ms)"], axis=1)
    findings = findings_of_readings(first, last) if in_paper else []
    return Page({"scene": runs.scene.name, "size": runs.size, "pes": runs.size, "format": format_for(runs.scene),
                 "recomputed_share": runs.recomputed, "factor": FACTOR},
                findings + findings_of(runs, first, last),
                with_paper(in_paper, comparisons_of(rows, runs.recomputed)), claims_of(lab, runs, rows, filtered) if in_paper and not scenes else [],
                [Table("table4", "Supersampling", shown),
                 Table("table4-offsets", "Every offset", offsets, on_page=False)], [plot_of(runs, in_paper, matched_times(lab, "supersample") if in_paper and not scenes else [])],
                clock=CLOCK, compared_with=papers.SPA)


def comparisons_of(rows, share):
    comparisons = []
    for row, exchange, computation in ((rows.iloc[0], papers.EXCHANGE_0_MS, papers.SUPERSAMPLE_0_MS),
                                       (rows.iloc[-1], papers.EXCHANGE_16_MS, papers.SUPERSAMPLE_16_MS)):
        comparisons += [Comparison(f"p = {row['p']:.0f}: {what}", "ms", paper, row[column], remark)
                        for what, paper, column, remark in (
                       ("communication", exchange, "communication", "the clock is derived from it"),
                       ("phase alone", computation, "alone", "computation, comparisons included"),
                       ("with first pass", computation, "with_first", "computation of both passes"))]
    first, middle, last = (rows.iloc[i] for i in range(3))
    return comparisons + [
        Comparison(f"p = {middle['p']:.0f}: communication", "ms", papers.EXCHANGE_8_MS, middle["communication"],
                   "predicted from Tables 3 and 4", derived=True),
        Comparison("phase alone, p = 0 over p = 16", "", PRINTED_RATIO, first["alone"] / last["alone"],
                   "needs no clock", derived=True),
        Comparison("with first pass, p = 0 over p = 16", "", PRINTED_RATIO,
                   first["with_first"] / last["with_first"], "needs no clock", derived=True),
        Comparison("pixels recomputed", "%", 50 * (papers.RECOMPUTED_MIN + papers.RECOMPUTED_MAX),
                   100 * share, "16 .. 18 %, if Table 4 shows the phase alone", derived=True)]


def claims_of(lab, runs, rows, filtered):
    ensemble = lab.ensemble([], papers.SIZE, "supersample")
    saved = ensemble.map(lambda costs: gain_of(offset_times(costs, papers.SIZE, "supersample", 1)))
    same = all(a.report["communication"][key] == b.report["communication"][key]
               for a, b in zip(filtered, runs.runs.values()) for key in ("rotations", "rotation_words"))
    counted_text = ", ".join(f"{r} for p = {p}" for r, p in zip(rows["rotations"], rows["p"]))
    how = "as many, and as many words, as" if same else "not as many rotations or words as"
    ratio = rows["compare"].iloc[0] / filtered[0].time()["filter"]
    return [judged("comparison-communicates", counted(same), "", f"Rotations counted: {counted_text}; {how} the filter's on the same scene."),
            judged("comparison-like-filter", counted(abs(ratio - 1) <= LIKE_FILTER), "",
                   f"The comparison's budget is {ratio:.2f} times the filter's: 121 cycles a pixel against 42. The paper's values lie in "
                   "0..1; ours may exceed 1, so both values of each comparison are clamped, 48 cycles, and each colour ends in a branch, 36 "
                   "cycles. Without both, the budget is 37 cycles, about that of the filter: the paper's statement holds for its kind of values."),
            judged("gain-exceeds-communication", above(saved, 0, ensemble.families, 1), ensemble.description,
                   f"p = 16 saves {estimate(saved, ensemble.families).text(1)} ms more computing than it adds communication; it gains in "
                   f"{(saved > 0).sum()} of {len(saved)} pictures.")]


def gain_of(times):
    """Returns the milliseconds of supersampling, with comparison and communication, that p = 16 saves against p = 0."""
    total = times["smooth_ms"] + times["supersample_ms"] + times["ring_ms"]
    return total[0] - total[16]


def mean_factor(*times):
    """Returns the geometric mean of the factors (>= 1) by which two times differ from the printed times."""
    return np.exp(np.abs(np.log(np.divide(times, (papers.SUPERSAMPLE_0_MS, papers.SUPERSAMPLE_16_MS)))).mean())


def findings_of_readings(first, last):
    alone = mean_factor(first["alone"], last["alone"])
    both = mean_factor(first["with_first"], last["with_first"])
    ratio = first["supersample"] / last["supersample"]
    tail = ("Our supersampling takes {:.2f} times as long at p = 0 as at p = 16, on any clock, which is evidence for the first reading."
            if ratio > 1 else "Ours is also longer at p = 16: at p = 0 it takes {:.2f} times as long, on any clock, which is evidence for the "
            "second reading.")
    return [f"Table 4 prints {papers.SUPERSAMPLE_0_MS} and {papers.SUPERSAMPLE_16_MS} ms of computation at p = 0 and "
            f"16. Ours are {first['alone']:.0f} and {last['alone']:.0f} ms alone, {first['with_first']:.0f} and "
            f"{last['with_first']:.0f} ms with the first pass. {'The first' if alone < both else 'The second'} reading is nearer: "
            f"the readings differ from the paper by factors of {alone:.2f} and {both:.2f} (geometric mean over both offsets).",
            f"If the printed times included the first pass, Tables 3 and 4 would leave {papers.SUPERSAMPLE_0_MS - papers.TRACE_0_MS} ms "
            f"for supersampling at p = 0 and {papers.SUPERSAMPLE_16_MS - papers.TRACE_16_MS} ms at p = 16 [D]: the "
            f"offset that balances the first pass would make supersampling longer. {tail.format(ratio)}"]


def findings_of(runs, first, last):
    within = papers.RECOMPUTED_MIN <= runs.recomputed <= papers.RECOMPUTED_MAX
    saved = [rows["alone"].iloc[0] - rows["alone"].iloc[-1] for rows in map(runs.rows, (1, FACTOR, 8))]
    return [f"{100 * runs.recomputed:.1f} % of the pixels are recomputed, {'within the' if within else 'outside the'} "
            f"16-18 % that follow from Table 4's first reading; u of supersampling is {first['u']:.3f} at p = "
            f"{first['p']:.0f} and {last['u']:.3f} at p = {last['p']:.0f}.",
            f"p = {last['p']:.0f} instead of p = {first['p']:.0f} saves {saved[1]:.0f} ms in supersampling, "
            f"{min(saved[0], saved[2]):.0f} to {max(saved[0], saved[2]):.0f} for factors of 1 to 8, and costs "
            f"{last['communication'] - first['communication']:.1f} ms more in rotations."]


def plot_of(runs, in_paper, matched):
    near = runs.times()[:17]
    alone = near["smooth_ms"] + near["supersample_ms"]
    series = [Series(f"{runs.scene.name}, phase alone", near["offset"], alone),
              Series(f"{runs.scene.name}, with the first pass", near["offset"], alone + near["trace_ms"])]
    if len(matched) > 1:
        series += [series_of_matched(f"{len(matched)} matched scenes, phase alone", matched, ["smooth_ms", "supersample_ms"])]
    if in_paper:
        series.append(Series("Kohata & Ito", [0, 16], [papers.SUPERSAMPLE_0_MS, papers.SUPERSAMPLE_16_MS], "paper"))
    return Plot("table4", "Computation of supersampling against the offset", "offset p (pixels)",
                "computation (modelled ms)", series)
