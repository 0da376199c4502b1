"""Closed forms of a rectangular chair on circular arcs [NarrowArcs, Sections 2 and 3].

The paper's letters: d is the overhang ahead of the drive axle, w the body's width, r the radius
of the body's inner side, R = r + w of its outer side, R_c = sqrt(d^2 + R^2) of the outer front
corner, L the width of a corridor, D of a door. The drive axle's middle is on the radius r + w/2.
The paper takes d for the length (no rear overhang) and w for the track too; here the overhangs
are apart and the track does not occur. `corridor_turn` and `door_arc` hold what goes beyond it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..errors import ShapeError
from ..vehicle import Vehicle

_ROOT2 = math.sqrt(2.0)


@dataclass(frozen=True)
class ArcBody:
    """The rectangle around a chair's body.

    Attributes:
        front: How far it reaches ahead of the drive axle [m].
        rear: How far it reaches behind it [m].
        width: Its width [m], symmetric about the middle of the drive axle.
    """

    front: float
    rear: float
    width: float

    def __post_init__(self) -> None:
        """Check the numbers."""
        if not (min(self.front, self.rear) >= 0.0 and self.width > 0.0):
            raise ShapeError(
                f"a body on arcs needs overhangs >= 0 and a width > 0, got {self.front}, "
                f"{self.rear}, {self.width}"
            )

    @classmethod
    def of(cls, vehicle: Vehicle) -> ArcBody:
        """Return the smallest rectangle around a chair, symmetric about its x axis."""
        outline = vehicle.outline
        front, rear = max(vehicle.front_overhang, 0.0), max(vehicle.rear_overhang, 0.0)
        return cls(front, rear, 2.0 * float(abs(outline[:, 1]).max()))

    @property
    def overhang(self) -> float:
        """The longer of both overhangs [m]: d of a turn that must fit both ways round."""
        return max(self.front, self.rear)


@dataclass(frozen=True)
class PaperTurn:
    """An arc round the corner of a corridor of equal widths, centre on the bisector.

    Attributes:
        inner_radius: r [m].
        outer_radius: R = r + w [m].
        side_gap: C_r, from the inner side to the inner wall before the turn [m].
        axle_gap: C_n, from the drive axle to the inner wall's line after the turn [m].
        centre: Distance c of the centre from both outer walls [m].
        clearance: Least distance from walls and inner corner while turning [m].
    """

    inner_radius: float
    outer_radius: float
    side_gap: float
    axle_gap: float
    centre: float
    clearance: float


def swept_width(overhang: float, width: float, inner_radius: float) -> float:
    """Return D_s = sqrt(d^2 + R^2) - r, the room a chair takes on an arc [NarrowArcs, Section 2].

    >>> swept_width(1.0, 0.67, 0.0) > swept_width(1.0, 0.67, 10.0) > 0.67
    True

    Args:
        overhang: d, ahead of the axle or behind it, the longer [m].
        width: w [m].
        inner_radius: r [m], >= 0.
    """
    return math.hypot(overhang, inner_radius + width) - inner_radius


def contact_radii(overhang: float, width: float, corridor: float) -> tuple[float, float] | None:
    """Return r- and r+, the inner radii that touch both the corner and the outer walls.

    r+- = (sqrt2 L - 2 w) +- sqrt2 sqrt((sqrt2 L - w)^2 - d^2) [NarrowArcs, Eqs. (3.1.5), (3.1.9)].
    Every r >= 0 between them passes. The paper assigns r+ to d^2 + w^2 < L^2 and r- to the
    opposite; both are ends of the one interval, and where d^2 + w^2 < L^2 its lower end is
    negative, since r- r+ = 2 (d^2 + w^2 - L^2). Its condition (*), d + w <= sqrt2 L, makes the
    roots real and is not sufficient: r+ must be >= 0.

    >>> tuple(round(r, 2) for r in contact_radii(1.0, 0.67, 1.30))
    (-0.36, 1.35)

    Args:
        overhang: d [m].
        width: w [m].
        corridor: L [m].

    Returns:
        (r-, r+) [m], or None where no radius passes.
    """
    inside = (_ROOT2 * corridor - width) ** 2 - overhang**2
    if inside < 0.0 or _ROOT2 * corridor < width:
        return None
    middle, half = _ROOT2 * corridor - 2.0 * width, _ROOT2 * math.sqrt(inside)
    return None if middle + half < 0.0 else (middle - half, middle + half)


def paper_turn(overhang: float, width: float, corridor: float, inner_radius: float) -> PaperTurn:
    """Return the arc of an inner radius with its centre where the clearance is uniform.

    The centre is (c, c) from the outer corner; R_c + g = c and r - g = sqrt2 (c - L) give
    g = (r - sqrt2 (R_c - L)) / (1 + sqrt2). At a contact radius g = 0 and this is the paper's arc:
    C_r = (1 - 1/sqrt2) r, C_n = r / sqrt2 [NarrowArcs, Eqs. (3.1.7), (3.1.8), (3.1.11), (3.1.12)],
    parentheses restored in C_r. In wide corridors the centre comes to lie outside of the inner
    walls (c < L); then the walls along the legs decide: r - g = c - L.

    Args:
        overhang: d [m].
        width: w [m].
        corridor: L [m].
        inner_radius: r [m], >= 0.
    """
    if inner_radius < 0.0:
        raise ShapeError(f"the inner radius must not be negative, got {inner_radius} m")
    reach = math.hypot(overhang, inner_radius + width)
    clearance = (inner_radius - _ROOT2 * (reach - corridor)) / (1.0 + _ROOT2)
    if reach + clearance < corridor:
        clearance = 0.5 * (inner_radius - reach + corridor)
    centre = reach + clearance
    behind = centre - corridor
    return PaperTurn(
        inner_radius, inner_radius + width, inner_radius - behind, behind, centre, clearance
    )


def best_paper_turn(overhang: float, width: float, corridor: float) -> PaperTurn:
    """Return the arc on the bisector with the greatest clearance; beyond the paper.

    r* = d - w with g* = (sqrt2 L - d - w) / (1 + sqrt2) where the centre lies behind the inner
    walls, L <= (1 + sqrt2) d - w; in wider corridors, and where d < w, the corner and the walls
    along the legs decide together: r* = g* = (L^2 - d^2 - w^2) / (2 (L + w)), c = L. (Setting
    r* = 0 for d < w, as is tempting, loses up to half of g*.)

    >>> turn = best_paper_turn(1.0, 0.67, 1.30)
    >>> round(turn.inner_radius, 2), round(turn.clearance, 4)
    (0.33, 0.0698)
    """
    if overhang >= width and corridor <= (1.0 + _ROOT2) * overhang - width:
        return paper_turn(overhang, width, corridor, overhang - width)
    inner = (corridor**2 - overhang**2 - width**2) / (2.0 * (corridor + width))
    return paper_turn(overhang, width, corridor, max(inner, 0.0))


def least_paper_corridor(overhang: float, width: float) -> float:
    """Return the narrowest corridor for one arc r >= 0 with its centre on the bisector [m].

    (d + w) / sqrt2 where d >= w, else sqrt(d^2 + w^2).
    """
    if overhang >= width:
        return (overhang + width) / _ROOT2
    return math.hypot(overhang, width)


def spin_corridor(body: ArcBody) -> float:
    """Return the narrowest L corridor turned in by spinning about the drive axle's middle [m].

    max(r_f, r_b) + w/2 with the distances r_f, r_b of the front and rear corners.
    """
    return max(_corner_distances(body)) + 0.5 * body.width


def rigid_bound(body: ArcBody) -> float:
    """Return a width below which no rigid motion turns round an equal L corridor [m].

    max(w, (length / 2 + w) / sqrt2).
    """
    half_length = 0.5 * (body.front + body.rear)
    return max(body.width, (half_length + body.width) / _ROOT2)


def turning_diameter(body: ArcBody) -> float:
    """Return the diameter of the circle a chair needs to turn on the spot [m].

    A surrogate for what standards measure with an occupant.
    """
    return 2.0 * max(_corner_distances(body))


def pivot_width(body: ArcBody) -> float:
    """Return the width of the aisle in which a chair can turn round on the spot, r_f + r_b [m]."""
    return sum(_corner_distances(body))


def _corner_distances(body: ArcBody) -> tuple[float, float]:
    half = 0.5 * body.width
    return math.hypot(body.front, half), math.hypot(body.rear, half)


def door_radius(overhang: float, width: float, door: float) -> float:
    """Return r of the arc that fills a door, its centre in the plane of the door.

    r = (d^2 + w^2 - D^2) / (2 (D - w)) [NarrowArcs, Eq. (3.2.1)], from R_c - r = D. Where the
    door is wider than the body's diagonal every r passes and 0 is returned, as the paper says
    below Eq. (3.2.5). Its clearance is zero, and what the paper does not say: the corridor before
    the door must be sqrt(b^2 + R^2) wide with the rear overhang b, see `door_arc`.

    >>> round(door_radius(1.0, 0.67, 0.90), 4)
    1.3889

    Raises:
        ShapeError: If the door is not wider than the body [NarrowArcs, Eq. (3.2.5)].
    """
    if door <= width:
        raise ShapeError(f"the door must be wider than the chair's {width} m, got {door} m")
    return max(0.0, (overhang**2 + width**2 - door**2) / (2.0 * (door - width)))


def door_outer_radius(overhang: float, width: float, door: float) -> float:
    """Return R = (d + w - D) (d - w + D) / (2 (D - w)), at least w [NarrowArcs, Eq. (3.2.2)]."""
    if door <= width:
        raise ShapeError(f"the door must be wider than the chair's {width} m, got {door} m")
    product = (overhang + width - door) * (overhang - width + door)
    return max(width, product / (2.0 * (door - width)))
