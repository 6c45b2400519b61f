"""The claims of claims.toml: the file, the studies that judge them, and synthetic data for each possible verdict of each claim."""
import ast
import re
from collections import Counter
from pathlib import Path
from types import SimpleNamespace
from unittest.mock import patch

import numpy as np
import pandas as pd
import pytest

raya = pytest.importorskip("raya", reason="the module is not built: -DRAYA_PYTHON=ON")
from raya.lab import claims as claims_module  # noqa: E402
from raya.lab import papers  # noqa: E402
from raya.lab.claims import CLAIMS, Claim, decide, errors_sentence, judged, undecided_claims  # noqa: E402
from raya.lab.document import write_document  # noqa: E402
from raya.lab.families import CROWDED, FAMILIES  # noqa: E402
from raya.lab.laboratory import Costs, Ensemble, Laboratory  # noqa: E402
from raya.lab.page import Page  # noqa: E402
from raya.lab.statistics import COMPATIBLE, NOT_REPRODUCED, REPRODUCED, UNTESTABLE, counted, estimate, proportion  # noqa: E402
from raya.lab.statistics import Test as Result  # noqa: E402
from raya.lab.study import ORDER, studies  # noqa: E402
from raya.lab.studies import (best_offset, cluster, divisions, images, imbalance, loads, objects,  # noqa: E402
                              offsets_beyond, scale, speedup, static_vs_dynamic, table2, table3, table4)

SEED, SIDE, COUNT = 32, 64, 12  # COUNT: pictures of an ensemble, half of them of each of two families
VERDICTS = {"yes": REPRODUCED, "?": COMPATIBLE, "no": NOT_REPRODUCED}
FOLDER = Path(claims_module.__file__).parent


def families(count):
    return ["first" if i < count / 2 else "second" for i in range(count)]


def ensemble_of(traces):
    """An ensemble with these cost images, the same for the first pass and for supersampling."""
    pictures = [Costs(f"picture {i}", image, image, {}, 0) for i, image in enumerate(traces)]
    return Ensemble(pictures, families(len(pictures)), f"{len(pictures)} pictures")


class FakeLaboratory:
    """A laboratory whose ensembles have the given cost images. parts: {part: cost images}, if they differ from `traces`. asked: the ensembles that a
    study asked for."""

    network, seed, views = None, 1, COUNT

    def __init__(self, traces, parts=None):
        self._ensembles, self.asked = {part: ensemble_of(some) for part, some in (parts or {0: traces, 1: traces, 2: traces}).items()}, []

    def size(self, default):
        return self._ensembles[0].pictures[0].trace.shape[1]

    def costs(self, scene, size, antialias="none"):
        return self._ensembles[0].pictures[0]

    def ensemble(self, scenes, size, antialias="none", views=None, families=FAMILIES, part=0):
        assert scenes == [] and antialias in ("none", "supersample")
        self.asked.append((size, antialias, part, families))
        return self._ensembles[part]


def around(mean, spread, count=COUNT):
    """Values whose mean is exactly `mean`, in each family: half of them `spread` below it and half above."""
    return mean + spread * np.resize([-1.0, 1.0], count)


def along(p, slot=5, height=500, side=SIDE):
    """A cost image in which the pixels of one slot of offset p cost more."""
    return 1000 + np.uint64(height) * (raya.owners(side, side, offset=p, pes=side) == slot % side).astype(np.uint64)


def several(make, heights=around(500, 50)):
    """Cost images make(slot, height) of random slots."""
    random = np.random.default_rng(SEED)
    return [make(int(random.integers(SIDE)), int(height)) for height in heights]


def alternating(*kinds, count=COUNT):
    """Pictures of the kinds in turn: whatever differs between the kinds, varies within each family."""
    return [kinds[i % len(kinds)] for i in range(count)]


def noise(count=COUNT):
    random = np.random.default_rng(SEED)
    return [random.integers(500, 1500, (SIDE, SIDE)).astype(np.uint64) for _ in range(count)]


def columns(weights):
    return np.tile(np.asarray(weights).astype(np.uint64), (SIDE, 1))


HUMP = np.exp(-((np.arange(SIDE) + 0.5 - SIDE / 2) / 8.0) ** 2)  # of columns in the middle


# Data for the claims of each study. Each function returns the judgements of the study.


def of_fig8(traces):
    return imbalance.fig8(FakeLaboratory(traces), []).claims


def of_fig13(traces):
    return imbalance.fig13(FakeLaboratory(traces), []).claims


def of_fig7(traces):
    return loads.fig7(FakeLaboratory(traces), []).claims


def humps_along_16(heights):
    """Images whose loads have a hump in the middle with p = 16, and none with p = 0."""
    slots = raya.owners(SIDE, SIDE, offset=16, pes=SIDE)
    return [(1000 + height * HUMP[slots]).astype(np.uint64) for height in heights]


def of_fig9(like_2d=1.0, efficiency=0.9, cap=3.9, on_64=62.0, few=0.9, full=0, spread=0.01, worst=None):
    """fig9 for pictures with these means. efficiency: on each number of PEs, with the block fold; the cyclic fold has 0.1 less; worst: on 77 PEs;
    full: height of a slot of p = 8 in the images with a PE for each column."""
    tables = []
    for one in around(1, spread):
        block = np.full(256, efficiency * one)
        block[76] = (worst or efficiency) * one
        pes = np.arange(1, 257)
        cyclic = pes * (block - 0.1)
        cyclic[63], cyclic[255] = on_64 * one, on_64 * one * cap * one
        table = pd.DataFrame({"p = 16, cyclic fold": cyclic, "p = 16, block fold": pes * block, "p = 0, cyclic fold": pes * few * one})
        tables.append((table, {16: cyclic[255] / (like_2d * one)}))
    lab = FakeLaboratory(several(lambda slot, height: along(8, slot, height), around(full, full / 4)))
    found = speedup.claims_of(lab, tables, ensemble_of([None] * COUNT))
    assert lab.asked == [(side, "none", 0, FAMILIES) for side in (256, 512, 1024)]
    return found


