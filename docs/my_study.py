"""Imbalance of three mappings over a turn of the camera

What is the mean imbalance of {scene} over a full turn of the camera, for three mappings?

- {scene} at {size} x {size} on {pes} PEs, {frames} frames.
- u = (max load - mean load) / mean load, from the cost image of each frame.
"""
import pandas as pd
import raya
from raya.lab import Page, Plot, Table, estimate, first_scene, series_by

MAPPINGS = {"column split": {"mapping": "column"}, "cyclic, p = 16": {"offset": 16},
            "tiles 8 x 8": {"mapping": "tiles:8x8"}}


def run(lab, scenes):
    scene, size, frames = first_scene(scenes), lab.size(128), 12
    rows = []
    for frame in range(frames):
        cost = lab.costs(scene.turned(360 * frame / frames), size).trace
        for name, options in MAPPINGS.items():
            loads = raya.loads(cost, pes=size, **options)
            rows.append({"angle (degrees)": 360 * frame / frames, "mapping": name,
                         "u": loads.max() / loads.mean() - 1})
    rows = pd.DataFrame(rows)
    means = {name: estimate(group["u"]).text() for name, group in rows.groupby("mapping", sort=False)}
    return Page({"scene": scene.name, "size": size, "pes": size, "frames": frames},
                [f"Mean u over the turn: {', '.join(f'{u} ({name})' for name, u in means.items())}."],
                tables=[Table("my-study", "Imbalance of every frame", rows)],
                plots=[Plot("my-study", "Imbalance over a turn of the camera", "angle (degrees)", "u",
                            series_by(rows, "mapping", "angle (degrees)", "u"), log="y")])
