"""What can be played: a motion with its times and the curves that belong to it."""

from __future__ import annotations

import math
from bisect import bisect_right
from dataclasses import dataclass

import numpy as np

from narrows.scene import Scene
from narrows.se2 import Array
from narrows.trajectory import Trajectory

from .control_colours import states_told
from .page_senses import Moment
from .page_work import Drive, distances

_ROWS = 240  # of a curve


@dataclass(frozen=True, eq=False)
class Curve:
    """Figures over time.

    Attributes:
        title: What they are, with the unit.
        names: Name of each line.
        values: Shape (N, L) for L lines; NaN where there is nothing to tell.
        most: What is above this is not shown.
        places: Decimals of the figures beside it.
    """

    title: str
    names: tuple[str, ...]
    values: Array
    most: float = math.inf
    places: int = 0


@dataclass(frozen=True, eq=False)
class Motion:
    """A plan or a drive as it is played.

    Attributes:
        name: `plan` or `drive`.
        times: Shape (N,), from 0, [s].
        poses: Shape (N, 3), [m, m, rad].
        curves: What is plotted, rows at `times`.
        fault: Why it must not be taken for a motion that is clear, or empty.
        moments: What was known on the way, by time.
        states: Name of who was in control at each row, shape (N,); empty: always the same.
    """

    name: str
    times: Array
    poses: Array
    curves: tuple[Curve, ...]
    fault: str = ""
    moments: tuple[Moment, ...] = ()
    states: tuple[str, ...] = ()

    @property
    def duration(self) -> float:
        """Time at the end [s]."""
        return float(self.times[-1])

    def moment(self, time: float) -> Moment | None:
        """Return what was known last at a time [s], or None."""
        index = bisect_right(self.moments, time + 1e-9, key=lambda moment: moment.time) - 1
        return self.moments[index] if index >= 0 else None

    def state(self, time: float) -> str:
        """Return who was in control at a time [s], or nothing."""
        if not self.states:
            return ""
        index = int(np.searchsorted(self.times, time + 1e-9, side="right")) - 1
        return self.states[max(index, 0)]

    def pose(self, time: float) -> Array:
        """Return the pose at a time, shape (3,)."""
        return np.array([np.interp(time, self.times, column) for column in self.poses.T])


def planned_motion(scene: Scene, trajectory: Trajectory) -> Motion:
    """Return a certified trajectory as it is played."""
    times = np.linspace(0.0, trajectory.duration, _ROWS)
    poses = trajectory(times)
    curves = (
        _wheels(scene.vehicle.wheel_speeds(trajectory.command(times))),
        _clearance(distances(scene, poses)),
    )
    return Motion("plan", times, poses, curves)


def driven_motion(drive: Drive) -> Motion | None:
    """Return a drive as it is played; None where nothing was driven."""
    record, judgement, clearance = drive.record, drive.judgement, drive.clearance
    if record is None or judgement is None or clearance is None:
        return None
    rows = np.unique(np.linspace(0, len(record.times) - 1, _ROWS).astype(int))
    curves = [_wheels(record.wheel_speeds[rows]), _clearance(clearance[rows])]
    if record.has_reference:
        error = 1e3 * np.abs(record.cross_track[rows])
        curves.append(Curve("tracking error [mm]", ("off the plan",), error[:, None]))
    if "intrusion" in record.signals:
        intrusion = record.signals["intrusion"][rows]
        curves.append(Curve("intrusion", ("of the zone",), intrusion[:, None], places=2))
    fault = "driven with contact" if judgement.collisions else ""
    times, poses = record.times[rows], record.poses[rows]
    states = states_told({name: values[rows] for name, values in record.signals.items()})
    return Motion("drive", times, poses, tuple(curves), fault, drive.moments, states)


def _wheels(speeds: Array) -> Curve:
    return Curve("wheel speeds [m/s]", ("left", "right"), np.asarray(speeds), places=2)


def _clearance(distance: Array) -> Curve:
    shown = np.where(np.isfinite(distance), 1e3 * distance, np.nan)
    return Curve("clearance [mm]", ("nearest solid",), shown[:, None], most=300.0)