def of_cluster(speed, p0, p16, spread):
    values = {name: around(mean, spread * mean, 30) for name, mean in
              (("speed-up", speed), ("supersampling, p = 0 (ms)", p0), ("supersampling, p = 16 (ms)", p16))}
    return cluster.claims_of(pd.DataFrame(values), "30 matched scenes")


def of_images(kinds, count, windows, finer=None):
    """images, for pictures of these kinds, given as {cost image: number}; windows: (u(0), u(p)) of each window."""
    some = ensemble_of(alternating(*kinds, count=count))
    return images.claims_of(some, finer or some, np.array(windows), SIDE, 8)


def of_lattice(difference, spread, shared="yes", side=SIDE):
    """lattice, where the offsets beyond n have this mean difference of u from p = n; shared: whether p = n shares the blocks."""
    n = round(side**0.5)
    beyond = [p for p in range(n + 1, side) if p != side - n]
    u = 0.2 + np.zeros((COUNT, side))
    u[:, beyond] += around(difference, spread)[:, None]
    rows = pd.DataFrame({"p": range(side), "n x n blocks shared": [shared if p == n else "no" for p in range(side)]})
    return offsets_beyond.claims_of(u, ensemble_of([None] * COUNT), rows, n, beyond)


def of_table2(pes=256):
    with patch.dict(table2.SPA, pes=pes):
        return [table2.claim_of_totals()]


def block_of_16(height, extra=0, offset=16):
    """256 x 16 pixels: 16 neighbouring columns cost more, which p = 16 spreads evenly; `extra` on a slot of this offset."""
    image = np.full((16, 256), 100_000, np.uint64)
    image[:, 120:136] += np.uint64(height)
    return image + np.uint64(extra) * (raya.owners(256, 16, offset=offset, pes=256) == 7).astype(np.uint64)


MATCHED = 188_370  # u(0) = (1 + 1.8837) / (1 + 1.8837 / 16) - 1 = 1.58


def of_table3(extras, rotations=(2, 18, 34), near=range(17)):
    """table3, for scenes with the paper's u(0) and with `extras` on one PE of p = 16, among others with another u(0)."""
    lab = FakeLaboratory([block_of_16(MATCHED, extra) for extra in extras] + [block_of_16(1000)] * COUNT)
    rows = pd.DataFrame({"p": [0, 8, 16], "rotations": rotations})
    found = table3.claims_of(lab, rows, pd.DataFrame({"offset": range(17), "rotations": [2 * (p + 1) for p in near]}))
    assert lab.asked == [(256, "supersample", 1, CROWDED)]
    assert f"{len(extras)} matched scenes" in found[-1].ensemble
    return found


def of_table4(heights, rotations=(2, 18, 34), words=768, ratio=1.0, uneven_at_8=0):
    """table4, for pictures with a block of 16 columns that cost more, and with uneven loads with p = 8. rotations, words: of the filter; ratio:
    comparison over filter."""
    def run(rotations, words):
        return SimpleNamespace(report={"communication": {"rotations": rotations, "rotation_words": words * rotations}}, time=lambda: {"filter": 1.0})

    rows = pd.DataFrame({"p": [0, 8, 16], "rotations": [2, 18, 34], "compare": [ratio, 1, 1]})
    lab = FakeLaboratory([block_of_16(height, uneven_at_8, 8) for height in heights])
    return table4.claims_of(lab, SimpleNamespace(runs={p: run(2 * p + 2, 768) for p in (0, 8, 16)}), rows, [run(r, words) for r in rotations])


def uneven(offsets, height=50_000):
    """256 x 16 pixels on which each of the offsets gives one PE more work than the others, with 256 and with 64 PEs."""
    image = np.full((16, 256), 100_000, np.uint64)
    for p in offsets:
        image += np.uint64(height) * (raya.owners(256, 16, offset=p, pes=64) == 3 * p % 64).astype(np.uint64)
    return image


def of_best_offset(chosen_by, judged_by):
    lab = FakeLaboratory([], {0: chosen_by, 2: judged_by})
    found = [best_offset.claim_of_enough(lab)]
    assert lab.asked == [(256, "supersample", 0, FAMILIES), (256, "supersample", 2, FAMILIES)]
    return found


def of_scale(fixed, root, adapted, spread=0.02):
    """scale, on two arrays, with these efficiencies of the cyclic mappings, divided by that of the 2-D mapping."""
    means = {scale.FIXED: fixed, scale.ROOT: root, scale.ADAPTED: adapted}
    views = [pd.DataFrame({scale.GRID: np.full(3, 0.5), **{name: 0.5 * np.array([9, *some]) * one for name, some in means.items()}})
             for one in around(1, spread)]
    return [scale.claim_of_2d(pd.Series([256, 512, 1024])[1:], views, ensemble_of([None] * COUNT))]


def of_static_vs_dynamic(*kinds, count=COUNT):
    return static_vs_dynamic.claims_of(FakeLaboratory(alternating(*kinds, count=count)))


def random_pixels(share, times, side=128):
    """A share of the pixels costs `times` as much as the others."""
    return np.random.default_rng(SEED).choice(np.array([10**6, times * 10**6], np.uint64), (side, side), p=[1 - share, share])


