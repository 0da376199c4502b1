"""Walls, ends and things on the page: their numbers, and where they are dragged to."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import shapely
from viser import GuiApi

from .page_fields import Field, FieldGroup, rounded_number
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
THING = (
    Field("x", "x [m]", -1e4, 1e4, 0.05, "its middle"),
    Field("y", "y [m]", -1e4, 1e4, 0.05, "its middle"),
    Field("low", "underside [m]", 0.0, 5.0, 0.01, "above the floor"),
    Field("high", "top [m]", 0.01, 5.0, 0.01, "above the floor"),
)
NEW: dict[str, dict[str, Any]] = {
    "stool": {"circle": [0.0, 0.0, 0.2], "z": [0.0, 0.5]},
    "box": {"polygon": [[-0.3, -0.2], [0.3, -0.2], [0.3, 0.2], [-0.3, 0.2]], "z": [0.0, 0.6]},
    "hanging shelf": {
        "polygon": [[-0.4, -0.2], [0.4, -0.2], [0.4, 0.2], [-0.4, 0.2]],
        "z": [1.1, 1.4],
    },
}
"""Things that can be put into the scene, about their middle."""

NONE = "(none)"


class WallsPanel:
    """The short form's numbers and the margin."""

    def __init__(self, gui: GuiApi, state: SceneState, apply: Callable[[Changes], None]) -> None:
        """Add the fields of the scene's short form.

        Args:
            gui: The page.
            state: Says which short form it is; that never changes.
            apply: Called with the changes to the document.
        """
        self._apply = apply
        self._form = state.form
        self._shown: dict[str, float] = {}
        fields = WALLS.get(self._form, ())
        if not fields:
            which = "a map" if self._form == "map" else "the scene file"
            gui.add_html(answer(f"The walls are those of {which}.", good=True))
        self.fields = FieldGroup(gui, (*fields, *MARGIN), self._changed)

    def show(self, state: SceneState) -> None:
        """Show the numbers of a state."""
        self._shown = {}
        values: dict[str, float] = {"margin": float(state.document.get("margin", 0.02))}
        if self._form in WALLS:
            entry = state.document[self._form]
            room = entry.get("room") or _DEFAULTS["room"]
            for field in WALLS[self._form]:
                value = entry.get(field.name)
                if field.name == "room_width":
                    value = room[0]
                elif field.name == "room_depth":
                    value = room[1]
                elif field.name == "width_after" and value is None:
                    value = entry["width"]
                values[field.name] = float(_DEFAULTS[field.name] if value is None else value)
        self.fields.show(values)
        self._shown = self.fields.values

    def _changed(self, event: Any) -> None:
        if not self._shown or event.client is None:
            return
        now = self.fields.values
        changed = {name for name, value in now.items() if value != self._shown[name]}
        if not changed:
            return
        changes: dict[tuple[Step, ...], Any] = {}
        for name in changed:
            if name == "margin":
                changes["margin",] = now[name]
            elif name in ("room_width", "room_depth"):
                changes[self._form, "room"] = [now["room_width"], now["room_depth"]]
            else:
                changes[self._form, name] = now[name]
        self._shown = now
        self._apply(changes)


class EndPanel:
    """Start or goal."""

    def __init__(self, gui: GuiApi, name: str, apply: Callable[[Changes], None]) -> None:
        """Add the fields of `start` or `goal`."""
        self._name = name
        self._apply = apply
        self._shown: dict[str, float] = {}
        self.fields = FieldGroup(gui, POSE, self._changed)

    def show(self, state: SceneState) -> None:
        """Show the pose of a state."""
        self._shown = {}
        self.fields.show(state.pose(self._name))
        self._shown = self.fields.values

    def _changed(self, event: Any) -> None:
        if not self._shown or event.client is None or self.fields.values == self._shown:
            return
        self._shown = self.fields.values
        self._apply(pose_changes(self._name, self._shown))


