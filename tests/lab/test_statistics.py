"""The laboratory's statistics: worked examples and simulations. Simulations print their seed if they fail."""
import os

import numpy as np
import pytest
from scipy import stats

pytest.importorskip("raya", reason="the module is not built; configure with -DRAYA_PYTHON=ON")
from raya.lab import statistics as s  # noqa: E402

SEED, DRAWS = 20261124, 2000 if os.environ.get("RAYA_THOROUGH") == "1" else 500
SIDE, POWER = 0.025, 0.8  # SIDE: maximum probability of a wrong verdict on one side; POWER: at the detectable deviation
# Standard deviations of u(0) in the nine families of laboratory.py, 64 x 64 pixels, 300 seeds.
FAMILY_DEVIATIONS = [0.55, 0.72, 0.60, 0.11, 0.62, 0.07, 0.20, 0.16, 0.16]
ONE_DOMINATES = [1] + 8 * [0.01]


def random():
    return np.random.default_rng(SEED)


def error_of(probability, draws):
    """Returns three standard deviations of a simulated probability."""
    return 3 * (probability * (1 - probability) / draws) ** 0.5


def assert_at_most(fraction, bound, draws=DRAWS):
    assert fraction <= bound + error_of(bound, draws), f"fraction {fraction} of {draws} draws instead of at most {bound}, seed {SEED}"


def assert_about(fraction, wanted, draws=DRAWS):
    assert abs(fraction - wanted) <= error_of(wanted, draws), f"fraction {fraction} of {draws} draws instead of {wanted}, seed {SEED}"


def assert_covers(fraction, draws=DRAWS):
    """For intervals that are 95 % intervals only approximately: within 2 % with 2,000 draws, and as wide as the error with fewer."""
    assert abs(fraction - 0.95) <= 0.02 * (2000 / min(draws, 2000)) ** 0.5, f"{fraction} of {draws} intervals, seed {SEED}"


def reproduced(test):
    return test.verdict() == s.REPRODUCED


def contradicted(test):
    return test.verdict() == s.NOT_REPRODUCED


def fractions(tests):
    """Returns the fraction of the tests that are reproduced, and the fraction that are contradicted."""
    tests = list(tests)
    return np.mean([reproduced(test) for test in tests]), np.mean([contradicted(test) for test in tests])


# Intervals


def coverage(distribution, true_mean, count, confidence=0.95):
    """Returns the fraction of intervals, each computed from `count` values, that contain the true mean."""
    estimates = [s.estimate(row, None, confidence) for row in distribution(random(), (DRAWS, count))]
    return np.mean([e.low <= true_mean <= e.high for e in estimates])


@pytest.mark.parametrize("count", [2, 5, 16, 64])
def test_interval_of_normal_values_contains_the_mean(count):
    fraction = coverage(lambda g, shape: g.normal(7, 3, shape), 7, count)
    assert_covers(fraction)


def stratified_coverage(deviations, count, draw):
    """Returns the fraction of intervals of families, with `count` values per family, that contain the mean of the families' means. draw:
    function(generator, shape) with mean 0 and deviation 1. The families' means are 0, 1, ..., so an interval that ignores families is too long."""
    generator, families = random(), [name for name in range(len(deviations)) for _ in range(count)]
    scale, shift = np.repeat(deviations, count), np.array(families)
    estimates = [s.estimate(shift + scale * draw(generator, len(families)), families) for _ in range(DRAWS)]
    return np.mean([e.low <= np.mean(range(len(deviations))) <= e.high for e in estimates])


def normal(generator, shape):
    return generator.normal(size=shape)


def skewed(generator, shape):
    return generator.gamma(4, 1, shape) / 2 - 2


@pytest.mark.parametrize("draw", [normal, skewed])
def test_interval_of_families_contains_the_mean_of_their_means(draw):
    fraction = stratified_coverage([1] * 9, 12, draw)
    assert_covers(fraction)


