"""Confidence intervals, tests and verdicts, with numpy and scipy.

claims.toml states the rule of each test, and whether it was changed after a result. Values are independent, one for each picture. `families`: the family of
each value. The families are strata: a mean is the mean of the families' means, and its interval contains only the variation within families.
"""
from dataclasses import dataclass, replace

import numpy as np
from scipy import special, stats

REPRODUCED, PLATEAU, CONDITIONAL, COMPATIBLE, NOT_REPRODUCED, UNTESTABLE = VERDICTS = (
    "reproduced", "plateau", "conditional", "compatible", "not reproduced", "untestable")
LEVEL = 0.05  # probability of one or more wrong verdicts on all claims of claims.toml, by Bonferroni's correction
POWER = 0.8  # probability with which a test detects its detectable deviation


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
        """Returns, for example, '0.137 +- 0.007'."""
        mean = f"{self.mean:.{digits}f}"
        return mean if np.isnan(self.half) else f"{mean} +- {self.half:.{digits}f}"


def mean_and_error(values, families=None):
    """Returns (mean, standard error of the mean, degrees of freedom) of independent values; with families, of strata with equal weights."""
    values = np.asarray(values, float)
    if values.ndim != 1 or not len(values):
        raise ValueError(f"an array of shape {values.shape} is not a list of values")
    names = list(dict.fromkeys(families)) if families is not None else []
    strata = [values[np.asarray(families) == name] for name in names] if len(names) > 1 else [values]
    mean = float(np.mean([stratum.mean() for stratum in strata]))
    if min(map(len, strata)) < 2:
        return mean, np.nan, len(values) - len(strata)
    squared_errors = np.array([stratum.var(ddof=1) / len(stratum) for stratum in strata])  # squared standard errors of the strata's means
    fourths = sum(square**2 / (len(stratum) - 1) for square, stratum in zip(squared_errors, strata))
    degrees = squared_errors.sum()**2 / fourths if squared_errors.any() else np.inf  # Welch & Satterthwaite: the variances of the strata differ
    return mean, float(np.sqrt(squared_errors.sum()) / len(strata)), float(degrees)


def estimate(values, families=None, confidence=0.95):
    """Returns mean and confidence interval by Student's t distribution."""
    mean, error, degrees = mean_and_error(values, families)
    half = np.nan if np.isnan(error) else float(special.stdtrit(degrees, (1 + confidence) / 2) * error)
    return Estimate(mean, half, len(values))


def estimates(columns, families=None):
    """Returns (list of means, list of half widths) of the estimates of each column of an array [value, column]."""
    return tuple(map(list, zip(*((e.mean, e.half) for e in (estimate(column, families) for column in np.asarray(columns).T)))))


@dataclass(frozen=True)
class Test:
    """Result of a test. p_for: p value of the data if the claim is false; small if the claim is reproduced. p_against: p value if the claim is
    true. interval: the tested quantity as text. detectable: deviation from the rule's bound that the test detects with probability POWER. p_plateau:
    p value if no alternative equals the claimed optimum; 1 for a claim of no optimum. cases: {condition: Test} of a claim that has a verdict under each
    condition."""

    p_for: float
    p_against: float
    interval: str = ""
    detectable: float = np.nan
    p_plateau: float = 1.0
    cases: dict = None

    @property
    def p(self):
        """p value, corrected for the number of verdicts that the test can have."""
        return min(1.0, (2 if self.p_plateau == 1 else 3) * min(self.p_for, self.p_against, self.p_plateau))

    def case_verdicts(self, level=LEVEL):
        """Returns {condition: verdict}."""
        return {name: case.verdict(level / len(self.cases)) for name, case in (self.cases or {}).items()}

    def verdict(self, level=LEVEL):
        """Returns the verdict. A claim under several conditions is CONDITIONAL if it is reproduced under some and not under others."""
        if self.cases:
            found = set(self.case_verdicts(level).values())
            if found >= {REPRODUCED, NOT_REPRODUCED}:
                return CONDITIONAL
            return found.pop() if len(found) == 1 else NOT_REPRODUCED if NOT_REPRODUCED in found else COMPATIBLE
        return COMPATIBLE if self.p > level else min(
            (self.p_for, REPRODUCED), (self.p_against, NOT_REPRODUCED), (self.p_plateau, PLATEAU))[1]


def _one_sided(values, bound, families):
    """Returns the p value of the hypothesis that the mean is at most `bound`; 0.5 if the values have no interval."""
    mean, error, degrees = mean_and_error(values, families)
    if np.isnan(error):
        return 0.5
    return float(mean <= bound) if error == 0 else float(special.stdtr(degrees, (bound - mean) / error))


def _detectable(values, families):
    """Returns the deviation of the mean from a bound that a two-sided test with level LEVEL detects with probability POWER."""
    _, error, degrees = mean_and_error(values, families)
    return float((special.stdtrit(max(degrees, 1), 1 - LEVEL / 2) + special.stdtrit(max(degrees, 1), POWER)) * error)


def above(values, bound=0.0, families=None, digits=3):
    """Tests the claim that the mean is above the bound."""
    p = _one_sided(values, bound, families)
    return Test(p, 1 - p, estimate(values, families).text(digits), _detectable(values, families))


def below(values, bound=0.0, families=None, digits=3):
    """Tests the claim that the mean is below the bound."""
    test = above(values, bound, families, digits)
    return Test(test.p_against, test.p_for, test.interval, test.detectable)


