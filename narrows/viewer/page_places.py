"""Walls, start and goal on the page: their numbers, and where they are dragged to."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from viser import GuiApi

from .page_fields import Field, FieldGroup, rounded_number
from .page_guard import Guard
from .page_state import SceneState, Step
from .page_words import answer

Changes = Mapping[tuple[Step, ...], Any]

WALLS = {
    "doorway": (
        Field("door_width", "door width [m]", 0.2, 5.0, 0.01, "clear width"),
        Field("corridor_width", "corridor width [m]", 0.2, 10.0, 0.01, "between its walls"),
        Field("door_position", "door at x [m]", -50.0, 50.0, 0.05, "middle of the door"),
        Field("wall_thickness", "walls [m]", 0.01, 1.0, 0.01, "their thickness"),
        Field("room_width", "room width [m]", 0.3, 50.0, 0.1, "along the corridor"),
        Field("room_depth", "room depth [m]", 0.3, 50.0, 0.1, "behind the door"),
    ),
    "corridor": (
        Field("width", "corridor width [m]", 0.2, 10.0, 0.01, "before the turn"),
        Field("width_after", "width after [m]", 0.2, 10.0, 0.01, "after the turn"),
        Field("turn_deg", "turn [°]", -150.0, 150.0, 5.0, "left positive; 5 to 150 either way"),
        Field("length", "legs [m]", 0.3, 50.0, 0.1, "outside the corner"),
        Field("wall_thickness", "walls [m]", 0.01, 1.0, 0.01, "their thickness"),
    ),
}
"""Fields of each short form; what is left out keeps its default."""

_DEFAULTS: dict[str, Any] = {
    "door_position": 1.6,
    "wall_thickness": 0.1,
    "room": (4.0, 3.0),
    "turn_deg": 90.0,
    "length": 3.0,
}
POSE = (
    Field("x", "x [m]", -1e4, 1e4, 0.05, "middle of the drive axle"),
    Field("y", "y [m]", -1e4, 1e4, 0.05, "middle of the drive axle"),
    Field("heading_deg", "heading [°]", -720.0, 720.0, 5.0, "counter-clockwise from x"),
)
MARGIN = (Field("margin", "margin [m]", 0.0, 1.0, 0.005, "clearance asked for"),)


class WallsPanel:
    """The short form's numbers and the margin."""

    def __init__(
        self, gui: GuiApi, guard: Guard, state: SceneState, apply: Callable[[Changes], None]
    ) -> None:
        """Add the fields of the scene's short form.

        Args:
            gui: The page.
            guard: Makes callbacks wait for each other.
            state: Says which short form it is; that never changes.
            apply: Called with the changes to the document.
        """
        self._apply = apply
        self._form = state.form
        fields = WALLS.get(self._form, ())
        if not fields:
            which = "a map" if self._form == "map" else "the scene file"
            gui.add_html(answer(f"The walls are those of {which}.", good=True))
        self.fields = FieldGroup(gui, (*fields, *MARGIN), guard(self._changed))

    def show(self, state: SceneState) -> None:
        """Show the numbers of a state."""
        values: dict[str, float] = {"margin": float(state.document.get("margin", 0.02))}
        if self._form in WALLS:
            entry = state.document[self._form]
            room = entry.get("room") or _DEFAULTS["room"]
            given = {**entry, "room_width": room[0], "room_depth": room[1]}
            for field in WALLS[self._form]:
                value = given.get(field.name)
                if value is None:
                    value = given["width"] if field.name == "width_after" else None
                values[field.name] = float(_DEFAULTS[field.name] if value is None else value)
        self.fields.show(values)

    def _changed(self, event: Any) -> None:
        changes: dict[tuple[Step, ...], Any] = {}
        for name in self.fields.read():
            now = self.fields.known
            if name == "margin":
                changes["margin",] = now[name]
            elif name in ("room_width", "room_depth"):
                changes[self._form, "room"] = [now["room_width"], now["room_depth"]]
            else:
                changes[self._form, name] = now[name]
        if changes:
            self._apply(changes)


class EndPanel:
    """Start or goal."""

    def __init__(
        self, gui: GuiApi, guard: Guard, name: str, apply: Callable[[Changes], None]
    ) -> None:
        """Add the fields of `start` or `goal`."""
        self._name = name
        self._apply = apply
        self.fields = FieldGroup(gui, POSE, guard(self._changed))

    def show(self, state: SceneState) -> None:
        """Show the pose of a state."""
        self.fields.show(state.pose(self._name))

    def _changed(self, event: Any) -> None:
        if self.fields.read():
            self._apply(pose_changes(self._name, self.fields.known))


def pose_changes(name: str, pose: Mapping[str, float]) -> dict[tuple[Step, ...], Any]:
    """Return the changes that move `start` or `goal`, tolerances kept."""
    return {(name, key): rounded_number(value) for key, value in pose.items()}
