"""Renders through a grid in one PE: what the studies of voxels count and time."""
import math
from dataclasses import dataclass

import raya
from raya.lab.laboratory import Measured, measured, sampled
from raya.lab.torus import sides_text


@dataclass
class GridRun:
    scene: str
    objects: int
    divisions: tuple  # of the box of its finite objects
    copies: int  # entries of the voxels' lists beyond each object's first
    events: dict  # of one image
    time: Measured  # seconds of tracing one image on the device

    def __post_init__(self):
        e = self.events
        self.voxels = math.prod(self.divisions)
        self.rays = e["primary"] + e["reflected"] + e["refracted"] + e["shadow"]
        self.tests = sum(e[f"{kind}_tests"] for kind in ("sphere", "plane", "polygon", "cone"))
        self.voxels_of_object = 1 + self.copies / self.objects

    def row(self):
        return {"scene": self.scene, "divisions": self.voxels, "A x B x C": sides_text(self.divisions),
                "copies": self.copies, "rays": self.rays, "tests": self.tests, "steps": self.events["steps"],
                "tests a ray": self.tests / self.rays, "steps a ray": self.events["steps"] / self.rays,
                "modelled (s)": 1e-3 * raya.t805_ms(self.events), "measured (ms)": 1e3 * self.time.least,
                "measured, median (ms)": 1e3 * self.time.median, "objects": self.objects,
                "voxels of an object": self.voxels_of_object}


def run_grid(lab, scene, divisions, size, bounces=0, sampling="centres", runs=1):
    """The scene in fp32 on one PE of grande, every ray walking through the grid; `runs` samples are timed."""
    options = dict(machine="grande", format="fp32", size=size, pes=1, offset=0, bounces=bounces, sampling=sampling,
                   accel=f"grid:{sides_text(divisions)}")
    counted = lab.render(scene, **options)  # a warm-up for those that are timed
    time = measured(lambda: sampled(lambda: lab.render(scene, **options).device_s), runs, 1, warm=False)
    return GridRun(scene.name, scene.objects, tuple(divisions), counted.report["accel"]["copies"], counted.events, time)
