"""The claims of claims.toml: the file, the studies that judge the claims, and synthetic data for each possible verdict of each claim."""
import re
from collections import Counter
from types import SimpleNamespace
from unittest.mock import patch

import numpy as np
import pandas as pd
import pytest

raya = pytest.importorskip("raya", reason="the module is not built: -DRAYA_PYTHON=ON")
from raya.lab import papers  # noqa: E402
from raya.lab.claims import CLAIMS, TESTS, decide, judged  # noqa: E402
from raya.lab.document import write_document  # noqa: E402
from raya.lab.laboratory import CROWDED, FAMILIES, Costs, Ensemble, Laboratory  # noqa: E402
from raya.lab.page import Page  # noqa: E402
from raya.lab.statistics import COMPATIBLE, CONDITIONAL, NOT_REPRODUCED, PLATEAU, REPRODUCED, counted, estimate, proportion  # noqa: E402
from raya.lab.statistics import Test as Result  # noqa: E402
from raya.lab.studies import (best_offset, cluster, divisions, images, imbalance, lattice, loads,  # noqa: E402
                              objects, speedup, static_vs_dynamic, table3, table4)

SEED, SIDE, COUNT = 32, 64, 12  # COUNT: number of pictures in an ensemble of two families of equal size
VERDICTS = {"yes": REPRODUCED, "?": COMPATIBLE, "no": NOT_REPRODUCED, "some": CONDITIONAL, "flat": PLATEAU}


def families(count):
    return ["first" if i < count / 2 else "second" for i in range(count)]


def ensemble_of(traces):
    """Returns an ensemble with these cost images. Each is used both for the first pass and for the supersampling of its picture."""
    pictures = [Costs(f"picture {i}", image, image, 0, 0) for i, image in enumerate(traces)]
    return Ensemble(pictures, families(len(pictures)), f"{len(pictures)} pictures")


class FakeLaboratory:
    """A laboratory whose ensembles have given cost images: parts, as {part: cost images}, or else `traces` for each part. asked: (size, antialias,
    part, families) of each ensemble that a study asked for."""

    seed, views = 1, COUNT

    def __init__(self, traces, parts=None):
        self._ensembles, self.asked = {part: ensemble_of(images) for part, images in (parts or {0: traces, 1: traces, 2: traces}).items()}, []

    def size(self, default):
        return self._ensembles[0].pictures[0].trace.shape[1]

    def costs(self, scene, size, antialias="none"):
        return self._ensembles[0].pictures[0]

    def ensemble(self, scenes, size, antialias="none", views=None, families=FAMILIES, part=0):
        assert scenes == [] and antialias in ("none", "supersample")
        self.asked.append((size, antialias, part, families))
        return self._ensembles[part]


def values_of(mean, spread, count=COUNT):
    """Returns values with this mean in each family: half of them are mean - spread, the others mean + spread."""
    return mean + spread * np.resize([-1.0, 1.0], count)


def slot_image(p, slot=5, height=500, side=SIDE):
    """Returns a cost image in which the pixels of one slot of the mapping with offset p cost `height` more than the others."""
    return 1000 + np.uint64(height) * (raya.owners(side, side, offset=p, pes=side) == slot % side).astype(np.uint64)


def slot_images(make, heights=values_of(500, 50)):
    """Returns cost images make(slot, height), one for each height, with random slots."""
    random = np.random.default_rng(SEED)
    return [make(int(random.integers(SIDE)), int(height)) for height in heights]


def in_turn(*kinds, count=COUNT):
    """Returns `count` pictures, in turn from the kinds, so that each family has pictures of all kinds."""
    return [kinds[i % len(kinds)] for i in range(count)]


def noise(count=COUNT):
    random = np.random.default_rng(SEED)
    return [random.integers(500, 1500, (SIDE, SIDE)).astype(np.uint64) for _ in range(count)]


def columns(weights):
    return np.tile(np.asarray(weights).astype(np.uint64), (SIDE, 1))


HUMP = np.exp(-((np.arange(SIDE) + 0.5 - SIDE / 2) / 8.0) ** 2)  # columns in the middle cost more


# Data for the claims of each study. Each function returns the judgements of the study.


def judge_fig8(traces):
    return imbalance.fig8(FakeLaboratory(traces), []).claims


def judge_fig13(traces):
    return imbalance.fig13(FakeLaboratory(traces), []).claims


def judge_fig7(traces):
    return loads.fig7(FakeLaboratory(traces), []).claims


