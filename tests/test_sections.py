"""Sections: arc length, derivatives, and enclosures that do hold the motion."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from narrows import bezier
from narrows.bezier_section import BezierSection
from narrows.errors import ShapeError
from narrows.se2 import compose, exponential, wrap
from narrows.section import Section
from narrows.twist_section import TwistSection, twist_directions

CURVE = np.array([[0, 0], [1.0, 0.1], [1.4, 0.8], [1.2, 2.0]])
# a second curve whose first leg continues the first curve's last
NEXT = np.array([[1.2, 2.0], [1.1, 2.6], [0.2, 2.9], [-0.8, 2.4]])

TURNS = st.tuples(st.floats(0.02, 1.0), st.just(0.0), st.floats(-3.0, 3.0))
SPOTS = st.tuples(st.just(0.0), st.just(0.0), st.floats(0.05, 3.0))


def joined(twists: list[tuple[float, float, float]], sign: float = 1.0) -> TwistSection:
    """Return the section of body twists, one after the other, from an odd pose."""
    poses = [np.array([0.4, -0.3, 2.9])]
    for twist in twists:
        poses.append(compose(poses[-1], exponential(sign * np.array(twist))))
    return TwistSection(np.array(poses))


def sections() -> list[Section]:
    return [
        BezierSection(CURVE[None]),
        BezierSection(np.stack([CURVE, NEXT]), direction=-1),
        joined([(0.5, 0.0, 0.7), (0.3, 0.0, 0.0), (0.6, 0.0, -1.9)]),
        joined([(0.5, 0.0, 0.7), (0.2, 0.0, 0.4)], sign=-1.0),
        joined([(0.0, 0.0, 0.7), (0.0, 0.0, 1.4)]),
    ]


def test_the_span_of_a_curve_is_its_arc_length() -> None:
    def speed(u: float) -> float:
        return float(np.linalg.norm(bezier.evaluate(CURVE, u, 1)))

    section = BezierSection(CURVE[None])
    assert section.span == pytest.approx(quad(speed, 0, 1, epsabs=1e-12)[0], abs=1e-10)
    middle = section.progress_at(np.array([0]), np.array([0.37]))[0]
    assert middle == pytest.approx(quad(speed, 0, 0.37, epsabs=1e-12)[0], abs=1e-10)


@pytest.mark.parametrize("section", sections())
@pytest.mark.parametrize("order", [1, 2])
def test_derivatives_agree_with_central_differences(section: Section, order: int) -> None:
    h = 1e-5
    joints = section.progress_at(np.arange(section.pieces), np.ones(section.pieces))
    s = np.linspace(0.01, section.span - 0.01, 83)
    s = s[np.abs(s[:, None] - joints).min(axis=1) > 2 * h]
    above, below = (section.evaluate(s + e, order - 1) for e in (h, -h))
    np.testing.assert_allclose(
        section.evaluate(s, order), (above - below) / (2 * h), atol=2e-5, rtol=1e-5
    )


@pytest.mark.parametrize("section", sections()[:4])
def test_driven_sections_move_along_their_heading_at_unit_rate(section: Section) -> None:
    s = np.linspace(0.0, section.span, 200)
    pose, rate = section.evaluate(s), section.evaluate(s, 1)
    ahead = np.c_[np.cos(pose[:, 2]), np.sin(pose[:, 2])]
    np.testing.assert_allclose(rate[:, :2], section.direction * ahead, atol=1e-9)


def test_turning_on_the_spot_goes_by_the_angle() -> None:
    section = joined([(0.0, 0.0, -0.7), (0.0, 0.0, 0.5)])
    assert section.direction == 0
    assert section.span == pytest.approx(1.2)
    np.testing.assert_allclose(section.evaluate([0.0, 0.7, 1.2])[:, 2], [2.9, 2.2, 2.7], atol=1e-12)
    np.testing.assert_allclose(section.evaluate([0.3, 1.0], 1), [[0, 0, -1], [0, 0, 1]], atol=1e-12)


@pytest.mark.parametrize("section", sections())
def test_progress_and_parameters_are_each_others_inverse(section: Section) -> None:
    s = np.linspace(0.0, section.span, 77)
    piece, parameter = section.locate(s)
    np.testing.assert_allclose(section.progress_at(piece, parameter), s, atol=1e-9)
    assert ((parameter >= 0.0) & (parameter <= 1.0 + 1e-12)).all()


@pytest.mark.parametrize("section", sections())
def test_headings_are_continuous(section: Section) -> None:
    heading = section.evaluate(np.linspace(0.0, section.span, 2000))[:, 2]
    assert np.abs(np.diff(heading)).max() < 0.02


def test_a_loop_turns_the_heading_a_whole_turn() -> None:
    circle = BezierSection(_circle())
    turned = circle.evaluate(circle.span)[2] - circle.evaluate(0.0)[2]
    assert turned == pytest.approx(2 * math.pi, abs=1e-9)
    assert circle.span == pytest.approx(2 * math.pi, rel=3e-4)


def _circle() -> np.ndarray:
    """Return four cubics near the unit circle."""
    k = 4.0 / 3.0 * (math.sqrt(2.0) - 1.0)
    quarter = np.array([[1.0, 0.0], [1.0, k], [k, 1.0], [0.0, 1.0]])
    turn = np.array([[0.0, -1.0], [1.0, 0.0]])
    curves = [quarter]
    for _ in range(3):
        curves.append(curves[-1] @ turn.T)
    return np.array(curves)


def assert_encloses(section: Section, low: float, high: float) -> None:
    """Check that dense samples of each piece lie in its enclosure."""
    piece = np.arange(section.pieces)
    bounds = section.enclose(piece, np.full(len(piece), low), np.full(len(piece), high))
    inner = np.linspace(low, high, 101)
    directions = np.linspace(0.0, 2 * math.pi, 48, endpoint=False)
    axes = np.c_[np.cos(directions), np.sin(directions)]
    for k in piece:
        s = section.progress_at(np.full(len(inner), k), inner)
        poses = section.evaluate(np.clip(s, 0.0, section.span))
        # in the convex hull: no direction in which a sample reaches further than the hull
        over = (poses[:, :2] @ axes.T).max(axis=0) - (bounds.hull[k] @ axes.T).max(axis=0)
        assert over.max() < 1e-8  # m: a place is found again by its progress to some 1e-9
        if bounds.heading_high[k] - bounds.heading_low[k] >= 2 * math.pi - 1e-9:
            continue  # a full turn holds every heading
        whole = 2 * math.pi * round((poses[50, 2] - bounds.middle[k, 2]) / (2 * math.pi))
        heading = poses[:, 2] - whole
        assert heading.min() > bounds.heading_low[k] - 1e-7  # arc-length inversion leaves 1e-9
        assert heading.max() < bounds.heading_high[k] + 1e-7
        assert bounds.heading_low[k] <= bounds.middle[k, 2] <= bounds.heading_high[k]


@given(
    twists=st.lists(TURNS, min_size=1, max_size=3), ends=st.tuples(st.floats(0, 1), st.floats(0, 1))
)
@settings(deadline=None, max_examples=150)
def test_enclosures_hold_arcs(
    twists: list[tuple[float, float, float]], ends: tuple[float, float]
) -> None:
    for sign in (1.0, -1.0):
        assert_encloses(joined(twists, sign), *sorted(ends))


@given(twists=st.lists(SPOTS, min_size=1, max_size=2))
@settings(deadline=None, max_examples=30)
def test_enclosures_hold_turns_on_the_spot(twists: list[tuple[float, float, float]]) -> None:
    assert_encloses(joined(twists), 0.0, 1.0)


@given(
    inner=st.lists(st.tuples(st.floats(-2, 2), st.floats(-2, 2)), min_size=4, max_size=4),
    ends=st.tuples(st.floats(0, 1), st.floats(0, 1)),
    direction=st.sampled_from([1, -1]),
)
@settings(deadline=None, max_examples=100)
def test_enclosures_hold_curves(
    inner: list[tuple[float, float]], ends: tuple[float, float], direction: int
) -> None:
    control = np.array(inner)
    speed = np.linalg.norm(bezier.evaluate(control, np.linspace(0, 1, 400), 1), axis=-1)
    assume(speed.min() > 0.05)  # curves that nearly stand still have no heading to enclose
    assert_encloses(BezierSection(control[None], direction), *sorted(ends))


def test_enclosures_shrink_onto_the_motion() -> None:
    section = BezierSection(CURVE[None])
    for width in (0.1, 0.01):
        bounds = section.enclose(np.array([0]), np.array([0.4]), np.array([0.4 + width]))
        assert np.ptp(bounds.hull[0], axis=0).max() < 4.0 * width
        assert float(bounds.heading_high[0] - bounds.heading_low[0]) < 4.0 * width


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_directions_are_told_by_the_body(sign: float) -> None:
    twists = np.array([[1.0, 0, 0.5], [-1.0, 0, 0.5], [0, 0, 0.5], [1e-6, 0, 0.5]])
    assert twist_directions(twists).tolist() == [1, -1, 0, 0]
    assert joined([(0.3, 0.0, 0.2)], sign).direction == sign


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: TwistSection([[0, 0, 0], [1, 0, 0], [0, 0, 0]]), "drives one way"),
        (lambda: TwistSection([[0, 0, 0], [0, 0, 0]]), "must differ"),
        (lambda: TwistSection([[0, 0, 0], [1, 0, 5.5]]), "3/4 of a turn"),
        (lambda: TwistSection([[0, 0, 0]]), r"\(N >= 2, 3\)"),
        (lambda: BezierSection([CURVE, NEXT + 0.01]), "do not join"),
        (lambda: BezierSection([CURVE, CURVE[::-1] - CURVE[::-1][0] + CURVE[3]]), "bend"),
        (lambda: BezierSection(np.zeros((1, 4, 2))), "stands still"),
        (lambda: BezierSection(CURVE[None], 2), "direction must be"),
        (lambda: BezierSection(CURVE), r"must be \(K >= 1, 4, 2\)"),
    ],
)
def test_what_is_no_section_is_refused(make, message: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(ShapeError, match=message):
        make()


def test_a_joint_of_equal_tangents_is_no_bend() -> None:
    section = BezierSection(np.stack([CURVE, NEXT]))
    joint = section.progress_at(np.array([0]), np.array([1.0]))[0]
    before, after = section.evaluate([joint - 1e-7, joint + 1e-7])
    assert abs(float(wrap(after[2] - before[2]))) < 1e-5
