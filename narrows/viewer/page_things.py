"""Furniture and what hangs, on the page: chosen by name, moved, sized, turned, raised, added."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from viser import GuiApi

from .page_fields import Field, FieldGroup, by_hand
from .page_guard import Guard
from .page_places import Changes
from .page_state import SceneState
from .thing_entries import (
    NEW,
    extent,
    middle,
    moved_entry,
    name_of,
    sized_entry,
    turned_entry,
)

THING = (
    Field("x", "x [m]", -1e4, 1e4, 0.05, "its middle"),
    Field("y", "y [m]", -1e4, 1e4, 0.05, "its middle"),
    Field("along_x", "size along x [m]", 0.01, 50.0, 0.05, "from end to end"),
    Field("along_y", "size along y [m]", 0.01, 50.0, 0.05, "from end to end"),
    Field("low", "underside [m]", 0.0, 5.0, 0.01, "above the floor"),
    Field("high", "top [m]", 0.01, 5.0, 0.01, "above the floor"),
)
NONE = "(none)"
_TURN = math.radians(15.0)


class ThingsPanel:
    """The things that the document lists itself, and the fields of the one that is chosen."""

    def __init__(self, gui: GuiApi, guard: Guard, apply: Callable[[Changes], None]) -> None:
        """Add the choice and the fields."""
        self._apply = apply
        self._state: SceneState | None = None
        self.choice: Any = gui.add_dropdown("thing", (NONE,), hint="Or drag it where you want it")
        self.choice.on_update(by_hand(guard(self._chosen)))
        self.fields = FieldGroup(gui, THING, guard(self._changed))
        gui.add_button("Turn it by 15°").on_click(guard(self._turned))
        gui.add_button("Take it away").on_click(guard(self._removed))
        self.kind = gui.add_dropdown("new", tuple(NEW))
        gui.add_button("Put it in").on_click(guard(self._added))

    @property
    def index(self) -> int | None:
        """Index in `world.solids` of the thing that is chosen."""
        head = str(self.choice.value).split(".")[0]
        count = 0 if self._state is None else len(self._state.listed_solids)
        return int(head) - 1 if head.isdecimal() and 0 < int(head) <= count else None

    def show(self, state: SceneState) -> None:
        """Show the things of a state."""
        self._state = state
        names = [f"{k + 1}. {name_of(entry, k)}" for k, entry in enumerate(state.listed_solids)]
        options = tuple(names) if names else (NONE,)
        if tuple(self.choice.options) != options:
            before = self.choice.value
            self.choice.options = options
            self.choice.value = before if before in options else options[-1]
        index = self.index
        self.fields.enable(on=index is not None)
        if index is not None:
            entry = state.listed_solids[index]
            (x, y), (along_x, along_y) = middle(entry), extent(entry)
            low, high = entry.get("z") or (0.0, 2.5)
            sizes = {"along_x": along_x, "along_y": along_y}
            self.fields.show({"x": x, "y": y, **sizes, "low": float(low), "high": float(high)})

    def _chosen(self, event: Any) -> None:
        if self._state is not None:
            self.show(self._state)

    def _changed(self, event: Any) -> None:
        before, changed, index = self.fields.known, self.fields.read(), self.index
        if not changed or self._state is None or index is None:
            return
        now = self.fields.known
        entry = dict(self._state.listed_solids[index])
        if changed & {"along_x", "along_y"} and min(now["along_x"], now["along_y"]) > 0.0:
            entry = sized_entry(entry, (now["along_x"], now["along_y"]))
        if changed & {"x", "y"}:
            entry = moved_entry(entry, (now["x"] - before["x"], now["y"] - before["y"]))
        if changed & {"low", "high"}:
            entry["z"] = [now["low"], now["high"]]
        self._apply({("world", "solids", index): entry})

    def _turned(self, event: Any) -> None:
        index = self.index
        if index is not None and self._state is not None:
            entry = turned_entry(self._state.listed_solids[index], _TURN)
            self._apply({("world", "solids", index): entry})

    def _removed(self, event: Any) -> None:
        index = self.index
        if index is not None:
            self._apply({("world", "solids", index): None})

    def _added(self, event: Any) -> None:
        if self._state is None or str(self.kind.value) not in NEW:
            return
        kind = str(self.kind.value)
        ends = [self._state.pose(name) for name in ("start", "goal")]
        at = np.mean([[end["x"], end["y"]] for end in ends], axis=0)
        count = len(self._state.listed_solids)
        entry = moved_entry(NEW[kind], at) | {"name": f"{kind} {count + 1}"}
        world = self._state.document.get("world") or {}
        self._apply({("world",): {**world, "solids": [*world.get("solids", []), entry]}})
