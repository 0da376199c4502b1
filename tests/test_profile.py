"""Profiles: piecewise cubics of time, their derivatives and their inverse."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from narrows.errors import ShapeError
from narrows.profile import Profile

# speed up at 0.5 m/s^2 for 2 s, cruise at 1 m/s for 3 s, brake for 2 s: 1 + 3 + 1 m
TRAPEZOID = Profile(
    np.array([0.0, 2.0, 5.0, 7.0]),
    np.array([[0, 0, 0.25, 0], [1, 1, 0, 0], [4, 1, -0.25, 0]], dtype=float),
)


def test_a_trapezoid_has_its_known_progress() -> None:
    assert TRAPEZOID.duration == 7.0
    assert TRAPEZOID.span == pytest.approx(5.0)
    t = np.array([0.0, 1.0, 2.0, 3.5, 5.0, 6.0, 7.0])
    np.testing.assert_allclose(TRAPEZOID(t), [0, 0.25, 1, 2.5, 4, 4.75, 5])
    np.testing.assert_allclose(TRAPEZOID(t, 1), [0, 0.5, 1, 1, 1, 0.5, 0])
    np.testing.assert_allclose(TRAPEZOID(t, 2), [0.5, 0.5, 0, 0, -0.5, -0.5, -0.5])
    np.testing.assert_array_equal(TRAPEZOID(t, 3), 0.0)
    np.testing.assert_array_equal(TRAPEZOID(t, 4), 0.0)


def test_times_beyond_the_ends_are_clipped() -> None:
    np.testing.assert_allclose(TRAPEZOID([-1.0, 8.0]), [0.0, 5.0])


@pytest.mark.parametrize("order", [1, 2, 3])
def test_derivatives_agree_with_central_differences(order: int) -> None:
    profile = Profile(
        np.array([0.0, 1.0, 1.5]), np.array([[0, 0, 0, 0.5], [0.5, 1.5, 1.5, -0.9]], dtype=float)
    )
    t, h = np.array([0.2, 0.7, 1.1, 1.4]), 1e-5
    difference = (profile(t + h, order - 1) - profile(t - h, order - 1)) / (2 * h)
    np.testing.assert_allclose(profile(t, order), difference, atol=1e-8)


@given(share=st.floats(0, 1))
@settings(deadline=None)
def test_the_time_at_a_progress_is_when_it_is_reached(share: float) -> None:
    s = share * 5.0
    t = float(TRAPEZOID.time_at(s))
    assert float(TRAPEZOID(t)) == pytest.approx(s, abs=1e-9)


def test_the_first_of_several_times_is_given() -> None:
    waiting = Profile(
        np.array([0.0, 1.0, 4.0, 5.0]), np.array([[0, 1, 0, 0], [1, 0, 0, 0], [1, 1, 0, 0.0]])
    )
    np.testing.assert_allclose(waiting.time_at([0.0, 1.0, 1.5, 9.0]), [0, 1, 4.5, 5], atol=1e-12)


@pytest.mark.parametrize(
    ("breaks", "rows", "message"),
    [
        ([0, 1], [[0, 1, 0]], r"\(K \+ 1,\) and \(K, 4\)"),
        ([0.5, 1], [[0, 1, 0, 0]], "increase from 0"),
        ([0, 1, 1], [[0, 1, 0, 0], [1, 1, 0, 0]], "increase from 0"),
        ([0, 1, 2], [[0, 1, 0, 0], [1.1, 1, 0, 0]], "progress jumps by 0.1"),
        ([0, np.inf], [[0, 1, 0, 0]], "must be finite"),
    ],
)
def test_what_is_no_profile_is_refused(breaks: list, rows: list, message: str) -> None:
    with pytest.raises(ShapeError, match=message):
        Profile(np.array(breaks, dtype=float), np.array(rows, dtype=float))


def test_a_negative_order_is_refused() -> None:
    with pytest.raises(ShapeError, match="got -1"):
        TRAPEZOID(0.0, -1)
