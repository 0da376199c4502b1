"""One arc round the corner where a corridor turns: any angle, any widths, any overhangs.

The corner's frame: origin in the inner corner, x along the first leg, a left turn. With u(phi) the
direction from the arc's centre O to the drive axle and p the inner corner seen from O,

    a_1 = p.u(0) and a_2 = p.u(turn) say how far O lies behind the inner walls' lines, and

    outer wall before the turn   W_1 + a_1 - max over phi in [0, turn] of R cos(phi) + b sin(phi)
    outer wall after the turn    W_2 + a_2 - max over phi in [0, turn] of R cos(phi) + f sin(phi)
    inner corner and walls       r - max over phi in [0, turn] of p.u(phi)

are the clearances of the whole motion line - arc - line, exact for a rectangle: the rear overhang
b swings towards the first outer wall, the front overhang f meets the second. The last maximum is
|p| where p points between u(0) and u(turn), else the greater of a_1 and a_2. All three are
concave in (R, a_1, a_2): the radii with at least some clearance are an interval, the best is one.
[NarrowArcs, Section 3.1] is turn = 90 degrees, W_1 = W_2 = L, b = 0 and a_1 = a_2; letting a_1 and
a_2 differ needs less room wherever the overhangs differ.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..errors import ShapeError
from ..se2 import Array
from .arc_geometry import ArcBody

_GRID = 48  # radii looked at together
_ZOOMS = 4  # each narrows the range 24-fold
_BISECTIONS = 50


@dataclass(frozen=True)
class Corner:
    """Where a corridor turns.

    Attributes:
        before: Width of the leg before the turn [m].
        after: Width of the leg behind it [m].
        turn: Angle turned, 0 < turn < pi, [rad]; a right turn is a left one in the mirror.
    """

    before: float
    after: float
    turn: float = 0.5 * math.pi

    def __post_init__(self) -> None:
        """Check the numbers."""
        if not (min(self.before, self.after) > 0.0 and 0.0 < self.turn < math.pi):
            raise ShapeError(
                f"a corner needs positive widths and an angle between 0 and pi, got "
                f"{self.before}, {self.after}, {self.turn}"
            )


@dataclass(frozen=True)
class TurnArc:
    """An arc of the drive axle's middle, in the corner's frame.

    Attributes:
        radius: Of the drive axle's middle [m].
        behind_before: a_1, how far its centre lies behind the inner wall before the turn [m].
        behind_after: a_2, the same for the inner wall after the turn [m].
        turn: Angle turned [rad].
        clearance: Least distance between the body's rectangle and walls or corner [m].
    """

    radius: float
    behind_before: float
    behind_after: float
    turn: float
    clearance: float

    @property
    def centre(self) -> tuple[float, float]:
        """Centre of the arc in the corner's frame [m]."""
        x = self.behind_before * math.cos(self.turn) - self.behind_after
        return x / math.sin(self.turn), self.behind_before

    def side_gap(self, width: float) -> float:
        """Return C_r, from the inner side to the inner wall before the turn [m]."""
        return self.radius - 0.5 * width - self.behind_before

    @property
    def axle_gap(self) -> float:
        """C_n, how far before the inner corner, along the leg, the drive axle starts to turn [m].

        For a right angle the distance to the inner wall's line behind it, as in the paper.
        """
        return -self.centre[0]


def outer_reach(overhang: float, outer_radius: Array, turn: float) -> Array:
    """Return how far the outer side's end swings out from the centre, across a leg [m].

    max of R cos(phi) + d sin(phi) over phi in [0, turn]: sqrt(d^2 + R^2) unless the turn is too
    small for the end to get there.
    """
    lead = np.maximum(np.arctan2(overhang, outer_radius) - turn, 0.0)
    return np.asarray(np.hypot(overhang, outer_radius) * np.cos(lead))


def corner_support(before: Array, after: Array, turn: float) -> Array:
    """Return the maximum of p.u(phi) over phi in [0, turn] from a_1 and a_2 [m]."""
    cosine, sine = math.cos(turn), math.sin(turn)
    squared = before**2 + after**2 - 2.0 * cosine * before * after
    between = (before >= after * cosine) & (after >= before * cosine)
    return np.where(between, np.sqrt(np.maximum(squared, 0.0)) / sine, np.maximum(before, after))


def arc_clearance(
    body: ArcBody, corner: Corner, radius: Array, before: Array, after: Array
) -> Array:
    """Return the clearance of arcs, any shape, negative where they hit [m].

    Args:
        body: The chair's rectangle.
        corner: The corner.
        radius: Of the drive axle's middle [m].
        before: a_1 [m].
        after: a_2 [m].
    """
    outer = radius + 0.5 * body.width
    first = corner.before + before - outer_reach(body.rear, outer, corner.turn)
    second = corner.after + after - outer_reach(body.front, outer, corner.turn)
    inner = radius - 0.5 * body.width - corner_support(before, after, corner.turn)
    return np.minimum(np.minimum(first, second), inner)


def uniform_clearance(body: ArcBody, corner: Corner, radius: Array) -> Array:
    """Return the clearance of arcs whose centre makes it greatest: equal on all three [m].

    With k_i = reach_i - W_i the centre is at a_i = k_i + g. Where p points between the walls'
    normals, (k_1+g)^2 + (k_2+g)^2 - 2 cos (k_1+g)(k_2+g) = sin^2 (r - g)^2, a quadratic in g; else
    g = (r - max k_i) / 2.
    """
    outer, inner = radius + 0.5 * body.width, radius - 0.5 * body.width
    first = outer_reach(body.rear, outer, corner.turn) - corner.before
    second = outer_reach(body.front, outer, corner.turn) - corner.after
    cosine, sine = math.cos(corner.turn), math.sin(corner.turn)
    a = (1.0 - cosine) ** 2
    half_b = (first + second) * (1.0 - cosine) + sine**2 * inner
    c = first**2 + second**2 - 2.0 * cosine * first * second - (sine * inner) ** 2
    quadratic = (-half_b + np.sqrt(np.maximum(half_b**2 - a * c, 0.0))) / a
    before, after = first + quadratic, second + quadratic
    between = (before >= after * cosine) & (after >= before * cosine)
    between &= (half_b**2 >= a * c) & (quadratic <= inner)  # squaring adds |p| = g - r
    return np.where(between, quadratic, 0.5 * (inner - np.maximum(first, second)))


