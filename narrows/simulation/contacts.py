"""When a driven chair touched something: on the swept body, between the rows as well as at them."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ..clearance import Certificate, certify, clearance_at
from ..geometry import separation
from ..path import is_repeated
from ..se2 import Array, transform
from ..trajectory import Trajectory
from ..vehicle import Vehicle
from ..world import MovingSolid, World

APART = 0.5
"""Contacts less than this apart count as one [s]: a chair that scrapes along a wall."""

STANDS = 0.005
"""Speed of its fastest point below which a chair stands [m/s]."""

STOOD = 0.5
"""How long a chair has stood before somebody who touches it has walked into it [s]."""


@dataclass(frozen=True)
class Contact:
    """A spell of time in which the body touched something, or could not be proven clear.

    Attributes:
        start: Time of the row before it [s].
        end: Time of the row after it [s].
        reason: What was touched and where, for people.
        while_standing: A moving solid came to the chair, which had stood for `STOOD` before and
            stood until the contact's end, and touched nothing else.
    """

    start: float
    end: float
    reason: str
    while_standing: bool = False


def certify_drive(world: World, vehicle: Vehicle, times: Array, poses: Array) -> Certificate:
    """Return the certificate of a driven motion, constant twist between rows.

    Args:
        world: Solids, bounds, moving solids by the times given.
        vehicle: The body.
        times: Times, shape (N,), N >= 1, increasing, [s].
        poses: True poses, shape (N, 3), [m, m, rad].
    """
    shifted = replace(world, moving=tuple(_later(solid, times[0]) for solid in world.moving))
    if len(times) > 1 and not is_repeated(poses).all():
        return certify(shifted, vehicle, Trajectory.from_samples(times - times[0], poses))
    return _standing(shifted, vehicle, poses[0], float(times[-1] - times[0]))


def contacts(world: World, vehicle: Vehicle, times: Array, poses: Array) -> tuple[Contact, ...]:
    """Return the distinct contacts of a driven motion: maximal spells of touching rows.

    An interval between rows touches unless it is proven clear; touching intervals that follow
    each other, or are less than `APART` apart, are one contact. Leaving the world's bounds
    counts as touching them.

    Args:
        world: Solids, bounds, moving solids.
        vehicle: The body.
        times: Times, shape (N,), increasing, [s].
        poses: True poses, shape (N, 3), [m, m, rad].
    """
    certificate = certify_drive(world, vehicle, times, poses)
    if certificate.is_clear:
        return ()
    if len(times) == 1:
        start = float(times[0])
        walked = _touches_moving_only(world, vehicle, times, poses)
        return (Contact(start, start, certificate.reason, walked),)
    overlaps = clearance_at(world, vehicle, poses)[0] <= 0.0
    overlaps |= _meets_moving(world, vehicle, times, poses)
    touching = overlaps[:-1] | overlaps[1:]
    for first, last in _runs(~touching):
        touching[first:last] = _unclear(world, vehicle, times, poses, first, last)
    stands = _stands(vehicle, times, poses)
    found: list[Contact] = []
    for first, last in _merged(_runs(touching), times):
        rows = slice(first, last + 1)
        part = certify_drive(world, vehicle, times[rows], poses[rows])
        before = int(np.searchsorted(times, times[first] - STOOD))
        walked = bool(stands[before:last].all())
        walked = walked and _touches_moving_only(world, vehicle, times[rows], poses[rows])
        found.append(Contact(float(times[first]), float(times[last]), part.reason, walked))
    return tuple(found)


def _stands(vehicle: Vehicle, times: Array, poses: Array) -> NDArray[np.bool_]:
    """Return in which intervals between rows no point of the body is faster than `STANDS`."""
    step = np.abs(np.diff(poses, axis=0))
    travel = np.hypot(step[:, 0], step[:, 1]) + vehicle.radius * step[:, 2]
    return np.asarray(travel <= STANDS * np.diff(times))


def _meets_moving(world: World, vehicle: Vehicle, times: Array, poses: Array) -> NDArray[np.bool_]:
    """Return at which rows the body overlaps a moving solid, so that nobody need look closer."""
    found = np.zeros(len(times), dtype=bool)
    for solid in world.moving:
        center = np.repeat(solid.position(times)[:, None], 2, axis=1)  # (N, 2, 2)
        for layer in vehicle.layers:
            if solid.z[0] < layer.z[1] and layer.z[0] < solid.z[1]:
                gap = separation(transform(poses, layer.polygon), center).distance
                found |= gap - solid.radius <= 0.0
    return found


def _touches_moving_only(world: World, vehicle: Vehicle, times: Array, poses: Array) -> bool:
    """Return whether without the moving solids nothing is touched."""
    return certify_drive(replace(world, moving=()), vehicle, times, poses).is_clear


def _unclear(
    world: World, vehicle: Vehicle, times: Array, poses: Array, first: int, last: int
) -> NDArray[np.bool_]:
    """Return which intervals between rows first..last are not proven clear, by halving."""
    result = np.zeros(last - first, dtype=bool)
    pending = [(first, last)]
    while pending:
        low, high = pending.pop()
        rows = slice(low, high + 1)
        if certify_drive(world, vehicle, times[rows], poses[rows]).is_clear:
            continue
        if high - low == 1:
            result[low - first] = True
        else:
            middle = (low + high) // 2
            pending += [(low, middle), (middle, high)]
    return result


def _runs(flags: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return the runs of true flags as (first, one past the last)."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(int)))
    return [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def _merged(runs: list[tuple[int, int]], times: Array) -> list[tuple[int, int]]:
    """Return runs with those joined that are less than `APART` apart in time."""
    merged = runs[:1]
    for before, now in pairwise(runs):
        if times[now[0]] - times[before[1]] < APART:
            merged[-1] = (merged[-1][0], now[1])
        else:
            merged.append(now)
    return merged


def _later(solid: MovingSolid, time: float) -> MovingSolid:
    """Return a moving solid as seen by a clock started at a time."""
    return replace(solid, path=solid.path - np.array([time, 0.0, 0.0]))


def _standing(world: World, vehicle: Vehicle, pose: Array, duration: float) -> Certificate:
    """Return the exact clearance of a chair that stands while others move."""
    distance, names = clearance_at(world, vehicle, pose[None])
    least, against = float(distance[0]), names[0]
    for solid in world.moving:
        for layer in vehicle.layers:
            if not (solid.z[0] < layer.z[1] and layer.z[0] < solid.z[1]):
                continue
            inner = solid.path[(solid.path[:, 0] > 0.0) & (solid.path[:, 0] < duration), 0]
            where = solid.position(np.concatenate([[0.0], inner, [duration]]))
            legs = np.stack([where[:-1], where[1:]], axis=1)  # (L, 2, 2)
            body = np.repeat(transform(pose, layer.polygon)[None], len(legs), axis=0)
            gap = float(separation(body, legs).distance.min()) - solid.radius
            if gap < least:
                least, against = gap, solid.name or "a person"
    inside = math.inf
    if world.bounds is not None:
        corners = transform(pose, vehicle.outline)
        low, high = np.array(world.bounds[:2]), np.array(world.bounds[2:])
        inside = float(min((corners - low).min(), (high - corners).min()))
    at = (0.0, float(pose[0]), float(pose[1]))
    return Certificate(least, least, at, against, inside, 0.0)
