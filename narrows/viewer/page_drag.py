"""Dragging in the scene: start and goal by their print, their heading by the arrow, things."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from viser import ClientHandle

from narrows.se2 import Array

from .page_drawing import SceneDrawing, turn
from .page_places import Changes, pose_changes
from .page_state import SceneState
from .thing_entries import moved_entry

Apply = Callable[[Changes], None]


class Dragging:
    """Lets handles be dragged on the floor; what they are dragged to becomes a change."""

    def __init__(self, client: ClientHandle, drawing: SceneDrawing, apply: Apply) -> None:
        """Keep where changes go.

        Args:
            client: Whose pointer it is.
            drawing: What is drawn.
            apply: Called with the changes to the document, in a thread.
        """
        self._client = client
        self._drawing = drawing
        self._apply = apply

    def attach(
        self,
        state: SceneState,
        things: Mapping[int, Any],
        people: Mapping[int, Any],
        ends: Mapping[str, Mapping[str, Any]],
    ) -> None:
        """Let what was drawn anew be dragged.

        Args:
            state: What it shows.
            things: Handles of furniture by index of the world's solids.
            people: Handles of those that move by index; their whole way is dragged.
            ends: Handles `frame`, `body` and `arrow` of `start` and `goal`.
        """
        for index, handle in things.items():
            if index >= state.first_thing:
                self._thing(state, "solids", index - state.first_thing, handle)
        for index, handle in people.items():
            self._thing(state, "moving", index, handle)
        for name, handles in ends.items():
            self._body(state, name, handles)
            self._arrow(state, name, handles)

    def _thing(self, state: SceneState, kind: str, index: int, handle: Any) -> None:
        """Let an entry of `world.solids` or `world.moving` be dragged."""
        begin = np.asarray(handle.position, dtype=float)[:2]

        def move(by: Array, *, ended: bool) -> Changes | None:
            handle.position = (*(begin + by).tolist(), 0.0)
            entry = state.document["world"][kind][index]
            return {("world", kind, index): moved_entry(entry, by)} if ended else None

        self._follow(handle, move)

    def _body(self, state: SceneState, name: str, handles: Mapping[str, Any]) -> None:
        pose = state.pose(name)

        def move(by: Array, *, ended: bool) -> Changes | None:
            there = {**pose, "x": pose["x"] + float(by[0]), "y": pose["y"] + float(by[1])}
            handles["frame"].position = (there["x"], there["y"], 0.0)
            if name == "start":
                heading = np.deg2rad(pose["heading_deg"])
                self._drawing.place(np.array([there["x"], there["y"], heading]))
            return pose_changes(name, there) if ended else None

        self._follow(handles["body"], move)

    def _arrow(self, state: SceneState, name: str, handles: Mapping[str, Any]) -> None:
        pose = state.pose(name)
        place = np.array([pose["x"], pose["y"]])

        def look(at: Array, *, ended: bool) -> Changes | None:
            step = at - place
            heading = float(np.round(np.degrees(np.arctan2(step[1], step[0])), 1))
            handles["frame"].wxyz = turn(float(np.deg2rad(heading)))
            if name == "start":
                self._drawing.place(np.array([*place, np.deg2rad(heading)]))
            return pose_changes(name, {**pose, "heading_deg": heading}) if ended else None

        self._follow(handles["arrow"], look, by_place=True)

    def _follow(
        self, handle: Any, move: Callable[..., Changes | None], *, by_place: bool = False
    ) -> None:
        """Call a function with how far (or where) the pointer has dragged on the floor."""
        began: list[Array] = []

        async def dragged(event: Any) -> None:
            height = float(event.start_position[2])
            eye = np.asarray(self._client.camera.position, dtype=float)
            if event.phase == "start":
                began[:] = [on_floor(eye, np.asarray(event.start_position), height)]
            there = on_floor(eye, np.asarray(event.end_position), height)
            if not began or not np.isfinite(there).all():
                return
            ended = event.phase == "end"
            changes = move(there if by_place else there - began[0], ended=ended)
            if changes is not None:
                await asyncio.get_running_loop().run_in_executor(None, self._apply, changes)

        handle.on_drag("left")(dragged)


def on_floor(eye: Array, through: Array, height: float) -> Array:
    """Return where the ray from an eye through a point meets a height, (2,), [m]; NaN: nowhere.

    >>> on_floor(np.array([0.0, 0.0, 2.0]), np.array([1.0, 0.0, 1.0]), 0.0)
    array([2., 0.])
    """
    down = eye[2] - through[2]
    share = (eye[2] - height) / down if down > 1e-6 else np.nan
    if not 0.0 < share < 50.0:  # above the horizon, or so near it that a pixel is metres
        return np.full(2, np.nan)
    return np.asarray((eye + share * (through - eye))[:2])
