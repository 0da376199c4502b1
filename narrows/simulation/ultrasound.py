"""Ultrasonic ranging: cones that tell how far the nearest echo is, and a ring of sixteen.

[NarrowArcs, Section 5.1]: sixteen sensors of 3 m range on the chair measure C_r and C_n before the
turn. A sensor sends one cone and returns one number, the distance of the nearest surface in it
that sends the sound back; where in the cone it is remains unknown.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..errors import ShapeError
from ..se2 import Array, compose
from ..vehicle import Vehicle
from ..world import World
from .surfaces import checked_pose

_TOGETHER = 0.04  # m: readings of one wall across lie that near to each other
_BESIDE = 0.25  # m: and of the wall beside, the chair askew


@dataclass(frozen=True)
class UltrasoundOptions:
    """What an ultrasonic sensor can do.

    Attributes:
        reach: Greatest distance it measures [m]; without an echo the reading is this.
        half_angle: Half the cone's opening [rad].
        incidence: Smooth walls send the sound back to the sensor up to this angle between the
            ray and the surface's normal [rad]; pi/2: always. Edges always do.
        noise: Standard deviation of a reading [m].
        rays: Rays a cone is looked at with; the middle of a wall between two of them is found
            exactly.
        height: Above the floor [m]: what it can see.
    """

    reach: float = 3.0
    half_angle: float = math.radians(15.0)
    incidence: float = math.radians(30.0)
    noise: float = 0.005
    rays: int = 21
    height: float = 0.4

    def __post_init__(self) -> None:
        """Check the numbers."""
        if not (self.reach > 0.0 and self.noise >= 0.0 and self.rays >= 2):
            raise ShapeError("ultrasound needs a reach > 0, a noise >= 0 and at least 2 rays")
        if not (0.0 < self.half_angle < 0.5 * math.pi and 0.0 < self.incidence <= 0.5 * math.pi):
            raise ShapeError("half_angle and incidence must lie between 0 and a right angle")


def sensor_ring(vehicle: Vehicle, *, per_side: int = 4) -> Array:
    """Return poses of sensors on the chair's sides, looking out, shape (4 per_side, 3).

    In the order front, left, back, right; on each side the first and the last are a tenth of it
    from its ends. Four a side are the paper's sixteen, their places are ours.

    Args:
        vehicle: The chair; its bounding rectangle carries the sensors.
        per_side: Sensors on each side, at least 2.
    """
    if per_side < 2:
        raise ShapeError(f"a side needs at least 2 sensors, got {per_side}")
    rear, front = -vehicle.rear_overhang, vehicle.front_overhang
    half = 0.5 * vehicle.width
    share = np.linspace(0.1, 0.9, per_side)
    across, along = half - 2.0 * half * share, rear + (front - rear) * share
    ones = np.ones(per_side)
    return np.concatenate(
        [
            np.column_stack([front * ones, across, 0.0 * ones]),
            np.column_stack([along, half * ones, 0.5 * math.pi * ones]),
            np.column_stack([rear * ones, across, math.pi * ones]),
            np.column_stack([along, -half * ones, -0.5 * math.pi * ones]),
        ]
    )


def measure_ranges(
    world: World,
    pose: ArrayLike,
    sensors: Array,
    *,
    time: float = 0.0,
    options: UltrasoundOptions | None = None,
    rng: np.random.Generator | None = None,
) -> Array:
    """Return a reading of every sensor, shape (S,), [m].

    Args:
        world: Solids and moving solids; circles are seen as circles.
        pose: True pose of the chair, shape (3,), [m, m, rad].
        sensors: Poses of the sensors on the chair, shape (S, 3), such as `sensor_ring`.
        time: When [s]: moving solids are where they are then.
        options: Default `UltrasoundOptions()`.
        rng: Source of the noise; None: exact readings.

    Raises:
        ShapeError: If the pose, the time or a sensor's pose is not finite, or none.
    """
    options = UltrasoundOptions() if options is None else options
    sensors = np.asarray(sensors, dtype=float)
    if sensors.ndim != 2 or sensors.shape[1] != 3 or not np.isfinite(sensors).all():
        raise ShapeError(f"sensors must be finite poses (S, 3), got {sensors.shape}")
    if not math.isfinite(time):
        raise ShapeError(f"a time must be a finite number [s], got {time}")
    placed = compose(checked_pose(pose), sensors)
    offsets = np.linspace(-options.half_angle, options.half_angle, options.rays)
    heading = placed[:, 2:] + offsets  # (S, R)
    pieces = world.pieces_between(options.height, options.height + 1e-6)
    reading = np.full(len(placed), options.reach)
    flat = pieces.radius == 0.0
    if flat.any():
        begin = pieces.corners[flat].reshape(-1, 2)
        end = np.roll(pieces.corners[flat], -1, axis=1).reshape(-1, 2)
        reading = np.minimum(reading, _echoes(placed, heading, begin, end, options))
    rounds = list(zip(pieces.corners[~flat, 0], pieces.radius[~flat], strict=True))
    for solid in world.moving:
        if solid.z[0] < options.height + 1e-6 and options.height < solid.z[1]:
            rounds.append((solid.position(time), solid.radius))
    for centre, radius in rounds:
        offset = centre - placed[:, :2]
        distance = np.hypot(offset[:, 0], offset[:, 1])
        aside = np.abs(_wrapped(np.arctan2(offset[:, 1], offset[:, 0]) - placed[:, 2]))
        seen = aside <= options.half_angle
        reading = np.where(seen, np.minimum(reading, distance - radius), reading)
    if rng is not None and options.noise > 0.0:
        reading = reading + options.noise * rng.standard_normal(len(reading))
    return np.asarray(np.clip(reading, 0.0, options.reach))


def _echoes(
    placed: Array, heading: Array, begin: Array, end: Array, options: UltrasoundOptions
) -> Array:
    """Return the nearest echo of walls: feet of perpendiculars in the cone, and along its rays."""
    edge = end - begin
    length = np.hypot(edge[:, 0], edge[:, 1])
    begin, edge, length = begin[length > 1e-9], edge[length > 1e-9], length[length > 1e-9]
    normal = np.column_stack([edge[:, 1], -edge[:, 0]]) / length[:, None]  # outward
    rel = begin - placed[:, None, :2]  # (S, E, 2)
    height = -np.einsum("sed,ed->se", rel, normal)  # of the sensor over the wall
    share = -np.einsum("sed,ed->se", rel, edge) / length**2
    toward = np.arctan2(-normal[:, 1], -normal[:, 0])
    in_cone = np.abs(_wrapped(toward - placed[:, 2:])) <= options.half_angle
    foot = np.where(in_cone & (height >= 0.0) & (share >= 0.0) & (share <= 1.0), height, np.inf)
    nearest = foot.min(axis=1)
    direction = np.stack([np.cos(heading), np.sin(heading)], axis=-1)  # (S, R, 2)
    facing = -np.einsum("srd,ed->sre", direction, normal)
    with np.errstate(divide="ignore", invalid="ignore"):
        ray = height[:, None] / facing
        hit = placed[:, None, None, :2] + ray[..., None] * direction[:, :, None]
        along = np.einsum("sred,ed->sre", hit - begin, edge) / length**2
    seen = (facing >= math.cos(options.incidence) - 1e-12) & (facing > 1e-9)
    seen &= (ray >= 0.0) & (along >= 0.0) & (along <= 1.0)
    nearest = np.minimum(nearest, np.where(seen, ray, np.inf).min(axis=(1, 2)))
    corner = np.hypot(rel[..., 0], rel[..., 1])
    aside = np.abs(_wrapped(np.arctan2(rel[..., 1], rel[..., 0]) - placed[:, 2:]))
    edges = np.where(aside <= options.half_angle, corner, np.inf).min(axis=1)
    return np.asarray(np.minimum(nearest, edges))


@dataclass(frozen=True)
class CornerReading:
    """Where a chair stands before a corner, from its own sensors.

    Attributes:
        side_gap: C_r, from the inner side at the drive axle to the inner wall [m].
        axle_gap: C_n, from the drive axle to the inner wall's line behind the turn [m].
        heading: From the direction of the corridor, left positive [rad].
    """

    side_gap: float
    axle_gap: float
    heading: float


def read_corner(
    vehicle: Vehicle,
    sensors: Array,
    ranges: Array,
    *,
    width_after: float,
    side: int = 1,
    reach: float = 3.0,
) -> CornerReading:
    """Return C_r, C_n and the heading before a right-angled corner from one set of readings.

    The sensors on the inner side lie at x_i before the axle and read the distance of the inner
    wall, which a cone measures at right angles: a straight line through them gives gap and
    heading. The front sensors read the wall across, W_2 behind the inner wall's line:
    C_n = reading + front overhang - W_2, turned into the corridor's direction; those that see an
    edge first read less and are left out. Side walls must not answer at grazing incidence.

    Args:
        vehicle: The chair.
        sensors: As they were measured with, in `sensor_ring`'s order and frame.
        ranges: Readings, shape (S,), [m].
        width_after: W_2, width of the corridor behind the turn [m].
        side: +1 where the corridor turns left, -1 right.
        reach: Greatest distance the sensors measure [m].

    Raises:
        ShapeError: If the wall beside or the wall across is out of reach.
    """
    looking = _wrapped(sensors[:, 2] - side * 0.5 * math.pi)
    beside, ahead = np.abs(looking) < 1e-6, np.abs(_wrapped(sensors[:, 2])) < 1e-6
    near = beside & (ranges < min(reach, float(ranges[beside].min()) + _BESIDE))
    if near.sum() < 2 or not ahead.any():
        raise ShapeError(
            "fewer than two sensors see the wall beside: drive nearer to it, before the corner"
        )
    slope, at_axle = np.polyfit(sensors[near, 0], ranges[near], 1)
    heading = -side * math.asin(max(-1.0, min(1.0, float(slope))))
    half = 0.5 * vehicle.width
    # A cone reads at right angles to the wall: reading = gap - (half + x tan) in its direction.
    middle = float(at_axle) + half * math.cos(heading)
    place, read = sensors[ahead], ranges[ahead]
    forward = place[:, 0] * math.cos(heading) - place[:, 1] * math.sin(heading)
    across = read + forward  # from the axle to what each sees
    if float(read.max()) >= reach:
        raise ShapeError("the wall across is out of reach: drive nearer to the corner")
    furthest = across[across > across.max() - _TOGETHER]  # nearer echoes are the side walls'
    return CornerReading(middle - half, float(furthest.mean()) - width_after, heading)


def _wrapped(angle: Array) -> Array:
    return np.asarray(np.remainder(angle + math.pi, 2.0 * math.pi) - math.pi)