def judge_fig9(ratio_to_2d=1.0, efficiency=0.9, cap_ratio=3.9, speedup_64=62.0, efficiency_p0=0.9, slot_height=0, spread=0.01, efficiency_77=None):
    """fig9 for pictures with these means. efficiency: on each number of PEs with the block fold, 0.1 less with the cyclic fold; cap_ratio: speed-up
    on 256 PEs over that on 64; slot_height: additional cost of a slot of p = 8 in the images with a PE for each column."""
    tables = []
    for factor in values_of(1, spread):
        block = np.full(256, efficiency * factor)
        block[76] = (efficiency_77 or efficiency) * factor
        pes = np.arange(1, 257)
        cyclic = pes * (block - 0.1)
        cyclic[63], cyclic[255] = speedup_64 * factor, speedup_64 * factor * cap_ratio * factor
        table = pd.DataFrame({"p = 16, cyclic fold": cyclic, "p = 16, block fold": pes * block, "p = 0, cyclic fold": pes * efficiency_p0 * factor})
        tables.append((table, {16: cyclic[255] / (ratio_to_2d * factor)}))
    lab = FakeLaboratory(slot_images(lambda slot, height: slot_image(8, slot, height), values_of(slot_height, slot_height / 4)))
    found = speedup.claims_of(lab, tables, ensemble_of([None] * COUNT), {})
    assert lab.asked == [(side, "none", 0, FAMILIES) for side in (256, 512, 1024)]
    return found


def judge_cluster(speedup, ratio, spread):
    values = {name: values_of(mean, spread * mean, 60) for name, mean in
              (("speed-up", speedup), ("speed-up, random permutation", 200), ("speed-up, p = 5", 180), ("supersampling, p = 0 / p = 16", ratio),
               ("supersampling, p = 0 / p = 5", 1.5))}
    return cluster.claims_of(pd.DataFrame(values).assign(matched=["yes", "yes", "no", "no"] * 15), "30 matched scenes")


def judge_images(kinds, count, windows, finer=None):
    """images, for pictures of these kinds in turn. windows: (u(0), u(p)) of each window; finer: ensemble of images of twice the size."""
    ensemble = ensemble_of(in_turn(*kinds, count=count))
    return images.claims_of(ensemble, finer or ensemble, np.array([[*one, 0.3, 0.3] for one in windows]), SIDE, 8)


def judge_lattice(difference, spread, shared="yes", side=SIDE):
    """lattice. difference: mean of u(p) - u(n) over the offsets p beyond n; shared: "yes" if no block has two pixels of one PE with p = n."""
    n = round(side**0.5)
    beyond = [p for p in range(n + 1, side) if p != side - n]
    u = 0.2 + np.zeros((COUNT, side))
    u[:, beyond] += values_of(difference, spread)[:, None]
    rows = pd.DataFrame({"p": range(side), "n x n blocks shared": [shared if p == n else "no" for p in range(side)]})
    return lattice.claims_of(u, ensemble_of([None] * COUNT), rows, n, beyond, {})


def block_of_16(height, extra=0, offset=16):
    """Returns 256 x 16 pixels. 16 neighbouring columns cost `height` more; p = 16 spreads them evenly. A slot of `offset` costs `extra` more."""
    image = np.full((16, 256), 100_000, np.uint64)
    image[:, 120:136] += np.uint64(height)
    return image + np.uint64(extra) * (raya.owners(256, 16, offset=offset, pes=256) == 7).astype(np.uint64)


MATCHED_HEIGHT = 188_370  # height for the paper's u(0) = (1 + 1.8837) / (1 + 1.8837 / 16) - 1 = 1.58


def judge_table3(extras, rotations=(2, 18, 34), offsets=range(17)):
    """table3, for scenes with and without the paper's u(0). extras: extra costs of a slot of p = 16; offset p has 2 (offsets[p] + 1) rotations."""
    lab = FakeLaboratory([block_of_16(MATCHED_HEIGHT, extra) for extra in extras] + [block_of_16(1000)] * COUNT)
    rows = pd.DataFrame({"p": [0, 8, 16], "rotations": rotations})
    matched = cluster.matched_times(lab, "filter")
    found = table3.claims_of(matched, rows, pd.DataFrame({"offset": range(17), "rotations": [2 * (p + 1) for p in offsets]}))
    assert lab.asked == [(256, "supersample", 1, CROWDED)]
    assert f"{len(extras)} matched scenes" in found[-1].ensemble
    return found


