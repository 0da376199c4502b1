"""Paths of lines and arcs: a turn joined to a start and a goal that stand off its lines."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ..path import Path
from ..se2 import Array, rotate, wrap
from ..twist_section import TwistSection
from .corridor_turn import TurnArc

_SHORTEST = 1e-7  # m: pieces below it are left out
_ALIGNED = (1e-6, 1e-7)  # m, rad: a pose this near a line is on it
_GENTLEST = 60.0  # m: radius of the gentlest S that is looked at
_RADII = 160

Piece = tuple[float, float]
"""Length [m] and curvature [1/m] of a line or an arc."""


@dataclass(frozen=True, eq=False)
class CornerFrame:
    """Where a corner's frame lies in the world; right turns are mirrored into left ones.

    Attributes:
        origin: The inner corner, shape (2,), [m].
        heading: Of travel along the first leg [rad].
        side: +1 for a left turn, -1 for a right one.
    """

    origin: Array
    heading: float
    side: int

    def pose_in_frame(self, pose: Array) -> tuple[float, float, float]:
        """Return a pose of the world in the corner's frame, its heading wrapped."""
        x, y = rotate(-self.heading, pose[:2] - self.origin)
        angle = float(wrap(pose[2] - self.heading))
        return float(x), self.side * float(y), self.side * angle

    def point_in_world(self, point: tuple[float, float]) -> Array:
        """Return a point of the corner's frame in the world, shape (2,), [m]."""
        return np.asarray(self.origin + rotate(self.heading, [point[0], self.side * point[1]]))

    def pose_in_world(self, x: float, y: float, heading: float) -> Array:
        """Return a pose of the corner's frame in the world, shape (3,)."""
        x_world, y_world = self.point_in_world((x, y))
        return np.array([x_world, y_world, self.heading + self.side * heading])


def leg_pose(pose: tuple[float, float, float], turn: float) -> tuple[float, float, float]:
    """Return a pose of the corner's frame in that of the second leg: along, left, heading."""
    along, left = rotate(-turn, pose[:2])
    return float(along), float(left), float(wrap(pose[2] - turn))


def align(
    left: float, heading: float, line: float, available: float, least_radius: float
) -> list[Piece] | None:
    """Return pieces from a pose onto a line ahead, or None if the way is too short.

    Two arcs of equal radius rho, the first turning to sigma alpha, the second back to the line:
    cos(alpha) = (cos(heading) + 1 - sigma (line - left) / rho) / 2, and the way along the line is
    sigma rho (2 sin(sigma alpha) - sin(heading)). The gentlest that fits is taken, the rest is
    straight.

    Args:
        left: Of the pose, across the line of travel [m].
        heading: Of the pose from the line's direction [rad].
        line: Of the line, across [m].
        available: Way along the line [m].
        least_radius: Of both arcs [m].
    """
    if available < -_SHORTEST:
        return None
    step = line - left
    if abs(step) < _ALIGNED[0] and abs(heading) < _ALIGNED[1]:
        return [(max(available, 0.0), 0.0)]
    radius = np.geomspace(max(least_radius, 0.05), _GENTLEST, _RADII)
    best: tuple[float, float, float, float] | None = None  # radius, sigma, alpha, way
    for sigma in (1.0, -1.0):
        cosine = 0.5 * (math.cos(heading) + 1.0 - sigma * step / radius)
        alpha = sigma * np.arccos(np.clip(cosine, -1.0, 1.0))
        way = sigma * radius * (2.0 * np.sin(alpha) - math.sin(heading))
        fits = (np.abs(cosine) <= 1.0) & (sigma * (alpha - heading) >= 0.0)
        fits &= (way >= 0.0) & (way <= available) & (np.abs(alpha) < 1.2)
        if fits.any():
            k = int(np.flatnonzero(fits)[-1])
            if best is None or radius[k] > best[0]:
                best = (float(radius[k]), sigma, float(alpha[k]), float(way[k]))
    if best is None:
        return None
    rho, sigma, alpha_end, used = best
    return [
        (rho * abs(alpha_end - heading), sigma / rho),
        (rho * abs(alpha_end), -sigma / rho),
        (available - used, 0.0),
    ]


def turn_pieces(
    arc: TurnArc,
    start: tuple[float, float, float],
    goal: tuple[float, float, float],
    least_radius: float,
    *,
    share: float = 1.0,
    straight: float = 0.0,
) -> list[Piece] | str:
    """Return the pieces of a path start - line - arc - line - goal, or what is too short.

    Args:
        arc: The turn.
        start: In the corner's frame.
        goal: In the corner's frame.
        least_radius: Of the arcs that align [m].
        share: Of each leg that aligning may take.
        straight: Way after the turn that is driven straight, to be out of a door [m].
    """
    centre_x, centre_y = arc.centre
    room = centre_x - start[0]
    end = leg_pose(goal, arc.turn)
    room_after = end[0] - (centre_x * math.cos(arc.turn) + centre_y * math.sin(arc.turn))
    for way, what in ((room, "start"), (room_after, "goal")):
        if way < -_SHORTEST:
            return (
                f"the {what} is {-1e3 * way:.0f} mm too near to the corner: the drive axle has to "
                f"{'begin' if what == 'start' else 'end'} the turn before it"
            )
    line_before = arc.behind_before - arc.radius
    line_after = arc.radius - arc.behind_after  # to the right of the inner wall
    before = align(start[1], start[2], line_before, share * room, least_radius)
    # Seen from the goal, driving backwards in the mirror, curvatures are the same.
    bend = max(share * (room_after - straight), 0.0)
    after = align(end[1], -end[2], -line_after, bend, least_radius)
    if before is None or after is None:
        which = "start" if before is None else "goal"
        return (
            f"the {which} is too near to the corner to reach the turn's line from where it stands"
        )
    rest = [((1.0 - share) * room, 0.0)], [(room_after - bend, 0.0)]
    turn = [(arc.radius * arc.turn, 1.0 / arc.radius)]
    return [*before, *rest[0], *turn, *rest[1], *reversed(after)]


def path_of(start: Array, pieces: list[Piece], side: int = 1, *, in_one: bool = False) -> Path:
    """Return the path of pieces from a pose; every piece a section, neighbours alike joined.

    Args:
        start: Pose, shape (3,).
        pieces: Lengths and curvatures, left positive for side 1.
        side: +1, or -1 to drive the mirror image.
        in_one: All in one section, quicker to make; for who does not time it.
    """
    merged: list[Piece] = []
    for length, bend in pieces:
        if length <= _SHORTEST:
            continue
        if merged and merged[-1][1] == bend:
            merged[-1] = (merged[-1][0] + length, bend)
        else:
            merged.append((length, bend))
    x, y, heading = (float(value) for value in start)
    poses = [(x, y, heading)]
    for length, bend in merged:
        half = 0.5 * side * bend * length
        chord = length * (math.sin(half) / half if half else 1.0)
        x += chord * math.cos(heading + half)
        y += chord * math.sin(heading + half)
        heading += 2.0 * half
        poses.append((x, y, heading))
    if in_one:
        return Path((TwistSection(np.array(poses)),))
    return Path(tuple(TwistSection(np.array(pair)) for pair in pairwise(poses)))
