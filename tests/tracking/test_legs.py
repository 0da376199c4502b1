"""Legs: one for each stretch driven without a stop; projection that stays on its branch."""

import math

import numpy as np
import pytest

from narrows.bezier_section import BezierSection
from narrows.path import Path
from narrows.tracking.legs import STEP, legs_of

QUARTER = math.pi / 2


def circle(radius: float, angle: float = QUARTER) -> Path:
    """Return an arc to the left from the origin."""
    end = [radius * math.sin(angle), radius * (1 - math.cos(angle)), angle]
    return Path.from_poses([[0, 0, 0], end])


def test_sections_of_one_direction_are_one_leg() -> None:
    path = circle(1.0)
    on = path.goal
    line = BezierSection([[(on[0], on[1] + k / 3) for k in range(4)]])
    legs = legs_of(Path((*path.sections, line)))
    assert [leg.direction for leg in legs] == [1]
    assert legs[0].end == pytest.approx(QUARTER + 1.0, abs=1e-9)


def test_legs_end_where_direction_or_sense_of_turning_changes() -> None:
    path = Path.from_poses(
        [[0, 0, 0], [1, 0, 0], [1, 0, 0.5], [1, 0, -0.25], [1, 0, 0.0], [0, 0, 0]]
    )
    legs = legs_of(path)
    assert [leg.direction for leg in legs] == [1, 0, 0, 0, -1]
    np.testing.assert_allclose([leg.turn for leg in legs], [0, 0.5, -0.75, 0.25, 0], atol=1e-12)
    np.testing.assert_allclose([leg.start for leg in legs], [0, 1, 1.5, 2.25, 2.5])
    np.testing.assert_allclose([leg.end for leg in legs], [1, 1.5, 2.25, 2.5, 3.5])


def test_rows_are_the_paths_own_poses() -> None:
    path = circle(0.8)
    leg = legs_of(path)[0]
    s = np.linspace(0.0, path.span, 57)
    got = np.array([leg.pose(float(each)) for each in s])
    assert leg.step <= STEP
    # linear interpolation on an arc: sagitta step^2 / (8 R) = 0.6 um
    np.testing.assert_allclose(got, path(s), atol=1e-6)


def test_a_point_beside_a_circle_has_the_foot_of_its_angle() -> None:
    path = circle(1.0)
    leg = legs_of(path)[0]
    for angle, inward in ((0.3, 0.2), (0.9, -0.15), (1.4, 0.05)):
        r = 1.0 - inward
        foot = leg.project(
            r * math.sin(angle), 1 - r * math.cos(angle), near=angle + 0.1, reach=0.5
        )
        # the foot sticks to the corners of the rows' polyline by step x bend x offset = 0.4 mm
        assert foot.progress == pytest.approx(angle, abs=4e-4)
        assert foot.offset == pytest.approx(inward, abs=1e-6)  # left of a left turn is inside


def test_offsets_keep_their_side_in_reverse() -> None:
    leg = legs_of(Path.from_poses([[0, 0, 0], [-1, 0, 0]]))[0]
    assert leg.direction == -1
    assert leg.project(-0.4, 0.1, near=0.4, reach=0.2).offset == pytest.approx(-0.1)
    assert leg.project(-0.4, 0.1, near=0.4, reach=0.2).progress == pytest.approx(0.4)


def test_a_leg_goes_on_straight_beyond_its_ends() -> None:
    leg = legs_of(circle(1.0))[0]
    beyond = leg.project(1.1, 1.4, near=leg.end, reach=0.6)
    assert beyond.progress == pytest.approx(leg.end + 0.4, abs=1e-9)
    assert beyond.offset == pytest.approx(-0.1, abs=1e-9)
    before = leg.project(-0.3, 0.0, near=0.0, reach=0.6)
    assert before.progress == pytest.approx(-0.3, abs=1e-9)


def test_projection_does_not_jump_to_another_branch() -> None:
    there_and_back = Path.from_poses([[0, 0, 0], [2, 0, 0], [2, 0.1, math.pi], [0, 0.1, math.pi]])
    leg = legs_of(there_and_back)[0]
    on_way_out = leg.project(1.0, 0.09, near=1.0, reach=0.2)
    assert on_way_out.progress == pytest.approx(1.0, abs=1e-6)
    on_way_back = leg.project(1.0, 0.01, near=leg.end - 1.0, reach=0.2)
    assert on_way_back.progress == pytest.approx(leg.end - 1.0, abs=1e-6)