@pytest.mark.parametrize("deviations, count", [(FAMILY_DEVIATIONS, 12), (FAMILY_DEVIATIONS, 2), (ONE_DOMINATES, 12), (ONE_DOMINATES, 4)])
def test_interval_of_families_with_unequal_variances_is_not_too_short(deviations, count):
    """A family that dominates the variance also dominates the degrees of freedom."""
    assert_at_most(1 - stratified_coverage(deviations, count, normal), 0.05)


@pytest.mark.parametrize("test", [lambda v, f: s.above(v, 0, f), lambda v, f: s.below(v, 0, f), lambda v, f: s.within(v, 5, 6, f)])
def test_values_without_an_interval_are_compatible(test):
    for values, families in (([1e9], None), ([1, 2, 3], list("aab"))):
        assert test(values, families).verdict() == s.COMPATIBLE


@pytest.mark.parametrize("tests", [3, 16])
def test_joint_intervals_contain_all_means(tests):
    draws, confidence = 8_000 // tests, s.bonferroni_confidence(tests)
    values = random().normal(0, 1, (draws, tests, 20))
    all_hold = [all(abs(e.mean) <= e.half for e in (s.estimate(row, None, confidence) for row in draw)) for draw in values]
    assert_about(np.mean(all_hold), 0.95, draws)


@pytest.mark.parametrize("count", [39, 64, 200])
@pytest.mark.parametrize("name", ["normal", "exponential", "uniform"])
def test_prediction_interval_contains_one_more_value(name, count):
    values = getattr(random(), name)(size=(DRAWS * 4, count + 1))
    bounds = np.quantile(values[:, 1:], [0.025, 0.975], axis=1, method="weibull")
    assert np.allclose(bounds[:, 0], s.prediction_interval(values[0, 1:]))  # `bounds`: the same computation for all rows at once
    fraction = np.mean((bounds[0] <= values[:, 0]) & (values[:, 0] <= bounds[1]))
    assert_covers(fraction, DRAWS * 4)


def test_estimate_of_a_worked_example():
    # Student's t with 4 degrees of freedom at 0.975 is 2.776445 (from tables); the standard deviation of 1..5 is sqrt(2.5).
    e = s.estimate([1, 2, 3, 4, 5])
    assert (e.mean, e.count) == (3, 5)
    assert e.half == pytest.approx(2.776445 * (2.5 / 5) ** 0.5, rel=1e-6)
    assert e.text() == "3.000 +- 1.963"
    assert (e.low, e.high) == (e.mean - e.half, e.mean + e.half)


# Tests whose true value is the bound of the rule: the probability of a wrong verdict is at most 2.5 % on each side.


@pytest.mark.parametrize("family_count, count", [(None, 5), (9, 108)])
def test_above_and_below_at_their_bound(family_count, count):
    names = family_count and [i % family_count for i in range(count)]
    values = 7 + random().normal(0, 3, (DRAWS, count))
    tests = [s.above(row, 7, names) for row in values]
    for fraction in fractions(tests):
        assert_about(fraction, SIDE)  # the test is exact for normal values
    assert_about(np.mean([test.p_for <= 0.5 for test in tests]), 0.5)
    assert_about(np.mean([test.p <= s.LEVEL / 20 for test in tests]), s.LEVEL / 20)  # the first bound of Holm's correction for 20 tests
    for row, test in zip(values[:20], tests):
        below = s.below(row, 7, names)
        assert (below.p_for, below.p_against, below.interval, below.detectable) == (test.p_against, test.p_for, test.interval, test.detectable)


@pytest.mark.parametrize("mean, first_wrong", [(1, 0), (2, 0), (1.5, 1)])
def test_within_at_its_bounds(mean, first_wrong):
    """first_wrong: index in fractions() of the first wrong verdict. At a bound both verdicts are wrong, between the bounds only "not reproduced"."""
    draws = DRAWS // 2
    found = fractions(s.within(row, 1, 2) for row in random().normal(mean, 1, (draws, 40)))
    for fraction in found[first_wrong:]:
        assert_at_most(fraction, SIDE, draws)
    if not first_wrong:
        assert min(found) > SIDE / 2, f"{found}, seed {SEED}"