def judge_table4(heights, rotations=(2, 18, 34), words=768, ratio=1.0, uneven_at_8=0):
    """table4. heights: additional costs of 16 columns in each picture; uneven_at_8: of a slot of p = 8; rotations, words: of the filter, words per
    rotation; ratio: budget of the comparison over that of the filter."""
    def run(rotations, words):
        return SimpleNamespace(report={"communication": {"rotations": rotations, "rotation_words": words * rotations}, "modelled_ms": {"filter": 1.0}})

    rows = pd.DataFrame({"p": [0, 8, 16], "rotations": [2, 18, 34], "compare": [ratio, 1, 1]})
    lab = FakeLaboratory([block_of_16(height, uneven_at_8, 8) for height in heights])
    return table4.claims_of(lab, SimpleNamespace(runs={p: run(2 * p + 2, 768) for p in (0, 8, 16)}), rows, [run(r, words) for r in rotations])


def judge_quality(filtered, supersampled, sharpness):
    """table4: gain of the PSNR (dB) with the filter and with supersampling; gradient at edges with the filter relative to the reference."""
    psnr = np.stack([values_of(30, 2), values_of(30, 2) + values_of(filtered, 0.2), values_of(30, 2) + values_of(supersampled, -0.2)], axis=1)
    return table4.claims_of_quality(psnr, np.stack([values_of(1.2, 0.1), values_of(sharpness, 0.05), values_of(1, 0.01)], axis=1), families(COUNT))


def uneven_image(offsets, height=50_000):
    """Returns 256 x 16 pixels. With each of the offsets, one of 256 PEs and one of 64 PEs has more load than the others."""
    image = np.full((16, 256), 100_000, np.uint64)
    for p in offsets:
        image += np.uint64(height) * (raya.owners(256, 16, offset=p, pes=64) == 3 * p % 64).astype(np.uint64)
    return image


def judge_best_offset(chosen_by, judged_by):
    lab = FakeLaboratory([], {0: chosen_by, 2: judged_by})
    found = [best_offset.claim_of_enough(lab)]
    assert lab.asked == [(256, "supersample", 0, FAMILIES), (256, "supersample", 2, FAMILIES)]
    return found


def judge_static_vs_dynamic(*kinds, count=COUNT):
    return static_vs_dynamic.claims_of(ensemble_of(in_turn(*kinds, count=count)))


def random_pixels(fraction, ratio, side=128):
    """Returns a cost image in which this fraction of the pixels costs `ratio` times as much as the others."""
    return np.random.default_rng(SEED).choice(np.array([10**6, ratio * 10**6], np.uint64), (side, side), p=[1 - fraction, fraction])


def last_pixel_late(side=128):
    """Returns a cost image with which 256 PEs have equal loads at p = 16. Its last pixel costs as much as another PE's pixels."""
    owners = raya.owners(side, side, offset=16, pes=256)
    image = np.full((side, side), 10**6, np.uint64)
    owned = owners == owners[-1, -1]
    image[owned] = 1
    image[-1, -1] = 10**6 * owned.sum() - (owned.sum() - 1)
    return image


def judge_divisions(falls, best=1, after=1.1, gain=papers.DIVISIONS_FALL):
    """divisions. falls: factors by which the tests fall in the layouts for 32 times as many divisions, in turn; best: number of divisions with the
    fewest tests / number of objects; after: factor of each doubling beyond; gain: mean factor by which the time falls, in proportion to the tests."""
    def layouts_of(lab, size, count):
        fall = np.resize(falls, len(divisions.RADII) * divisions.VIEWS)[:, None]
        doublings = np.arange(14) - np.log2(count * best)
        before, beyond = np.clip(-doublings, 0, None) / 5, np.clip(doublings, 0, None)
        return {"tests": fall**before * after**beyond, "time": (gain * fall / np.mean(falls))**before * after**beyond}

    with patch.object(divisions, "layouts_of", layouts_of):
        return divisions.claims_of(FakeLaboratory([]), 96)


def judge_objects(ratios, even, random, few_ratios=None):
    """objects. ratios: times of random over even objects, in turn; few_ratios: those up to 256 objects, by default the same; even, random: (growth of
    objects / time, part of its log due to fewer voxels)."""
    def growth(factor, part, spread):
        factors = factor * (1 + spread)
        return pd.DataFrame({"objects": 130.0, "time": 130 / factors, "objects / time": factors, "fewer voxels a ray": factors ** (part + spread)})

    runs, rows, growth_of_objects = {}, [], objects.COUNTS[-1] / objects.COUNTS[0]
    spread = np.resize([0.98, 1.02], objects.VARIANTS)
    for count in objects.COUNTS:
        times = np.resize(few_ratios if few_ratios and count <= 256 else ratios, objects.VARIANTS)
        base = 40.0 * (growth_of_objects / even[0] * spread if count == objects.COUNTS[-1] else 1) * np.ones((len(objects.ROOT_COSTS), objects.VARIANTS))
        for kind in (objects.EVEN, objects.WITHIN):
            runs[count, kind] = base
        runs[count, objects.RANDOM] = base * times
        rows.append({"objects": count, "kind": objects.RANDOM, "protocol": objects.PAPER, **dict.fromkeys(objects.TIMES, estimate(times))})
    return objects.claims_of(runs, pd.DataFrame(rows), [
        (kind, protocol, growth(*of_kind, np.array([-2, -1, 0, 1, 2]) / 50))
        for protocol in objects.PROTOCOLS for kind, of_kind in ((objects.EVEN, even), (objects.RANDOM, random))], "variants")


