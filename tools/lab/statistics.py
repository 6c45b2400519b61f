"""Confidence intervals, tests and verdicts, with numpy and scipy.

A claim is tested with a rule that claims.toml states before the result. Values are independent, one for each scene. `families`: the family of
each value. The families are strata: a mean is that of the families' means, and its interval contains the variation within the families only.
"""
from dataclasses import dataclass

import numpy as np
from scipy import stats

VERDICTS = REPRODUCED, COMPATIBLE, NOT_REPRODUCED, UNTESTABLE = "reproduced", "compatible", "not reproduced", "untestable"
LEVEL = 0.05  # probability of one or more wrong verdicts "reproduced" or "not reproduced" in a document, by Holm's correction
POWER = 0.8


@dataclass(frozen=True)
class Estimate:
    """Mean of `count` values, and half width of its confidence interval (nan for a single value)."""

    mean: float
    half: float
    count: int

    low = property(lambda self: self.mean - self.half)
    high = property(lambda self: self.mean + self.half)
    # Ends of the interval; the mean if there is no interval.
    low_or_mean = property(lambda self: self.mean if np.isnan(self.half) else self.low)
    high_or_mean = property(lambda self: self.mean if np.isnan(self.half) else self.high)

    def text(self, digits=3):
        """'0.137 +- 0.007'"""
        mean = f"{self.mean:.{digits}f}"
        return mean if np.isnan(self.half) else f"{mean} +- {self.half:.{digits}f}"


def mean_and_error(values, families=None):
    """(mean, its standard error, degrees of freedom) along the first axis: of independent values, or of strata with equal weights."""
    values = np.asarray(values, float)
    if values.ndim != 1 or not len(values):
        raise ValueError(f"an array of shape {values.shape} is not a list of values")
    names = list(dict.fromkeys(families)) if families is not None else []
    strata = [values[np.asarray(families) == name] for name in names] if len(names) > 1 else [values]
    mean = float(np.mean([one.mean() for one in strata]))
    if min(map(len, strata)) < 2:
        return mean, np.nan, len(values) - len(strata)
    squares = np.array([one.var(ddof=1) / len(one) for one in strata])  # of the errors of the strata's means
    # Degrees of freedom by Welch & Satterthwaite: the variances of the strata differ.
    degrees = squares.sum()**2 / sum(square**2 / (len(one) - 1) for square, one in zip(squares, strata)) if squares.any() else np.inf
    return mean, float(np.sqrt(squares.sum()) / len(strata)), float(degrees)


def estimate(values, families=None, confidence=0.95):
    """Mean and confidence interval by Student's t distribution."""
    mean, error, degrees = mean_and_error(values, families)
    half = np.nan if np.isnan(error) else float(stats.t.ppf((1 + confidence) / 2, degrees) * error)
    return Estimate(mean, half, len(values))


def estimates(columns, families=None):
    """List of `estimate` for each column of an array [value, column]."""
    return [estimate(column, families) for column in np.asarray(columns).T]


@dataclass(frozen=True)
class Test:
    """Result of a test: p value of the data if the claim is false (`p_for`; small: reproduced) and if it is true (`p_against`; small: not
    reproduced), the tested quantity with its interval as text, and the deviation from the rule's bound that the test detects with 80 %."""

    p_for: float
    p_against: float
    interval: str = ""
    detectable: float = np.nan

    # Two-sided p value of the direction that the data show.
    p = property(lambda self: min(1.0, 2 * min(self.p_for, self.p_against)))
    supports = property(lambda self: self.p_for < self.p_against)


def _one_sided(values, bound, families):
    """P value of 'the mean is at most `bound`'; 0.5 without an interval."""
    mean, error, degrees = mean_and_error(values, families)
    if np.isnan(error):
        return 0.5
    return float(mean <= bound) if error == 0 else float(stats.t.sf((mean - bound) / error, degrees))


def _detectable(values, families):
    """Deviation of the mean from a bound that a two-sided test with 5 % detects with probability POWER."""
    _, error, degrees = mean_and_error(values, families)
    return float((stats.t.ppf(1 - LEVEL / 2, max(degrees, 1)) + stats.t.ppf(POWER, max(degrees, 1))) * error)


def above(values, bound=0.0, families=None, digits=3):
    """Tests the claim that the mean is above the bound."""
    p = _one_sided(values, bound, families)
    return Test(p, 1 - p, estimate(values, families).text(digits), _detectable(values, families))


