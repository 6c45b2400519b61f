"""Table 4: supersampling

How long does supersampling take, and what do the computation times that Kohata & Ito print include?

- Source: Kohata & Ito 1993, Table 4 and section on anti-aliasing.
- {scene} at {size} x {size} pixels on {pes} PEs of the SPA, a PE for each column, is rendered (the first pass) and supersampled for three offsets.
  A pixel that differs from a neighbour by at least 0.125 is recomputed with four more rays, half a pixel to the left, right, top and bottom.
- Table 4 can be read in two ways. First reading: its computation is the comparisons and the new rays of the busiest PE. Second reading: it also
  contains the first pass of the PE that is busiest in it, because the PEs wait for each other between the passes.
- The model of communication is derived from Tables 3 and 4 (see study table3), so the times of communication at p = 0 and 16 do not test it.
- Our scene is not that of Kohata & Ito, which is not published. Only ratios of computation times can be compared, not milliseconds.
- Output: table4.csv has a row for each rendered offset, table4-offsets.csv a row for every offset p, with rotations, modelled times (ms) and u = (max
  load - mean load) / mean load. "Phase alone" is comparison and supersampling, without the first pass.
"""
import numpy as np
import raya
from raya.lab import Comparison, Page, Plot, Series, Table, above, below, controlled, estimate, every, judged, papers, study, with_paper
from raya.lab.laboratory import FAMILIES, SPA, format_for
from raya.lab.spa import CLOCK, FACTOR, offset_times, run_on_spa, smoothing_runs
from raya.lab.studies.cluster import matched_times, series_of_matched
from raya.lab.studies.formats import difference

QUALITY_VIEWS, QUALITY_SIZE, SAMPLES = 4, 128, 8  # claims on quality: pictures of each family, pixels per side, samples per pixel and axis
METHODS, BLURRED = ("none", "filter", "supersample"), 0.9  # BLURRED: filter-blurs, maximum gradient at edges relative to the reference

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
    comparisons = []
    for row, exchange, computation in ((first, papers.EXCHANGE_0_MS, papers.SUPERSAMPLE_0_MS), (last, papers.EXCHANGE_16_MS, papers.SUPERSAMPLE_16_MS)):
        comparisons += [Comparison(f"p = {row['p']:.0f}: {what}", "ms", paper, row[column], remark)
                        for what, paper, column, remark in (
                       ("communication", exchange, "communication", "the clock is derived from the printed time"),
                       ("phase alone", computation, "alone", "computation: comparisons and new rays"),
                       ("with first pass", computation, "with_first", "computation: first pass, comparisons and new rays"))]
    comparisons += [*(Comparison(f"{what}, p = 0 / p = 16", "", PRINTED_RATIO, first[column] / last[column], "the clock's factor cancels", derived=True)
                      for what, column in (("phase alone", "alone"), ("with first pass", "with_first"))),
                    Comparison("pixels recomputed", "%", 50 * (papers.RECOMPUTED_MIN + papers.RECOMPUTED_MAX), 100 * runs.recomputed,
                               "the paper's: 16 .. 18 % by the first reading of Table 4", derived=True)]
    return Page({"scene": runs.scene.name, "size": runs.size, "pes": runs.size, "format": format_for(runs.scene),
                 "recomputed_share": runs.recomputed, "factor": FACTOR},
                findings + findings_of(runs, first, last),
                with_paper(in_paper, comparisons), [*claims_of(lab, runs, rows, filtered), *claims_of_quality(*quality_of(lab))] if in_paper and not scenes else [],
                [Table("table4", "Supersampling, for each rendered offset", shown),
                 Table("table4-offsets", "Supersampling, for every offset", offsets, on_page=False)],
                [plot_of(runs, in_paper, matched_times(lab, "supersample") if in_paper and not scenes else [])],
                clock=CLOCK, compared_with=papers.SPA)


def quality_of(lab):
    """Returns (PSNR in dB, gradient at edges relative to the reference): arrays [picture, method] for METHODS, against the double-precision reference
    at SAMPLES x SAMPLES rays per pixel; and the family of each picture. Edges: the tenth of the pixels with the largest gradients of the reference."""
    def gradient(image):
        return sum(np.abs(np.diff(np.clip(image, 0, 1), axis=axis)).sum(-1)[:-1 if axis else None, :None if axis else -1] for axis in (0, 1))

    psnr, sharpness = [], []
    scenes = [(name, make(lab.seed + 3 * 100_000 + 1000 * i + view)) for i, (name, make) in enumerate(FAMILIES.items()) for view in range(QUALITY_VIEWS)]
    for _, scene in scenes:
        fine = np.clip(raya.reference(scene, SAMPLES * QUALITY_SIZE, SPA["bounces"]), 0, 1)
        expected = fine.reshape(QUALITY_SIZE, SAMPLES, QUALITY_SIZE, SAMPLES, 3).mean((1, 3))
        images = [lab.render(scene, machine="grande", format="fp32", bounces=SPA["bounces"], size=QUALITY_SIZE, pes=QUALITY_SIZE, offset=11, accel="none",
                             antialias=method).image for method in METHODS]
        edges = (change := gradient(expected)) >= np.quantile(change, 0.9)
        psnr.append([difference(expected, image)["psnr_db"] for image in images])
        sharpness.append([gradient(image.astype(float))[edges].mean() / change[edges].mean() for image in images])
    return np.array(psnr), np.array(sharpness), [name for name, _ in scenes]


