"""`narrows plan`: a certified trajectory through a scene, or why there is none."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..files import check_can_be_written
from ..interfaces import Plan, PlanStatus
from ..scene import Scene, load_scene
from .outcome import IMPASSABLE, NOT_FOUND, OK, Outcome, lines, millimetres

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_CODES = {
    PlanStatus.CERTIFIED: OK,
    PlanStatus.IMPASSABLE: IMPASSABLE,
    PlanStatus.NOT_FOUND: NOT_FOUND,
}


@dataclass(frozen=True)
class PlanFiles:
    """Where a plan goes; None: nowhere.

    Attributes:
        output: The trajectory, .csv or .json.
        picture: .png or .svg.
    """

    output: str | None = None
    picture: str | None = None

    def check(self) -> None:
        """Say early that one of them cannot be written."""
        from ..formats import check_suffix

        if self.output is not None:
            check_suffix(self.output)
            check_can_be_written(self.output)
        check_picture(self.picture)

    def write(self, scene: Scene, plan: Plan, draw: Callable[[], Figure]) -> tuple[str, list[str]]:
        """Write the trajectory if it is certified, and the picture in any case.

        Args:
            scene: What was planned for.
            plan: The outcome.
            draw: Returns the picture.

        Returns:
            A line that names what was written, empty if nothing was; and notes.
        """
        from ..formats import write_trajectory

        written, notes = [], []
        if self.output is not None and plan.trajectory is not None:
            write_trajectory(plan.trajectory, self.output, vehicle=scene.vehicle)
            written.append(self.output)
        elif self.output is not None:
            notes.append(f"nothing was written to {self.output}: only certified plans are")
        if self.picture is not None:
            from ..viewer.pictures import save_picture

            save_picture(draw(), self.picture)
            written.append(self.picture)
        return lines(("written", ", ".join(written))) if written else "", notes


def run_plan(scene_file: str, *, planner: str, files: PlanFiles) -> Outcome:
    """Plan a scene; write the trajectory if it is certified, and the picture in any case."""
    files.check()
    scene = load_scene(scene_file)
    from ..planners import plan  # after reading: a mistake in the scene is told at once

    result = plan(scene, planner=planner)

    def draw() -> Figure:
        from ..viewer.pictures import plan_picture

        return plan_picture(scene, result)

    written, notes = files.write(scene, result, draw)
    text = lines(describe_plan(scene, result), written)
    return Outcome(exit_code(result), plan_fields(scene, result), text, tuple(notes))


def check_picture(picture: str | None) -> None:
    """Say early that a picture cannot be written; without importing what draws it."""
    if picture is not None:
        from ..viewer.picture_files import check_picture_suffix

        check_picture_suffix(picture)
        check_can_be_written(picture)


def exit_code(plan: Plan) -> int:
    """Return the exit code of a plan."""
    return _CODES[plan.status]


def plan_fields(scene: Scene, plan: Plan) -> dict[str, object]:
    """Return the figures of `narrows plan --json`; null where there is no trajectory."""
    from ..limit_check import check_limits

    fields: dict[str, object] = {"status": plan.status.value, "planner": plan.planner}
    trajectory, certificate = plan.trajectory, plan.certificate
    names = (
        "clearance_m",
        "length_m",
        "duration_s",
        "max_curvature_1_m",
        "direction_changes",
        "peak_jerk_m_s3",
    )
    fields |= dict.fromkeys(names)
    if trajectory is not None and certificate is not None:
        path = trajectory.path
        fields |= {
            "clearance_m": certificate.clearance,
            "length_m": path.length,
            "duration_s": trajectory.duration,
            "max_curvature_1_m": path.max_curvature,
            "direction_changes": path.direction_changes,
            "peak_jerk_m_s3": check_limits(trajectory, scene.vehicle).peaks["jerk"],
        }
    fields["solve_time_s"] = plan.statistics.get("solve_time_s")
    fields["reason"] = plan.reason
    return fields


def describe_plan(scene: Scene, plan: Plan) -> str:
    """Return a plan for people."""
    status = plan.status.value.replace("_", " ")
    head = f"{scene.name or 'scene'}: {status} ({plan.planner})"
    if plan.trajectory is None or plan.certificate is None:
        return lines(head, f"  {plan.reason}")
    path = plan.trajectory.path
    changes = path.direction_changes
    return lines(
        head,
        f"  {plan.reason}",
        ("proven clearance", millimetres(plan.certificate.clearance)),
        ("length", f"{path.length:.2f} m in {plan.trajectory.duration:.1f} s"),
        ("greatest curvature", f"{path.max_curvature:.2f} 1/m"),
        ("changes of direction", f"{changes}"),
    )