def test_within_bounds_narrower_than_the_interval_is_never_reproduced():
    draws = DRAWS // 2
    right, wrong = fractions(s.within(row, -0.01, 0.01) for row in random().normal(0, 1, (draws, 40)))
    assert right == 0
    assert_at_most(wrong, 2 * SIDE, draws)


@pytest.mark.parametrize("value, above, below", [(1, False, True), (1.5, True, False), (0.5, False, True)])
def test_equal_values_decide_although_their_error_is_0(value, above, below):
    assert reproduced(s.above([value] * 3, 1)) == above and contradicted(s.above([value] * 3, 1)) != above
    assert reproduced(s.below([value] * 3, 1)) == below and contradicted(s.below([value] * 3, 1)) != below


@pytest.mark.parametrize("count", [2, 20])
def test_every_claim_must_hold(count):
    """If one claim is at its bound and the others hold clearly, "reproduced" is wrong. If all claims are at their bounds, "not reproduced" is wrong
    too."""
    generator = random()
    at_bound = [s.above(row) for row in generator.normal(0, 1, (DRAWS, 20))]
    clear = [s.Test(1e-9, 1 - 1e-9)] * (count - 1)
    assert_about(fractions(s.every([*clear, one]) for one in at_bound)[0], SIDE)
    uniform = generator.uniform(size=(DRAWS, count))
    at_bounds = [s.every(s.Test(p, 1 - p) for p in row) for row in uniform]
    assert_at_most(fractions(at_bounds)[0], SIDE)
    assert_at_most(fractions(at_bounds)[1], SIDE)
    assert fractions(at_bounds)[1] > SIDE / 2, f"seed {SEED}"


@pytest.mark.parametrize("total, bound", [(108, 0.95), (20, 0.5)])
def test_proportion_at_its_bound(total, bound):
    """If the true proportion is the bound, counts that decide have a probability of at most 2.5 % on each side. The test computes it exactly."""
    likely = [count for count in range(total + 1) if stats.binom.pmf(count, total, bound) > 1e-9]
    found = {count: s.proportion([True] * count + [False] * (total - count), bound) for count in likely}
    for decides in (reproduced, contradicted):
        counts = [count for count, test in found.items() if decides(test)]
        assert 0 < stats.binom.pmf(counts, total, bound).sum() <= SIDE
    fewest = min(count for count, test in found.items() if reproduced(test))
    proportion = bound + found[fewest].detectable  # from this proportion on, the count is at least `fewest` with a probability of 80 %
    assert stats.binom.sf(fewest - 1, total, proportion) >= POWER > stats.binom.sf(fewest - 1, total, proportion - (1 - bound) / 100)


def test_proportion_of_too_few_pictures_has_no_detectable_deviation():
    test = s.proportion([True] * 10, 0.95)
    assert np.isnan(test.detectable) and not reproduced(test)


@pytest.mark.parametrize("count, centre", [(5, 110), (40, 90), (40, 94), (40, 114)])
def test_another_picture_at_the_bounds(count, centre):
    """The verdict "reproduced" is wrong if the next picture lies outside 100 +- 10 %; "not reproduced" is wrong if it lies within."""
    draws = DRAWS // 2
    values = random().normal(centre, 3, (draws, count + 1))
    tests = [s.next_value_within(100, row[1:], 0.1) for row in values]
    inside = (90 <= values[:, 0]) & (values[:, 0] <= 110)
    assert_at_most(np.mean(~inside & [reproduced(test) for test in tests]), SIDE, draws)
    assert_at_most(np.mean(inside & [contradicted(test) for test in tests]), SIDE, draws)


# The power at the detectable deviation


def standardised(count, families=None):
    """Values with mean 0 and standard deviation 1 in each family."""
    values = random().normal(size=count)
    for name in dict.fromkeys(families or [0]):
        in_family = np.array(families or [0] * count) == name
        values[in_family] = (values[in_family] - values[in_family].mean()) / values[in_family].std(ddof=1)
    return values


def assert_power(fraction, draws=DRAWS):
    """Allows an error of 0.01, because the detectable deviation is approximated with two quantiles of Student's t distribution."""
    assert abs(fraction - POWER) <= 0.01 + error_of(POWER, draws), f"power {fraction} in {draws} draws instead of {POWER}, seed {SEED}"