# The cases: study, data, judgements, {id of a claim: "yes" for reproduced, "no" for not reproduced, "?" for compatible}.

EQUAL = np.full((128, 128), 10**6, np.uint64)  # pixels of equal cost
HUMPS = [columns(1000 + height * HUMP) for height in (500, 1000, 2000, 4000)]
ROUGH = [image + np.random.default_rng(SEED).integers(0, 1300, (SIDE, SIDE)).astype(np.uint64) for image in HUMPS]
WORST_AT_N = [slot_image(8, height=height) for height in (300, 600, 900, 1200)]
BAD_UP_TO_ROOT = uneven_image(range(17))

CASES = [
    ("fig8", "an expensive column", lambda: judge_fig8(slot_images(lambda slot, height: slot_image(0, slot, height))),
     {"cyclic-reduces": "yes", "best-is-n": "no", "good-at-8": "yes"}),
    ("fig8", "p = n is the worst", lambda: judge_fig8(slot_images(lambda slot, height: slot_image(8, slot, height))),
     {"cyclic-reduces": "no", "best-is-n": "no", "good-at-8": "no"}),
    ("fig8", "p = n is the best", lambda: judge_fig8(slot_images(lambda slot, height: sum(slot_image(p, slot + 5 * p, height) for p in range(8)))),
     {"cyclic-reduces": "yes", "best-is-n": "yes", "good-at-8": "no"}),
    ("fig8", "p = 0 is the best, so no offset has a gain",
     lambda: judge_fig8(slot_images(lambda slot, height: sum(slot_image(p, slot + 5 * p, height) for p in range(1, 9)))),
     {"cyclic-reduces": "no", "best-is-n": "no", "good-at-8": "no"}),
    ("fig8", "noise", lambda: judge_fig8(noise()), {"cyclic-reduces": "?", "best-is-n": "?", "good-at-8": "no"}),
    ("fig8", "p = n / 2 has 0.95 and 0.86 of the gain in turn", lambda: judge_fig8(in_turn(slot_image(0), slot_image(0) + slot_image(4, height=50))),
     {"cyclic-reduces": "yes", "best-is-n": "no", "good-at-8": "?"}),

    ("fig13", "a column of twice the cost", lambda: judge_fig13(slot_images(lambda slot, height: slot_image(0, slot, height), values_of(1000, 100))),
     {"contours-uneven": "yes", "supersampling-balances": "yes"}),
    ("fig13", "a column with u(0) = 0.5", lambda: judge_fig13(slot_images(lambda slot, height: slot_image(0, slot, height), values_of(512, 100))),
     {"contours-uneven": "?", "supersampling-balances": "yes"}),
    ("fig13", "p = n is the worst", lambda: judge_fig13(slot_images(lambda slot, height: slot_image(8, slot, height))),
     {"contours-uneven": "no", "supersampling-balances": "no"}),
    ("fig13", "noise", lambda: judge_fig13(noise()), {"contours-uneven": "no", "supersampling-balances": "?"}),

    ("fig7", "expensive columns in the middle", lambda: judge_fig7([columns(1000 + height * HUMP) for height in values_of(1000, 100)]),
     {"hump": "yes"}),
    ("fig7", "expensive columns at the sides", lambda: judge_fig7([columns(3000 - height * HUMP) for height in values_of(1000, 100)]),
     {"hump": "no"}),
    ("fig7", "noise", lambda: judge_fig7(noise()), {"hump": "?"}),

    ("fig9", "all figures within the rules", judge_fig9,
     {"like-2d": "yes", "proportional": "yes", "near-cap": "yes", "near-pixel-machine": "yes", "few-processors": "yes", "finer-images": "yes"}),
    ("fig9", "all figures too low", lambda: judge_fig9(0.8, 0.7, 3.0, 50.0, 0.7, 500),
     {"like-2d": "no", "proportional": "no", "near-cap": "no", "near-pixel-machine": "no", "few-processors": "no", "finer-images": "no"}),
    ("fig9", "all figures at the bounds of the rules", lambda: judge_fig9(0.95, 0.8, 0.9 * papers.CAP_RATIO, 54.0, 0.8, 256, 0.05),
     {"like-2d": "?", "proportional": "?", "near-cap": "?", "near-pixel-machine": "?", "few-processors": "?", "finer-images": "?"}),

    ("cluster", "the paper's figures", lambda: judge_cluster(230, 1.8, 0.01),
     {"speedup-229": "yes", "supersampling-ratio": "yes"}),
    ("cluster", "too small or too large", lambda: judge_cluster(150, 2.4, 0.01),
     {"speedup-229": "no", "supersampling-ratio": "no"}),
    ("cluster", "the paper's figures among very different ones", lambda: judge_cluster(229, 1.82, 0.15),
     {"speedup-229": "?", "supersampling-ratio": "?"}),

    ("images", "humps of columns", lambda: judge_images(HUMPS, 120, [(0.5, 0.1), (0.6, 0.1)] * 12),
     {"gain-for-all": "yes", "neighbours-alike": "yes", "columns-vary": "yes", "cyclic-is-high": "yes", "other-problems": "yes"}),
    ("images", "the cyclic mapping is worse", lambda: judge_images(WORST_AT_N, 120, [(0.1, 0.5), (0.1, 0.6)] * 12),
     {"gain-for-all": "no", "neighbours-alike": "no", "columns-vary": "no", "cyclic-is-high": "no", "other-problems": "no"}),
    ("images", "the cyclic mapping is worse in 3 of 40, and half of the humps are rough",
     lambda: judge_images((HUMPS + ROUGH) * 5 + WORST_AT_N[2:3] * 3, 129, list(zip(values_of(0.3, 0.2), values_of(0.3, -0.1)))),
     {"gain-for-all": "?", "neighbours-alike": "?", "columns-vary": "?", "cyclic-is-high": "no", "other-problems": "?"}),
    ("images", "two humps for each family, one of them rough", lambda: judge_images([HUMPS[1], ROUGH[3]], 4, [(0.5, 0.1), (0.6, 0.1)] * 12),
     {"gain-for-all": "?", "neighbours-alike": "?", "columns-vary": "yes", "cyclic-is-high": "?", "other-problems": "yes"}),

    ("lattice", "offsets beyond n are worse", lambda: judge_lattice(0.1, 0.02),
     {"beyond-is-worse": "yes"}),
    ("lattice", "offsets beyond n are better, and PEs own two pixels of a block", lambda: judge_lattice(-0.1, 0.02, "no"),
     {"beyond-is-worse": "no"}),
    ("lattice", "offsets beyond n scatter", lambda: judge_lattice(0.01, 0.05),
     {"beyond-is-worse": "?"}),
    ("lattice", "offsets beyond n are as good", lambda: judge_lattice(0.0001, 0.0005),
     {"beyond-is-worse": "flat"}),

    ("table3", "p = 16 is balanced", lambda: judge_table3(values_of(1000, 1000)),
     {"rotations": "yes"}),
    ("table3", "p = 16 is less balanced, and rotations fall with p", lambda: judge_table3(values_of(60_000, 10_000), (2, 18, 36), [1, 0, *range(15)]),
     {"rotations": "no"}),

    ("table4", "an expensive block", lambda: judge_table4(values_of(200_000, 20_000), ratio=1.25, uneven_at_8=400_000),
     {"gain-exceeds-communication": "yes"}),
    ("table4", "a block that costs hardly more, and more rotations", lambda: judge_table4(values_of(200, 20), (2, 18, 36), ratio=1.26),
     {"gain-exceeds-communication": "no"}),
    ("table4", "a block whose gain equals the rotations, and fewer words", lambda: judge_table4(values_of(4200, 3000), words=700, ratio=0.7),
     {"gain-exceeds-communication": "?"}),

    ("table4", "the filter blurs, supersampling is better", lambda: judge_quality(-1, 8, 0.5), {"filter-blurs": "yes", "supersampling-is-better": "yes"}),
    ("table4", "the filter is sharp, supersampling is worse", lambda: judge_quality(1, -1, 1.0), {"filter-blurs": "no", "supersampling-is-better": "no"}),
    ("table4", "both at the bounds", lambda: judge_quality(0, 0, 0.9), {"filter-blurs": "?", "supersampling-is-better": "?"}),

    ("best-offset", "pixels of equal cost", lambda: judge_best_offset([uneven_image([])] * 4, [uneven_image([])] * 4), {"root-is-enough": "yes"}),
    ("best-offset", "offsets up to sqrt(P) are uneven", lambda: judge_best_offset(
        [BAD_UP_TO_ROOT] * 4, [uneven_image(range(17), height) for height in values_of(50_000, 5000, 4)]), {"root-is-enough": "no"}),
    ("best-offset", "offsets up to sqrt(P) are uneven in some pictures",
     lambda: judge_best_offset([BAD_UP_TO_ROOT] * 4, [BAD_UP_TO_ROOT, uneven_image([])] * 2), {"root-is-enough": "?"}),

    ("static-vs-dynamic", "pixels of equal cost", lambda: judge_static_vs_dynamic(EQUAL, count=4),
     {"dynamic-balances": "no"}),
    ("static-vs-dynamic", "a tenth of the pixels costs 20 times as much", lambda: judge_static_vs_dynamic(random_pixels(0.1, 20), count=4),
     {"dynamic-balances": "yes"}),
    ("static-vs-dynamic", "pixels of equal cost and a costly tenth in turn", lambda: judge_static_vs_dynamic(EQUAL, random_pixels(0.1, 20), count=4),
     {"dynamic-balances": "?"}),
    ("static-vs-dynamic", "the last pixel costs much", lambda: judge_static_vs_dynamic(last_pixel_late(), count=4),
     {"dynamic-balances": "no"}),

    ("divisions", "minima at the number of objects", lambda: judge_divisions((4.8, 5.2)),
     {"tests-fewest-at-objects": "yes", "time-falls-then-rises": "yes", "more-objects-gain-more": "yes", "tests-to-a-fifth": "yes",
      "time-to-a-fifth": "yes"}),
    ("divisions", "minimum at four times the number of objects, tests to a ninth, and twice the time", lambda: judge_divisions((8, 10), 4, gain=0.5),
     {"tests-fewest-at-objects": "no", "time-falls-then-rises": "no", "more-objects-gain-more": "no", "tests-to-a-fifth": "no",
      "time-to-a-fifth": "no"}),
    ("divisions", "falls of tests and time vary", lambda: judge_divisions((2, 8)),
     {"tests-fewest-at-objects": "yes", "time-falls-then-rises": "yes", "more-objects-gain-more": "yes", "tests-to-a-fifth": "?",
      "time-to-a-fifth": "?"}),
    ("divisions", "tests and time rise in some layouts and fall in others", lambda: judge_divisions((0.8, 1.25), after=1.1, gain=1),
     {"tests-fewest-at-objects": "?", "time-falls-then-rises": "?", "more-objects-gain-more": "?", "tests-to-a-fifth": "no",
      "time-to-a-fifth": "no"}),

    ("objects", "random objects are slower, and rays end earlier", lambda: judge_objects((1.2, 1.25), (3, 0.8), (4, 0.7)),
     {"random-is-slower": "yes", "not-linear": "yes", "front-voxels": "yes"}),
    ("objects", "random objects are faster, and time is linear", lambda: judge_objects((0.9, 0.92), (1.2, 0.1), (1.15, 0.1)),
     {"random-is-slower": "no", "not-linear": "no", "front-voxels": "no"}),
    ("objects", "figures of random objects are at the bounds of the rules", lambda: judge_objects((0.9, 1.14), (1.25, 0.5), (1.25, 0.5)),
     {"random-is-slower": "?", "not-linear": "?", "front-voxels": "?"}),
    ("objects", "random objects are slower from 512 objects on", lambda: judge_objects((1.2, 1.25), (3, 0.8), (4, 0.7), (0.99, 1.0)),
     {"random-is-slower": "some", "not-linear": "yes", "front-voxels": "yes"}),
    ("objects", "time grows more than the objects, and rays visit more voxels", lambda: judge_objects((1.2, 1.25), (0.8, 1.5), (0.8, 1.5)),
     {"random-is-slower": "yes", "not-linear": "no", "front-voxels": "no"}),
]


