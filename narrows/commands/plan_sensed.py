"""`narrows plan --sensed`: a motion planned by what simulated sensors see, judged by the truth."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..scene import load_scene
from ..simulation.sensed_plan import SensedPlan, plan_sensed
from .outcome import Outcome, lines
from .plan import PlanFiles, describe_plan, exit_code, plan_fields

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def run_plan_sensed(scene_file: str, *, planner: str, files: PlanFiles) -> Outcome:
    """Plan by sensors alone; write the motion if the true world certifies it."""
    files.check()
    scene = load_scene(scene_file)
    outcome = plan_sensed(scene, planner=planner)

    def draw() -> Figure:
        from ..viewer.sensed_pictures import sensed_figure

        return sensed_figure(scene, outcome)

    written, notes = files.write(scene, outcome.plan, draw)
    text = lines(describe_plan(scene, outcome.plan), ("looks around", _looks(outcome)), written)
    fields = plan_fields(scene, outcome.plan)
    fields |= {"views": len(outcome.views), "replans": outcome.replans}
    return Outcome(exit_code(outcome.plan), fields, text, tuple(notes))


def _looks(outcome: SensedPlan) -> str:
    """Return how often the chair looked, and the doors it found."""
    doors = outcome.views[-1].space.doors
    found = ", ".join(f"{door.width:.2f} m" for door in doors)
    return f"{len(outcome.views)}; doors seen: {found or 'none'}"
