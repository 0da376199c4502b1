"""What the page asks for: the same functions as the command line, each run in a job's process."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from narrows.clearance import clearance_at
from narrows.interfaces import Plan
from narrows.scene import Scene, read_scene
from narrows.se2 import Array

from .page_report import Report, Work

if TYPE_CHECKING:
    from narrows.planners.passage import Verdict
    from narrows.simulation.judge import Judgement
    from narrows.simulation.record import Record
    from narrows.trajectory import Trajectory

    from .page_controllers import Protected
    from .page_senses import Moment

WARM_SCENE = """
vehicle: {preset: narrow-arcs, limits: {curvature: 2.5, reverse_speed: 0}}
doorway: {corridor_width: 1.6, door_width: 0.9}
"""
"""What the forge plans once, so that everything is built when somebody asks."""


@dataclass(frozen=True, eq=False)
class Drive:
    """What came of a drive.

    Attributes:
        plan: What was planned, if anything; not certified: a tracker drove nothing.
        record: The drive, or None.
        judgement: What is true of it, or None.
        clearance: Distance to the nearest solid at each row of the record, (N,), [m].
        moments: What was known on the way, for those who drive by what they perceive.
        who: Who drove.
        protected: Safety regions computed for it, for the next drive of the same chair.
        reference: What a controller was to keep to, or None.
    """

    plan: Plan | None
    record: Record | None = None
    judgement: Judgement | None = None
    clearance: Array | None = None
    moments: tuple[Moment, ...] = ()
    who: str = ""
    protected: Protected | None = None
    reference: Trajectory | None = None


def plan_scene(report: Report, scene: Scene) -> Plan:
    """Return the plan of a scene, as `narrows plan` does."""
    from narrows.planners import plan

    return plan(scene)


def pass_scene(report: Report, scene: Scene) -> Verdict:
    """Return whether anything can pass, as `narrows passable` does."""
    from narrows.planners.passage import passable

    return passable(scene)


def drive_scene(report: Report, scene: Scene, plan: Plan | None, tracker: str) -> Drive:
    """Return a drive of a plan, as `narrows drive` does; plans first where there is no plan."""
    from narrows.simulation.judge import judge
    from narrows.simulation.simulator import simulate
    from narrows.tracking.registry import make_tracker

    plan = plan_scene(report, scene) if plan is None else plan
    if plan.trajectory is None:
        return Drive(plan)
    follower = make_tracker(tracker, plan.trajectory, scene.vehicle)
    record = simulate(scene, follower, reference=plan.trajectory, report=report)
    near = distances(scene, record.poses)
    return Drive(plan, record, judge(scene, record), near, who=tracker)


def distances(scene: Scene, poses: Array) -> Array:
    """Return the distance of the body to the nearest solid that stands still, (N,), [m]."""
    if not len(scene.world.solids):
        return np.full(len(poses), np.inf)
    return clearance_at(scene.world, scene.vehicle, poses)[0]


def warm_plan(report: Report) -> None:
    """Build what planning builds once in a process."""
    plan_scene(report, read_scene(WARM_SCENE))


def warm_drive(report: Report) -> None:
    """Build what verdicts, drives and pictures need."""
    import narrows.planners.search
    import narrows.viewer.pictures  # noqa: F401

    scene = read_scene(WARM_SCENE)
    pass_scene(report, scene)
    drive_scene(report, scene, None, "lookahead")


WARM: tuple[Work, ...] = (warm_plan, warm_drive)
"""What a page's job runner is warmed with."""
