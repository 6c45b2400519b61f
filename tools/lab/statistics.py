"""Confidence intervals, prediction intervals and verdicts, with numpy and scipy."""
from dataclasses import dataclass

import numpy as np
from scipy import stats

VERDICTS = REPRODUCED, NOT_REPRODUCED, UNDECIDED = "reproduced", "not reproduced", "undecided"
# Minimum number of pictures for a prediction. With fewer pictures, the value of another picture lies between their minimum and maximum with a
# probability below 95 %.
MIN_PICTURES = 39


@dataclass(frozen=True)
class Estimate:
    """Mean of `count` independent values, and the half width of its confidence interval (nan for a single value)."""

    mean: float
    half: float
    count: int

    low = property(lambda self: self.mean - self.half)
    high = property(lambda self: self.mean + self.half)
    # For a single value, which has no interval: the mean.
    low_or_mean = property(lambda self: self.mean if np.isnan(self.half) else self.low)
    high_or_mean = property(lambda self: self.mean if np.isnan(self.half) else self.high)

    def text(self, digits=3):
        """'0.137 +- 0.007'"""
        mean = f"{self.mean:.{digits}f}"
        return mean if np.isnan(self.half) else f"{mean} +- {self.half:.{digits}f}"


def estimate(values, confidence=0.95):
    """Mean and confidence interval by Student's t distribution; exact for normally distributed values."""
    values = np.asarray(values, float)
    if len(values) < 2:
        return Estimate(float(values[0]), np.nan, 1)
    half = stats.t.ppf((1 + confidence) / 2, len(values) - 1) * stats.sem(values)
    return Estimate(float(values.mean()), float(half), len(values))


def bonferroni_confidence(tests):
    """Confidence of each of `tests` intervals so that all of them hold together with 95 % (Bonferroni correction)."""
    return 1 - 0.05 / tests


def prediction_interval(values):
    """(low, high): 95 % prediction interval for one more value, for any distribution (order statistics)."""
    return tuple(np.quantile(values, [0.025, 0.975], method="weibull"))


def verdict(seen, contrary):
    """Verdict on a claim. seen: the figures support the claim; contrary: the figures contradict it. Undecided if both or neither are true."""
    if bool(seen) == bool(contrary):
        return UNDECIDED
    return REPRODUCED if seen else NOT_REPRODUCED


def verdict_by_prediction(paper, pictures):
    """Verdict on a paper's figure for one picture: reproduced if the figure lies in the prediction interval of our pictures; undecided if it lies
    outside and there are fewer than MIN_PICTURES pictures."""
    low, high = prediction_interval(pictures)
    inside = low <= paper <= high
    return verdict(inside, not inside and len(pictures) >= MIN_PICTURES)


def prediction_text(values, digits=3):
    low, high = prediction_interval(values)
    return f"{low:.{digits}f} .. {high:.{digits}f}"


def range_text(values, digits=3):
    return f"{np.min(values):.{digits}f} .. {np.max(values):.{digits}f}"


def tail_where(values, holds):
    """The longest tail of the pandas series `values` in which the boolean series `holds` is true for every value."""
    return values[holds[::-1].cummin()[::-1]]


def fitted_exponent(x, y):
    """The exponent e of the fit y = c x^e, by least squares of the logarithms."""
    return float(stats.linregress(np.log(x), np.log(y)).slope)
