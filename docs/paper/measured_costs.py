"""Measures the costs of a second renderer, and the load imbalance of mappings with them.

    PYTHONPATH=build/python python3 docs/paper/measured_costs.py >docs/paper/data/measured.csv

For four views of each of five scenes, build/embree_peer (Embree 3, Whitted ray tracing; cmake --build build --target embree_peer) measures the time
of each tile of 4 x 4 pixels of 1024 x 1024, the least of five, by one thread. The 256 x 256 tiles take the place of the pixels: 256 PEs, one for each
column of tiles. Columns: scene, mapping, mean u over the views, half width of its 95 % interval, and the mean |difference| of u when all tiles are
measured again. Run it on an idle machine.
"""
import csv
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import raya
from raya.lab import estimate
from raya.lab.laboratory import imbalance

PEER = Path(__file__).resolve().parents[2] / "build/embree_peer"
SIDE, TILES, BOUNCES, SAMPLES, VIEWS, SEED = 1024, 256, 8, 5, 4, 60_001
SCENES = {"balls-4": raya.generate.balls(4), "lattice-6": raya.generate.lattice(6), "gears-4": raya.generate.gears(4),
          "random-2000": raya.generate.random(2000), "cluster": None}
MAPPINGS = {"column split": {"offset": 0}, "p = sqrt(P)": {"offset": 16}, "golden ratio": {"offset": 158}, "2-D grid": {"mapping": "grid:16x16"},
            "random": {"mapping": "random:1"}, "p = 5": {"offset": 5}}


def tile_costs(scene):
    """Returns the nanoseconds of each tile: uint64 [TILES, TILES]."""
    with tempfile.NamedTemporaryFile("w", suffix=".nff") as file:
        file.write(scene.nff)
        file.flush()
        done = subprocess.run([PEER, file.name, f"{SIDE}x{SIDE}", str(BOUNCES), str(SAMPLES), "tiles"], check=True, capture_output=True, text=True)
    return np.array(done.stdout.split(), np.uint64).reshape(TILES, TILES)


def main():
    rows = csv.writer(sys.stdout, lineterminator="\n")
    rows.writerow(["scene", "mapping", "mean u", "+-", "difference of a second measurement"])
    for name, scene in SCENES.items():
        views = [raya.generate.cluster(SEED + i) if scene is None else scene.random_view(SEED + i) for i in range(VIEWS)]
        images = [[tile_costs(view) for view in views] for _ in range(2)]  # [measurement, view]
        for mapping, options in MAPPINGS.items():
            u, again = ([imbalance(raya.loads(image, pes=TILES, **options)) for image in one] for one in images)
            mean = estimate(u)
            rows.writerow([name, mapping, f"{mean.mean:.5f}", f"{mean.half:.5f}", f"{np.abs(np.subtract(u, again)).mean():.5f}"])


if __name__ == "__main__":
    main()
