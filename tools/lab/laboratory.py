"""Renders scenes for studies, and caches cost images. A cost image has the modelled cycles of each pixel.

Scene families: scenes of 6 to 31 objects, as in Kohata & Ito 1993, section 4. Each seed gives another scene or another view, so the pictures of a
family are independent.
"""
from collections import namedtuple
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import raya
from raya.lab.claims import CONTROLS

MACHINES = {machine["name"]: machine for machine in raya.machines()}
SPA = MACHINES["spa"]
VIEWS = 108  # default number of pictures of an ensemble
# Numbers of seeds reserved for each part of a study, and for each family of a part. With the same seed two families would have the same view.
SEEDS, FAMILY_SEEDS = 100_000, 1000
TESTS = tuple(f"{kind}_tests" for kind in ("sphere", "plane", "polygon", "cone"))


def rays_of(events):
    """Returns the number of rays of all kinds, from a render's event counts."""
    return sum(events[kind] for kind in ("primary", "reflected", "refracted", "shadow"))


def tests_of(events):
    """Returns the number of intersection tests with objects of all kinds, from a render's event counts."""
    return sum(events[kind] for kind in TESTS)


def view_of(scene):
    """Returns a function(seed) -> scene. The camera looks at its target from a random direction, 5 to 75 degrees above it, at the same distance."""
    return lambda seed: scene.random_view(seed).renamed(f"{scene.name}, view {seed}")


def _scattered(make_scene):
    """Returns a function(seed) -> scene: the spheres of make_scene() at random places, from a random view."""
    def make_scattered(seed):
        scene = make_scene()
        return scene.scattered(seed).random_view(seed).renamed(f"{scene.name}, scattered, seed {seed}")
    return make_scattered


def _random(min_spheres, max_spheres):
    """Returns a function(seed) -> scene: random spheres from a random view."""
    def make_random(seed):
        count = min_spheres + seed % (max_spheres - min_spheres + 1)
        return raya.generate.random(count, seed).random_view(seed).renamed(f"random-{count}, seed {seed}")
    return make_random


def cluster(seed):
    """Returns a scene with its objects in the middle of the image, as in Fig. 6."""
    return raya.generate.cluster(seed).renamed(f"cluster, seed {seed}")


# {family: function(seed) -> scene}
FAMILIES = {"cluster": cluster,
            **{f"{name}, scattered": _scattered(lambda name=name: raya.example(name)) for name in ("centre", "spheres", "mirrors", "glass")},
            "balls-1, scattered": _scattered(lambda: raya.generate.balls(1).renamed("balls-1")),
            "random, 6 to 13": _random(6, 13), "random, 14 to 21": _random(14, 21), "random, 22 to 30": _random(22, 30)}
# Also scenes of many objects, evenly spread (uniform) or not, as in Haines's Standard Procedural Databases.
WIDE_FAMILIES = {**FAMILIES, "balls-2": view_of(raya.generate.balls(2).renamed("balls-2")), "lattice-2": view_of(raya.generate.lattice(2).renamed("lattice-2")),
                 "uniform-64": view_of(raya.generate.uniform(64, (4, 4, 4)).renamed("uniform-64"))}
CROWDED = {"cluster": cluster}  # families whose scenes have their objects in the middle of the image


@dataclass
class Costs:
    """Cost images of one render. They give the loads of the PEs for any mapping and number of PEs."""

    label: str
    trace: np.ndarray  # uint64 [H, W]: modelled cycles of each pixel in the first pass
    supersample: np.ndarray  # modelled cycles of each pixel in the supersampling pass; None without supersampling
    recomputed: int  # number of supersampled pixels
    job_words: int  # number of 32-bit words that the scene takes in each PE


@dataclass
class Ensemble:
    """Cost images of several scene families (FAMILIES), or of random views of scenes."""

    pictures: list  # of Costs
    families: list  # family of each picture
    description: str  # the families and seeds, for the method of a study

    def map(self, measure):
        """Returns an array [picture, ...] of measure(costs)."""
        with ThreadPoolExecutor() as threads:  # the engine computes without Python's global lock
            return np.array(list(threads.map(measure, self.pictures)))

    def control_u(self, pes, image_of=lambda costs: costs.trace):
        """Returns {control: load imbalance u of each picture} of the negative controls (CONTROLS)."""
        return dict(zip(CONTROLS, self.map(lambda costs: control_u(image_of(costs), pes)).T))


def imbalance(loads):
    """Returns the load imbalance u = (max load - mean load) / mean load."""
    return loads.max() / loads.mean() - 1