@pytest.mark.parametrize("study, make, wanted", [pytest.param(study, make, wanted, id=f"{study}: {what}") for study, what, make, wanted in CASES])
def test_verdicts(study, make, wanted):
    judgements = make()
    decide(judgements, max(1, sum(j.claim.kind == "test" for j in judgements)))
    tested = {j.claim.id: j.verdict for j in judgements if j.claim.kind in ("test", "counted")}
    assert tested == {key: VERDICTS[answer] for key, answer in wanted.items()}, f"seed {SEED}"
    for judgement in judgements:
        claim, test = judgement.claim, judgement.test
        assert claim.study == study and judgement.reason.endswith("."), claim.id
        if claim.kind == "test":
            assert judgement.ensemble and test.interval is not None, claim.id
        elif claim.kind != "counted":
            assert test is None and judgement.verdict == claim.kind, claim.id
        else:
            assert (repr(test), judgement.power) in ((repr(counted(True)), ""), (repr(counted(False)), "")), claim.id  # Python 3.13: NaN != NaN


def test_each_verdict_of_each_claim_has_a_case():
    found = {key: set() for key in CLAIMS}  # without "some" and "flat"
    for study, _, _, wanted in CASES:
        for key, answer in wanted.items():
            found[key] |= {answer} - {"some", "flat"}
    answers = {"test": {"yes", "?", "no"}, "counted": {"yes", "no"}, "derived": set(), "untestable": set()}
    assert found == {key: answers[claim.kind] for key, claim in CLAIMS.items()}