def last_pixel_late(side=128):
    """p = 16 is balanced on 256 PEs, as the last pixel costs as much as all pixels of another PE; dynamic distribution gives it out last."""
    owners = raya.owners(side, side, offset=16, pes=256)
    image = np.full((side, side), 10**6, np.uint64)
    own = owners == owners[-1, -1]
    image[own] = 1
    image[-1, -1] = 10**6 * own.sum() - (own.sum() - 1)
    return image


def divided(count, best, falls, after=1.1):
    """Rows of a scene of `count` objects. The figures fall to a minimum at `best` divisions, by the factors `falls` for each factor of 32 in the
    divisions, and rise beyond by `after` for each factor of 2."""
    power = np.arange(14)
    before, beyond = np.clip(np.log2(best) - power, 0, None) / 5, np.clip(power - np.log2(best), 0, None)
    names = ("modelled (s)", "measured (ms)", "tests")
    return pd.DataFrame({"scene": f"{count} objects", "objects": count, "divisions": 1 << power, "voxels of an object": 1.5,
                         **{name: fall**before * after**beyond for name, fall in zip(names, falls)}})


def of_divisions(falls, bests=(64, 1024), after=1.1, gain=5.2):
    """divisions. falls: factors by which the tests fall in the layouts, in turn; bests: divisions with the minimum, for 64 and 1024 objects."""
    drawn = iter(np.resize(falls, len(divisions.RADII) * divisions.VIEWS))

    def run(lab, scene, size, voxels):
        assert scene.objects == 1024 and np.prod(voxels) in (papers.FEW_DIVISIONS, papers.MANY_DIVISIONS)
        return SimpleNamespace(tests=1000 * next(drawn) if np.prod(voxels) == papers.FEW_DIVISIONS else 1000)

    with patch.object(divisions, "run_in_one_pe", run):
        return divisions.claims_of(FakeLaboratory([]), 96, [divided(count, best, (gain, 5, 5), after) for count, best in zip((64, 1024), bests)])


def of_objects(ratios, even, random):
    """objects. ratios: random over even times, in turn; even, random: (growth of objects / time, part of its logarithm due to fewer voxels)."""
    def growth(over, share, spread):
        over = over * (1 + spread)
        return pd.DataFrame({"objects": 130.0, "time": 130 / over, "objects / time": over, "fewer voxels a ray": over ** (share + spread)})

    runs, rows = {}, []
    for count in objects.COUNTS:
        times = np.resize(ratios, objects.SEEDS)
        runs[count, objects.EVEN, objects.PAPER] = [SimpleNamespace(asynchronous_ms=40.0)]
        runs[count, objects.RANDOM, objects.PAPER] = [SimpleNamespace(asynchronous_ms=40.0 * ratio) for ratio in times]
        rows.append({"objects": count, "kind": objects.RANDOM, "protocol": objects.PAPER, **dict.fromkeys(objects.TIMES, estimate(times))})
    return objects.claims_of(runs, pd.DataFrame(rows), [(objects.EVEN, objects.PAPER, growth(*even, np.zeros(1))),
                                                        (objects.RANDOM, objects.PAPER, growth(*random, np.array([-2, -1, 0, 1, 2]) / 50))])


# The cases. Words: "yes" reproduced, "no" not reproduced, "?" compatible.

EQUAL = np.full((128, 128), 10**6, np.uint64)  # pixels of equal cost
HUMPS = [columns(1000 + height * HUMP) for height in (500, 1000, 2000, 4000)]
ROUGH = [image + np.random.default_rng(SEED).integers(0, 1300, (SIDE, SIDE)).astype(np.uint64) for image in HUMPS]
WORST_AT_N = [along(8, height=height) for height in (300, 600, 900, 1200)]
BAD_UP_TO_ROOT = uneven(range(17))

