"""What the chair knew, drawn into a scene: rays, points, unknown places, zone or region."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

import numpy as np
from viser import SceneApi

from narrows.se2 import Array

from . import palette
from .page_drawing import rgb
from .page_senses import Moment

LAYERS = {
    "rays": "Beams of the scanners, to where they end",
    "points": "Obstacles as the chair knows them, seen or remembered",
    "unknown": "Places nothing is known of",
    "zone": "The navigator's zone as it is deformed; where a braking chair may still get to",
}
"""Names of the layers, and what each shows."""

_HEIGHT = 0.05  # m, of what lies on the floor


def has_layer(moment: Moment, name: str) -> bool:
    """Return whether a layer has anything to show at a moment."""
    return len(getattr(moment, "outline" if name == "zone" else name)) > 0


class LayerDrawing:
    """Layers in a scene; each is drawn anew for every moment."""

    def __init__(self, api: SceneApi) -> None:
        """Draw into the scene of a page or of a replay; nothing yet."""
        self._api = api
        self._drawn: dict[str, Any] = {}

    def show(self, moment: Moment | None, names: Collection[str]) -> None:
        """Show the layers of these names as they are at a moment, and no others."""
        for name in LAYERS:
            before = self._drawn.pop(name, None)
            after = None if moment is None or name not in names else self._draw(name, moment)
            if after is not None:
                self._drawn[name] = after
            elif before is not None:
                before.remove()

    def _draw(self, name: str, moment: Moment) -> Any:
        """Draw a layer in place of what it was; return its handle, None if there is nothing."""
        if name == "rays":
            return self._lines("/layers/rays", moment.rays, palette.SKY, 1.0)
        if name == "points":
            return self._cloud("/layers/points", moment.points, palette.RED, 0.04)
        if name == "unknown":
            places = np.column_stack([moment.unknown, np.full(len(moment.unknown), _HEIGHT)])
            return self._cloud("/layers/unknown", places, palette.OUTLINE, 0.06)
        if name == "zone":
            rows = [np.zeros((0, 2, 3)), *(_ring(ring) for ring in moment.outline)]
            return self._lines("/chair/zone", np.concatenate(rows), palette.ORANGE, 3.0)
        raise KeyError(name)

    def _lines(self, name: str, rows: Array, colour: str, width: float) -> Any:
        """Add line segments (S, 2, 3) of a width in pixels."""
        if not len(rows):
            return None
        return self._api.add_line_segments(
            name, rows.astype(np.float32), rgb(colour), thickness=width, thickness_units="screen"
        )

    def _cloud(self, name: str, rows: Array, colour: str, size: float) -> Any:
        """Add points (N, 3) of a size [m]."""
        if not len(rows):
            return None
        return self._api.add_point_cloud(
            name, rows.astype(np.float32), rgb(colour), point_size=size, point_shape="circle"
        )


def _ring(corners: Array) -> Array:
    """Return a closed ring (K, 2) on the floor as segments, (K, 2, 3)."""
    flat = np.column_stack([corners, np.full(len(corners), _HEIGHT)])
    return np.stack([flat, np.roll(flat, -1, axis=0)], axis=1)