def below(values, bound=0.0, families=None, digits=3):
    """Tests the claim that the mean is below the bound."""
    test = above(values, bound, families, digits)
    return Test(test.p_against, test.p_for, test.interval, test.detectable)


def within(values, low, high, families=None, digits=3):
    """Equivalence test of the claim that the mean lies in low..high: two one-sided tests."""
    values = np.asarray(values, float)
    under, over = (1 - _one_sided(*some, families) for some in ((-values, -low), (values, high)))  # p of 'mean < low' and of 'mean > high'
    return Test(max(under, over), min(1 - under, 1 - over), estimate(values, families).text(digits), _detectable(values, families))


def proportion(holds, bound):
    """Tests the claim that something holds for more than the fraction `bound` of the pictures: exact binomial test of booleans."""
    count, total = int(np.sum(holds)), len(holds)
    interval = stats.binomtest(count, total).proportion_ci(0.95)
    # Smallest deviation below 1 that would be seen: with this share the test rejects `bound` with probability POWER.
    needed = next((k for k in range(total + 1) if stats.binom.sf(k - 1, total, bound) <= LEVEL / 2), total + 1)
    share = next((q for q in np.linspace(bound, 1, 201) if stats.binom.sf(needed - 1, total, q) >= POWER), np.nan)
    return Test(float(stats.binom.sf(count - 1, total, bound)), float(stats.binom.cdf(count, total, bound)),
                f"{interval.low:.3f} .. {interval.high:.3f}", float(share - bound))


def every(tests, interval=""):
    """Tests the claim that all of several claims hold: supported by the weakest test, contradicted by the strongest (Bonferroni)."""
    tests = list(tests)
    against = min(1.0, len(tests) * min(test.p_against for test in tests))
    weakest = max(tests, key=lambda test: test.p_for)
    return Test(weakest.p_for, against, interval or f"weakest: {weakest.interval}", weakest.detectable)


def one_more(figure, values, share, digits=3):
    """Tests a paper's figure for one picture with our independent pictures: the claim is that another picture's value lies within `share` (0..1)
    of the figure. By Student's t distribution for one more value."""
    values = np.asarray(values, float)
    spread, degrees = values.std(ddof=1) * np.sqrt(1 + 1 / len(values)), len(values) - 1
    position = lambda value: float(stats.t.cdf((value - values.mean()) / spread, degrees))
    below_low, above_high = position(figure * (1 - share)), 1 - position(figure * (1 + share))
    half = float(stats.t.ppf(1 - LEVEL / 2, degrees) * spread)
    low, high = values.mean() - half, values.mean() + half
    detectable = float((stats.t.ppf(1 - LEVEL / 2, degrees) + stats.t.ppf(POWER, degrees)) * spread)
    return Test(max(below_low, above_high), min(1 - below_low, 1 - above_high), f"{low:.{digits}f} .. {high:.{digits}f}", detectable)


def counted(holds):
    """Result of a claim that is counted exactly, without a test."""
    return Test(0.0 if holds else 1.0, 1.0 if holds else 0.0)


def verdicts(tests):
    """Verdicts on {key: Test}, with Holm's correction over all of them: the probability that one or more of the verdicts "reproduced" and "not
    reproduced" are wrong is at most LEVEL. S. Holm, Scandinavian Journal of Statistics 6, 1979."""
    result, decided = {}, True
    for done, (key, test) in enumerate(sorted(tests.items(), key=lambda item: item[1].p)):
        decided = decided and test.p <= LEVEL / (len(tests) - done)
        result[key] = COMPATIBLE if not decided else REPRODUCED if test.supports else NOT_REPRODUCED
    return result


def bonferroni_confidence(tests):
    """Confidence of each of `tests` intervals so that all hold together with 95 % (Bonferroni correction)."""
    return 1 - 0.05 / tests


def prediction_interval(values):
    """(low, high): 95 % prediction interval for one more independent value, for any distribution (order statistics)."""
    return tuple(np.quantile(values, [0.025, 0.975], method="weibull"))


def prediction_text(values, digits=3):
    low, high = prediction_interval(values)
    return f"{low:.{digits}f} .. {high:.{digits}f}"


def range_text(values, digits=3):
    return f"{np.min(values):.{digits}f} .. {np.max(values):.{digits}f}"


def tail_where(values, holds):
    """The longest tail of the pandas series `values` in which `holds` (a boolean series) is true for every value."""
    return values[holds[::-1].cummin()[::-1]]


def fitted_exponent(x, y):
    """The exponent e of the fit y = c x^e, by least squares of the logarithms."""
    return float(stats.linregress(np.log(x), np.log(y)).slope)
