"""Where a chair is while it brakes; compiled."""

from __future__ import annotations

import math

from ..se2 import Array
from .compiled import compiled


@compiled
def braking_poses(
    v: float, omega: float, duration: float, latency: float, castors: float, poses: Array
) -> None:
    """Write poses along a braking manoeuvre that begins at the origin.

    For `latency` the motion goes on as it is; then v falls linearly to zero in `duration`, and
    omega = omega0 (v / v0) max(0, 1 - t / Tc). [DrivingAssistant, Sec. III-B] in words; the
    formula is derived. Half a dozen poses lie on the first phase, the rest on the second, evenly
    in the distance driven.

    Args:
        v: Speed at its beginning [m/s].
        omega: Heading rate at its beginning [rad/s].
        duration: Time of the second phase [s].
        latency: Time of the first [s].
        castors: c = Tc / (Tc + duration): 0, the castors turn straight at once; 1, never.
        poses: Filled with poses, shape (P, 3), P >= 5; the first is the origin, the last the stop.
    """
    count = len(poses)
    before = 2 if count < 9 else 3  # poses after the origin on the first phase
    poses[0] = 0.0
    x, y, heading = 0.0, 0.0, 0.0
    for i in range(1, before + 1):
        step = latency / before
        half = 0.5 * omega * step
        chord = v * step * (math.sin(half) / half if abs(half) > 1e-9 else 1.0)
        x += chord * math.cos(heading + half)
        y += chord * math.sin(heading + half)
        heading += omega * step
        poses[i, 0], poses[i, 1], poses[i, 2] = x, y, heading
    start, after = heading, count - 1 - before
    ratio = math.inf if castors >= 1.0 else castors / (1.0 - castors)  # Tc / duration
    last = 0.0
    for i in range(1, after + 1):
        share = 1.0 - math.sqrt(1.0 - i / after)  # of the duration
        # Gauss's two points integrate the step's smooth curve to far below a millimetre.
        middle, half = 0.5 * (last + share), 0.5 * (share - last)
        for sign in (-1.0, 1.0):
            s = middle + sign * half / math.sqrt(3.0)
            angle = start + omega * duration * _turned(s, ratio)
            weight = half * duration * v * (1.0 - s)
            x += weight * math.cos(angle)
            y += weight * math.sin(angle)
        heading = start + omega * duration * _turned(share, ratio)
        poses[before + i, 0], poses[before + i, 1], poses[before + i, 2] = x, y, heading
        last = share


@compiled
def _turned(s: float, ratio: float) -> float:
    """Return the integral of (1 - s) max(0, 1 - s / ratio) from 0 to s, for s in [0, 1]."""
    if ratio <= 0.0:
        return 0.0
    s = min(s, ratio)
    straight = s - 0.5 * s * s
    return straight - (0.5 * s * s - s * s * s / 3.0) / ratio
