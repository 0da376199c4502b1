"""Walls, ends and things on the page: their numbers, and where they are dragged to."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import shapely
from viser import GuiApi

from .page_fields import Field, FieldGroup, by_hand, rounded_number
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


class ThingsPanel:
    """Furniture and what hangs: chosen by name, moved, raised, added, taken away."""

    def __init__(self, gui: GuiApi, guard: Guard, apply: Callable[[Changes], None]) -> None:
        """Add the choice and the fields."""
        self._apply = apply
        self._state: SceneState | None = None
        self.choice: Any = gui.add_dropdown("thing", (NONE,), hint="Or drag it where you want it")
        self.choice.on_update(by_hand(guard(self._chosen)))
        self.fields = FieldGroup(gui, THING, guard(self._changed))
        gui.add_button("Take it away").on_click(guard(self._removed))
        self.kind = gui.add_dropdown("new", tuple(NEW))
        gui.add_button("Put it in").on_click(guard(self._added))

    @property
    def index(self) -> int | None:
        """Index in `world.solids` of the thing that is chosen."""
        head = str(self.choice.value).split(".")[0]
        return int(head) - 1 if head.isdigit() else None

    def show(self, state: SceneState) -> None:
        """Show the things of a state."""
        self._state = state
        names = [f"{k + 1}. {_name(entry, k)}" for k, entry in enumerate(state.listed_solids)]
        options = tuple(names) if names else (NONE,)
        if tuple(self.choice.options) != options:
            before = self.choice.value
            self.choice.options = options
            self.choice.value = before if before in options else options[-1]
        index = self.index
        self.fields.enable(on=index is not None)
        if index is not None and index < len(names):
            entry = state.listed_solids[index]
            x, y = _middle(entry)
            low, high = entry.get("z") or (0.0, 2.5)
            self.fields.show({"x": x, "y": y, "low": float(low), "high": float(high)})

    def _chosen(self, event: Any) -> None:
        if self._state is not None:
            self.show(self._state)

    def _changed(self, event: Any) -> None:
        before, changed, index = self.fields.known, self.fields.read(), self.index
        if not changed or self._state is None or index is None:
            return
        now = self.fields.known
        entry = dict(self._state.listed_solids[index])
        if changed & {"x", "y"}:
            entry = moved_entry(entry, (now["x"] - before["x"], now["y"] - before["y"]))
        if changed & {"low", "high"}:
            entry["z"] = [now["low"], now["high"]]
        self._apply({("world", "solids", index): entry})

    def _removed(self, event: Any) -> None:
        index = self.index
        if index is not None:
            self._apply({("world", "solids", index): None})

    def _added(self, event: Any) -> None:
        if self._state is None:
            return
        kind = str(self.kind.value)
        ends = [self._state.pose(name) for name in ("start", "goal")]
        at = np.mean([[end["x"], end["y"]] for end in ends], axis=0)
        count = len(self._state.listed_solids)
        entry = moved_entry(NEW[kind], at) | {"name": f"{kind} {count + 1}"}
        world = self._state.document.get("world") or {}
        self._apply({("world",): {**world, "solids": [*world.get("solids", []), entry]}})


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
