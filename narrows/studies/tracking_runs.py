"""One run of the tracking study: a plan, a tracker, a disturbance, and the clearance budget."""

from __future__ import annotations

import math
import time as clocks
from bisect import bisect_left
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from ..errors import StudyError
from ..interfaces import Tracker
from ..path import Path
from ..se2 import Array, transform
from ..simulation.judge import Judgement, judge
from ..simulation.localisation import EncoderOdometry, ExactPose, Localisation, NoisyPose
from ..simulation.plant import CastorFlip, PlantOptions
from ..simulation.record import Record
from ..simulation.simulator import SimulationOptions, simulate
from ..tracking.legs import Leg, legs_of
from ..tracking.registry import DELAY, make_tracker
from .case import Case, Scalar
from .tracking_plans import TrackedPlan, tracked_plan

_REACH = 0.4  # m: how far from the claimed progress the place on the path is looked for
_SLACK_TIME = 30.0  # s: a drive may take this much longer than the plan before it is broken off


@dataclass(frozen=True)
class Disturbance:
    """What goes wrong on a drive, and what the tracker knows of it.

    Attributes:
        plant: The chair.
        localisation: What it believes about its pose.
        delay: Time from command to effect the tracker reckons with [s].
        is_random: Whether drives with other seeds differ.
        plans: The plans it matters on; empty: all.
    """

    plant: PlantOptions = field(default_factory=PlantOptions)
    localisation: Localisation = field(default_factory=ExactPose)
    delay: float = DELAY
    is_random: bool = False
    plans: tuple[str, ...] = ()


def _noise(position: float, degrees: float, memory: float) -> Disturbance:
    pose = NoisyPose(position, math.radians(degrees), memory)
    return Disturbance(localisation=pose, is_random=True)


DISTURBANCES: dict[str, Disturbance] = {
    "nominal": Disturbance(),
    "pose noise 2 cm, 1 deg": _noise(0.02, 1.0, 0.0),
    "pose drift 2 cm, 1 deg": _noise(0.02, 1.0, 1.0),
    "pose drift 5 cm, 2 deg": _noise(0.05, 2.0, 1.0),
    "latency 0.1 s, unknown": Disturbance(PlantOptions(latency=0.1)),
    "latency 0.2 s, known": Disturbance(PlantOptions(latency=0.2), delay=DELAY + 0.2),
    "latency 0.3 s, known": Disturbance(PlantOptions(latency=0.3), delay=DELAY + 0.3),
    "motor lag 0.2 s, unknown": Disturbance(PlantOptions(motor_lag=0.2)),
    "wheel slip 5 %": Disturbance(PlantOptions(slip=0.05), is_random=True),
    "left wheel 3 % small": Disturbance(PlantOptions(left_radius_error=-0.03)),
    "castor flip 5 deg": Disturbance(
        PlantOptions(castor_flip=CastorFlip(math.radians(5.0))), is_random=True, plans=("shunt",)
    ),
    "odometry only": Disturbance(
        PlantOptions(slip=0.01, left_radius_error=0.002),
        localisation=EncoderOdometry(),
        is_random=True,
    ),
}
"""Disturbances by name. Noise is fresh at every reading, drift changes over a second."""


class Stopwatch:
    """A tracker whose steps are timed.

    Attributes:
        times: CPU time of each step [s].
    """

    def __init__(self, tracker: Tracker) -> None:
        """Time a tracker."""
        self._tracker = tracker
        self.times: list[float] = []

    @property
    def progress(self) -> float:
        """See `Tracker`."""
        return self._tracker.progress

    @property
    def finished(self) -> bool:
        """See `Tracker`."""
        return self._tracker.finished

    def step(self, time: float, pose: ArrayLike) -> Array:
        """Return the tracker's command."""
        begun = clocks.thread_time()
        command = self._tracker.step(time, pose)
        self.times.append(clocks.thread_time() - begun)
        return command