class ThingsPanel:
    """Furniture and what hangs: chosen by name, moved, raised, added, taken away."""

    def __init__(self, gui: GuiApi, apply: Callable[[Changes], None]) -> None:
        """Add the choice and the fields."""
        self._apply = apply
        self._shown: dict[str, float] = {}
        self._state: SceneState | None = None
        self.choice: Any = gui.add_dropdown("thing", (NONE,), hint="Or drag it where you want it")
        self.choice.on_update(self._chosen)
        self.fields = FieldGroup(gui, THING, self._changed)
        gui.add_button("Take it away").on_click(self._removed)
        self.kind = gui.add_dropdown("new", tuple(NEW))
        gui.add_button("Put it in").on_click(self._added)

    @property
    def index(self) -> int | None:
        """Index in `world.solids` of the thing that is chosen."""
        head = str(self.choice.value).split(".")[0]
        return int(head) - 1 if head.isdigit() else None

    def show(self, state: SceneState) -> None:
        """Show the things of a state."""
        self._shown, self._state = {}, state
        names = [f"{k + 1}. {_name(entry, k)}" for k, entry in enumerate(state.listed_solids)]
        before = self.choice.value
        options = (*names, NONE) if names else (NONE,)
        if tuple(self.choice.options) != options:
            self.choice.options = options
            self.choice.value = before if before in options and before != NONE else options[0]
        index = self.index
        self.fields.enable(on=index is not None)
        if index is not None and index < len(state.listed_solids):
            entry = state.listed_solids[index]
            x, y = _middle(entry)
            low, high = entry.get("z") or (0.0, 2.5)
            self.fields.show({"x": x, "y": y, "low": float(low), "high": float(high)})
            self._shown = self.fields.values

    def _chosen(self, event: Any) -> None:
        if event.client is not None and self._state is not None:
            self.show(self._state)

    def _changed(self, event: Any) -> None:
        index, now = self.index, self.fields.values
        if not self._shown or event.client is None or self._state is None or index is None:
            return
        if now == self._shown:
            return
        changes: dict[tuple[Step, ...], Any] = {}
        moved = np.array([now["x"] - self._shown["x"], now["y"] - self._shown["y"]])
        if moved.any():
            changes |= moved_thing(self._state, index, moved)
        if (now["low"], now["high"]) != (self._shown["low"], self._shown["high"]):
            changes["world", "solids", index, "z"] = [now["low"], now["high"]]
        self._shown = now
        self._apply(changes)

    def _removed(self, event: Any) -> None:
        index = self.index
        if index is not None:
            self._apply({("world", "solids", index): None})

    def _added(self, event: Any) -> None:
        if self._state is None:
            return
        kind = str(self.kind.value)
        entry = dict(NEW[kind])
        at = np.array([self._state.pose("goal")[name] for name in ("x", "y")])
        at = 0.5 * (at + [self._state.pose("start")[name] for name in ("x", "y")])
        count = len(self._state.listed_solids)
        entry = moved_entry(entry, at) | {"name": f"{kind} {count + 1}"}
        world = self._state.document.get("world") or {}
        solids = [*world.get("solids", []), entry]
        self._apply({("world",): {**world, "solids": solids}})


def pose_changes(name: str, pose: Mapping[str, float]) -> dict[tuple[Step, ...], Any]:
    """Return the changes that move `start` or `goal`, tolerances kept."""
    return {(name, key): rounded_number(value) for key, value in pose.items()}


def moved_thing(state: SceneState, index: int, by: Any) -> dict[tuple[Step, ...], Any]:
    """Return the changes that move an entry of `world.solids` by a step (2,), [m]."""
    entry = moved_entry(state.listed_solids[index], by)
    return {("world", "solids", index): entry}


def moved_entry(entry: Mapping[str, Any], by: Any) -> dict[str, Any]:
    """Return an entry of a solid moved by a step (2,), [m]; to whole tenths of a millimetre."""
    dx, dy = (float(value) for value in by)

    def there(point: Any) -> list[float]:
        return [rounded_number(point[0] + dx), rounded_number(point[1] + dy)]

    moved = dict(entry)
    if moved.get("circle") is not None:
        moved["circle"] = [*there(entry["circle"]), entry["circle"][2]]
    if moved.get("polygon") is not None:
        moved["polygon"] = [there(corner) for corner in entry["polygon"]]
    if moved.get("holes") is not None:
        moved["holes"] = [[there(corner) for corner in hole] for hole in entry["holes"]]
    return moved


def _middle(entry: Mapping[str, Any]) -> tuple[float, float]:
    if entry.get("circle") is not None:
        return float(entry["circle"][0]), float(entry["circle"][1])
    middle = shapely.MultiPoint(entry["polygon"]).envelope.centroid
    return float(middle.x), float(middle.y)


def _name(entry: Mapping[str, Any], index: int) -> str:
    kind = "circle" if entry.get("circle") is not None else "wall"
    return str(entry.get("name") or f"{kind} {index + 1}")
