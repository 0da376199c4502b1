"""Bodies thinner than the chair on all sides."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from narrows.errors import ShapeError
from narrows.geometry import offset_polygon
from narrows.se2 import Array
from narrows.vehicle import Layer, Vehicle

_SHARE = 0.8  # of the inradius that a body may lose


class ThinBodies:
    """A vehicle with every side moved inward by any distance up to `thinnest` [m]."""

    def __init__(self, vehicle: Vehicle) -> None:
        """Find out how thin the vehicle can be made."""
        self.thinnest = _SHARE * min(_inradius(layer.polygon) for layer in vehicle.layers)
        self._made = {0.0: vehicle}

    def thinner_by(self, distance: float) -> Vehicle:
        """Return the vehicle with every side moved inward by a distance [m]."""
        if distance not in self._made:
            vehicle = self._made[0.0]
            layers = tuple(
                Layer(offset_polygon(layer.polygon, -distance), layer.z) for layer in vehicle.layers
            )
            self._made[distance] = replace(vehicle, layers=layers)
        return self._made[distance]


def _inradius(polygon: Array) -> float:
    """Return a distance by which every edge can move inward at least [m]."""
    low, high = 0.0, float(np.ptp(polygon, axis=0).min())
    for _ in range(12):
        middle = 0.5 * (low + high)
        try:
            offset_polygon(polygon, -middle)
        except ShapeError:
            high = middle
        else:
            low = middle
    return low
