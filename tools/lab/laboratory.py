"""Renders scenes for studies, and caches cost images. A cost image has the modelled cycles of each pixel."""
import hashlib
import pickle
from collections import namedtuple
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import raya

SPA = next(m for m in raya.machines() if m["name"] == "spa")
VIEWS = 64  # default number of random views of a scene
TESTS = tuple(f"{kind}_tests" for kind in ("sphere", "plane", "polygon", "cone"))


def rays_of(events):
    """Returns the number of rays of all kinds in a render's event counts."""
    return sum(events[kind] for kind in ("primary", "reflected", "refracted", "shadow"))


def tests_of(events):
    """Returns the number of intersection tests with objects of all kinds in a render's event counts."""
    return sum(events[kind] for kind in TESTS)


@dataclass
class Costs:
    """Cost images of one render. They give the loads of the PEs for any mapping and number of PEs."""

    label: str
    trace: np.ndarray  # uint64 [H, W]: modelled cycles of each pixel in the first pass
    supersample: np.ndarray  # the same for the supersampling pass; None without supersampling
    report: dict
    job_words: int  # number of 32-bit words that the scene takes in each PE

    @property
    def recomputed(self):
        """Number of supersampled pixels."""
        return self.report["antialias"].get("recomputed_pixels", 0)


@dataclass
class Ensemble:
    """Costs of a scene with its own camera (`picture`), and with random cameras with seeds 1, 2, ... (`views`)."""

    picture: Costs
    views: list


def format_for(scene):
    """Returns the SPA's number format; fp32 if the scene does not fit the memory of a PE of the SPA."""
    return SPA["format"] if 4 * raya.job_words(scene) <= SPA["pe_memory_bytes"] else "fp32"


class Laboratory:
    """Renders scenes. Cost images are cached in `folder`, by scene and settings, so that the studies of one run share them.

    size: pixels per side; None: each study's default. network: (seconds per message, seconds per byte) or None. options: `device`, and options of
    every render.
    """

    def __init__(self, folder, size=None, network=None, **options):
        self._folder, self._size, self.network, self._options = Path(folder), size, network, options

    @cached_property
    def session(self):
        return raya.Session(self._options.get("device") or "")

    def size(self, default):
        return self._size or default

    def render(self, scene, **options):
        """Calls raya.render() on the laboratory's device."""
        common = {k: v for k, v in self._options.items() if k != "device"}
        return raya.render(scene, session=self.session, **common, **options)

    def costs(self, scene, size, antialias="none"):
        """Returns the cost images (`Costs`) of the scene, size x size pixels, on PEs of the SPA without their memory limit."""
        options = dict(machine="grande", format=format_for(scene), bounces=SPA["bounces"], size=size, pes=size,
                       offset=16 % size, accel="none", antialias=antialias)
        key = hashlib.sha256(repr((scene.nff, sorted(options.items()))).encode()).hexdigest()
        file = self._folder / f"{key}.costs"
        if file.exists():
            costs = pickle.loads(file.read_bytes())
            costs.label = scene.name
            return costs
        result = self.render(scene, cost=True, **options)
        images = {name: image.copy() for name, image in result.costs.items()}
        costs = Costs(scene.name, images["trace"], images.get("supersample"), result.report, result.job_words)
        file.write_bytes(pickle.dumps(costs))
        return costs

    def ensemble(self, scene, size, antialias="none", max_views=VIEWS):
        """Returns the costs of the scene and of random views (`Ensemble`). There are max_views views, or fewer so that views x pixels x objects is
        at most 2^27, but at least min(4, max_views)."""
        count = max(min(4, max_views), min(2**27 // (size * size * max(scene.objects, 1)), max_views))
        views = [self.costs(scene.random_view(seed).renamed(f"{scene.name}, view {seed}"), size, antialias)
                 for seed in range(1, count + 1)]
        return Ensemble(self.costs(scene, size, antialias), views)


def first_scene(scenes):
    """Returns the first scene of the command line; by default the example scene centre, which resembles the scene of Kohata & Ito."""
    return scenes[0] if scenes else raya.example("centre")


def costs_of_pass(lab, scenes, first):
    """Renders the cost images of the first pass, or of supersampling if `first` is false, for one scene with a PE for each column. Returns (settings,
    cost image of the picture, cost images of the views). A cost image is uint64 [H, W]: modelled cycles of each pixel."""
    scene, size = first_scene(scenes), lab.size(256)
    ensemble = lab.ensemble(scene, size, "none" if first else "supersample")
    picture, *views = (costs.trace if first else costs.supersample for costs in [ensemble.picture, *ensemble.views])
    return {"scene": scene.name, "size": size, "pes": size, "views": len(views), "view_seeds": f"1..{len(views)}",
            "lowest_view_degrees": 5, "highest_view_degrees": 75}, picture, views


VIEWS_PROSE = """
- {views} random views of the same scene, seeds {view_seeds}, are rendered in addition to the picture. The camera keeps its distance; its
  direction is uniform on the sphere between {lowest_view_degrees} and {highest_view_degrees} degrees above the point that it
  looks at."""  # part of the method of fig7, fig8, fig12 and fig13


Timing = namedtuple("Timing", "minimum median maximum runs")  # minimum, median, maximum in seconds; runs: number of samples


def time_calls(run, runs, sampling_s, warm=True):
    """Calls run(), which returns seconds, at most `runs` times, until the sum reaches sampling_s seconds. Returns the minimum, median and maximum
    (`Timing`). warm: makes an additional first call as a warm-up, which is not counted."""
    if warm:
        run()
    seconds = [run()]
    while len(seconds) < runs and sum(seconds) < sampling_s:
        seconds.append(run())
    return Timing(min(seconds), float(np.median(seconds)), max(seconds), len(seconds))


def mean_seconds(run, minimum_s=0.02):
    """Returns the mean of the seconds that run() returns, over as many calls as take minimum_s seconds, because clock and launch overhead distort
    shorter times."""
    total = calls = 0
    while total < minimum_s:
        total += run()
        calls += 1
    return total / calls
