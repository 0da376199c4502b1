"""Charts of what was driven show the speeds that were driven."""

import matplotlib.figure
import numpy as np
import pytest

from narrows.se2 import compose, exponential
from narrows.trajectory import Trajectory
from narrows.vehicle import Vehicle
from narrows.viewer.charts import draw_curvature, draw_speeds

CHAIR = Vehicle.rectangle(1.0, 0.66, 0.25)
PERIOD = 0.05


@pytest.fixture(scope="module")
def driven():
    """A chair that slows down until it turns on the spot, and drives on."""
    speeds = [*np.geomspace(0.4, 1e-4, 40), *np.zeros(10), *np.geomspace(1e-4, 0.4, 40)]
    poses = [np.zeros(3)]
    for v in speeds:
        poses.append(compose(poses[-1], exponential(np.array([v, 0.0, 0.5]) * PERIOD)))
    return Trajectory.from_samples(PERIOD * np.arange(len(poses)), np.array(poses))


def test_no_wheel_is_drawn_faster_than_it_turned(driven):
    axes = matplotlib.figure.Figure().add_subplot()
    draw_speeds(axes, driven, CHAIR, "black")
    fastest = 0.4 + 0.5 * 0.5 * CHAIR.track
    for line in axes.lines:
        assert np.abs(line.get_ydata()).max() <= fastest + 1e-6


def test_a_bend_as_tight_as_on_the_spot_leaves_a_gap(driven):
    axes = matplotlib.figure.Figure().add_subplot()
    draw_curvature(axes, driven, CHAIR, "black")
    shown = axes.lines[0].get_ydata()
    assert np.nanmax(np.abs(shown)) <= 20.0
    assert np.isnan(shown).any()
    assert np.nanmin(shown[:5]) == pytest.approx(0.5 / 0.4, abs=0.01)
