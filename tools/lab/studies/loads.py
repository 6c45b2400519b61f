"""Figs 7 and 12 of Kohata & Ito 1993: the load of each PE divided by the mean load, in the first pass and in supersampling."""
import numpy as np
import pandas as pd
import raya
from raya.lab import (Comparison, Page, Plot, Series, Table, above, estimate, estimates, first_scene, judged, papers, range_text, study,
                      with_paper)
from raya.lab.laboratory import CROWDED

PROSE = """{figure}

{question}

- Source: Kohata & Ito 1993, {place}.
- {size} x {size} pixels on {pes} PEs of the SPA, one PE per column; {phase}. The single picture is scene {scene}.
- The load of a PE is the sum of the modelled cycles that the kernels counted for its pixels. Plots show each load divided by the mean load of
  all PEs; this ratio does not depend on a clock rate.
- Ensemble: {ensemble}. By default its scenes have their objects in the middle, like that of Fig. 6.
- Output: {name}.csv has a row for each PE: its loads in the single picture with p = 0 and p = 16 (cycles); its load / mean load of all PEs,
  as mean of the ensemble, with half the width of the 95 % interval (+-)."""


def relative_loads(image, offset):
    """Returns the load of each PE divided by the mean load; 1 for all PEs if there is no load."""
    loads = raya.loads(image, offset=offset)
    return loads / loads.mean() if loads.any() else np.ones(len(loads))


def middle_and_sides(loads):
    """Returns the mean load of the middle quarter of the PEs, and the mean load of the first and last eighth together. loads: [..., PE]."""
    eighth, middle = loads.shape[-1] // 8, loads.shape[-1] // 2
    sides = (loads[..., :eighth].mean(-1) + loads[..., loads.shape[-1] - eighth:].mean(-1)) / 2
    return loads[..., middle - eighth:middle + eighth].mean(-1), sides


def page_of(name, lab, scenes, first_pass):
    scene, size = first_scene(scenes), lab.size(256)
    antialias, image_of = ("none", lambda costs: costs.trace) if first_pass else ("supersample", lambda costs: costs.supersample)
    offsets, picture = (0, 16 % size), image_of(lab.costs(scene, size, antialias))
    ensemble = lab.ensemble(scenes, size, antialias, families=CROWDED)
    scene_loads = [relative_loads(picture, p) for p in offsets]
    picture_loads = [ensemble.map(lambda costs, p=p: relative_loads(image_of(costs), p)) for p in offsets]  # [picture, PE]
    u = ensemble.map(lambda costs: raya.imbalances(image_of(costs), size, offsets)).T  # [offset, picture]
    scene_u = raya.imbalances(picture, size, offsets)
    rows = pd.DataFrame({"PE": range(size), "p = 0 (cycles)": raya.loads(picture, offset=0),
                         "p = 16 (cycles)": raya.loads(picture, offset=offsets[1])})
    for label, some in zip(("p = 0", "p = 16"), picture_loads):
        rows[f"{label}, mean of the ensemble"], rows[f"{label}, +-"] = estimates(some)
    place, phase = ("Fig. 7", "first pass") if first_pass else ("Fig. 12", "supersampling without the first pass")
    (middle, sides), mean_u = middle_and_sides(scene_loads[0]), [estimate(offset_u) for offset_u in u]
    findings = [f"The mean load imbalance u of {len(u[0])} pictures is {mean_u[0].text()} with p = 0 (range {range_text(u[0])}) and "
                f"{mean_u[1].text()} with p = 16 (range {range_text(u[1])}).",
                f"In the single picture with p = 0, the PEs of the middle quarter have {middle:.2f} times the mean load, and the first "
                f"and last eighth of the PEs {sides:.2f} times. With p = 16 the lowest load of a PE is "
                f"{scene_loads[1].min():.2f} times the mean load and the highest {1 + scene_u[1]:.2f} times."]
    in_paper = first_pass and papers.is_papers(scene.name, size)
    remarks = ("our scene is calibrated to this value: see scenes/README.md", papers.IMBALANCE_16_ROUNDING) if in_paper else ("", "")
    plotted_rows = rows[rows["PE"] % max(len(rows) // 64, 1) == 0]
    labels, mean_line = ("p = 0, column split", "p = 16, cyclic mapping"), Series("mean load", [0, len(rows) - 1], [1, 1])
    return Page({"scene": scene.name, "size": size, "pes": size, "pictures": len(u[0]), "offsets": list(offsets)},
                findings,
                with_paper(in_paper, [Comparison(f"u({p}) of the single picture", "", *some, True) for p, *some in
                                      zip((0, 16), (papers.IMBALANCE_0, papers.IMBALANCE_16), scene_u, remarks)])
                + [Comparison(f"u({p}), mean of the ensemble", "", None, mean.mean, "", False, mean.half) for p, mean in zip((0, 16), mean_u)],
                claims_of(picture_loads, ensemble.description) if first_pass and not scenes else [],
                [Table(name, "Load of each PE with p = 0 and p = 16", rows, on_page=False)],
                [Plot(name, f"Load of each PE, {scene.name}, {phase}", "number of the PE", "load / mean load",
                      [Series(label, rows["PE"], one) for label, one in zip(labels, scene_loads)] + [mean_line]),
                 Plot(f"{name}-views", f"Load of each PE, {phase}, mean of {len(u[0])} pictures", "number of the PE", "load / mean load",
                      [Series(label, plotted_rows["PE"], plotted_rows[f"{p}, mean of the ensemble"], half_widths=plotted_rows[f"{p}, +-"])
                       for label, p in zip(labels, ("p = 0", "p = 16"))] + [mean_line])],
                compared_with=papers.SPA,
                placeholders={"figure": f"{place}: load of each PE{'' if first_pass else ' in supersampling'}", "phase": phase, "place": place,
                              "name": name, "ensemble": ensemble.description,
                              "question": "How do the column split (p = 0) and the cyclic mapping (p = 16) spread the work of an image over the PEs?"
                              if first_pass else "Is the work of supersampling spread over the PEs as evenly as that of the first pass?"})


def claims_of(picture_loads, about):
    columns, cyclic = (np.subtract(*middle_and_sides(offset_loads)) for offset_loads in picture_loads)
    text = "With p = {}, the mean load of the PEs in the middle quarter minus that of the first and last eighth is {} of the mean load of all PEs."
    return [judged("hump", above(columns, 0, digits=2), about, text.format(0, estimate(columns).text(2))),
            judged("no-hump", None, about, text.format(16, estimate(cyclic).text(2)))]


@study("fig7", prose=PROSE, one_scene=True, prepare=lambda lab, scenes: lab.ensemble(scenes, lab.size(256), families=CROWDED))
def fig7(lab, scenes):
    return page_of("fig7", lab, scenes, first_pass=True)


@study("fig12", prose=PROSE, one_scene=True,
       prepare=lambda lab, scenes: lab.ensemble(scenes, lab.size(256), "supersample", families=CROWDED))
def fig12(lab, scenes):
    return page_of("fig12", lab, scenes, first_pass=False)
