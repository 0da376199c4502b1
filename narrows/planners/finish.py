"""The last step of every planner: certify, time, and only then call it a plan."""

from __future__ import annotations

from collections.abc import Mapping

from narrows.clearance import certify
from narrows.errors import ShapeError
from narrows.interfaces import Plan, PlanStatus
from narrows.path import Path
from narrows.scene import Scene
from narrows.se2 import Array, wrap

from .comfort import ride_figures
from .timing import timed_path

CERTIFICATE_TOLERANCE = 2e-4
"""How far below the true clearance a plan's certificate may stay [m]."""

_START_TOLERANCE = (1e-3, 2e-3)  # m, rad: a plan starts where the chair stands, solver rounding


def finished_plan(
    scene: Scene,
    path: Path,
    *,
    planner: str,
    statistics: Mapping[str, float] | None = None,
    note: str = "",
) -> Plan:
    """Return a certified plan of a path, or `not_found` with what is wrong with it.

    The path must start at the scene's start, end within the goal's tolerances, be proven clear
    and inside the bounds, and keep the limits once timed. A clearance below the margin asked for
    is a certified plan whose reason says so.

    Args:
        scene: The scene.
        path: What a planner found.
        planner: The planner's name.
        statistics: Figures of the planner.
        note: A sentence of the planner's, added to the reason.
    """
    figures = dict(statistics or {})

    def refused(reason: str) -> Plan:
        return Plan(PlanStatus.NOT_FOUND, planner, reason, statistics=figures)

    ends = ends_problem(scene, path)
    if ends:
        return refused(ends)
    certificate = certify(scene.world, scene.vehicle, path, tolerance=CERTIFICATE_TOLERANCE)
    if not certificate.is_clear:
        return refused(f"the best path found is not clear: {certificate.reason}")
    try:
        trajectory, check = timed_path(path, scene.vehicle)
    except ShapeError as error:
        return refused(f"the path found is clear but cannot be driven: {error}")
    if not check.kept:
        return refused(f"the path found breaks a limit: {'; '.join(check.violations)}")
    figures |= ride_figures(trajectory, check)
    if scene.world.moving:
        certificate = certify(
            scene.world, scene.vehicle, trajectory, tolerance=CERTIFICATE_TOLERANCE
        )
        if not certificate.is_clear:
            return refused(f"clear of what stands still, but {certificate.reason}")
    reason = certificate.reason
    if certificate.clearance < scene.margin - CERTIFICATE_TOLERANCE:
        reason += f"; the margin of {1e3 * scene.margin:.0f} mm asked for is not kept"
    if note:
        reason += f"; {note}"
    return Plan(
        PlanStatus.CERTIFIED, planner, reason, path, trajectory, certificate, statistics=figures
    )


def ends_problem(scene: Scene, path: Path) -> str:
    """Return what is wrong with a path's ends for a scene, or an empty string."""
    start, goal = path.start, path.goal
    off, turned = _difference(start, scene.start)
    if off > _START_TOLERANCE[0] or turned > _START_TOLERANCE[1]:
        return f"the path starts {1e3 * off:.1f} mm and {turned:.4f} rad off the start"
    off, turned = _difference(goal, scene.goal.pose)
    slack = 1.0 + 1e-6
    if off > scene.goal.position_tolerance * slack or turned > scene.goal.heading_tolerance * slack:
        return f"the path ends {1e3 * off:.1f} mm and {turned:.4f} rad off the goal"
    return ""


def _difference(first: Array, second: Array) -> tuple[float, float]:
    """Return distance [m] and angle [rad] between two poses."""
    step = first - second
    return float((step[0] ** 2 + step[1] ** 2) ** 0.5), abs(float(wrap(step[2])))
