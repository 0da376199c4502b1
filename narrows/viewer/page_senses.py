"""What a controller knew while it drove, moment by moment, as the page draws it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from narrows.interfaces import Percept
from narrows.se2 import Array, transform

if TYPE_CHECKING:
    from narrows.reactive.safety_regions import SafetyRegions
    from narrows.reactive.zone_shape import ZoneShape
    from narrows.simulation.senses import Senses

EVERY = 0.2
"""Time between moments [s]."""

_MOST_POINTS = 1500
_RAYS = 60  # of a scanner


@dataclass(frozen=True, eq=False)
class Moment:
    """What was known at a time.

    Attributes:
        time: When [s].
        points: Points of obstacles, seen or remembered, in the world, shape (N, 3), [m].
        unknown: Places of which nothing was known, in the world, shape (M, 2), [m].
        rays: Beams of the scanners, from the sensor to where they end, in the world, shape
            (R, 2, 3), [m].
        outline: The deformable zone as deformed, or where a braking chair may still get to, in
            the body frame: rings (K, 2), [m]; none for a tracker.
    """

    time: float
    points: Array
    unknown: Array
    rays: Array
    outline: tuple[Array, ...] = ()


Outline = Callable[[Percept], tuple[Array, ...]]


class Watched:
    """Senses whose percepts are taken down every `EVERY` seconds."""

    def __init__(self, senses: Senses) -> None:
        """Watch senses."""
        self._senses = senses
        self.moments: list[Moment] = []
        self.outline: Outline = _no_outline

    def perceive(self, time: float, true_pose: Array, believed_pose: Array) -> Percept:
        """See `narrows.simulation.senses.Senses`."""
        percept = self._senses.perceive(time, true_pose, believed_pose)
        if not self.moments or time >= self.moments[-1].time + EVERY - 1e-9:
            pose = np.asarray(true_pose, dtype=float)
            answers = getattr(self._senses, "answers", {})
            self.moments.append(
                Moment(
                    time,
                    _lifted(pose, percept.points[:: 1 + len(percept.points) // _MOST_POINTS]),
                    transform(pose, percept.unknown[:: 1 + len(percept.unknown) // _MOST_POINTS]),
                    _rays(pose, answers.values()),
                    self.outline(percept),
                )
            )
        return percept


def zone_outline(shape: ZoneShape, speed: float, percept: Percept) -> tuple[Array, ...]:
    """Return the zone at its focus' height, each direction no further than the nearest point."""
    ring = shape.section(speed)
    angle, reach = np.arctan2(ring[:, 1], ring[:, 0]), np.hypot(*ring.T)
    points = percept.points[shape.holds(percept.points, speed)] if len(percept.points) else []
    if len(points):
        rows = np.asarray(points)
        bearing, distance = np.arctan2(rows[:, 1], rows[:, 0]), np.hypot(rows[:, 0], rows[:, 1])
        off = np.abs(np.angle(np.exp(1j * (angle[:, None] - bearing))))
        near = np.where(off < math.radians(3.0), np.maximum(distance - percept.spread, 0.0), np.inf)
        reach = np.minimum(reach, near.min(axis=1))
    return (np.column_stack([reach * np.cos(angle), reach * np.sin(angle)]),)


def region_outline(regions: SafetyRegions, v: float, omega: float) -> tuple[Array, ...]:
    """Return the outline of the cells that a chair braking from a motion may reach."""
    import shapely

    cells = regions.region(v, omega)
    size = regions.options.cell
    x, y = (
        low + size * np.arange(n + 1) for low, n in zip(regions.lower, cells.shape, strict=True)
    )
    boxes = []
    for row in np.flatnonzero(cells.any(axis=1)):
        columns = np.flatnonzero(np.diff(np.concatenate([[0], cells[row].astype(int), [0]])))
        for first, last in zip(columns[::2], columns[1::2], strict=True):
            boxes.append(shapely.box(x[row], y[first], x[row + 1], y[last]))
    area = shapely.union_all(boxes)
    parts = [part for part in shapely.get_parts(area) if part.area > 0.0]
    return tuple(np.array(part.exterior.simplify(size).coords)[:-1] for part in parts)


def _no_outline(percept: Percept) -> tuple[Array, ...]:
    return ()


def _lifted(pose: Array, points: Array) -> Array:
    """Return points of the body frame in the world, (N, 3)."""
    return np.column_stack([transform(pose, points[:, :2]), points[:, 2]])


def _rays(pose: Array, answers: Any) -> Array:
    """Return the beams of laser scans among answers, as segments in the world."""
    found = [np.zeros((0, 2, 3))]
    for answer in answers:
        if hasattr(answer, "free_reach") and hasattr(answer, "mounting"):
            kept = slice(None, None, 1 + len(answer.ranges) // _RAYS)
            reach = np.minimum(answer.free_reach()[kept], 6.0)
            begin = np.broadcast_to(answer.mounting.pose[:2], (len(reach), 2))
            end = begin + reach[:, None] * answer.directions[kept]
            height = np.full(len(reach), answer.mounting.height)
            ends = [np.column_stack([transform(pose, at), height]) for at in (begin, end)]
            found.append(np.stack(ends, axis=1)[reach > 0.0])
    return np.concatenate(found)
