"""The study offsets: the loads' variance is that of the cost image's spectrum at the points of the dual lattice."""
import numpy as np
import pytest

raya = pytest.importorskip("raya", reason="the module is not built; configure with -DRAYA_PYTHON=ON")
from raya.lab.studies import offsets as study  # noqa: E402

SIZE, SEED = 32, 20261126


def power_at(cost, fx, fy):
    """Returns |Fourier transform of the cost image|^2 at a point in cycles per pixel."""
    y, x = np.mgrid[:len(cost), :len(cost)]
    return abs((cost * np.exp(-2j * np.pi * (x * fx + y * fy))).sum()) ** 2


@pytest.mark.parametrize("pes", [4, 16, 32, 64, 128])
def test_variance_of_loads(pes):
    random = np.random.default_rng(SEED)
    for offset in random.integers(SIZE, size=4).tolist():
        cost = random.integers(1, 10_000, (SIZE, SIZE)).astype(np.uint64)
        loads = raya.loads(cost, pes=pes, offset=offset)
        spectrum = sum(power_at(cost.astype(float), *point) for point in zip(*study.dual_points(pes, offset, SIZE)))
        assert np.var(loads) == pytest.approx(spectrum / pes**2, rel=1e-9), f"offset {offset}, seed {SEED}"


@pytest.mark.parametrize("pes", [16, 32, 128])
def test_rings_are_interpolated(pes):
    spectrum = study.ring_spectrum(np.random.default_rng(SEED).random((SIZE, SIZE)))
    offsets = range(min(pes, SIZE))
    nearest_zero = [[(part + 0.5) % 1 - 0.5 for part in study.dual_points(pes, p, SIZE)] for p in offsets]
    sums = [np.interp(SIZE * np.hypot(*points), np.arange(len(spectrum)), spectrum).sum() for points in nearest_zero]
    predicted = study.predicted_u(spectrum[None], pes, offsets, SIZE)[0]
    assert predicted == pytest.approx(study.expected_maximum(pes) * np.sqrt(sums), abs=1e-11), f"seed {SEED}"
    assert predicted[1:].tolist() == predicted[:0:-1].tolist()  # p and its mirror image


def test_prediction_of_a_picture_with_equal_rings():
    """For a picture of independent pixels the spectrum is flat, so the prediction is that of a random mapping."""
    cost = np.random.default_rng(SEED).integers(0, 1000, (64, 64)).astype(np.uint64)
    spectrum = study.ring_spectrum(cost.astype(float))
    pes = 64
    u = np.mean([study.random_u(cost, pes, seed) for seed in range(200)])
    assert study.predicted_u(spectrum[None], pes, [8], 64)[0, 0] == pytest.approx(u, rel=0.1), f"seed {SEED}"


def test_an_edge_costs_most_along_its_direction():
    """A vertical bar is uneven for the column split, and hardly for an offset."""
    cost = np.full((64, 64), 100, np.uint64)
    cost[:, :20] = 1000
    spectrum = study.ring_spectrum(cost.astype(float))
    with_offset_0, with_offset_8 = study.predicted_u(spectrum[None], 64, [0, 8], 64)[0]
    assert with_offset_0 > 2 * with_offset_8
