"""The scene families of the studies of load balance: scenes of 6 to 31 objects, as in Kohata & Ito 1993, section 4. Each seed gives another scene or
another view, so the pictures of a family are independent."""
import raya


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
