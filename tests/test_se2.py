"""Poses: a group with an exponential map, exact at small angles, wrapped where it says so."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from narrows.se2 import compose, exponential, invert, logarithm, rotate, transform, wrap

LENGTHS = st.floats(-10, 10)
ANGLES = st.floats(-6, 6)
POSES = st.tuples(LENGTHS, LENGTHS, ANGLES).map(np.array)


@given(angle=st.floats(-100, 100))
@settings(deadline=None)
def test_wrapping_keeps_the_direction(angle: float) -> None:
    wrapped = float(wrap(angle))
    assert -math.pi < wrapped <= math.pi
    assert math.cos(wrapped) == pytest.approx(math.cos(angle), abs=1e-12)
    assert math.sin(wrapped) == pytest.approx(math.sin(angle), abs=1e-12)


def test_half_turns_wrap_to_plus_pi() -> None:
    np.testing.assert_array_equal(wrap([math.pi, -math.pi, 0.0]), [math.pi, math.pi, 0.0])


@pytest.mark.parametrize("angle", [math.pi, -math.pi, 3 * math.pi])
def test_a_hair_beyond_half_a_turn_stays_in_the_interval(angle: float) -> None:
    for beyond in (math.nextafter(angle, 99.0), math.nextafter(angle, -99.0)):
        assert -math.pi < float(wrap(beyond)) <= math.pi


@given(one=POSES, two=POSES, three=POSES)
@settings(deadline=None)
def test_poses_are_a_group(one: np.ndarray, two: np.ndarray, three: np.ndarray) -> None:
    left = compose(compose(one, two), three)
    np.testing.assert_allclose(left, compose(one, compose(two, three)), atol=1e-12)
    np.testing.assert_allclose(compose(one, invert(one)), 0.0, atol=1e-12)
    np.testing.assert_allclose(compose(invert(one), one), 0.0, atol=1e-12)
    np.testing.assert_allclose(compose(one, np.zeros(3)), one, atol=0)


@given(one=POSES, two=POSES)
@settings(deadline=None)
def test_transforming_by_a_composition_is_transforming_twice(
    one: np.ndarray, two: np.ndarray
) -> None:
    points = np.array([[0.3, -1.2], [2.0, 0.5], [0.0, 0.0]])
    once = transform(compose(one, two), points)
    np.testing.assert_allclose(once, transform(one, transform(two, points)), atol=1e-11)
    spread = np.linalg.norm(once[0] - once[1])
    assert spread == pytest.approx(np.linalg.norm(points[0] - points[1]), abs=1e-11)


@pytest.mark.parametrize("angle", [0.0, 1e-12, 1e-8, 1e-5, -1e-7, 0.3, -3.0, 3.1, 6.2])
def test_logarithm_undoes_the_exponential_near_and_far_from_a_line(angle: float) -> None:
    twist = np.array([0.7, -0.2, angle])
    np.testing.assert_allclose(logarithm(exponential(twist)), twist, rtol=0, atol=1e-12)


@given(pose=st.tuples(LENGTHS, LENGTHS, st.floats(-3.1, 3.1)).map(np.array))
@settings(deadline=None)
def test_exponential_undoes_the_logarithm(pose: np.ndarray) -> None:
    np.testing.assert_allclose(exponential(logarithm(pose)), pose, atol=1e-11)


def test_a_constant_twist_is_its_small_steps_joined() -> None:
    twist = np.array([1.2, 0.1, 2.0])
    step, pose = exponential(twist / 1000), np.zeros(3)
    for _ in range(1000):
        pose = compose(pose, step)
    np.testing.assert_allclose(pose, exponential(twist), atol=1e-11)


def test_a_circle_of_known_radius_is_driven() -> None:
    end = exponential([math.pi * 0.5, 0.0, math.pi])  # half a circle of radius 0.5
    np.testing.assert_allclose(end, [0.0, 1.0, math.pi], atol=1e-15)


def test_batches_are_their_rows() -> None:
    rng = np.random.default_rng(0)
    first, second = rng.normal(size=(5, 3)), rng.normal(size=(5, 3))
    points = rng.normal(size=(4, 2))
    for k in range(5):
        np.testing.assert_allclose(compose(first, second)[k], compose(first[k], second[k]))
        np.testing.assert_allclose(invert(first)[k], invert(first[k]))
        np.testing.assert_allclose(transform(first, points)[k], transform(first[k], points))
    np.testing.assert_allclose(rotate(first[:, 2], points[0])[2], rotate(first[2, 2], points[0]))
    np.testing.assert_allclose(compose(first[0], second), [compose(first[0], b) for b in second])
