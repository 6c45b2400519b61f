"""The laboratory's statistics: worked examples and simulations. Simulations print their seed if they fail."""
import numpy as np
import pytest

pytest.importorskip("raya", reason="the module is not built: -DRAYA_PYTHON=ON")
from raya.lab import statistics as s  # noqa: E402

SEED, DRAWS = 20261124, 2000


def covered(distribution, true_mean, count, confidence=0.95):
    """The fraction of intervals, each computed from `count` values, that contain the true mean."""
    generator = np.random.default_rng(SEED)
    values = distribution(generator, (DRAWS, count))
    estimates = [s.estimate(row, confidence) for row in values]
    return np.mean([e.low <= true_mean <= e.high for e in estimates])


@pytest.mark.parametrize("count", [2, 5, 16, 64])
def test_interval_of_normal_values_contains_the_mean(count):
    part = covered(lambda g, shape: g.normal(7, 3, shape), 7, count)
    assert 0.93 <= part <= 0.97, f"{part} of {DRAWS} intervals, seed {SEED}"


def test_interval_of_64_skewed_values_contains_the_mean():
    part = covered(lambda g, shape: g.gamma(4, 1, shape), 4, 64)
    assert 0.93 <= part <= 0.97, f"{part} of {DRAWS} intervals, seed {SEED}"


@pytest.mark.parametrize("tests", [3, 16])
def test_joint_intervals_contain_all_means(tests):
    generator = np.random.default_rng(SEED)
    values = generator.normal(0, 1, (DRAWS, tests, 20))
    all_hold = [all(abs(e.mean) <= e.half for e in (s.estimate(row, s.bonferroni_confidence(tests)) for row in draw))
                for draw in values]
    assert 0.93 <= np.mean(all_hold) <= 0.97, f"{np.mean(all_hold)} of {DRAWS}, seed {SEED}"


@pytest.mark.parametrize("count", [39, 64, 200])
@pytest.mark.parametrize("name", ["normal", "exponential", "uniform"])
def test_prediction_interval_contains_one_more_value(name, count):
    generator = np.random.default_rng(SEED)
    values = getattr(generator, name)(size=(DRAWS * 4, count + 1))
    bounds = np.quantile(values[:, 1:], [0.025, 0.975], axis=1, method="weibull")
    assert np.allclose(bounds[:, 0], s.prediction_interval(values[0, 1:]))  # the same computation for all rows at once
    part = np.mean((bounds[0] <= values[:, 0]) & (values[:, 0] <= bounds[1]))
    assert 0.93 <= part <= 0.97, f"{part} of {DRAWS * 4}, seed {SEED}"


def test_estimate_of_a_worked_example():
    # Student's t with 4 degrees of freedom at 0.975 is 2.776445 (from tables); the standard deviation of 1..5 is sqrt(2.5).
    e = s.estimate([1, 2, 3, 4, 5])
    assert (e.mean, e.count) == (3, 5)
    assert e.half == pytest.approx(2.776445 * (2.5 / 5) ** 0.5, rel=1e-6)
    assert e.text() == "3.000 +- 1.963"
    assert (e.low, e.high) == (e.mean - e.half, e.mean + e.half)


def test_estimate_of_one_value_has_no_interval():
    e = s.estimate([0.25])
    assert e.mean == 0.25 and np.isnan(e.half) and e.text() == "0.250"
    assert not e.low > 0 and not e.high < 1  # so the interval decides no claim


def test_prediction_of_39_values_is_their_range():
    assert s.prediction_interval(np.arange(39)) == (0, 38)


@pytest.mark.parametrize("seen, contrary, word", [(True, False, s.REPRODUCED), (False, True, s.NOT_REPRODUCED),
                                                  (False, False, s.UNDECIDED), (True, True, s.UNDECIDED)])
def test_verdict(seen, contrary, word):
    assert s.verdict(seen, contrary) == word
    assert s.verdict(np.bool_(seen), np.bool_(contrary)) == word


@pytest.mark.parametrize("paper, count, word", [(20, 39, s.REPRODUCED), (50, 39, s.NOT_REPRODUCED),
                                                (20, 38, s.REPRODUCED), (50, 38, s.UNDECIDED)])
def test_verdict_among_values(paper, count, word):
    assert s.verdict_by_prediction(paper, np.arange(count)) == word


@pytest.mark.parametrize("exponent", [-1, 0, 0.5, 3])
def test_exponent_of_a_power(exponent):
    x = np.array([1, 2, 5, 10, 100])
    assert s.fitted_exponent(x, 7 * x**float(exponent)) == pytest.approx(exponent, abs=1e-12)
