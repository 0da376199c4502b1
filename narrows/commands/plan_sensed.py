"""`narrows plan --sensed`: a motion planned by what simulated sensors see, judged by the truth."""

from __future__ import annotations

from ..files import check_can_be_written
from ..formats import check_suffix, write_trajectory
from ..scene import load_scene
from ..simulation.sensed_plan import SensedPlan, plan_sensed
from .outcome import Outcome, lines
from .plan import check_picture, describe_plan, exit_code, plan_fields


def run_plan_sensed(
    scene_file: str, *, planner: str, output: str | None, picture: str | None
) -> Outcome:
    """Plan by sensors alone; write the motion if the true world certifies it."""
    if output is not None:
        check_suffix(output)
        check_can_be_written(output)
    check_picture(picture)
    scene = load_scene(scene_file)
    outcome = plan_sensed(scene, planner=planner)
    plan = outcome.plan
    written, notes = [], []
    if output is not None and plan.trajectory is not None:
        write_trajectory(plan.trajectory, output, vehicle=scene.vehicle)
        written.append(output)
    elif output is not None:
        notes.append(f"nothing was written to {output}: only certified plans are")
    if picture is not None:
        from ..viewer.pictures import save_picture
        from ..viewer.sensed_pictures import sensed_figure

        save_picture(sensed_figure(scene, outcome), picture)
        written.append(picture)
    text = lines(describe_plan(scene, plan), ("looks around", _looks(outcome)))
    if written:
        text = lines(text, ("written", ", ".join(written)))
    fields = plan_fields(scene, plan)
    fields |= {"views": len(outcome.views), "replans": outcome.replans}
    return Outcome(exit_code(plan), fields, text, tuple(notes))


def _looks(outcome: SensedPlan) -> str:
    """Return how often the chair looked, and the doors it found."""
    doors = outcome.views[-1].space.doors
    found = ", ".join(f"{door.width:.2f} m" for door in doors)
    return f"{len(outcome.views)}; doors seen: {found or 'none'}"
