"""What the chair knew, as layers of the scene: rays, points, unknown places, zone, region."""

from __future__ import annotations

from typing import Any

import numpy as np
from viser import GuiApi, SceneApi

from narrows.se2 import Array

from . import palette
from .page_drawing import rgb
from .page_motion import Motion
from .page_senses import Moment

_LAYERS = {
    "rays": "Beams of the scanners, to where they end",
    "points": "Obstacles as the chair knows them, seen or remembered",
    "unknown": "Places nothing is known of",
    "zone": "The navigator's zone as it is deformed; where a braking chair may still get to",
}
_HEIGHT = 0.05  # m, of what lies on the floor


class Layers:
    """Layers that can be switched on and off, and follow the time."""

    def __init__(self, gui: GuiApi, api: SceneApi) -> None:
        """Add the switches; nothing to show yet."""
        self._api = api
        self._motion: Motion | None = None
        self._drawn: dict[str, list[Any]] = {}
        self._shown: Moment | None = None
        self._folder = gui.add_folder("Layers", visible=False)
        self._boxes: dict[str, Any] = {}
        with self._folder:
            for name, says in _LAYERS.items():
                box = gui.add_checkbox(name, name in ("points", "zone"), hint=says)
                box.on_update(self._switched)
                self._boxes[name] = box

    def load(self, motion: Motion | None) -> None:
        """Take a motion; one without moments has no layers."""
        self._motion, self._shown = motion, None
        self._folder.visible = bool(motion is not None and motion.moments)
        for name in _LAYERS:
            self._remove(name)

    def show(self, at: float) -> None:
        """Show what was known at a time [s]."""
        moment = None if self._motion is None else self._motion.moment(at)
        if moment is not None and moment is not self._shown:
            self._shown = moment
            for name, box in self._boxes.items():
                if box.value:
                    self._draw(name, moment)

    def _switched(self, event: Any) -> None:
        for name, box in self._boxes.items():
            if not box.value:
                self._remove(name)
            elif self._shown is not None:
                self._draw(name, self._shown)

    def _remove(self, name: str) -> None:
        for handle in self._drawn.pop(name, []):
            handle.remove()

    def _draw(self, name: str, moment: Moment) -> None:
        before = self._drawn.pop(name, [])
        drawn: list[Any] = []
        if name == "rays":
            drawn += self._lines("/layers/rays", moment.rays, rgb(palette.SKY), 1.0)
        elif name == "points":
            drawn += self._cloud("/layers/points", moment.points, rgb(palette.RED), 0.04)
        elif name == "unknown":
            places = np.column_stack([moment.unknown, np.full(len(moment.unknown), _HEIGHT)])
            drawn += self._cloud("/layers/unknown", places, rgb(palette.OUTLINE), 0.06)
        elif name == "zone":
            segments = [_ring(ring) for ring in moment.outline]
            rows = np.concatenate([np.zeros((0, 2, 3)), *segments])
            drawn += self._lines("/chair/zone", rows, rgb(palette.ORANGE), 3.0)
        else:
            raise KeyError(name)
        kept = {handle.name for handle in drawn}
        for handle in before:
            if handle.name not in kept:
                handle.remove()
        self._drawn[name] = drawn

    def _lines(
        self, name: str, rows: Array, colour: tuple[int, int, int], width: float
    ) -> list[Any]:
        if not len(rows):
            return []
        return [
            self._api.add_line_segments(
                name, rows.astype(np.float32), colour, thickness=width, thickness_units="screen"
            )
        ]

    def _cloud(
        self, name: str, rows: Array, colour: tuple[int, int, int], size: float
    ) -> list[Any]:
        if not len(rows):
            return []
        return [
            self._api.add_point_cloud(
                name, rows.astype(np.float32), colour, point_size=size, point_shape="circle"
            )
        ]


def _ring(corners: Array) -> Array:
    """Return a closed ring (K, 2) on the floor as segments, (K, 2, 3)."""
    flat = np.column_stack([corners, np.full(len(corners), _HEIGHT)])
    return np.stack([flat, np.roll(flat, -1, axis=0)], axis=1)