@pytest.mark.parametrize("family_count, count", [(None, 12), (9, 108)])
def test_power_of_above_and_within(family_count, count):
    names, draws = family_count and [i % family_count for i in range(count)], DRAWS // 2
    d = s.above(standardised(count, names), 0, names).detectable
    assert s.within(standardised(count, names), -1, 1, names).detectable == d
    values = random().normal(size=(draws, count))
    assert_power(fractions(s.above(row, -d, names) for row in values)[0], draws)
    if not family_count:
        assert_power(fractions(s.within(row, d, 9) for row in values)[1], draws)
        assert_power(fractions(s.within(row, -9, d) for row in values)[0], draws)


def test_power_of_another_picture():
    """The figure is one more value, shifted by the detectable deviation."""
    d = s.next_value_within(100, 100 + standardised(40), 1e-6).detectable
    values = random().normal(100, 1, (DRAWS, 41))
    assert_power(np.mean([contradicted(s.next_value_within(row[0] + d, row[1:], 1e-6)) for row in values]))


# Verdicts


def test_verdict_is_the_alternative_with_the_smallest_p():
    assert s.Test(0.01, 0.99).verdict(0.05) == s.REPRODUCED and s.Test(0.01, 0.99).verdict(0.01) == s.COMPATIBLE
    assert s.Test(0.9, 0.02).verdict(0.05) == s.NOT_REPRODUCED
    assert s.Test(0.4, 0.6, p_plateau=0.001).verdict(0.05) == s.PLATEAU
    assert s.Test(0.02, 0.98, p_plateau=0.9).p == pytest.approx(0.06)  # three possible verdicts


@pytest.mark.parametrize("ps, verdict", [((0.001, 0.001), "REPRODUCED"), ((0.001, 0.999), "CONDITIONAL"), ((0.001, 0.5), "COMPATIBLE"),
                                         ((0.999, 0.999), "NOT_REPRODUCED"), ((0.999, 0.5), "NOT_REPRODUCED"), ((0.02, 0.02), "COMPATIBLE")])
def test_claim_under_two_conditions(ps, verdict):
    """Each condition is tested at half the level, 0.025; 0.02 is one-sided."""
    assert s.under({str(i): s.Test(p, 1 - p) for i, p in enumerate(ps)}).verdict(0.05) == getattr(s, verdict)


@pytest.mark.parametrize("difference, error", [(0.0, False), (s.LEVEL, True)])
def test_plateau_is_rarely_wrong(difference, error):
    """An alternative whose mean is at the margin is no plateau; one with the mean of the optimum is. error: a verdict PLATEAU is wrong."""
    draws, generator, found = 300, random(), 0
    for _ in range(draws):
        differences = np.stack([generator.normal(difference, 0.05, 100), generator.normal(0.5, 0.05, 100)], axis=1)
        found += s.lowest(differences, s.LEVEL).verdict() == s.PLATEAU
    if error:
        assert_at_most(found / draws, s.LEVEL, draws)
    else:
        assert found / draws > 0.9, f"seed {SEED}"


@pytest.mark.parametrize("count", [5, 45])
def test_quantile_above_at_its_bound(count):
    """Nine in ten normal values exceed mean - 1.2816 deviations: at this bound a verdict is wrong in at most LEVEL of the draws."""
    draws, generator, wrong = 1000, random(), 0
    for _ in range(draws):
        wrong += s.quantile_above(generator.normal(3, 1, count), 3 - 1.2815515655, 0.9).verdict() != s.COMPATIBLE
    assert_at_most(wrong / draws, s.LEVEL, draws)
    assert s.quantile_above(generator.normal(3, 0.1, count), 1, 0.9).verdict() == s.REPRODUCED
    assert s.quantile_above(generator.normal(3, 0.1, count), 4, 0.9).verdict() == s.NOT_REPRODUCED
    assert s.quantile_above([2.0] * count, 1, 0.9).verdict() == s.REPRODUCED