def claims_of_quality(psnr, sharpness, families):
    about = f"{len(families)} pictures of {len(set(families))} families at {QUALITY_SIZE} x {QUALITY_SIZE} pixels"
    texts = ", ".join(f"{estimate(psnr[:, i], families).text(1)} dB and {estimate(sharpness[:, i], families).text(2)} ({method})"
                      for i, method in enumerate(METHODS))
    text = f"PSNR, and gradient at edges relative to the reference: {texts}."
    none, filtered, supersampled = psnr.T
    return [judged("filter-blurs", below(sharpness[:, 1], BLURRED, families, 2), about, text),
            judged("supersampling-is-better", every(above(supersampled - other, 0, families, 1) for other in (filtered, none)), about, text)]


def claims_of(lab, runs, rows, filtered):
    ensemble = lab.ensemble([], papers.SIZE, "supersample")

    def saved_ms(costs):
        times = offset_times(costs, papers.SIZE, "supersample", 1)
        total = times["smooth_ms"] + times["supersample_ms"] + times["ring_ms"]
        return total[0] - total[16], total[0] - total[5]

    saved, saved_by_5 = ensemble.map(saved_ms).T
    same = all(a.report["communication"][key] == b.report["communication"][key]
               for a, b in zip(filtered, runs.runs.values()) for key in ("rotations", "rotation_words"))
    counted_text = ", ".join(f"{r} for p = {p}" for r, p in zip(rows["rotations"], rows["p"]))
    how = "the rotations and words equal" if same else "the rotations or words differ from"
    ratio = rows["compare"].iloc[0] / filtered[0].report["modelled_ms"]["filter"]
    return [judged("comparison-communicates", None, "", f"Rotations counted: {counted_text}; {how} those of the filter for the same scene."),
            judged("comparison-like-filter", None, "",
                   f"The instruction budget of a comparison is {ratio:.2f} times that of the filter: 121 cycles a pixel against 42. Our colours may "
                   "exceed 1, so a comparison clamps both colours (48 cycles); it also has a branch for each component (36 cycles). Without "
                   "clamping and branches the budget is 37 cycles, about that of the filter: the statement holds for such a comparison."),
            controlled("gain-exceeds-communication", lambda ms: above(ms, 0, ensemble.families, 1), saved, {"p = 5": saved_by_5}, ensemble.description,
                   f"p = 16 saves {estimate(saved, ensemble.families).text(1)} ms more computing than it adds communication. The total falls in "
                   f"{(saved > 0).sum()} of {len(saved)} pictures.")]


def mean_factor(*times):
    """Returns the geometric mean of the factors (>= 1) by which our times at p = 0 and 16 differ from the printed ones."""
    return np.exp(np.abs(np.log(np.divide(times, (papers.SUPERSAMPLE_0_MS, papers.SUPERSAMPLE_16_MS)))).mean())


def findings_of_readings(first, last):
    alone = mean_factor(first["alone"], last["alone"])
    both = mean_factor(first["with_first"], last["with_first"])
    ratio = first["supersample"] / last["supersample"]
    tail = ("Our supersampling takes {:.2f} times as long at p = 0 as at p = 16, with any factor of the clock: evidence for the first reading."
            if ratio > 1 else "Ours is also longer at p = 16: at p = 0 it takes {:.2f} times as long, with any factor of the clock: evidence "
            "for the second reading.")
    return [f"Table 4 prints {papers.SUPERSAMPLE_0_MS} and {papers.SUPERSAMPLE_16_MS} ms of computation at p = 0 and "
            f"16. Our times are {first['alone']:.0f} and {last['alone']:.0f} ms without the first pass, {first['with_first']:.0f} and "
            f"{last['with_first']:.0f} ms with it. {'The first' if alone < both else 'The second'} reading is nearer: "
            f"with the first one our times differ from the paper's by a factor of {alone:.2f}, with the second by {both:.2f} (geometric means).",
            f"If the printed times included the first pass, Tables 3 and 4 would leave {papers.SUPERSAMPLE_0_MS - papers.TRACE_0_MS} ms "
            f"for supersampling at p = 0 and {papers.SUPERSAMPLE_16_MS - papers.TRACE_16_MS} ms at p = 16 [D]: the "
            f"offset that balances the first pass would make supersampling longer. {tail.format(ratio)}"]


def findings_of(runs, first, last):
    within = papers.RECOMPUTED_MIN <= runs.recomputed <= papers.RECOMPUTED_MAX
    saved = [rows["alone"].iloc[0] - rows["alone"].iloc[-1] for rows in map(runs.rows, (1, FACTOR, 8))]
    return [f"{100 * runs.recomputed:.1f} % of the pixels are recomputed, {'within the' if within else 'outside the'} "
            f"16-18 % that follow from the first reading of Table 4; u of supersampling is {first['u']:.3f} at p = "
            f"{first['p']:.0f} and {last['u']:.3f} at p = {last['p']:.0f}.",
            f"p = {last['p']:.0f} instead of p = {first['p']:.0f} saves {saved[1]:.0f} ms of supersampling "
            f"({min(saved[0], saved[2]):.0f} to {max(saved[0], saved[2]):.0f} ms with factors of the clock from 1 to 8) and takes "
            f"{last['communication'] - first['communication']:.1f} ms more for rotations."]


def plot_of(runs, in_paper, matched):
    near = runs.times()[:17]
    alone = near["smooth_ms"] + near["supersample_ms"]
    series = [Series(f"{runs.scene.name}, phase alone", near["offset"], alone),
              Series(f"{runs.scene.name}, with the first pass", near["offset"], alone + near["trace_ms"]),
              *series_of_matched(f"{len(matched)} matched scenes, phase alone", matched, ["smooth_ms", "supersample_ms"])]
    if in_paper:
        series.append(Series("Kohata & Ito", [0, 16], [papers.SUPERSAMPLE_0_MS, papers.SUPERSAMPLE_16_MS], "paper"))
    return Plot("table4", "Computation of supersampling against the offset", "offset p (pixels)",
                "computation (modelled ms)", series)
