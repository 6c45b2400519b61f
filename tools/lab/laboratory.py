"""Where studies get their material: renders, and what each pixel of a scene costs."""
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
    """What one render counted. The load of every array and mapping follows from it."""

    label: str
    trace: np.ndarray  # uint64 [H, W]: modelled cycles of each pixel in the first pass
    supersample: np.ndarray  # of supersampling; None without
    report: dict
    job_words: int  # what a PE holds of the scene

    @property
    def recomputed(self):
        """Pixels that were supersampled."""
        return self.report["antialias"].get("recomputed_pixels", 0)


@dataclass
class Ensemble:
    """A scene's own picture, and random views of it, of the seeds 1, 2, ..."""

    picture: Costs
    views: list


def format_for(scene):
    """The SPA's format, but fp32 for a scene that none of its PEs could hold."""
    return SPA["format"] if 4 * raya.job_words(scene) <= SPA["pe_memory_bytes"] else "fp32"


class Laboratory:
    """Renders, each once: cost images are kept in a folder, by scene and settings, for all studies of a call.

    size: pixels a side that the user asked for; network: (alpha s, beta s a byte); options: of every render (device).
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
        """The scene rendered as PEs of the SPA do it, without its memory limit."""
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
        """64 views of scenes like the paper's at 256 x 256; fewer of large images and of many objects, 4 at least."""
        count = max(min(4, most), min(2**27 // (size * size * max(scene.objects, 1)), most))
        views = [self.costs(scene.random_view(seed).renamed(f"{scene.name}, view {seed}"), size, antialias)
                 for seed in range(1, count + 1)]
        return Ensemble(self.costs(scene, size, antialias), views)


def one_of(scenes):
    """For studies of one scene: the first of those that were named, else centre, the paper's kind."""
    return scenes[0] if scenes else raya.example("centre")


def balance_pass(lab, scenes, first):
    """One pass over one scene, a PE for each column: (settings, cost image of the picture, those of the views)."""
    scene, size = one_of(scenes), lab.size(256)
    ensemble = lab.ensemble(scene, size, "none" if first else "supersample")
    picture, *views = (one.trace if first else one.supersample for one in [ensemble.picture, *ensemble.views])
    return {"scene": scene.name, "size": size, "pes": size, "views": len(views), "view_seeds": f"1..{len(views)}",
            "lowest_view_degrees": 5, "highest_view_degrees": 75}, picture, views


VIEWS_PROSE = """
- Next to the picture stand {views} views of the same scene, of the seeds {view_seeds}: the camera at the same
  distance, drawn evenly from the sphere between {lowest_view_degrees} and {highest_view_degrees} degrees above what it
  looks at."""  # of the studies of one pass, below what they measure


Measured = namedtuple("Measured", "least median largest runs")  # seconds


def measured(run, runs, enough_s, warm=True):
    """Of the seconds that run() returns; after a call that does not count. No further one after enough_s seconds."""
    if warm:
        run()
    seconds = [run()]
    while len(seconds) < runs and sum(seconds) < enough_s:
        seconds.append(run())
    return Measured(min(seconds), float(np.median(seconds)), max(seconds), len(seconds))


def sampled(run, least_s=0.02):
    """Mean seconds of a call, of as many as take 20 ms together: shorter ones measure clock and launch as well."""
    total = calls = 0
    while total < least_s:
        total += run()
        calls += 1
    return total / calls
