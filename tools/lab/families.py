"""The scene families of the studies of load: scenes of 6 to 31 objects, as in the experiments of Kohata & Ito 1993, section 4. Each seed gives
another scene and another view, so the pictures of a family are independent."""
import raya


def view_of(scene):
    """Function(seed) that returns a random view of the scene: another direction from the same distance, 5 to 75 degrees above its target."""
    return lambda seed: scene.random_view(seed).renamed(f"{scene.name}, view {seed}")


def _scattered(scene):
    """The scene's spheres at random places, from a random view. `scene`: function that returns it."""
    def make(seed):
        one = scene()
        return one.scattered(seed).random_view(seed).renamed(f"{one.name}, scattered, seed {seed}")
    return make


def _random(low, high):
    """Random spheres: another scene and another view for each seed."""
    def scene(seed):
        count = low + seed % (high - low + 1)
        return raya.generate.random(count, seed).random_view(seed).renamed(f"random-{count}, seed {seed}")
    return scene


def cluster(seed):
    """A scene with its objects in the middle, as that of Fig. 6."""
    return raya.generate.cluster(seed).renamed(f"cluster, seed {seed}")


# {family: function(seed) -> scene}
FAMILIES = {"cluster": cluster,
            **{f"{name}, scattered": _scattered(lambda name=name: raya.example(name)) for name in ("centre", "spheres", "mirrors", "glass")},
            "balls-1, scattered": _scattered(lambda: raya.generate.balls(1).renamed("balls-1")),
            "random, 6 to 13": _random(6, 13), "random, 14 to 21": _random(14, 21), "random, 22 to 30": _random(22, 30)}
CROWDED = {"cluster": cluster}  # scenes with their objects in the middle
