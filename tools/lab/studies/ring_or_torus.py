"""Ring or torus for the same scene and number of processors

From how many objects on is a torus of transputers, which divides space, faster than a ring, which divides the image?

- Scenes of N spheres, spread evenly over 4 x 4 x 4 voxels, {size} x {size} pixels, {bounces} bounces on both machines. P processors on each.
- Ring: every PE stores the whole scene and tests each ray against all objects. Cyclic mapping with the offset sqrt(P). Clock: {ring_clock}
- Torus: every node stores the objects of one voxel. Clock: {torus_clock}
- Ring, time: compute and communication (broadcast of the objects, gathering of the image), without display. Torus, time: overlapped and stepwise; a
  real machine takes a time between them.
- On one clock: the ring's cycles per PE are also charged as T805 cycles of the same events, as if its PEs were transputers.
- Break-even: least N, in powers of 4, from which on the torus is faster.
- Output: ring-or-torus.csv has a row for each P and N: modelled times in ms, and the ratio ring / torus on the machines' own clocks and on one.
"""
import pandas as pd
import raya
from raya.lab import Page, Plot, Series, Table, first_from, series_by, study
from raya.lab.spa import CLOCK as RING_CLOCK
from raya.lab.spa import run_on_spa
from raya.lab.voxels import BOUNCES, CLOCK, even_scene, near_cube, run_on_torus

PROCESSORS = (8, 64, 512)
OBJECTS = [4**k for k in range(2, 7)]  # 16 to 4096


def row_of(lab, pes, scene, size):
    ring = run_on_spa(lab, scene, size, pes, round(pes**0.5))
    torus = run_on_torus(lab, scene, size, near_cube(pes), near_cube(pes), queue=256)
    time = ring.report["modelled_ms"]
    ring_ms = time["compute"] + time["communication"] + time["objects"] + time["image"]
    # The events of all PEs on one transputer, divided by the PEs, times the load imbalance of the busiest PE.
    same_clock_ms = raya.t805_ms(ring.events) / pes * (1 + ring.report["load"]["imbalance"])
    return {"P": pes, "N": scene.objects, "ring (ms)": ring_ms, "ring, T805 (ms)": same_clock_ms, "torus, overlapped (ms)": torus["overlapped (ms)"],
            "torus, stepwise (ms)": torus["stepwise (ms)"], "ring / torus": ring_ms / torus["overlapped (ms)"],
            "ring / torus, stepwise": ring_ms / torus["stepwise (ms)"], "ring / torus, one clock": same_clock_ms / torus["overlapped (ms)"],
            "tests a ray, ring": scene.objects, "tests a ray, torus": torus["tests a ray"]}


@study("ring-or-torus")
def ring_or_torus(lab, scenes):
    size = lab.size(128)
    rows = pd.DataFrame([row_of(lab, pes, scene, size) for pes in PROCESSORS for scene in (scenes or map(even_scene, OBJECTS))])
    ratios = {"overlapped": "ring / torus", "stepwise": "ring / torus, stepwise", "one clock": "ring / torus, one clock"}
    evens = pd.DataFrame([{"P": pes, **{f"break-even N, {name}": first_from(group["N"], group[column] > 1, f"above {group['N'].max()}")
                                        for name, column in ratios.items()}} for pes, group in rows.groupby("P")])
    findings = [f"P = {pes}: with the machines' own clocks the torus is faster from {overlapped} objects on if it waits for nothing, and from "
                f"{stepwise} on step by step; with one clock, waiting for nothing, from {one} on."
                for pes, overlapped, stepwise, one in evens.itertuples(index=False)]
    return Page({"size": size, "processors": ", ".join(map(str, PROCESSORS))}, findings,
                tables=[Table("ring-or-torus", "Modelled times of ring and torus", rows),
                        Table("ring-or-torus-even", "Objects from which on the torus is faster", evens)],
                plots=[Plot("ring-or-torus", "Time on the ring / time on the torus", "objects", "ring / torus",
                            [*series_by(rows.assign(label="own clocks, P = " + rows["P"].astype(str)), "label", "N", "ring / torus"),
                             *series_by(rows.assign(label="one clock, P = " + rows["P"].astype(str)), "label", "N", "ring / torus, one clock"),
                             Series("break-even", OBJECTS, [1] * len(OBJECTS), "line")], "xy")],
                placeholders={"bounces": BOUNCES, "ring_clock": RING_CLOCK, "torus_clock": CLOCK})