CASES = [
    ("fig8", "an expensive column", lambda: of_fig8(several(lambda slot, height: along(0, slot, height))),
     {"cyclic-reduces": "yes", "best-is-n": "no", "good-at-8": "yes"}),
    ("fig8", "p = n is the worst", lambda: of_fig8(several(lambda slot, height: along(8, slot, height))),
     {"cyclic-reduces": "no", "best-is-n": "no", "good-at-8": "no"}),
    ("fig8", "p = n is the best", lambda: of_fig8(several(lambda slot, height: sum(along(p, slot + 5 * p, height) for p in range(8)))),
     {"cyclic-reduces": "yes", "best-is-n": "yes", "good-at-8": "no"}),
    ("fig8", "p = 0 is the best, so no offset has a gain",
     lambda: of_fig8(several(lambda slot, height: sum(along(p, slot + 5 * p, height) for p in range(1, 9)))),
     {"cyclic-reduces": "no", "best-is-n": "no", "good-at-8": "no"}),
    ("fig8", "noise", lambda: of_fig8(noise()), {"cyclic-reduces": "?", "best-is-n": "?", "good-at-8": "no"}),
    ("fig8", "p = n / 2 has 0.95 and 0.86 of the gain in turn", lambda: of_fig8(alternating(along(0), along(0) + along(4, height=50))),
     {"cyclic-reduces": "yes", "best-is-n": "no", "good-at-8": "?"}),
    ("fig8", "a picture of each family", lambda: of_fig8(noise(2)), {"cyclic-reduces": "?", "best-is-n": "?", "good-at-8": "?"}),

    ("fig13", "a column that costs twice as much", lambda: of_fig13(several(lambda slot, height: along(0, slot, height), around(1000, 100))),
     {"contours-uneven": "yes", "supersampling-balances": "yes"}),
    ("fig13", "a column with u(0) = 0.5", lambda: of_fig13(several(lambda slot, height: along(0, slot, height), around(512, 100))),
     {"contours-uneven": "?", "supersampling-balances": "yes"}),
    ("fig13", "p = n is the worst", lambda: of_fig13(several(lambda slot, height: along(8, slot, height))),
     {"contours-uneven": "no", "supersampling-balances": "no"}),
    ("fig13", "noise", lambda: of_fig13(noise()), {"contours-uneven": "no", "supersampling-balances": "?"}),

    ("fig7", "expensive columns in the middle", lambda: of_fig7([columns(1000 + height * HUMP) for height in around(1000, 100)]),
     {"hump": "yes", "no-hump": "yes"}),
    ("fig7", "expensive columns at the sides", lambda: of_fig7([columns(3000 - height * HUMP) for height in around(1000, 100)]),
     {"hump": "no", "no-hump": "yes"}),
    ("fig7", "noise", lambda: of_fig7(noise()), {"hump": "?", "no-hump": "yes"}),
    ("fig7", "a hump with p = 16", lambda: of_fig7(humps_along_16(around(1000, 100))), {"hump": "no", "no-hump": "no"}),
    ("fig7", "a hump of about 0.1 with p = 16", lambda: of_fig7(humps_along_16(around(140, 50))), {"hump": "no", "no-hump": "?"}),

    ("fig9", "efficient", of_fig9,
     {"like-2d": "yes", "proportional": "yes", "near-cap": "yes", "near-pixel-machine": "yes", "few-processors": "yes", "finer-images": "yes"}),
    ("fig9", "not efficient", lambda: of_fig9(0.8, 0.7, 3.0, 50.0, 0.7, 500),
     {"like-2d": "no", "proportional": "no", "near-cap": "no", "near-pixel-machine": "no", "few-processors": "no", "finer-images": "no"}),
    ("fig9", "better than the rules allow", lambda: of_fig9(1.2, 0.9, 4.4, 67.0),
     {"like-2d": "no", "proportional": "yes", "near-cap": "no", "near-pixel-machine": "no", "few-processors": "yes", "finer-images": "yes"}),
    ("fig9", "not efficient on one number of PEs", lambda: of_fig9(worst=0.5),
     {"like-2d": "yes", "proportional": "no", "near-cap": "yes", "near-pixel-machine": "yes", "few-processors": "yes", "finer-images": "yes"}),
    ("fig9", "at the bounds", lambda: of_fig9(0.9, 0.8, 0.9 * papers.CAP_RATIO, 54.0, 0.8, 256, 0.05),
     {"like-2d": "?", "proportional": "?", "near-cap": "?", "near-pixel-machine": "?", "few-processors": "?", "finer-images": "?"}),

    ("cluster", "the paper's figures", lambda: of_cluster(230, 750, 400, 0.01),
     {"speedup-229": "yes", "supersampling-p0": "yes", "supersampling-p16": "yes"}),
    ("cluster", "within the rules, but never the paper's figures", lambda: of_cluster(215, 650, 460, 0.005),
     {"speedup-229": "yes", "supersampling-p0": "yes", "supersampling-p16": "yes"}),
    ("cluster", "too small or too large", lambda: of_cluster(150, 500, 600, 0.01),
     {"speedup-229": "no", "supersampling-p0": "no", "supersampling-p16": "no"}),
    ("cluster", "the paper's figures among very different ones", lambda: of_cluster(229, 739, 407, 0.15),
     {"speedup-229": "?", "supersampling-p0": "?", "supersampling-p16": "?"}),

    ("images", "humps of columns", lambda: of_images(HUMPS, 120, [(0.5, 0.1), (0.6, 0.1)] * 12),
     {"gain-for-all": "yes", "neighbours-alike": "yes", "columns-vary": "yes", "cyclic-is-high": "yes", "other-problems": "yes"}),
    ("images", "the cyclic mapping is worse", lambda: of_images(WORST_AT_N, 120, [(0.1, 0.5), (0.1, 0.6)] * 12),
     {"gain-for-all": "no", "neighbours-alike": "no", "columns-vary": "no", "cyclic-is-high": "no", "other-problems": "no"}),
    ("images", "the cyclic mapping is worse in 3 of 40, and half of the humps are rough",
     lambda: of_images((HUMPS + ROUGH) * 5 + WORST_AT_N[2:3] * 3, 129, list(zip(around(0.3, 0.2), around(0.3, -0.1)))),
     {"gain-for-all": "?", "neighbours-alike": "?", "columns-vary": "?", "cyclic-is-high": "?", "other-problems": "?"}),
    ("images", "few pictures", lambda: of_images(HUMPS, 12, [(0.5, 0.1), (0.6, 0.1)] * 12),
     {"gain-for-all": "?", "neighbours-alike": "yes", "columns-vary": "yes", "cyclic-is-high": "?", "other-problems": "yes"}),
    ("images", "no gain at twice the size", lambda: of_images(HUMPS, 120, [(0.5, 0.1), (0.6, 0.1)] * 12, ensemble_of(WORST_AT_N * 30)),
     {"gain-for-all": "no", "neighbours-alike": "yes", "columns-vary": "yes", "cyclic-is-high": "yes", "other-problems": "yes"}),

    ("lattice", "offsets beyond n are worse", lambda: of_lattice(0.1, 0.02),
     {"blocks-shared": "yes", "beyond-is-worse": "yes"}),
    ("lattice", "offsets beyond n are better, and PEs own two pixels of a block", lambda: of_lattice(-0.1, 0.02, "no"),
     {"blocks-shared": "no", "beyond-is-worse": "no"}),
    ("lattice", "offsets beyond n scatter", lambda: of_lattice(0.01, 0.05),
     {"blocks-shared": "yes", "beyond-is-worse": "?"}),

    ("table2", "256 PEs", of_table2, {"totals-of-table-1": "yes"}),
    ("table2", "128 PEs", lambda: of_table2(128), {"totals-of-table-1": "no"}),

    ("table3", "p = 16 is balanced", lambda: of_table3(around(1000, 1000)),
     {"rotations": "yes", "small-p-communicates-less": "yes", "filter-total": "yes"}),
    ("table3", "p = 16 is less balanced, and rotations fall with p", lambda: of_table3(around(60_000, 10_000), (2, 18, 36), [1, 0, *range(15)]),
     {"rotations": "no", "small-p-communicates-less": "no", "filter-total": "no"}),
    ("table3", "p = 16 halves the total", lambda: of_table3(around(33_000, 8000)),
     {"rotations": "yes", "small-p-communicates-less": "yes", "filter-total": "?"}),

    ("table4", "an expensive block", lambda: of_table4(around(200_000, 20_000), ratio=1.25, uneven_at_8=400_000),
     {"comparison-communicates": "yes", "comparison-like-filter": "yes", "gain-exceeds-communication": "yes"}),
    ("table4", "a block that costs hardly more, and more rotations", lambda: of_table4(around(200, 20), (2, 18, 36), ratio=1.26),
     {"comparison-communicates": "no", "comparison-like-filter": "no", "gain-exceeds-communication": "no"}),
    ("table4", "a block whose gain equals the rotations, and fewer words", lambda: of_table4(around(4200, 3000), words=700, ratio=0.7),
     {"comparison-communicates": "no", "comparison-like-filter": "no", "gain-exceeds-communication": "?"}),

    ("best-offset", "pixels of equal cost", lambda: of_best_offset([uneven([])] * 4, [uneven([])] * 4), {"root-is-enough": "yes"}),
    ("best-offset", "offsets up to sqrt(P) are uneven but for sqrt(P) itself, 8 and 16",
     lambda: of_best_offset([uneven([*range(8), *range(9, 16)])] * 4, [uneven([*range(8), *range(9, 16)])] * 4), {"root-is-enough": "yes"}),
    ("best-offset", "offsets up to sqrt(P) are uneven",
     lambda: of_best_offset([BAD_UP_TO_ROOT] * 4, [uneven(range(17), height) for height in around(50_000, 5000, 4)]), {"root-is-enough": "no"}),
    ("best-offset", "offsets up to sqrt(P) are uneven in some pictures",
     lambda: of_best_offset([BAD_UP_TO_ROOT] * 4, [BAD_UP_TO_ROOT, uneven([])] * 2), {"root-is-enough": "?"}),

    ("scale", "no cyclic mapping keeps up", lambda: of_scale((0.5, 0.6), (0.4, 0.6), (0.1, 0.1)), {"beyond-a-side": "yes"}),
    ("scale", "a cyclic mapping keeps up", lambda: of_scale((0.95, 1.0), (0.5, 0.9), (0.1, 0.9)), {"beyond-a-side": "no"}),
    ("scale", "a cyclic mapping keeps up on one array", lambda: of_scale((0.5, 1.1), (0.85, 0.85), (0.1, 0.1)), {"beyond-a-side": "no"}),
    ("scale", "a cyclic mapping is at the bound on one array", lambda: of_scale((0.9, 0.5), (0.4, 0.5), (0.1, 0.1)), {"beyond-a-side": "?"}),

    ("static-vs-dynamic", "pixels of equal cost", lambda: of_static_vs_dynamic(EQUAL, count=4),
     {"static-inadequate": "no", "hybrid-nearly-optimal": "yes", "dynamic-balances": "no"}),
    ("static-vs-dynamic", "a tenth of the pixels costs 20 times as much", lambda: of_static_vs_dynamic(random_pixels(0.1, 20), count=4),
     {"static-inadequate": "yes", "hybrid-nearly-optimal": "no", "dynamic-balances": "yes"}),
    ("static-vs-dynamic", "the same, one pixel for each of 4096 PEs", lambda: of_static_vs_dynamic(random_pixels(0.1, 20, 64), count=4),
     {"static-inadequate": "no", "hybrid-nearly-optimal": "no", "dynamic-balances": "yes"}),
    ("static-vs-dynamic", "half of the pixels costs twice as much, so hybrids are nearly optimal on few PEs",
     lambda: of_static_vs_dynamic(random_pixels(0.5, 2), count=4),
     {"static-inadequate": "no", "hybrid-nearly-optimal": "no", "dynamic-balances": "yes"}),
    ("static-vs-dynamic", "equal pixels and the second case in turn", lambda: of_static_vs_dynamic(EQUAL, random_pixels(0.1, 20), count=4),
     {"static-inadequate": "?", "hybrid-nearly-optimal": "?", "dynamic-balances": "?"}),
    ("static-vs-dynamic", "the last pixel costs much", lambda: of_static_vs_dynamic(last_pixel_late(), count=4),
     {"static-inadequate": "no", "hybrid-nearly-optimal": "no", "dynamic-balances": "no"}),

    ("divisions", "minima at the number of objects", lambda: of_divisions((4.8, 5.2)),
     {"tests-fewest-at-objects": "yes", "time-falls-then-rises": "yes", "more-objects-gain-more": "yes", "tests-to-a-fifth": "yes"}),
    ("divisions", "minima elsewhere, and tests to a half", lambda: of_divisions((1.8, 2.2), (1024, 64)),
     {"tests-fewest-at-objects": "no", "time-falls-then-rises": "no", "more-objects-gain-more": "no", "tests-to-a-fifth": "no"}),
    ("divisions", "tests to a quarter in the mean", lambda: of_divisions((3.5, 4.5)),
     {"tests-fewest-at-objects": "yes", "time-falls-then-rises": "yes", "more-objects-gain-more": "yes", "tests-to-a-fifth": "?"}),
    ("divisions", "no rise beyond the number of objects, and tests to a ninth", lambda: of_divisions((8, 10), after=1.0),
     {"tests-fewest-at-objects": "yes", "time-falls-then-rises": "no", "more-objects-gain-more": "yes", "tests-to-a-fifth": "no"}),

    ("objects", "random objects are slower, and rays end earlier", lambda: of_objects((1.2, 1.25), (3, 0.8), (4, 0.7)),
     {"random-is-slower": "yes", "not-linear": "yes", "front-voxels": "yes"}),
    ("objects", "random objects are faster, and time is linear", lambda: of_objects((0.9, 0.92), (1.05, 0.2), (1.04, 0.3)),
     {"random-is-slower": "no", "not-linear": "no", "front-voxels": "no"}),
    ("objects", "random objects are at the bounds", lambda: of_objects((0.9, 1.1), (3, 0.8), (1.25, 0.5)),
     {"random-is-slower": "?", "not-linear": "?", "front-voxels": "?"}),
    ("objects", "time grows more than the objects, and rays visit more voxels", lambda: of_objects((1.2, 1.25), (0.8, 1.5), (0.8, 1.5)),
     {"random-is-slower": "yes", "not-linear": "no", "front-voxels": "no"}),
]