# The file claims.toml.


@pytest.mark.parametrize("key, part", [
    ("speedup-229", f"within {100 * cluster.SPEEDUP_BOUND:g} % of {papers.SPEEDUP_16}"),
    ("neighbours-alike", f"at least {images.ALIKE}"),
    ("like-2d", f"within {1 - speedup.SIMILAR:g} .. {1 + speedup.SIMILAR:g}"),
    ("root-is-enough", f"at most {best_offset.MAX_LOSS} % longer"),
    ("gain-for-all", f"at least {100 * images.SHARE:g} %"),
    ("good-at-8", f"at least {imbalance.GOOD_FRACTION} of the gain"),
    ("proportional", f"at least {speedup.HIGH}."),
    ("near-cap", f"within {100 * speedup.CLOSE:g} % of {papers.CAP_RATIO}"),
    ("near-pixel-machine", f"within {100 * speedup.CLOSE:g} % of {papers.PIXEL_MACHINE_SPEEDUP}"),
    ("columns-vary", {2: "at least twice"}[images.STRONGLY]),
    ("cyclic-is-high", f"In every family {100 * images.SHARE:g} % of the pictures have an efficiency of {images.HIGH} or more"),
    ("supersampling-ratio", f"within {100 * cluster.SUPERSAMPLING_BOUND:g} % of {papers.SUPERSAMPLE_0_MS / papers.SUPERSAMPLE_16_MS:.2f}"),
    ("contours-uneven", f"above {imbalance.UNEVEN}"),
    ("few-processors", f"at least {speedup.HIGH}"),
    ("finer-images", f"at least {speedup.HIGH}"),
    ("filter-blurs", f"below {table4.BLURRED} of"),
    ("best-is-n", f"differs by at most {lattice.EQUAL}"),
    ("beyond-is-worse", f"differs by at most {lattice.EQUAL}"),
    ("random-is-slower", f"above {objects.SLOWER}"),
    ("tests-fewest-at-objects", f"at most {100 * (divisions.DIFFERENCE_RATIO - 1):.0f} %"),
    ("tests-to-a-fifth", f"within {100 * divisions.TOLERANCE:g} %"),
    ("time-to-a-fifth", f"within {100 * divisions.TOLERANCE:g} %"),
    ("not-linear", f"above {objects.LINEAR_LIMIT}"),
    ("front-voxels", {0.5: "more than half"}[objects.HALF])])