def arc_of_radius(body: ArcBody, corner: Corner, radius: float) -> TurnArc:
    """Return the arc of a radius of the drive axle whose centre makes the clearance greatest."""
    rho = np.array(radius)
    clearance = float(uniform_clearance(body, corner, rho))
    outer = rho + 0.5 * body.width
    before = float(outer_reach(body.rear, outer, corner.turn)) - corner.before + clearance
    after = float(outer_reach(body.front, outer, corner.turn)) - corner.after + clearance
    return TurnArc(radius, before, after, corner.turn, clearance)


def arc_between_lines(
    body: ArcBody, corner: Corner, radius: float, offsets: tuple[float, float]
) -> TurnArc:
    """Return the arc of a radius that joins two lines of travel along the legs.

    Args:
        body: The chair's rectangle.
        corner: The corner.
        radius: Of the drive axle's middle [m].
        offsets: Distance of the lines from the inner walls before and after the turn [m].
    """
    before, after = radius - offsets[0], radius - offsets[1]
    values = (np.array(value) for value in (radius, before, after))
    return TurnArc(radius, before, after, corner.turn, float(arc_clearance(body, corner, *values)))


def best_arc(
    body: ArcBody,
    corner: Corner,
    *,
    least_radius: float = 0.0,
    offsets: tuple[float, float] | None = None,
) -> TurnArc:
    """Return the arc with the greatest clearance, negative where none passes.

    Args:
        body: The chair's rectangle.
        corner: The corner.
        least_radius: Of the drive axle's middle [m]; w/2 is the paper's r >= 0, 0 a turn on the
            spot.
        offsets: Lines of travel the arc has to join, see `arc_between_lines`; None: any.
    """
    low, high = least_radius, max(_largest_radius(body, corner), least_radius + 1e-6)
    best = low
    for _ in range(_ZOOMS):
        radii = np.linspace(low, high, _GRID)
        if offsets is None:
            clearance = uniform_clearance(body, corner, radii)
        else:
            clearance = arc_clearance(body, corner, radii, radii - offsets[0], radii - offsets[1])
        k = int(clearance.argmax())
        best = float(radii[k])
        low, high = float(radii[max(k - 1, 0)]), float(radii[min(k + 1, _GRID - 1)])
    if offsets is None:
        return arc_of_radius(body, corner, best)
    return arc_between_lines(body, corner, best, offsets)


def _largest_radius(body: ArcBody, corner: Corner) -> float:
    """Return a radius of the axle beyond which arcs cut the corner or lose clearance [m].

    A strip as wide as the body fits round the corner of the wider leg up to
    R (1 - cos(turn/2)) = W - w cos(turn/2).
    """
    half = math.cos(0.5 * corner.turn)
    outer = (max(corner.before, corner.after) - body.width * half) / (1.0 - half)
    return max(outer - 0.5 * body.width, 0.0)


def radius_interval(
    body: ArcBody, corner: Corner, *, clearance: float = 0.0, least_radius: float = 0.0
) -> tuple[float, float] | None:
    """Return the radii of the drive axle that keep a clearance, all between included, or None.

    For the paper's case and clearance 0 they are r- + w/2 and r+ + w/2, or `least_radius`.
    """
    best = best_arc(body, corner, least_radius=least_radius)
    if best.clearance < clearance:
        return None

    def border(inside: float, outside: float) -> float:
        if arc_of_radius(body, corner, outside).clearance >= clearance:
            return outside
        for _ in range(_BISECTIONS):
            middle = 0.5 * (inside + outside)
            if arc_of_radius(body, corner, middle).clearance >= clearance:
                inside = middle
            else:
                outside = middle
        return inside

    largest = _largest_radius(body, corner)
    return border(best.radius, least_radius), border(best.radius, max(largest, best.radius))


def missing_width(
    body: ArcBody, corner: Corner, *, clearance: float = 0.0, least_radius: float = 0.0
) -> float:
    """Return by how much both legs must be wider for one arc of a clearance [m], or 0.

    The clearance grows by at least half of what both legs are widened by.
    """
    lack = clearance - best_arc(body, corner, least_radius=least_radius).clearance
    if lack <= 0.0:
        return 0.0
    low, high = 0.0, 2.0 * lack + 1e-9
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        wider = Corner(corner.before + middle, corner.after + middle, corner.turn)
        if best_arc(body, wider, least_radius=least_radius).clearance < clearance:
            low = middle
        else:
            high = middle
    return high


def least_corridor(
    body: ArcBody, turn: float = 0.5 * math.pi, *, least_radius: float | None = None
) -> float:
    """Return the narrowest corridor of equal widths a chair turns in with one arc [m].

    Args:
        body: The chair's rectangle.
        turn: Angle of the turn [rad].
        least_radius: Of the drive axle's middle [m]; None: the paper's r >= 0.
    """
    least = 0.5 * body.width if least_radius is None else least_radius
    narrow = Corner(body.width, body.width, turn)
    return body.width + missing_width(body, narrow, least_radius=least)
