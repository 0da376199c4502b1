"""Paths: progress is arc length, headings are continuous, poses come back, misfits are refused."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from narrows.bezier_section import BezierSection
from narrows.errors import ShapeError
from narrows.path import Path, is_repeated
from narrows.se2 import compose, exponential, wrap
from narrows.twist_section import TwistSection

CURVE = np.array([[0, 0], [1.0, 0.0], [1.4, 0.8], [1.4, 2.0]])
BACK = np.array([[1.4, 2.0], [1.4, 1.0], [0.8, 0.4], [0.0, 0.4]])  # starts where CURVE ends


def shunt() -> Path:
    """Return a curve forward, a curve in reverse, a turn on the spot and a line forward."""
    forward, reverse = BezierSection(CURVE[None]), BezierSection(BACK[None], -1)
    x, y, heading = reverse.evaluate(reverse.span)
    turned = heading + 1.2
    spot = TwistSection([[x, y, heading], [x, y, turned]])
    line = TwistSection([[x, y, turned], [x + math.cos(turned), y + math.sin(turned), turned]])
    return Path((forward, reverse, spot, line))


def test_a_quarter_circle_has_its_length_curvature_and_goal() -> None:
    path = Path.from_poses([[0, 0, 0], [2, 2, math.pi / 2]])
    assert path.length == pytest.approx(math.pi)
    assert path.span == path.length
    assert path.max_curvature == pytest.approx(0.5)
    assert path.curvature(1.0) == pytest.approx(0.5)
    r = math.sqrt(0.5)
    np.testing.assert_allclose(path(math.pi / 2), [2 * r, 2 - 2 * r, math.pi / 4], atol=1e-12)
    np.testing.assert_allclose(path.goal, [2, 2, math.pi / 2], atol=1e-12)


def test_progress_is_the_arc_length_travelled() -> None:
    path = shunt()
    s = np.union1d(np.linspace(0.0, path.span, 20001), path.section_bounds)  # cusps cut nothing off
    travelled = np.hypot(*np.diff(path(s)[:, :2], axis=0).T).sum()
    assert path.length == pytest.approx(travelled, abs=1e-5)
    assert path.span == pytest.approx(path.length + 1.2)
    assert path.section_bounds[-1] == path.span


def test_directions_and_their_changes_are_counted() -> None:
    path = shunt()
    assert path.directions.tolist() == [1, -1, 0, 1]
    assert path.direction_changes == 2
    assert path.section_index([0.0, path.section_bounds[1], path.span]).tolist() == [0, 0, 3]


@pytest.mark.parametrize("order", [1, 2])
def test_derivatives_agree_with_central_differences(order: int) -> None:
    path, h = shunt(), 1e-5
    s = np.linspace(0.01, path.span - 0.01, 301)
    s = s[np.abs(s[:, None] - path.section_bounds).min(axis=1) > 2 * h]
    difference = (path(s + h, order - 1) - path(s - h, order - 1)) / (2 * h)
    np.testing.assert_allclose(path(s, order), difference, atol=2e-5, rtol=1e-5)


def test_headings_are_unwrapped_along_the_path() -> None:
    poses = [[0, 0, 0.0]]
    for _ in range(9):  # nine arcs of 80 degrees
        poses.append(compose(poses[-1], exponential([0.5, 0.0, math.radians(80)])).tolist())
    wrapped = np.array(poses)
    wrapped[:, 2] = wrap(wrapped[:, 2])
    path = Path.from_poses(wrapped)
    assert path.goal[2] == pytest.approx(math.radians(720))
    heading = shunt()(np.linspace(0, shunt().span, 5000))[:, 2]
    assert np.abs(np.diff(heading)).max() < 0.01


def test_sections_that_count_turns_differently_join_without_a_jump() -> None:
    first = TwistSection([[0, 0, 3.0], [0, 0, 4.0]])
    x, y = math.cos(4.0), math.sin(4.0)
    second = TwistSection([[0, 0, 4.0 - 2 * math.pi], [x, y, 4.0 - 2 * math.pi]])
    path = Path((first, second))
    np.testing.assert_allclose(path([0.5, 1.0, 1.5, 2.0])[:, 2], [3.5, 4.0, 4.0, 4.0], atol=1e-12)


@given(
    twists=st.lists(
        st.tuples(st.sampled_from([-0.4, 0.05, 0.3]), st.floats(-2.5, 2.5)), min_size=1, max_size=8
    )
)
@settings(deadline=None, max_examples=60)
def test_poses_lie_on_the_path_made_of_them(twists: list[tuple[float, float]]) -> None:
    poses = [np.array([1.0, -2.0, 3.0])]
    for v, turn in twists:
        poses.append(compose(poses[-1], exponential([v, 0.0, turn])))
    path = Path.from_poses(poses)
    s = np.concatenate([[0.0], np.cumsum([abs(v) for v, _ in twists])])
    np.testing.assert_allclose(path(s), poses, atol=1e-9)
    assert path.direction_changes == np.count_nonzero(np.diff(np.sign([v for v, _ in twists])))
    again = Path.from_poses(path(s))
    middle = 0.5 * (s[1:] + s[:-1])
    np.testing.assert_allclose(again(middle), path(middle), atol=1e-9)


def test_repeated_poses_are_dropped() -> None:
    path = Path.from_poses([[0, 0, 0], [0, 0, 0], [1, 0, 0], [1, 0, 2 * math.pi], [2, 0, 0]])
    assert path.length == pytest.approx(2.0)
    assert path.sections[0].pieces == 2
    rows = np.array([[0, 0, 0], [0, 0, 1e-11], [0, 0, 1e-6]])
    assert is_repeated(rows).tolist() == [True, False]


def test_a_rigid_motion_moves_the_path_with_it() -> None:
    poses = np.array([[0, 0, 0], [1, 0.2, 0.4], [1.5, 1.0, 1.5]])
    moved = compose([3.0, -1.0, 2.0], poses)
    s = np.linspace(0, 2, 21)
    np.testing.assert_allclose(
        Path.from_poses(moved)(s), compose([3.0, -1.0, 2.0], Path.from_poses(poses)(s)), atol=1e-9
    )


def test_progress_beyond_the_ends_is_clipped() -> None:
    path = shunt()
    np.testing.assert_array_equal(path(-1.0), path.start)
    np.testing.assert_array_equal(path(path.span + 1.0), path.goal)
    assert path(np.zeros((2, 3))).shape == (2, 3, 3)


def test_a_single_curve_keeps_its_ends_and_its_curvature() -> None:
    path = Path((BezierSection(CURVE[None]),))
    np.testing.assert_allclose(path.start, [0, 0, 0], atol=1e-12)
    np.testing.assert_allclose(path.goal, [1.4, 2.0, math.pi / 2], atol=1e-9)
    fine = np.abs(path.curvature(np.linspace(0, path.span, 20001))).max()
    assert path.max_curvature == pytest.approx(fine, rel=1e-6)


def test_reverse_points_the_chair_away_from_its_travel() -> None:
    path = Path((BezierSection(BACK[None], -1),))
    np.testing.assert_allclose(wrap(path.start[2]), math.pi / 2, atol=1e-12)  # nose up, going down
    np.testing.assert_allclose(path(0.0, 1)[:2], [0.0, -1.0], atol=1e-12)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Path(()), "at least one section"),
        (lambda: Path.from_poses([[0, 0, 0]]), "two different poses"),
        (lambda: Path.from_poses([[0, 0, 0], [0, 0, 0]]), "two different poses"),
        (lambda: Path.from_poses([[0, 0], [1, 1]]), r"got shape \(2, 2\)"),
        (lambda: Path.from_poses([[0, 0, 0], [math.nan, 0, 0]]), "must be finite"),
        (
            lambda: Path((BezierSection(CURVE[None]), BezierSection(CURVE[None]))),
            "do not join: 2.44 m and 1.57 rad apart",
        ),
    ],
)
def test_what_is_no_path_is_refused(make, message: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(ShapeError, match=message):
        make()