def test_bound_of_the_rule_is_that_of_the_study(key, part):
    assert part in CLAIMS[key].rule


@pytest.mark.parametrize("pictures", [images.FINER_VIEWS, 400])
def test_proportion_of_enough_pictures_can_be_reproduced(pictures):
    """A claim on a fraction of the pictures that holds for all pictures is reproduced."""
    decide(judgements := [judged("gain-for-all", proportion([True] * pictures, images.SHARE))])
    assert judgements[0].verdict == REPRODUCED, f"{pictures} pictures: {judgements[0].test}"


# Verdicts on the claims of a document.


def judgements_with(p_values, keys):
    return [judged(key, Result(p, 1 - p)) for key, p in zip(keys, p_values)]


def test_verdicts_do_not_depend_on_other_claims():
    """The level of each test is LEVEL divided by the number of tests in claims.toml."""
    p = 0.05 / TESTS / 2
    for count in (1, 9):
        decide(found := judgements_with([0.99 * p, 1.01 * p, *[0.4] * count], ["hump", "good-at-8", *["speedup-229"] * count]))
        assert [judgement.verdict for judgement in found[:2]] == [REPRODUCED, COMPATIBLE]


def test_controls_qualify_a_reproduced_claim():
    for p, passes, qualified in ((1e-6, "yes", True), (1 - 1e-6, "no", False), (0.3, "undecided", False)):
        judgement = judged("hump", Result(1e-6, 1), controls={"p = 5": Result(p, 1 - p)})
        decide([judgement])
        assert (judgement.passes("p = 5"), judgement.passes("random permutation")) == (passes, "n/a")
        assert bool(judgement.qualification) == qualified


