"""The picture of a sensed plan: axes with units, all named, what was refused drawn as such."""

import numpy as np
import pytest

from narrows.scene import Goal, Scene
from narrows.simulation.lookout import LookOptions
from narrows.simulation.sensed_plan import SensedOptions, plan_sensed
from narrows.vehicle import Vehicle
from narrows.world import MovingSolid, World


def figure_of(*moving):
    pytest.importorskip("matplotlib")
    from narrows.viewer.sensed_pictures import sensed_figure

    world = World((), (-1.0, -1.5, 5.0, 1.5), moving=moving)
    chair = Vehicle.rectangle(1.0, 0.6, 0.25, height=1.2)
    scene = Scene(chair, world, np.zeros(3), Goal(np.array([3.0, 0.0, 0.0])), name="yard")
    look = LookOptions(scans=1, side=8.0, camera_headings=())
    return sensed_figure(scene, plan_sensed(scene, SensedOptions(look)))


def test_a_certified_plan_has_labelled_axes_and_one_legend():
    figure = figure_of()
    first, truth = (axes for axes in figure.axes if axes.axison)
    assert {(a.get_xlabel(), a.get_ylabel()) for a in (first, truth)} == {("x [m]", "y [m]")}
    names = [text.get_text() for text in figure.legends[0].get_texts()]
    assert {"unknown", "seen to be free", "door found", "goal"} <= set(names)
    assert "certified" in figure.get_suptitle()


def test_a_refused_plan_says_why_and_shows_who_walks():
    figure = figure_of(MovingSolid(0.25, [[0.0, 2.0, -1.0], [3.0, 2.0, 0.0]], name="guest"))
    assert "into guest" in figure.get_suptitle().replace("\n", " ")
    truth = [axes for axes in figure.axes if axes.axison][1]
    assert truth.get_title() == "the true world: not certified"
    assert any(np.array_equal(line.get_xdata(), [2.0, 2.0]) for line in truth.lines)
