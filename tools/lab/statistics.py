"""Intervals, predictions and verdicts. Everything that a library has comes from numpy and scipy."""
from dataclasses import dataclass

import numpy as np
from scipy import stats

VERDICTS = REPRODUCED, NOT_REPRODUCED, UNDECIDED = "reproduced", "not reproduced", "cannot be told"
PREDICTABLE = 39  # pictures; the least and the largest of fewer hold less than 95 %


@dataclass(frozen=True)
class Estimate:
    """The mean of independent values and the half width of its confidence interval; nan for one value."""

    mean: float
    half: float
    count: int

    low = property(lambda self: self.mean - self.half)
    high = property(lambda self: self.mean + self.half)
    # The same, or where there is no interval the value itself.
    least = property(lambda self: self.mean if np.isnan(self.half) else self.low)
    most = property(lambda self: self.mean if np.isnan(self.half) else self.high)

    def text(self, digits=3):
        """'0.137 +- 0.007'"""
        mean = f"{self.mean:.{digits}f}"
        return mean if np.isnan(self.half) else f"{mean} +- {self.half:.{digits}f}"


def estimate(values, confidence=0.95):
    """By Student's t distribution: exact for values that scatter normally."""
    values = np.asarray(values, float)
    if len(values) < 2:
        return Estimate(float(values[0]), np.nan, 1)
    half = stats.t.ppf((1 + confidence) / 2, len(values) - 1) * stats.sem(values)
    return Estimate(float(values.mean()), float(half), len(values))


def each_of(tests):
    """The confidence of each of n intervals that together hold with 95 % (Bonferroni)."""
    return 1 - 0.05 / tests


def prediction(values):
    """(low, high): between these one more value lies with 95 %, whatever the distribution (order statistics)."""
    return tuple(np.quantile(values, [0.025, 0.975], method="weibull"))


def verdict(seen, contrary):
    """Of a claim that was seen, or whose contrary was; undecided where neither was."""
    if bool(seen) == bool(contrary):
        return UNDECIDED
    return REPRODUCED if seen else NOT_REPRODUCED


def verdict_among(paper, pictures):
    """Of a paper's figure for one picture: whether it lies in the prediction interval of many pictures."""
    low, high = prediction(pictures)
    among = low <= paper <= high
    return verdict(among, not among and len(pictures) >= PREDICTABLE)


def prediction_text(values, digits=3):
    low, high = prediction(values)
    return f"{low:.{digits}f} .. {high:.{digits}f}"


def range_text(values, digits=3):
    return f"{np.min(values):.{digits}f} .. {np.max(values):.{digits}f}"


def holding_to_the_end(values, holds):
    """The values from the first on from which something holds for all: pandas series."""
    return values[holds[::-1].cummin()[::-1]]


def fitted_exponent(x, y):
    """The e for which c x^e lies nearest to y, by least squares of the logarithms."""
    return float(stats.linregress(np.log(x), np.log(y)).slope)