def within(values, low, high, families=None, digits=3):
    """Tests the claim that the mean lies in low..high: equivalence test by two one-sided tests."""
    values = np.asarray(values, float)
    under, over = (1 - _one_sided(*case, families) for case in ((-values, -low), (values, high)))  # p values: mean < low, mean > high
    return Test(max(under, over), min(1 - under, 1 - over), estimate(values, families).text(digits), _detectable(values, families))


def proportion(holds, bound):
    """Tests the claim that `holds`, a boolean for each picture, is true for more than the fraction `bound` of all pictures: exact binomial test."""
    count, total = int(np.sum(holds)), len(holds)
    interval = stats.binomtest(count, total).proportion_ci(0.95)
    # The smallest true fraction for which the test supports the claim with probability POWER.
    needed_count = next((k for k in range(total + 1) if stats.binom.sf(k - 1, total, bound) <= LEVEL / 2), total + 1)
    detectable_fraction = next((q for q in np.linspace(bound, 1, 201) if stats.binom.sf(needed_count - 1, total, q) >= POWER), np.nan)
    return Test(float(stats.binom.sf(count - 1, total, bound)), float(stats.binom.cdf(count, total, bound)),
                f"{interval.low:.3f} .. {interval.high:.3f}", float(detectable_fraction - bound))


def every(tests):
    """Tests that several claims all hold. p_for: the largest p_for. p_against: the smallest p_against, with Bonferroni's correction."""
    tests = list(tests)
    against = min(1.0, len(tests) * min(test.p_against for test in tests))
    weakest = max(tests, key=lambda test: test.p_for)
    return Test(weakest.p_for, against, f"weakest: {weakest.interval}", weakest.detectable)


def lowest(differences, margin, families=None):
    """Tests the claim that every alternative has a higher mean than the claimed optimum. A plateau: one or more of them are equivalent, their means
    differ from the optimum's by at most `margin`. differences: [picture, alternative], alternative - optimum."""
    columns = np.asarray(differences, float).T
    equal = min(within(column, -margin, margin, families).p_for for column in columns)
    return replace(every(above(column, 0, families) for column in columns), p_plateau=min(1.0, len(columns) * equal))


def under(cases):
    """Tests a claim under each of several conditions, {condition: Test}."""
    return replace(every(cases.values()), cases=cases, interval="; ".join(f"{name}: {test.interval}" for name, test in cases.items()))


def quantile_above(values, bound, share):
    """Tests the claim that the fraction `share` of all pictures is above the bound: one-sided tolerance limit of normal values."""
    count, mean, error = len(values), np.mean(values), np.std(values, ddof=1) / np.sqrt(len(values))
    if error == 0:
        return counted(mean > bound)
    distance, centre = (mean - bound) / error, stats.norm.ppf(share) * np.sqrt(count)
    with np.errstate(invalid="ignore"):
        p = float(stats.nct.sf(distance, count - 1, centre))
    p = float(distance < centre) if np.isnan(p) else p  # far out scipy has no value
    return Test(p, 1 - p, f"{mean:.3f}, deviation {error * np.sqrt(count):.3f}")


def next_value_within(figure, values, tolerance, digits=3):
    """Tests the claim that one more picture's value differs from a paper's figure by at most the fraction `tolerance` (0..1) of the figure. `values`:
    those of our independent pictures. Uses Student's t distribution for one more value."""
    values = np.asarray(values, float)
    spread, degrees = values.std(ddof=1) * np.sqrt(1 + 1 / len(values)), len(values) - 1
    cumulative = lambda value: float(special.stdtr(degrees, (value - values.mean()) / spread))
    below_low, above_high = cumulative(figure * (1 - tolerance)), 1 - cumulative(figure * (1 + tolerance))
    half = float(special.stdtrit(degrees, 1 - LEVEL / 2) * spread)
    low, high = values.mean() - half, values.mean() + half
    detectable = float((special.stdtrit(degrees, 1 - LEVEL / 2) + special.stdtrit(degrees, POWER)) * spread)
    return Test(max(below_low, above_high), min(1 - below_low, 1 - above_high), f"{low:.{digits}f} .. {high:.{digits}f}", detectable)


def counted(holds):
    """Returns the result of a claim that counting decides: true or false, without a statistical test."""
    return Test(0.0 if holds else 1.0, 1.0 if holds else 0.0)


def bonferroni_confidence(tests):
    """Returns the confidence that each of `tests` intervals needs, so that all of them hold at once with 95 % (Bonferroni)."""
    return 1 - 0.05 / tests


def prediction_interval(values):
    """Returns (low, high): 95 % prediction interval for one more independent value, for any distribution (order statistics)."""
    return tuple(np.quantile(values, [0.025, 0.975], method="weibull"))


def range_text(values, digits=3):
    return f"{np.min(values):.{digits}f} .. {np.max(values):.{digits}f}"


def first_from(values, holds, default=None):
    """Returns the first of the values from which on `holds` is true for all values; `default` if it is false for the last one."""
    tail = np.asarray(values)[np.logical_and.accumulate(np.asarray(holds)[::-1])[::-1]]
    return tail[0] if len(tail) else default


def fitted_exponent(x, y):
    """Returns the exponent e of the fit y = c x^e, by least squares of the logarithms."""
    return float(stats.linregress(np.log(x), np.log(y)).slope)
