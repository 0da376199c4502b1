"""Claims about the intervals: known answers, agreement with SciPy, coverage."""

import numpy as np
import pytest
import scipy.stats

from narrows.errors import ShapeError
from narrows.studies.statistics import mean_interval, quantile_interval, wilson_interval


@pytest.mark.parametrize(
    ("successes", "trials", "low", "high"),
    [
        # p = 0: high = z^2 / (n + z^2) with z = 1.959964; p = 1 is its mirror image
        (0, 10, 0.0, 3.841459 / 13.841459),
        (10, 10, 10 / 13.841459, 1.0),
        # p = 1/2: half width = z / (2 sqrt(n + z^2))
        (50, 100, 0.5 - 1.959964 / 2 / 103.841459**0.5, 0.5 + 1.959964 / 2 / 103.841459**0.5),
    ],
)
def test_wilson_gives_the_closed_forms(successes, trials, low, high):
    found = wilson_interval(successes, trials)
    assert found.estimate == successes / trials
    assert (found.low, found.high) == pytest.approx((low, high), abs=1e-6)  # digits of z above


def test_wilson_agrees_with_scipy():
    for successes, trials, confidence in ((1, 3, 0.9), (7, 40, 0.95), (399, 400, 0.99)):
        found = wilson_interval(successes, trials, confidence=confidence)
        theirs = scipy.stats.binomtest(successes, trials).proportion_ci(confidence, "wilson")
        assert (found.low, found.high) == pytest.approx((theirs.low, theirs.high), abs=1e-12)


def test_bca_of_a_skewed_mean_agrees_with_scipy():
    sample = np.random.default_rng(3).exponential(size=40)
    found = mean_interval(sample, rng=np.random.default_rng(0), resamples=40_000)
    theirs = scipy.stats.bootstrap(
        (sample,), np.mean, n_resamples=40_000, method="BCa", rng=np.random.default_rng(1)
    ).confidence_interval
    plain = np.quantile(
        np.random.default_rng(2).choice(sample, (40_000, 40)).mean(axis=1), [0.025, 0.975]
    )
    spread = sample.std() / 40**0.5
    # The ends of two runs of 40,000 resamples scatter by 0.02 standard errors; BCa moves the
    # ends of the percentile interval by six times that, so the test sees the correction.
    assert (found.low, found.high) == pytest.approx(tuple(theirs), abs=0.04 * spread)
    assert found.high - plain[1] > 0.1 * spread
    assert found.estimate == pytest.approx(sample.mean(), rel=1e-15)


def test_median_interval_is_that_of_the_order_statistics():
    # Resampled medians of n = 2m + 1 distinct values exceed the k-th smallest unless at least
    # m + 1 draws are among the k smallest: a binomial tail gives the exact quantiles.
    count, half = 25, 12
    ranks = np.arange(1, count + 1)
    below = scipy.stats.binom.sf(half, count, ranks / count)  # P(median <= k-th)
    exact = [int(ranks[np.searchsorted(below, p)]) for p in (0.025, 0.975)]
    found = quantile_interval(
        np.random.default_rng(0).permutation(ranks), rng=np.random.default_rng(1), resamples=20_000
    )
    assert (found.low, found.estimate, found.high) == (exact[0], 13, exact[1])


@pytest.mark.parametrize("interval", [mean_interval, quantile_interval])
def test_intervals_follow_shift_and_scale_and_repeat(interval):
    sample = np.random.default_rng(5).normal(size=30)
    first, again, moved = (
        interval(values, rng=np.random.default_rng(7), resamples=500)
        for values in (sample, sample, 3.0 * sample + 10.0)
    )
    assert first == again
    assert (moved.low, moved.high) == pytest.approx((3 * first.low + 10, 3 * first.high + 10))


@pytest.mark.parametrize("interval", [mean_interval, quantile_interval])
def test_a_constant_sample_has_a_point_for_interval(interval):
    found = interval([2.0] * 5, rng=np.random.default_rng(0), resamples=100)
    assert (found.low, found.estimate, found.high) == (2.0, 2.0, 2.0)


@pytest.mark.parametrize("interval", [mean_interval, quantile_interval])
def test_nine_of_ten_intervals_at_ninety_percent_cover_the_truth(interval):
    rng = np.random.default_rng(11)
    covered = 0
    for _ in range(400):
        found = interval(rng.normal(size=30), rng=rng, confidence=0.9, resamples=400)
        covered += found.low <= 0.0 <= found.high
    # 400 trials: standard deviation 1.5 %; bootstrap of 30 values undercovers by a percent or two
    assert 0.84 < covered / 400 < 0.95


@pytest.mark.parametrize("sample", [[], [1.0], [1.0, np.nan], [1.0, np.inf], [[1.0, 2.0]]])
def test_a_sample_that_says_nothing_is_refused(sample):
    for interval in (mean_interval, quantile_interval):
        with pytest.raises(ShapeError):
            interval(sample, rng=np.random.default_rng(0))


def test_impossible_counts_and_confidences_are_refused():
    for successes, trials in ((1, 0), (3, 2), (-1, 2)):
        with pytest.raises(ShapeError, match="successes"):
            wilson_interval(successes, trials)
    with pytest.raises(ShapeError, match="confidence"):
        wilson_interval(1, 2, confidence=95)
    with pytest.raises(ShapeError, match="quantile"):
        quantile_interval([1.0, 2.0], rng=np.random.default_rng(0), quantile=50)
