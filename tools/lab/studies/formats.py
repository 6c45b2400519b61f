"""Number formats against the double-precision reference

How much does an image in a reduced format differ from the exact one, and how much time does the format take?

- Source: none of the papers; `spa22` is the number format of the SPA (Kohata & Ito 1993).
- {size} x {size} pixels, rays through pixel centres, {bounces} bounces, raya's machine {machine} with {pes} PEs at offset {offset}. Each image is
  compared with that of raya's double-precision reference renderer, after clamping of both to 0..1.
- Formats: `eXmY` has X exponent bits and Y fraction bits and rounds to nearest; `eXmYt` truncates. `e6m15` is `spa22`.
- Times are measured on {device}, {lanes} rays per work-item: the minimum over {samples} renders with each format, in turn.
- Output: formats-overview.csv has a row for each format, formats.csv one for each scene and format. psnr_db: PSNR in dB, peak 1; largest_error:
  over all colour channels; pixels_over, share_over: number and fraction of pixels with a channel whose error exceeds 1/255; u: load imbalance.
"""
import re

import numpy as np
import pandas as pd
import raya
from raya.lab import Page, Plot, Table, series_by, study
from raya.lab.laboratory import MACHINES

REDUCED = [name + cut for name in "e8m21 e8m18 e8m15 e7m15 e6m15 e6m14 e6m13".split() for cut in ("", "t")]
STEP, SAMPLES = 1 / 255, 5  # STEP: one step of an 8-bit channel, the smallest visible difference


def difference(expected, image):
    """Returns PSNR (dB, peak 1), largest error of a channel, and number and fraction of the pixels with a channel whose error exceeds STEP. Values
    are clamped to 0..1. The error of a value that is not finite is infinite."""
    finite = np.isfinite(expected) & np.isfinite(image)
    off = np.where(finite, np.abs(np.clip(expected, 0, 1) - np.clip(image.astype(float), 0, 1)), np.inf)
    with np.errstate(divide="ignore"):
        return {"psnr_db": -10 * np.log10((off**2).mean()), "largest_error": off.max(),
                "pixels_over": int((off.max(-1) > STEP).sum()), "share_over": (off.max(-1) > STEP).mean()}


def rows_of(lab, scene, size):
    expected = raya.reference(scene, size, MACHINES["grande"]["bounces"])
    options = dict(machine="grande", size=size, pes=size, offset=16 % size, accel="none")
    rows = {}
    for sample in range(SAMPLES):
        for form in ["fp32", *REDUCED]:
            result = lab.render(scene, format=form, **options)
            if sample == 0:
                exponent, fraction, cut = re.fullmatch(r"e(\d+)m(\d+)(t?)", "e8m23" if form == "fp32" else form).groups()
                rows[form] = {"scene": scene.name, "format": form, "exponent_bits": int(exponent), "fraction_bits": int(fraction),
                              "rounding": "truncate" if cut else "nearest", **difference(expected, result.image), "image_hash": result.hash, "u": result.imbalance,
                              "measured_kernel_s": np.inf}
            rows[form]["measured_kernel_s"] = min(rows[form]["measured_kernel_s"], result.device_s)
    rows = pd.DataFrame(rows.values())
    rows["measured_ratio_to_fp32"] = rows["measured_kernel_s"] / rows["measured_kernel_s"][0]
    return rows, result.report["device"]["lanes"]


@study("formats", measures=True)
def formats(lab, scenes):
    size = lab.size(256)
    own = [raya.example(name) for name in ("centre", "spheres", "glass", "polygons", "cones")]
    by_scene, lanes = zip(*(rows_of(lab, scene, size) for scene in scenes or own))
    rows, overview = pd.concat(by_scene, ignore_index=True), []
    for form, format_rows in rows.groupby("format", sort=False):
        worst, ratio = format_rows.loc[format_rows["psnr_db"].idxmin()], format_rows["measured_ratio_to_fp32"]
        overview.append({"format": form, "lowest PSNR (dB)": worst["psnr_db"], "of scene": worst["scene"],
                         "largest error": format_rows["largest_error"].max(),
                         "most off by > 1/255 (%)": 100 * format_rows["share_over"].max(),
                         "time / fp32, least (measured)": ratio.min(), "time / fp32, largest (measured)": ratio.max()})
    nearest = rows[(rows["rounding"] == "nearest") & (rows["fraction_bits"] < 23)]
    spa, fp32 = (rows[rows["format"] == form] for form in ("e6m15", "fp32"))
    psnr = rows.pivot(index="scene", columns="format", values="psnr_db").reindex(rows["scene"].unique())
    u = rows.pivot(index="scene", columns="format", values="u")
    load_changes = u.div(u["fp32"], axis=0).sub(1).abs().max()

    def spread(gains):
        return f"{gains.mean():+.1f} dB on average ({gains.min():+.1f} to {gains.max():+.1f})"

    def text(format_rows, column, factor=1, digits=1):
        return f"{factor * format_rows[column].min():.{digits}f} to {factor * format_rows[column].max():.{digits}f}"

    gains = pd.concat([psnr[form] - psnr[form + "t"] for form in REDUCED if not form.endswith("t")])
    changes = [f"From {a} to {b} the PSNR changes by {spread(psnr[b] - psnr[a])}." for a, b in
               (("e6m13", "e6m15"), ("e8m15", "e8m21"), ("e6m15", "e8m15"))]
    findings = [f"spa22 (e6m15) has a PSNR of {text(spa, 'psnr_db')} dB, fp32 has {text(fp32, 'psnr_db')} dB; "
                f"{text(spa, 'share_over', 100, 2)} % of spa22's pixels and {text(fp32, 'share_over', 100, 2)} % of fp32's have an error above "
                f"1/255; spa22 takes {text(spa, 'measured_ratio_to_fp32', 1, 2)} "
                "times fp32's kernel time (measured).",
                f"The load imbalance u in a reduced format differs from that in fp32 by at most {100 * load_changes.max():.1f} % (spa22: "
                f"{100 * load_changes['e6m15'].max():.1f} %).",
                f"Rounding to nearest has a higher PSNR than truncation in {(gains > 0).sum()} of {len(gains)} pairs of the same "
                f"format and scene: {spread(gains)}.", *changes]
    return Page({"size": size, "machine": "grande", "pes": size, "offset": 16 % size, "bounces": MACHINES["grande"]["bounces"],
                 "samples": SAMPLES, "lanes": lanes[0], "device": lab.session.device["name"]}, findings,
                tables=[Table("formats-overview", "Each format, over all scenes", overview),
                        Table("formats", "Each scene and format", rows, on_page=False)],
                plots=[Plot("formats", "PSNR against the number of fraction bits, rounding to nearest", "fraction bits", "PSNR (dB)",
                            series_by(nearest.sort_values("fraction_bits", kind="stable"), "scene", "fraction_bits",
                                      "psnr_db", style="points"))])
