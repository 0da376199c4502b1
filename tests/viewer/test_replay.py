"""A replay says and shows what the page does, also of drives that had no plan."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from narrows.errors import TrajectoryError
from narrows.viewer.page_motion import Curve, Motion
from narrows.viewer.page_report import Report
from narrows.viewer.page_save import Saved, show_of
from narrows.viewer.page_senses import Moment
from narrows.viewer.page_state import load_state
from narrows.viewer.page_work import Drive
from narrows.viewer.replay import replay_html

SEEN = Moment(0.0, np.ones((4, 3)), np.zeros((0, 2)), np.zeros((0, 2, 3)))
MOTION = Motion(
    "drive",
    np.array([0.0, 0.2]),
    np.array([[0.0, 0.8, 0.0], [0.1, 0.8, 0.0]]),
    (Curve("clearance [mm]", ("nearest solid",), np.zeros((2, 1))),),
    moments=(SEEN, replace(SEEN, time=0.1)),
    states=("goal", "zone"),
)
DRIVE = Drive(
    None,
    judgement=SimpleNamespace(
        min_clearance=0.0199, collisions=(), reached=False, reason="stopped <b>early</b>"
    ),
)


def test_nothing_driven_and_nothing_planned_is_no_replay():
    with pytest.raises(TrajectoryError, match="press Plan or Drive first"):
        show_of(Saved(load_state(None), None, None, None))
    with pytest.raises(TrajectoryError, match="press Plan or Drive first"):
        show_of(Saved(load_state(None), None, DRIVE, None))


def test_a_drive_without_a_plan_is_replayed_with_its_layers_and_who_was_in_control():
    state = load_state(None)
    named = replace(state, scene=replace(state.scene, name="<script>door</script>"))
    show = show_of(Saved(named, None, DRIVE, MOTION, ("rays", "points")))
    assert show.path is None
    shares = []

    class Heard(Report):
        def __call__(self, share):
            shares.append(share)

    page = replay_html(Heard(), show)
    banner = page[page.index('<details open id="narrows-banner"') :]
    assert "not reached" in banner
    assert "19 mm clear, driven" in banner
    assert "stopped &lt;b&gt;early&lt;/b&gt;" in banner
    assert "&lt;script&gt;door" in banner
    assert "shown: points" in banner  # no ray was cast
    assert banner.index(">goal</b>") < banner.index(">zone</b>")
    assert shares[-1] == 1.0