def control_u(image, pes):
    """Returns the load imbalance u of a cost image with each of CONTROLS."""
    return [imbalance(raya.loads(image, pes=pes, **options)) for options in CONTROLS.values()]


def format_for(scene):
    """Returns the SPA's number format; fp32 if the scene does not fit the memory of a PE of the SPA."""
    return SPA["format"] if 4 * raya.job_words(scene) <= SPA["pe_memory_bytes"] else "fp32"


class Laboratory:
    """Renders scenes. `store` (Store) keeps cost images by scene and settings, so that the studies of one run share them.

    size: pixels per side; None: each study's default. views: pictures per ensemble. seed: seed of the first picture. options: `device`, and options of raya.render() for every render.
    devices: descriptions of the devices that computed the results used so far.
    """

    def __init__(self, store, size=None, views=None, seed=1, **options):
        self.store, self._size, self._options = store, size, options
        self.views, self.seed, self.devices = views or VIEWS, seed, set()

    @cached_property
    def session(self):
        return raya.Session(self._options.get("device") or "")

    @cached_property
    def device(self):
        """Description of the laboratory's device: name, platform and driver."""
        device = self.session.device
        return f"{device['name']} ({device['platform']}, driver {device['driver']})"

    def size(self, default):
        return self._size or default

    def render(self, scene, **options):
        """Calls raya.render() on the laboratory's device."""
        common = {k: v for k, v in self._options.items() if k != "device"}
        self.devices.add(self.device)
        return raya.render(scene, session=self.session, **common, **options)

    def stored(self, request, compute):
        """Returns the stored result of the request, or else stores and returns compute(): a dictionary of numpy arrays and JSON values without
        measured times. `request` must identify the result. A shard of a study (`raya study --shard`) computes only its part of the results, and
        stored() returns None."""
        result = self.store.get(request, lambda: {**compute(), "device": self.device})
        if result:
            self.devices.add(result.pop("device"))
        return result

    def costs(self, scene, size, antialias="none", accel="none"):
        """Returns the cost images (`Costs`) of a render of size x size pixels on PEs of the SPA, without their memory limit. Returns None in a
        shard."""
        options = dict(machine="grande", format=format_for(scene), bounces=SPA["bounces"], size=size, pes=size,
                       offset=16 % size, accel=accel, antialias=antialias)

        def compute():
            result = self.render(scene, cost=True, **options)
            images = {name: image.copy() for name, image in result.costs.items()}  # views would keep the whole result in memory
            return {**images, "recomputed": result.report["antialias"].get("recomputed_pixels", 0), "job_words": result.job_words}

        result = self.stored((scene.nff, sorted(options.items())), compute)
        return result and Costs(scene.name, result["trace"], result.get("supersample"), result["recomputed"], result["job_words"])

    def ensemble(self, scenes, size, antialias="none", views=None, families=FAMILIES, part=0):
        """Returns an Ensemble of `views` pictures, equally many of each family. If there are scenes, each is a family of random views. A family has
        at most max(4, 2^31 / (pixels x objects)) pictures. part: ensembles of different parts of a study share no picture."""
        if scenes:
            families = {scene.name: view_of(scene) for scene in scenes}
        objects = max(make(1).objects for make in families.values())
        limit = max(4, 2**31 // (size * size * max(objects, 1)))
        views_each = max(2, min(limit, -(-(views or self.views) // len(families))))
        first_seeds = {name: self.seed + part * SEEDS + i * FAMILY_SEEDS for i, name in enumerate(families)}
        pictures = [(name, self.costs(make(first_seeds[name] + i), size, antialias)) for name, make in families.items() for i in range(views_each)]
        seeds = [f"{seed}..{seed + views_each - 1}" for seed in first_seeds.values()]
        seeds_text = ", ".join(seeds if len(seeds) < 4 else [*seeds[:2], "...", seeds[-1]])
        families_text = "family" if len(seeds) == 1 else "families"
        return Ensemble([costs for _, costs in pictures], [name for name, _ in pictures],
                        f"{len(pictures)} pictures of {len(seeds)} {families_text}, seeds {seeds_text}")


def first_scene(scenes):
    """Returns the first scene of the command line; by default the example scene centre, which resembles the scene of Kohata & Ito."""
    return scenes[0] if scenes else raya.example("centre")


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
    """Returns the mean of the seconds that run() returns. Calls it until the sum is minimum_s or more, as the overhead of clock and launch would
    distort shorter times."""
    total = calls = 0
    while total < minimum_s:
        total += run()
        calls += 1
    return total / calls
