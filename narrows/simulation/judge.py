"""The judge of a drive: did it get there, and what did it touch? From the true motion alone."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..scene import Scene
from ..se2 import wrap
from .contacts import Contact, certify_drive, contacts
from .record import Record

STANDS = 0.005
"""Rim speed below which the chair stands [m/s]."""

WINDOW = 0.1
"""Time over which accelerations and jerk are averaged [s]."""


@dataclass(frozen=True)
class Judgement:
    """What is true of a drive.

    Attributes:
        reached: The chair stands within the goal's tolerances and had no collision.
        contacts: All distinct contacts, in the order of time; see `narrows.simulation.contacts`.
        min_clearance: Proven lower bound on the driven body's clearance [m]; infinite where there
            is nothing to touch, negative: depth of an overlap.
        max_cross_track_error: Greatest distance to the reference [m]; None without one.
        rms_cross_track_error: Root of its mean square over time [m]; None without a reference.
        max_heading_error: Greatest heading error [rad]; None without a reference.
        final_position_error: Distance of the last true position to the goal's [m].
        final_heading_error: Angle of the last true heading to the goal's, >= 0, [rad].
        duration: Time driven [s].
        length: Distance travelled [m].
        peak_acceleration: Greatest rate of v by the wheels, averaged over 0.1 s [m/s^2].
        peak_jerk: Greatest rate of that [m/s^3].
        peak_wheel_acceleration: Greatest rate of a wheel's rim speed [m/s^2].
        reason: For people: why it is reached or not.
    """

    reached: bool
    contacts: tuple[Contact, ...]
    min_clearance: float
    max_cross_track_error: float | None
    rms_cross_track_error: float | None
    max_heading_error: float | None
    final_position_error: float
    final_heading_error: float
    duration: float
    length: float
    peak_acceleration: float
    peak_jerk: float
    peak_wheel_acceleration: float
    reason: str

    @property
    def collisions(self) -> tuple[Contact, ...]:
        """The contacts that count: all but those of moving solids with a chair that stood."""
        return tuple(contact for contact in self.contacts if not contact.while_standing)

    @property
    def walked_into(self) -> tuple[Contact, ...]:
        """The contacts of moving solids that walked into the chair while it stood."""
        return tuple(contact for contact in self.contacts if contact.while_standing)

    def figures(self) -> dict[str, bool | int | float | None]:
        """Return the figures of `narrows drive --json`, by its names; no infinite numbers."""
        clearance = self.min_clearance
        return {
            "reached": self.reached,
            "collisions": len(self.collisions),
            "min_clearance_m": clearance if math.isfinite(clearance) else None,
            "max_cross_track_error_m": self.max_cross_track_error,
            "final_position_error_m": self.final_position_error,
            "final_heading_error_deg": math.degrees(self.final_heading_error),
            "duration_s": self.duration,
            "length_m": self.length,
        }


def judge(scene: Scene, record: Record) -> Judgement:
    """Return the judgement of a drive, from its true poses and the scene.

    Args:
        scene: What had to be reached and must not be touched, moving solids by the record's time.
        record: The drive.
    """
    certificate = certify_drive(scene.world, scene.vehicle, record.times, record.poses)
    touched: tuple[Contact, ...] = ()
    if not certificate.is_clear:
        touched = contacts(scene.world, scene.vehicle, record.times, record.poses)
    goal = scene.goal
    last = record.poses[-1]
    position = float(math.hypot(last[0] - goal.pose[0], last[1] - goal.pose[1]))
    heading = abs(float(wrap(last[2] - goal.pose[2])))
    stands = float(np.abs(record.wheel_speeds[-1]).max()) < STANDS
    near = position <= goal.position_tolerance and heading <= goal.heading_tolerance
    acceleration, jerk, wheel = _peaks(record)
    known = record.has_reference
    collided = [contact for contact in touched if not contact.while_standing]
    return Judgement(
        reached=near and stands and not collided,
        contacts=touched,
        min_clearance=certificate.clearance,
        max_cross_track_error=float(np.abs(record.cross_track).max()) if known else None,
        rms_cross_track_error=float(np.sqrt(np.mean(record.cross_track**2))) if known else None,
        max_heading_error=float(np.abs(record.heading_error).max()) if known else None,
        final_position_error=position,
        final_heading_error=heading,
        duration=record.duration,
        length=record.length,
        peak_acceleration=acceleration,
        peak_jerk=jerk,
        peak_wheel_acceleration=wheel,
        reason=_reason(touched, near, stands, position, heading),
    )


def _reason(
    touched: tuple[Contact, ...], near: bool, stands: bool, position: float, heading: float
) -> str:
    collided = [contact for contact in touched if not contact.while_standing]
    if collided:
        first = collided[0]
        return f"{len(collided)} collision(s), the first after {first.start:.2f} s: {first.reason}"
    off = f"{1e3 * position:.0f} mm and {math.degrees(heading):.1f} degrees from the goal"
    walked = len(touched)
    note = f"; somebody walked into the standing chair, {walked} time(s)" if walked else ""
    if not near:
        return f"it ended {off}{note}"
    if not stands:
        return f"it was still moving when time was up, {off}{note}"
    return f"it stands {off}{note}"


def _peaks(record: Record) -> tuple[float, float, float]:
    """Return the greatest acceleration, jerk and wheel acceleration, as means over `WINDOW`.

    Commands are steps every control period; over shorter times their edges would be measured.
    """
    dt = WINDOW / 2.0
    times = np.arange(record.times[0], record.times[-1] + dt, dt)
    left, right = (np.interp(times, record.times, rim) for rim in record.wheel_speeds.T)
    wheels = np.column_stack([left, right])
    rates = (wheels[2:] - wheels[:-2]) / WINDOW
    acceleration = rates.mean(axis=1)
    jerk = (acceleration[2:] - acceleration[:-2]) / WINDOW
    return (
        float(np.abs(acceleration).max(initial=0.0)),
        float(np.abs(jerk).max(initial=0.0)),
        float(np.abs(rates).max(initial=0.0)),
    )
