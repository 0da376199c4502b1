"""How large a map is, how fast it learns and forgets, and which heights it tells apart."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ..errors import InputError
from ..vehicle import Vehicle

_BANDS = (0.025, *(round(0.1 * k, 1) for k in range(1, 17)))


@dataclass(frozen=True)
class MapOptions:
    """Size of the map and how fast it learns and forgets.

    A hit adds `hit` to a cell's certainty, a ray that passes takes `miss`; with the defaults a
    thing seen once is doubted after one scan that sees past it and gone after five, one seen
    often after 13 and 17.

    Attributes:
        side: Edge of the map [m]; the paper's.
        cell: Edge of a cell [m]; the paper does not print it.
        bands: Heights between the bands [m], increasing, at most 32 bands. What is below the
            first is floor, what is above the last is nobody's concern.
        hit: Certainty a hit adds; as much is occupied.
        miss: Certainty a ray that passes takes away.
        most: Greatest certainty, up to 127.
        short: How much before its return a ray stops clearing [m]: error of the sensor and of
            the pose, and the slant of a surface within a cell.
        own: Returns that far inside the chair's body are its own [m].
        deep: That far inside the body nothing can stand: what is there is forgotten [m].
        sensors: Names of the sensors that must speak; empty: those that have spoken.
    """

    side: float = 7.5
    cell: float = 0.025
    bands: tuple[float, ...] = _BANDS
    hit: int = 4
    miss: int = 1
    most: int = 16
    short: float = 0.05
    own: float = 0.02
    deep: float = 0.05
    sensors: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Refuse maps without cells or with too many, and rules that learn nothing."""
        if not (0.0 < self.cell < math.inf and 2.0 * self.cell <= self.side <= 4000.0 * self.cell):
            sizes = f"side {self.side} m, cell {self.cell} m"
            raise InputError("no map", value=sizes, allowed="2 to 4000 cells a side")
        edges = np.array(self.bands, dtype=float)
        increasing = len(edges) >= 2 and np.isfinite(edges).all() and (np.diff(edges) > 0.0).all()
        if not increasing or len(edges) > 33:
            allowed = "2 to 33 increasing heights"
            raise InputError("no bands", field="bands", value=self.bands, allowed=allowed)
        if not 1 <= self.miss <= self.hit <= self.most <= 127:
            rule = f"hit {self.hit}, miss {self.miss}, most {self.most}"
            raise InputError("no rule", value=rule, allowed="1 <= miss <= hit <= most <= 127")
        for name in ("short", "own", "deep"):
            if not 0.0 <= getattr(self, name) < math.inf:
                raise InputError(
                    "not a distance", field=name, value=getattr(self, name), allowed=">= 0 m"
                )

    @property
    def count(self) -> int:
        """Number of cells along a side."""
        return round(self.side / self.cell)


def bands_of(vehicle: Vehicle, *, step: float = 0.1, above: float = 0.3) -> tuple[float, ...]:
    """Return heights of bands that begin and end where the layers of a chair do.

    So a band lies in a layer or outside it, and the middle of a band says which.

    Args:
        vehicle: The chair.
        step: Greatest height of a band [m].
        above: How far above the chair there are bands [m].
    """
    marks = {0.025, vehicle.height + above}
    marks |= {edge for layer in vehicle.layers for edge in layer.z if edge > 0.025}
    edges = sorted(marks)
    rows = [
        np.linspace(a, b, 1 + math.ceil((b - a) / step - 1e-9))[:-1] for a, b in pairwise(edges)
    ]
    return (*np.concatenate(rows).tolist(), edges[-1])
