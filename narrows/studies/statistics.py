"""Intervals for what a study estimates from a sample.

Rates get Wilson's score interval, which stays inside [0, 1] and does not shrink to a point at
0 or n successes [Wilson1927]. Means get the bias-corrected and accelerated bootstrap (BCa)
[EfronTibshirani1993, Ch. 14]; medians and other quantiles the percentile bootstrap, because the
jackknife that BCa needs is not consistent for them [EfronTibshirani1993, Ch. 11].
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from statistics import NormalDist

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import ShapeError

_Sample = NDArray[np.float64]
_NORMAL = NormalDist()
_CELLS = 2_000_000  # numbers drawn at once, to bound memory (16 MB)


@dataclass(frozen=True)
class Interval:
    """An estimate and the interval around it, in the unit of the sample.

    Attributes:
        estimate: The statistic of the sample itself.
        low: Lower end.
        high: Upper end.
        confidence: Probability that such intervals cover the true value, as far as the
            method's assumptions hold.
    """

    estimate: float
    low: float
    high: float
    confidence: float

    def __str__(self) -> str:
        """Return the estimate with its interval, four significant digits."""
        return f"{self.estimate:.4g} [{self.low:.4g}, {self.high:.4g}]"


def wilson_interval(successes: int, trials: int, *, confidence: float = 0.95) -> Interval:
    """Return the share of successes with Wilson's score interval.

    With z the normal quantile, p the share and n the trials, the ends are
    (p + z^2/2n -+ z sqrt(p (1 - p)/n + z^2/4n^2)) / (1 + z^2/n).

    Raises:
        ShapeError: If there are no trials, or more successes than trials.

    >>> print(wilson_interval(0, 10))
    0 [0, 0.2775]
    """
    if trials < 1 or not 0 <= successes <= trials:
        raise ShapeError(f"need 0 <= successes <= trials >= 1, got {successes} of {trials}")
    z = _two_sided_quantile(confidence)
    share = successes / trials
    scale = 1.0 + z**2 / trials
    centre = (share + z**2 / (2.0 * trials)) / scale
    half = z * math.sqrt(share * (1.0 - share) / trials + (z / (2.0 * trials)) ** 2) / scale
    low = 0.0 if successes == 0 else max(0.0, centre - half)
    high = 1.0 if successes == trials else min(1.0, centre + half)
    return Interval(share, low, high, confidence)


def mean_interval(
    sample: ArrayLike,
    *,
    rng: np.random.Generator,
    confidence: float = 0.95,
    resamples: int = 5000,
) -> Interval:
    """Return the mean of a sample with its BCa bootstrap interval.

    The interval's ends are those quantiles of the resampled means that the bias z0 (share of
    resampled means below the mean) and the acceleration a (skewness of the jackknife) choose.

    Args:
        sample: Finite values, shape (N,), N >= 2.
        rng: Source of the resamples; the same state gives the same interval.
        confidence: Between 0 and 1.
        resamples: Number of resamples.

    Raises:
        ShapeError: If the sample is too small or holds NaN or infinity.
    """
    values = _checked(sample, resamples)
    z = _two_sided_quantile(confidence)
    mean = float(np.mean(values))
    means = _resampled(values, resamples, rng, np.mean)  # (resamples,)
    deviation = values - mean
    squares = float(np.sum(deviation**2))
    if squares == 0.0 or means.min() == means.max():
        return Interval(mean, mean, mean, confidence)
    acceleration = float(np.sum(deviation**3)) / (6.0 * squares**1.5)
    # Ties count half, which keeps z0 finite and zero for symmetric samples.
    below = float(np.mean(means < mean) + 0.5 * np.mean(means == mean))
    least = 0.5 / resamples
    bias = _NORMAL.inv_cdf(min(max(below, least), 1.0 - least))
    ends = [
        _NORMAL.cdf(bias + (bias + side) / (1.0 - acceleration * (bias + side))) for side in (-z, z)
    ]
    low, high = np.quantile(means, ends)
    return Interval(mean, float(low), float(high), confidence)


def quantile_interval(
    sample: ArrayLike,
    *,
    rng: np.random.Generator,
    quantile: float = 0.5,
    confidence: float = 0.95,
    resamples: int = 5000,
) -> Interval:
    """Return a quantile of a sample, the median by default, with its percentile interval.

    An interval for a quantile far out in the tail is no better than the few values out there:
    it never leaves the sample's range.

    Args:
        sample: Finite values, shape (N,), N >= 2.
        rng: Source of the resamples; the same state gives the same interval.
        quantile: Between 0 and 1; 0.5 is the median.
        confidence: Between 0 and 1.
        resamples: Number of resamples.

    Raises:
        ShapeError: If the sample is too small or holds NaN or infinity.
    """
    values = _checked(sample, resamples)
    if not 0.0 <= quantile <= 1.0:
        raise ShapeError(f"a quantile lies between 0 and 1, got {quantile}")
    _two_sided_quantile(confidence)

    def statistic(drawn: _Sample, axis: int) -> _Sample:
        return np.asarray(np.quantile(drawn, quantile, axis=axis))

    found = _resampled(values, resamples, rng, statistic)
    low, high = np.quantile(found, [(1.0 - confidence) / 2.0, (1.0 + confidence) / 2.0])
    return Interval(float(np.quantile(values, quantile)), float(low), float(high), confidence)


def _checked(sample: ArrayLike, resamples: int) -> _Sample:
    values = np.asarray(sample, dtype=float)
    if values.ndim != 1 or len(values) < 2:
        raise ShapeError(f"a bootstrap needs at least two values, got shape {values.shape}")
    if not np.all(np.isfinite(values)):
        raise ShapeError("a bootstrap needs finite values; decide first what NaN and inf mean")
    if resamples < 1:
        raise ShapeError(f"a bootstrap needs resamples, got {resamples}")
    return values


def _two_sided_quantile(confidence: float) -> float:
    if not 0.0 < confidence < 1.0:
        raise ShapeError(f"a confidence lies between 0 and 1, got {confidence}")
    return _NORMAL.inv_cdf((1.0 + confidence) / 2.0)


def _resampled(
    values: _Sample,
    resamples: int,
    rng: np.random.Generator,
    statistic: Callable[..., _Sample],
) -> _Sample:
    """Return a statistic of samples drawn with replacement, shape (resamples,)."""
    batch = max(1, _CELLS // len(values))
    found = []
    for first in range(0, resamples, batch):
        count = min(batch, resamples - first)
        drawn = values[rng.integers(len(values), size=(count, len(values)))]  # (count, N)
        found.append(statistic(drawn, axis=1))
    return np.concatenate(found)
