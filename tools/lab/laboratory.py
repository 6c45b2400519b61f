"""Renders for studies, and cost images: the modelled cycles of each pixel of a scene."""
import hashlib
import pickle
from collections import namedtuple
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import raya

SPA = next(m for m in raya.machines() if m["name"] == "spa")
VIEWS = 64
TESTS = tuple(f"{kind}_tests" for kind in ("sphere", "plane", "polygon", "cone"))


def rays_of(events):
    return sum(events[kind] for kind in ("primary", "reflected", "refracted", "shadow"))


def tests_of(events):
    return sum(events[kind] for kind in TESTS)


@dataclass
class Costs:
    """The cost image of one render. The load of every array and mapping follows from it."""

    label: str
    trace: np.ndarray  # uint64 [H, W]: modelled cycles of each pixel in the first pass
    supersample: np.ndarray  # the same for supersampling; None without it
    report: dict
    job_words: int  # 32-bit words of the scene that a PE stores

    @property
    def recomputed(self):
        """Pixels that were supersampled."""
        return self.report["antialias"].get("recomputed_pixels", 0)


@dataclass
class Ensemble:
    """Costs of a scene's own picture and of random views of it, seeds 1, 2, ..."""

    picture: Costs
    views: list


def format_for(scene):
    """The SPA's number format; fp32 for a scene that does not fit the memory of an SPA's PE."""
    return SPA["format"] if 4 * raya.job_words(scene) <= SPA["pe_memory_bytes"] else "fp32"


class Laboratory:
    """Renders scenes. Cost images are cached in a folder, by scene and settings, for all studies of a call.

    size: pixels a side that the user asked for; network: (alpha in s, beta in s/byte); options: of every render (device).
    """

    def __init__(self, folder, size=None, network=None, **options):
        self._folder, self._size, self.network, self._options = Path(folder), size, network, options

    @cached_property
    def session(self):
        return raya.Session(self._options.get("device") or "")

    def size(self, default):
        return self._size or default

    def render(self, scene, **options):
        """raya.render() on the laboratory's device."""
        kept = {k: v for k, v in self._options.items() if k != "device"}
        return raya.render(scene, session=self.session, **kept, **options)

    def costs(self, scene, size, antialias="none"):
        """Cost image of the scene as the SPA's PEs render it, without their memory limit."""
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

    def ensemble(self, scene, size, antialias="none", most=VIEWS):
        """64 views of scenes like the paper's at 256 x 256; fewer for larger images and more objects, at least 4."""
        count = max(min(4, most), min(2**27 // (size * size * max(scene.objects, 1)), most))
        views = [self.costs(scene.random_view(seed).renamed(f"{scene.name}, view {seed}"), size, antialias)
                 for seed in range(1, count + 1)]
        return Ensemble(self.costs(scene, size, antialias), views)


def one_of(scenes):
    """The scene of a study of one scene: the first that the user named; by default centre, which resembles the paper's."""
    return scenes[0] if scenes else raya.example("centre")


def balance_pass(lab, scenes, first):
    """One pass over one scene, a PE for each column. Returns (settings, cost image of the picture, cost images of the views)."""
    scene, size = one_of(scenes), lab.size(256)
    ensemble = lab.ensemble(scene, size, "none" if first else "supersample")
    picture, *views = (one.trace if first else one.supersample for one in [ensemble.picture, *ensemble.views])
    return {"scene": scene.name, "size": size, "pes": size, "views": len(views), "view_seeds": f"1..{len(views)}",
            "lowest_view_degrees": 5, "highest_view_degrees": 75}, picture, views


VIEWS_PROSE = """
- The picture is accompanied by {views} random views of the same scene, seeds {view_seeds}. The camera keeps its distance; its
  direction is uniform on the sphere between {lowest_view_degrees} and {highest_view_degrees} degrees above the point that it
  looks at."""  # part of the method of fig7, fig8, fig12 and fig13


Measured = namedtuple("Measured", "minimum median maximum runs")  # seconds; runs: a count


def measured(run, runs, enough_s, warm=True):
    """Statistics of the seconds that run() returns, over at most `runs` calls after a warm-up. Stops after enough_s seconds."""
    if warm:
        run()
    seconds = [run()]
    while len(seconds) < runs and sum(seconds) < enough_s:
        seconds.append(run())
    return Measured(min(seconds), float(np.median(seconds)), max(seconds), len(seconds))


def sampled(run, minimum_s=0.02):
    """Mean seconds of a call, over as many calls as take 20 ms: clock and launch overhead distort shorter measurements."""
    total = calls = 0
    while total < minimum_s:
        total += run()
        calls += 1
    return total / calls
