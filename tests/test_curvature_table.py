"""The table of a path's bends: as exact as it says, jumps where they are."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from narrows.bezier_section import BezierSection
from narrows.curvature_table import CurvatureTable
from narrows.path import Path


@given(seed=st.integers(0, 2**32 - 1), spread=st.sampled_from([0.1, 0.3, 0.6]))
@settings(deadline=None, max_examples=60, derandomize=True)
def test_between_nodes_it_is_off_by_no_more_than_it_says(seed: int, spread: float) -> None:
    rng = np.random.default_rng(seed)
    corners = np.array([[0, 0], [0.7, 0], [1.4, 0], [2.1, 0]])
    path = Path((BezierSection((corners + rng.normal(0.0, spread, (4, 2)))[None]),))
    table = path.curvature_table
    s = np.linspace(0.0, path.span, 4001)
    kappa, rate, kappa_error, rate_error = table.with_errors(s)
    scale = max(1.0, path.max_curvature)
    # 1e-6 of the scale: progress itself is found by quadrature and Newton's method
    assert (np.abs(kappa - path(s, 1)[:, 2]) <= kappa_error + 1e-6 * scale).all()
    assert (np.abs(rate - path(s, 2)[:, 2]) <= rate_error + 1e-5 * scale**2).all()
    assert kappa_error.max() <= 1e-3 * scale or len(table.progress) > 512


def test_curvature_jumps_between_twists_and_nowhere_else() -> None:
    path = Path.from_poses([[0, 0, 0], [1, 0, 0], [2, 1, math.pi / 2], [2, 2, math.pi / 2]])
    where, step = path.curvature_table.jumps()
    np.testing.assert_allclose(where, [1.0, 1.0 + math.pi / 2])
    np.testing.assert_allclose(step, [1.0, -1.0])
    kappa, rate = path.curvature_table(np.array([0.5, 1.5, 3.0]))
    np.testing.assert_allclose(kappa, [0.0, 1.0, 0.0], atol=1e-12)
    assert (rate == 0.0).all()


def test_the_greatest_curvature_leaves_turns_on_the_spot_out() -> None:
    path = Path.from_poses([[0, 0, 0], [0, 2, math.pi], [0, 2, math.pi + 1.0]])
    assert path.max_curvature == pytest.approx(1.0)
    assert path.curvature_table(np.array([path.span - 0.1]))[0] == pytest.approx([1.0])


def test_the_greatest_curvature_of_a_parabola_is_the_known_one() -> None:
    # y = x^2 as a cubic: curvature 2 at the vertex, which no node of the table need hit
    quadratic = np.array([[-0.9, 0.81], [0.05, -0.9], [1.0, 1.0]])
    control = np.array(
        [
            quadratic[0],
            quadratic[0] / 3 + 2 * quadratic[1] / 3,
            2 * quadratic[1] / 3 + quadratic[2] / 3,
            quadratic[2],
        ]
    )
    table = CurvatureTable.of((BezierSection(control[None]),))
    assert table.greatest == pytest.approx(2.0, rel=1e-6)