@pytest.mark.parametrize("study, make, wanted", [pytest.param(study, make, wanted, id=f"{study}: {what}") for study, what, make, wanted in CASES])
def test_verdicts(study, make, wanted):
    judgements = make()
    decide(judgements)
    assert {one.claim.id: one.verdict for one in judgements} == {key: VERDICTS[word] for key, word in wanted.items()}, f"seed {SEED}"
    for one in judgements:
        assert one.claim.study == study and one.reason.endswith("."), one.claim.id
        if one.claim.kind == "test":
            assert one.ensemble and one.test.interval is not None, one.claim.id
        else:
            assert one.claim.kind == "counted" and (one.test, one.power) in ((counted(True), ""), (counted(False), "")), one.claim.id


def test_each_verdict_of_each_claim_has_a_case():
    found = {key: set() for key in CLAIMS}
    for study, _, _, wanted in CASES:
        for key, word in wanted.items():
            found[key].add(word)
    words = {"test": {"yes", "?", "no"}, "counted": {"yes", "no"}, "derived": set(), "untestable": set()}
    assert found == {key: words[claim.kind] for key, claim in CLAIMS.items()}


def test_every_claim_function_is_called():
    """Each function that judges claims is called above, by itself or through the study."""
    through_study = {"imbalance": ("fig8", "fig13"), "loads": ("fig7",)}
    text = Path(__file__).read_text()
    for module, functions in functions_that_judge().items():
        for function in through_study.get(module, functions):
            assert f"{module}.{function}(" in text, f"{module}.{function}"


