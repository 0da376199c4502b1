"""Layers show what was known at a moment, where they are switched on, and nothing else."""

import numpy as np
import pytest

from narrows.viewer.control_colours import STATES, state_chip, state_colour, states_told
from narrows.viewer.layer_drawing import LAYERS, LayerDrawing, has_layer
from narrows.viewer.page_senses import Moment

NOTHING = np.zeros((0, 2, 3))
SQUARE = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
BEFORE = Moment(0.0, np.ones((4, 3)), np.ones((5, 2)), np.ones((6, 2, 3)), (SQUARE,))
AFTER = Moment(0.2, np.ones((2, 3)), np.zeros((0, 2)), NOTHING)


class Recorded:
    """A scene that keeps what was added to it."""

    def __init__(self):
        """Start empty."""
        self.added = {}

    def __getattr__(self, kind):
        """Return what takes down a call."""

        def add(name, rows, *looks, **options):
            self.added[name] = rows
            return Handle(self, name)

        return add


class Handle:
    """What viser hands back."""

    def __init__(self, scene, name):
        """Keep where it belongs."""
        self.scene, self.name = scene, name

    def remove(self):
        del self.scene.added[self.name]


def test_only_what_is_switched_on_is_shown():
    scene = Recorded()
    layers = LayerDrawing(scene)
    layers.show(BEFORE, tuple(LAYERS))
    assert {name: len(rows) for name, rows in scene.added.items()} == {
        "/layers/rays": 6,
        "/layers/points": 4,
        "/layers/unknown": 5,
        "/chair/zone": 4,
    }
    layers.show(BEFORE, ("rays",))
    assert list(scene.added) == ["/layers/rays"]
    layers.show(None, ("rays",))
    assert not scene.added


def test_what_is_no_longer_known_is_taken_away():
    scene = Recorded()
    layers = LayerDrawing(scene)
    layers.show(BEFORE, tuple(LAYERS))
    layers.show(AFTER, tuple(LAYERS))
    assert {name: len(rows) for name, rows in scene.added.items()} == {"/layers/points": 2}
    assert [name for name in LAYERS if has_layer(AFTER, name)] == ["points"]
    assert all(has_layer(BEFORE, name) for name in LAYERS)


def test_the_zone_is_a_closed_ring():
    scene = Recorded()
    LayerDrawing(scene).show(BEFORE, ("zone",))
    segments = scene.added["/chair/zone"]
    np.testing.assert_array_equal(segments[:, 1], np.roll(segments[:, 0], -1, axis=0))


def test_every_state_that_a_controller_tells_has_a_colour():
    from narrows.reactive.assistant_options import AssistantState
    from narrows.reactive.switching import Active

    for signal, kind in (("active", Active), ("state", AssistantState)):
        told = states_told({signal: np.array([float(member) for member in kind])})
        assert len(told) == len(kind)
        assert set(told) <= set(STATES)
    assert states_told({"intrusion": np.zeros(3)}) == ()
    assert state_colour("") == state_colour("nobody of that name")
    assert "<script>" not in state_chip("<script>")


@pytest.mark.parametrize("name", LAYERS)
def test_a_layer_that_is_empty_from_the_start_is_no_error(name):
    scene = Recorded()
    LayerDrawing(scene).show(Moment(0.0, np.zeros((0, 3)), np.zeros((0, 2)), NOTHING), (name,))
    assert not scene.added
