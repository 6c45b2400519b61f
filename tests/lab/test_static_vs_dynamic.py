"""Classes of scenes in the study static-vs-dynamic: from which number of PEs on static distribution is not enough."""
from types import SimpleNamespace

import numpy as np
import pytest

raya = pytest.importorskip("raya", reason="the module is not built; configure with -DRAYA_PYTHON=ON")
from raya.lab.studies import static_vs_dynamic as study  # noqa: E402

SIDE, MEAN, SEED = 128, 10**9, 20261126  # a request costs much less than a pixel
LAST = study.CLASS_PES[-1]
UNDER_90, FASTER = (f"{what}, median" for what in study.CLASS_LIMITS)


@pytest.mark.parametrize("holds, first", [("0000000", np.inf), ("0000001", LAST), ("0000011", LAST // 2), ("1111111", study.CLASS_PES[0]),
                                          ("1101111", study.CLASS_PES[3]), ("1111110", np.inf)])
def test_first_from(holds, first):
    assert study.first_from(study.CLASS_PES, np.array([letter == "1" for letter in holds]), np.inf) == first


def row_of(images):
    ensemble = SimpleNamespace(families=["class"] * len(images), pictures=[SimpleNamespace(trace=image) for image in images])
    return study.class_rows(ensemble).iloc[0]


def test_equal_pixels_need_no_dynamic_distribution():
    row = row_of([np.full((SIDE, SIDE), MEAN, np.uint64)])
    assert (row["pictures"], row[UNDER_90], row[FASTER]) == (1, "never", "never")


def test_a_costly_pixel_limits_every_strategy():
    """A pixel that costs as much as 400 others, more than the mean load of 64 PEs."""
    image = np.full((SIDE, SIDE), MEAN, np.uint64)
    image[17, 5] *= 400
    row = row_of([image] * 3)
    assert (row[UNDER_90], row[FASTER], row[f"{study.CLASS_LIMITS[0]}, 10 % .. 90 %"]) == ("64", "never", "64 .. 64")


def test_uneven_pixels_favour_dynamic_distribution():
    image = np.random.default_rng(SEED).integers(1, 2 * MEAN, (SIDE, SIDE)).astype(np.uint64)
    row = row_of([image])
    assert (row[UNDER_90], row[FASTER]) == ("128", "128"), f"seed {SEED}"