# The file claims.toml, and the sources of the studies.


def sources():
    """{name of a study's module: its syntax tree}"""
    return {file.stem: ast.parse(file.read_text()) for file in sorted((FOLDER / "studies").glob("*.py"))}


def calls_of(tree, *names):
    return [node for node in ast.walk(tree) if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in names]


def functions_that_judge():
    """{module: names of its functions that call judged()}"""
    found = {module: [f.name for f in tree.body if isinstance(f, ast.FunctionDef) and calls_of(f, "judged")] for module, tree in sources().items()}
    return {module: functions for module, functions in found.items() if functions}


def ids_judged():
    """[(module, id)] of each judged("id", ...), and of claim("id", ...) where a function `claim` calls judged(key, ...)."""
    found = []
    for module, tree in sources().items():
        helpers = [f for f in ast.walk(tree) if isinstance(f, ast.FunctionDef) and f.name == "claim"]
        within = [call for f in helpers for call in calls_of(f, "judged")]
        for call in calls_of(tree, "judged", *(["claim"] if within else [])):
            assert call in within or isinstance(call.args[0], ast.Constant), f"{module}, line {call.lineno}: judged() without the id of a claim"
            if call not in within:
                found.append((module, call.args[0].value))
    return found


def test_each_claim_is_judged_once_by_the_study_that_it_names():
    """A claim without a verdict is judged by none."""
    names = {}
    for name, study in studies().items():
        names.setdefault(study.run.__module__.split(".")[-1], []).append(name)
    judged_by = ids_judged()
    assert Counter(key for _, key in judged_by) == Counter(key for key, claim in CLAIMS.items() if claim.kind in ("test", "counted"))
    for module, key in judged_by:
        assert CLAIMS[key].study in names[module], f"{key}: judged by {module}"


def test_ids_are_unique():
    ids = re.findall(r"^\[(.+)\]$", (FOLDER / "claims.toml").read_text(), re.MULTILINE)
    assert len(set(ids)) == len(ids) and ids == list(CLAIMS) and all(re.fullmatch(r"[a-z0-9-]+", key) for key in ids)