def run_case(case: Case, rng: np.random.Generator) -> Mapping[str, Scalar]:
    """Return the results of one drive.

    Args:
        case: `plan`, `tracker`, `disturbance`, `doorbench`.
        rng: Source of the disturbance.
    """
    disturbance = DISTURBANCES.get(str(case["disturbance"]))
    if disturbance is None:
        allowed = ", ".join(DISTURBANCES)
        raise StudyError("no such disturbance", value=str(case["disturbance"]), allowed=allowed)
    plan = tracked_plan(str(case["plan"]), str(case.get("doorbench", "")))
    scene, path = plan.scene, plan.path
    tracker = Stopwatch(
        make_tracker(
            str(case["tracker"]),
            plan.motion,
            scene.vehicle,
            speed=plan.speed,
            delay=disturbance.delay,
        )
    )
    options = SimulationOptions(
        disturbance.plant,
        disturbance.localisation,
        time_limit=4.0 * path.span / plan.speed + _SLACK_TIME,
    )
    record = simulate(scene, tracker, reference=plan.motion, options=options, rng=rng)
    verdict = judge(scene, record)
    cross, heading = np.abs(record.cross_track), np.abs(record.heading_error)
    steps = 1e3 * np.array(tracker.times)
    return {
        "reached": verdict.reached,
        "collisions": len(verdict.contacts),
        "max_cross_mm": 1e3 * float(cross.max()),
        "rms_cross_mm": 1e3 * float(np.sqrt(np.mean(cross**2))),
        "max_heading_deg": math.degrees(float(heading.max())),
        "final_position_mm": 1e3 * verdict.final_position_error,
        "final_heading_deg": math.degrees(verdict.final_heading_error),
        **_clearance_budget(plan, record, verdict, round(options.period / options.step)),
        "peak_wheel_acceleration": verdict.peak_wheel_acceleration,
        "peak_jerk": verdict.peak_jerk,
        "duration_s": verdict.duration,
        "step_ms": float(np.median(steps)),
        "step_p95_ms": float(np.quantile(steps, 0.95)),
    }


def _clearance_budget(
    plan: TrackedPlan, record: Record, verdict: Judgement, every: int
) -> dict[str, Scalar]:
    """Return what becomes of the plan's clearance: tracking and localisation take their share.

    Args:
        plan: The plan driven.
        record: The drive.
        verdict: What was found of it.
        every: Physics steps from one reading of the pose to the next.
    """
    outline = plan.scene.vehicle.outline
    true, believed = record.poses[::every], record.estimates[::every]
    progress = record.progress[::every]
    deviation = body_deviation(plan.path, true, progress, outline)
    tracking = body_deviation(plan.path, believed, progress, outline)
    localisation = _apart(true, believed, outline)
    clear = math.isfinite(plan.clearance)
    budget = plan.clearance - tracking.max() - localisation.max()
    return {
        "plan_clearance_mm": 1e3 * plan.clearance if clear else None,
        "tracking_mm": 1e3 * float(tracking.max()),
        "localisation_mm": 1e3 * float(localisation.max()),
        "deviation_mm": 1e3 * float(deviation.max()),
        "budget_mm": 1e3 * float(budget) if clear else None,
        "driven_clearance_mm": 1e3 * verdict.min_clearance if clear else None,
    }


def _apart(first: Array, second: Array, outline: Array) -> Array:
    """Return the greatest distance between the body's corners at two poses, shape (N,), [m]."""
    gap = transform(first, outline) - transform(second, outline)  # (N, K, 2)
    return np.asarray(np.hypot(gap[..., 0], gap[..., 1]).max(axis=1))


def body_deviation(path: Path, poses: Array, progress: Array, outline: Array) -> Array:
    """Return how far the body is from where the path would have it, shape (N,), [m].

    The greatest distance a corner has moved from the body on the path to the body at the pose,
    the place on the path being the nearest to the body origin (on the spot: the nearest heading)
    of the leg claimed or the one before. Nothing of the body is further from the path's swept area
    than this, so that the clearance driven is at least the plan's less the greatest deviation.

    Args:
        path: The path.
        poses: Poses, shape (N, 3), [m, m, rad].
        progress: Progress claimed at each, shape (N,).
        outline: Corners of the body, shape (K, 2), [m].
    """
    legs = legs_of(path)
    ends = [leg.end for leg in legs]
    least = np.full(len(poses), np.inf)
    for back in (0, 1):
        places = np.empty((len(poses), 3))
        for row, (pose, claimed) in enumerate(zip(poses.tolist(), progress.tolist(), strict=True)):
            index = min(bisect_left(ends, claimed - 1e-9), len(legs) - 1)
            places[row] = _place(legs[max(index - back, 0)], pose, claimed)
        least = np.minimum(least, _apart(poses, places, outline))
    return least


def _place(leg: Leg, pose: list[float], claimed: float) -> tuple[float, float, float]:
    """Return the pose of a leg nearest to a pose, ends included."""
    x, y, heading = pose
    if leg.direction == 0:
        spot_x, spot_y, first = leg.pose(leg.start)
        middle = first + 0.5 * leg.turn
        off = math.remainder(heading - middle, 2.0 * math.pi)
        half = 0.5 * abs(leg.turn)
        return spot_x, spot_y, middle + min(max(off, -half), half)
    near = min(max(claimed, leg.start), leg.end)
    foot = leg.project(x, y, near=near, reach=_REACH)
    return leg.pose(min(max(foot.progress, leg.start), leg.end))
