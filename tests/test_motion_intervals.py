"""Intervals cover the motion, and nothing of the body swept over one is beyond its bound."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from narrows.bezier_section import BezierSection
from narrows.motion_intervals import FIRST_CUT, Intervals, support_bound
from narrows.path import Path
from narrows.se2 import compose, exponential, transform
from narrows.vehicle import Vehicle

BODY = Vehicle.rectangle(1.0, 0.67, 0.25).outline
CURVES = np.array(
    [[[0, 0], [0.4, 0], [0.8, 0.3], [0.9, 0.7]], [[0.9, 0.7], [0.96, 0.94], [0.5, 1.4], [0.1, 1.0]]]
)


def paths() -> list[Path]:
    start = np.array([0.3, -0.2, 2.8])
    twists = [(0.5, 0, 0), (0.4, 0, 0.9), (0, 0, 1.2), (0, 0, 0.3), (-0.3, 0, 0.5), (0.2, 0, -2.4)]
    poses = [start]
    for twist in twists:
        poses.append(compose(poses[-1], exponential(np.array(twist, dtype=float))))
    return [
        Path((BezierSection(CURVES),)),
        Path((BezierSection(CURVES[::-1, ::-1], -1),)),
        Path.from_poses(poses),
    ]


@pytest.mark.parametrize("path", paths())
def test_intervals_cover_the_path_once_and_are_short(path: Path) -> None:
    intervals = Intervals.of(path)
    ends = []
    for parameter in (intervals.low, intervals.high):
        progress = np.empty(len(parameter))
        for k, section in enumerate(path.sections):
            rows = intervals.section == k
            within = section.progress_at(intervals.piece[rows], parameter[rows])
            progress[rows] = path.section_bounds[k] + within
        ends.append(progress)
    low, high = ends
    assert low[0] == pytest.approx(0.0, abs=1e-12)
    assert high[-1] == pytest.approx(path.span, abs=1e-12)
    np.testing.assert_allclose(low[1:], high[:-1], atol=1e-12)
    # a Bezier piece is cut evenly in its parameter, not in length: twice as long at most here
    assert (high - low).max() <= 2.0 * FIRST_CUT
    assert (high > low).all()


def test_cutting_keeps_the_ends_and_what_lies_between() -> None:
    intervals = Intervals.of(paths()[2])
    rows = np.array([3, 0, 7])
    cut = intervals.cut(rows, 4)
    assert len(cut.low) == 12
    np.testing.assert_array_equal(cut.low[::4], intervals.low[rows])
    np.testing.assert_allclose(cut.high[3::4], intervals.high[rows], atol=1e-15)
    np.testing.assert_allclose(cut.low.reshape(3, 4)[:, 1:], cut.high.reshape(3, 4)[:, :-1])
    np.testing.assert_array_equal(cut.section[::4], intervals.section[rows])
    np.testing.assert_array_equal(cut.piece[::4], intervals.piece[rows])


@given(st.integers(0, 2**32 - 1), st.integers(0, 3))
@settings(deadline=None, max_examples=40, derandomize=True)
def test_no_corner_swept_over_an_interval_reaches_beyond_its_bound(seed: int, cuts: int) -> None:
    rng = np.random.default_rng(seed)
    path = paths()[seed % 3]
    intervals = Intervals.of(path)
    rows = rng.integers(0, len(intervals.low), 6)
    for _ in range(cuts):
        intervals = intervals.cut(rows, 4)
        rows = rng.integers(0, len(intervals.low), 6)
    angle = rng.uniform(-math.pi, math.pi, 6)
    axis = np.column_stack([np.cos(angle), np.sin(angle)])
    bound = support_bound(BODY, intervals.enclose(path.sections), rows, axis)
    for bounded, row, normal in zip(bound, rows, axis, strict=True):
        section = path.sections[intervals.section[row]]
        parameter = np.linspace(intervals.low[row], intervals.high[row], 200)
        piece = np.full(200, intervals.piece[row])
        poses = section.evaluate(section.progress_at(piece, parameter))
        reach = float((transform(poses, BODY) @ normal).max())
        assert reach <= bounded + 1e-12
        # and not far beyond: by what the body turns and moves over the interval
        turned = float(np.ptp(poses[:, 2]))
        moved = float(np.linalg.norm(np.diff(poses[:, :2], axis=0), axis=1).sum())
        assert bounded <= reach + 2.5 * moved + 2.5 * turned + 1e-9


@pytest.mark.parametrize("path", paths()[:2])
@pytest.mark.parametrize("length", [0.0, 1e-16, 1e-12, 1e-9, 1e-5])
def test_the_heading_is_known_however_short_the_interval_is(path: Path, length: float) -> None:
    """A chair that sets off moves nanometres in its first instants; its heading is certain."""
    low = np.array([0.0, 0.3, 0.7, 1.0 - length])
    piece = np.array([0, 1, 0, 1])
    intervals = Intervals(np.zeros(4, dtype=np.int64), piece, low, low + length)
    enclosure = intervals.enclose(path.sections)
    assert (enclosure.heading_high - enclosure.heading_low <= 20 * length + 1e-12).all()
    assert (enclosure.heading_low <= enclosure.middle[:, 2]).all()
    assert (enclosure.heading_high >= enclosure.middle[:, 2]).all()


def test_a_full_turn_reaches_as_far_as_the_body_does_whatever_the_axis() -> None:
    path = Path.from_poses([[1.0, 2.0, k * math.pi / 2] for k in range(5)])
    intervals = Intervals.of(path)
    enclosure = intervals.enclose(path.sections)
    count = len(intervals.low)
    for angle in (0.1, 1.7, -2.0):
        axis = np.array([math.cos(angle), math.sin(angle)])
        bound = support_bound(BODY, enclosure, np.arange(count), np.tile(axis, (count, 1)))
        expected = axis @ [1.0, 2.0] + math.hypot(0.75, 0.335)
        assert bound.max() == pytest.approx(expected, abs=1e-9)