@pytest.mark.parametrize("claim", CLAIMS.values(), ids=list(CLAIMS))
def test_claim_is_complete(claim):
    assert claim.kind in ("test", "counted", "derived", "untestable")
    assert claim.paper in (papers.SPA, papers.TP, papers.DYNAMIC) and claim.study in ORDER
    assert claim.place and claim.statement.endswith(".") and claim.rule.endswith(".")
    assert claim.original or claim.paper == papers.DYNAMIC  # the other papers are in Japanese


def test_each_paper_has_claims():
    assert set(papers_of := Counter(claim.paper for claim in CLAIMS.values())) == {papers.SPA, papers.TP, papers.DYNAMIC}, papers_of


def test_claims_without_a_verdict_are_on_a_page_with_verdicts():
    """A page shows the derived and untestable claims of its study next to those that it judges."""
    with_verdicts = {claim.study for claim in CLAIMS.values() if claim.kind in ("test", "counted")}
    for claim in CLAIMS.values():
        assert claim.study in with_verdicts, claim.id
    for study in with_verdicts:
        assert [one.claim for one in undecided_claims(study)] == [
            claim for claim in CLAIMS.values() if claim.study == study and claim.kind in ("derived", "untestable")]


@pytest.mark.parametrize("key, part", [
    ("speedup-229", f"within {100 * cluster.SPEEDUP_BOUND:g} % of {papers.SPEEDUP_16}"),
    ("neighbours-alike", f"at least {images.ALIKE}"),
    ("like-2d", f"within {1 - speedup.CLOSE:g} .. {1 + speedup.CLOSE:g}"),
    ("root-is-enough", f"at most {best_offset.MAX_LOSS} % longer"),
    ("gain-for-all", f"at least {100 * images.SHARE:g} %"),
    ("no-hump", f"at most {loads.FLAT_LIMIT} of the mean load"),
    ("good-at-8", f"at least {imbalance.GOOD_FRACTION} of the gain"),
    ("proportional", f"at least {speedup.HIGH},"),
    ("near-cap", f"within {100 * speedup.CLOSE:g} % of {papers.CAP_RATIO}"),
    ("near-pixel-machine", f"within {100 * speedup.CLOSE:g} % of {papers.PIXEL_MACHINE_SPEEDUP}"),
    ("columns-vary", {2: "at least twice"}[images.STRONGLY]),
    ("cyclic-is-high", f"At least {100 * images.SHARE:g} % of the pictures have an efficiency of {images.HIGH} or more"),
    ("filter-total", f"above {table3.TWICE},"),
    ("supersampling-p0", f"within {100 * cluster.SUPERSAMPLING_BOUND:g} % of {papers.SUPERSAMPLE_0_MS} ms"),
    ("supersampling-p16", f"within {100 * cluster.SUPERSAMPLING_BOUND:g} % of {papers.SUPERSAMPLE_16_MS} ms"),
    ("comparison-like-filter", f"within {100 * table4.LIKE_FILTER:g} %"),
    ("contours-uneven", f"above {imbalance.UNEVEN}"),
    ("few-processors", f"at least {speedup.HIGH}"),
    ("finer-images", f"at least {speedup.HIGH}"),
    ("beyond-a-side", f"below {scale.KEEPS_UP}"),
    ("tests-fewest-at-objects", f"at most {100 * (divisions.DIFFERENCE_RATIO - 1):.0f} %"),
    ("tests-to-a-fifth", "{} .. {}".format(*divisions.FIFTH)),
    ("not-linear", f"above {objects.LINEAR_LIMIT}"),
    ("front-voxels", {0.5: "more than half"}[objects.HALF]),
    ("static-inadequate", f"more than {static_vs_dynamic.NEAR_OPTIMAL}"),
    ("static-inadequate", f"from {min(static_vs_dynamic.CLAIM_PES)} on"),
    ("hybrid-nearly-optimal", f"at most {static_vs_dynamic.NEAR_OPTIMAL}"),
    ("hybrid-nearly-optimal", f"from {min(static_vs_dynamic.CLAIM_PES)} on")])
def test_bound_of_the_rule_is_that_of_the_study(key, part):
    assert part in CLAIMS[key].rule


@pytest.mark.parametrize("study, pictures", [("images", images.FINER_VIEWS), ("images", Laboratory("").views)])
def test_proportion_of_the_default_pictures_can_be_reproduced(study, pictures):
    """A claim on a share of the pictures can be reproduced, at least without Holm's correction, if it holds for all pictures."""
    test = proportion([True] * pictures, images.SHARE)
    decide(one := [judged("cyclic-is-high", test)])
    assert one[0].verdict == REPRODUCED, f"{pictures} pictures: {test}"


@pytest.mark.parametrize("kind", ["", "tested", "Test"])
def test_claim_needs_a_known_kind(kind):
    with pytest.raises(ValueError, match=rf"claims.toml, \[it\]: kind '{kind}'; one of test, counted, derived, untestable"):
        Claim("it", papers.SPA, "", "", "", "fig8", kind, "")


def test_claim_needs_a_known_id():
    with pytest.raises(KeyError, match="unknown-claim"):
        judged("unknown-claim", counted(True))


# Verdicts on all claims of a document.


def judgements_with(p_values, keys=None):
    return [judged(key, Result(p, 1 - p)) for key, p in zip(keys or (key for key, claim in CLAIMS.items() if claim.kind == "test"), p_values)]


def test_holms_correction_covers_all_pages():
    page, others = judgements_with([0.02]), judgements_with([0.4] * 9)
    decide(page)
    assert page[0].verdict == REPRODUCED
    decide(page + others)
    assert [one.verdict for one in page + others] == [COMPATIBLE] * 10
    decide(page)
    assert page[0].verdict == REPRODUCED