def test_documents_have_verdicts_and_controls(tmp_path):
    pages = [Page({}, claims=judgements_with([0.02], ["speedup-229"])).describe("cluster", "Cluster"),
             Page({}, claims=[*judgements_with([0.4, 0.4], ["hump", "good-at-8"]), judged("rotations", counted(False))]).describe("fig7", "Loads")]
    for page in pages:
        decide(page.claims)
    write_document(tmp_path, pages, {})
    written = pd.read_csv(tmp_path / "claims.csv").set_index("id")
    assert written["verdict"].to_dict() == {
        "speedup-229": COMPATIBLE, "imbalance-16": "derived", "filter-totals": "derived", "supersampling-times": "derived", "hump": COMPATIBLE,
        "good-at-8": COMPATIBLE, "no-hump": "derived", "rotations": NOT_REPRODUCED}
    assert written["random_passes"].isna().all()  # pandas reads "n/a" as no value
    for name in ("index.html", "index.md"):
        text = (tmp_path / name).read_text()
        assert "0 reproduced, 0 plateau, 0 conditional, 3 compatible, 1 not reproduced, 0 untestable, 4 derived" in text, name


# The ensembles of the claims.


class SeenLaboratory(Laboratory):
    """A laboratory that does not render. `seen`: the scenes whose costs a study asked for."""

    def __init__(self, **options):
        super().__init__("", **options)
        self.seen = []

    def costs(self, scene, size, antialias="none"):
        self.seen.append(scene)
        return Costs(scene.name, None, None, 0, 0)


def ensemble_and_scenes(part=0, scenes=(), size=256, views=None, **options):
    lab = SeenLaboratory(**options)
    return lab.ensemble(list(scenes), size, views=views, part=part), lab.seen


@pytest.mark.parametrize("views, family_views", [(None, 12), (18, 2), (27, 3), (28, 4), (1, 2)])
def test_ensemble_has_equally_many_pictures_of_each_family(views, family_views):
    ensemble, scenes = ensemble_and_scenes(views=views)
    assert Counter(ensemble.families) == dict.fromkeys(FAMILIES, family_views)
    assert len(scenes) == len(ensemble.pictures) == len(ensemble.families) and ensemble.description.startswith(f"{len(scenes)} pictures of 9 families, seeds 1..")
    for costs, family in zip(ensemble.pictures, ensemble.families):
        assert costs.label.split(",")[0].split("-")[0] == family.split(",")[0].split("-")[0]


def test_scenes_have_6_to_31_objects():
    """laboratory.py, the documents and the study images state this range."""
    assert all(6 <= scene.objects <= 31 for part in (0, 1, 2) for scene in ensemble_and_scenes(part)[1])


def test_parts_and_seeds_share_no_scene():
    texts = [scene.nff for part in (0, 1, 2) for scene in ensemble_and_scenes(part)[1]]
    assert len(set(texts)) == len(texts)
    assert not set(texts) & {scene.nff for scene in ensemble_and_scenes(seed=1000)[1]}
    assert [scene.nff for scene in ensemble_and_scenes()[1]] == texts[:len(texts) // 3]


def direction_of(scene):
    """Returns the direction from the point that the camera looks at to the camera."""
    eye, at = (np.array(re.search(rf"^{name} (.+)$", scene.nff, re.MULTILINE)[1].split(), float) for name in ("from", "at"))
    return tuple(np.round((eye - at) / np.linalg.norm(eye - at), 4))


def test_pictures_are_independent():
    """Values of scenes with equal views or equal positions of objects would be correlated. Only the scenes of the family `cluster` share a view."""
    ensemble, scenes = ensemble_and_scenes()
    random_views = [scene for scene, family in zip(scenes, ensemble.families) if family != "cluster"]
    views = Counter(map(direction_of, random_views))
    assert max(views.values()) == 1, views.most_common(1)
    spheres = Counter(line.rsplit(" ", 1)[0] for scene, family in zip(scenes, ensemble.families) if family.startswith("random")
                      for line in scene.nff.splitlines() if line.startswith("s "))
    assert max(spheres.values()) == 1, spheres.most_common(1)