def test_claims_that_no_study_decides_keep_their_kind_and_change_no_verdict():
    without = [*undecided_claims("cluster"), *undecided_claims("objects")]
    tested = judgements_with([0.02])
    decide(without + tested)
    assert tested[0].verdict == REPRODUCED
    assert Counter(one.verdict for one in without) == Counter(one.claim.kind for one in without) == {"derived": 2, UNTESTABLE: 2}
    assert all(one.test is None and one.power == "" for one in without)


def test_sentence_on_errors_counts_the_statistical_tests():
    some = [*judgements_with([0.02, 0.5, 0.5]), judged("rotations", counted(True)), *undecided_claims("cluster")]
    assert errors_sentence(some).startswith("3 of the claims are decided by statistical tests.") and "at most 5 %" in errors_sentence(some)
    assert errors_sentence(some[3:]) == ""


def test_sentence_on_the_power():
    assert judged("hump", Result(0.5, 0.5, "", 0.0123)).power == "A deviation of 0.012 from the bound would be seen with 80 %."
    assert judged("hump", Result(0.5, 0.5)).power == judged("rotations", counted(True)).power == ""


def test_pages_of_a_document_have_the_verdicts_on_all_claims(tmp_path):
    pages = [Page({}, claims=judgements_with([0.02], ["speedup-229"])).describe("cluster", "Cluster"),
             Page({}, claims=[*judgements_with([0.4, 0.4], ["hump", "no-hump"]), judged("rotations", counted(False))]).describe("fig7", "Loads")]
    write_document(tmp_path, pages, {})
    written = pd.read_csv(tmp_path / "claims.csv").set_index("id")["verdict"]
    assert written.to_dict() == {"speedup-229": COMPATIBLE, "imbalance-16": "derived", "filter-totals": "derived", "hump": COMPATIBLE,
                                 "no-hump": COMPATIBLE, "rotations": NOT_REPRODUCED}
    for name in ("index.html", "index.md"):
        text = (tmp_path / name).read_text()
        assert "0 reproduced, 3 compatible, 1 not reproduced, 0 untestable, 2 derived" in text, name
    assert '"verdict": "compatible"' in (tmp_path / "cluster.json").read_text()


# The ensembles of the claims.


class SeenLaboratory(Laboratory):
    """A laboratory that does not render. `seen`: the scenes whose costs were asked for."""

    def __init__(self, **options):
        super().__init__("", **options)
        self.seen = []

    def costs(self, scene, size, antialias="none"):
        self.seen.append(scene)
        return Costs(scene.name, None, None, {}, 0)


def seen(part=0, scenes=(), size=256, views=None, **options):
    lab = SeenLaboratory(**options)
    return lab.ensemble(list(scenes), size, views=views, part=part), lab.seen


@pytest.mark.parametrize("views, each", [(None, 12), (18, 2), (27, 3), (28, 4), (1, 2)])
def test_ensemble_has_equally_many_pictures_of_each_family(views, each):
    ensemble, scenes = seen(views=views)
    assert Counter(ensemble.families) == dict.fromkeys(FAMILIES, each)
    assert len(scenes) == len(ensemble.pictures) == len(ensemble.families) and ensemble.description.startswith(f"{len(scenes)} pictures: seeds 1..")
    for costs, family in zip(ensemble.pictures, ensemble.families):
        assert costs.label.split(",")[0].split("-")[0] == family.split(",")[0].split("-")[0]


def test_scenes_have_6_to_31_objects():
    """As families.py says, and docs and the study images repeat."""
    assert all(6 <= scene.objects <= 31 for part in (0, 1, 2) for scene in seen(part)[1])


def test_parts_and_seeds_share_no_scene():
    texts = [scene.nff for part in (0, 1, 2) for scene in seen(part)[1]]
    assert len(set(texts)) == len(texts)
    assert not set(texts) & {scene.nff for scene in seen(seed=1000)[1]}
    assert [scene.nff for scene in seen()[1]] == texts[:len(texts) // 3]


def direction_of(scene):
    """Direction from the point that the camera looks at to the camera."""
    eye, at = (np.array(re.search(rf"^{name} (.+)$", scene.nff, re.MULTILINE)[1].split(), float) for name in ("from", "at"))
    return tuple(np.round((eye - at) / np.linalg.norm(eye - at), 4))


def test_pictures_are_independent():
    """Scenes of different families share neither their view nor the places of their objects, or else their values are correlated. The family
    `cluster` has one view, as the paper's scene."""
    ensemble, scenes = seen()
    own = [scene for scene, family in zip(scenes, ensemble.families) if family != "cluster"]
    views = Counter(map(direction_of, own))
    assert max(views.values()) == 1, views.most_common(1)
    spheres = Counter(line.rsplit(" ", 1)[0] for scene, family in zip(scenes, ensemble.families) if family.startswith("random")
                      for line in scene.nff.splitlines() if line.startswith("s "))
    assert max(spheres.values()) == 1, spheres.most_common(1)


def test_ensemble_of_scenes_has_their_views():
    scenes = [raya.example("centre"), raya.example("glass")]
    ensemble, views = seen(scenes=scenes, views=10)
    assert Counter(ensemble.families) == {"centre": 5, "glass": 5} and [scene.objects for scene in views[::5]] == [one.objects for one in scenes]
    assert ensemble.pictures[0].label.startswith("centre, view ") and len({scene.nff for scene in views}) == 10


def test_expensive_scenes_have_fewer_views():
    scene = raya.generate.uniform(1024, (8, 8, 16))
    for size, count in ((64, 20), (256, 8), (1024, 4)):
        assert len(seen(scenes=[scene], size=size, views=20)[0].pictures) == count
