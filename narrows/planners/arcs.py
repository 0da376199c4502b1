"""The planner named "arc": one arc round a corner or through a door, in closed form."""

from __future__ import annotations

import math

from ..clearance import certify
from ..interfaces import Plan, PlanStatus
from ..path import Path
from ..scene import Scene
from .arc_candidates import ArcCandidate, ArcTask
from .arc_path import path_of
from .corridor_turn import Corner, missing_width
from .door_arc import missing_corridor, missing_door
from .finish import finished_plan
from .planning_clock import clock

NAME = "arc"

_MOST_PATHS = 10  # certified
_SHARE = 0.6  # of the best arc's clearance with which a path is taken at once


class ArcPlanner:
    """The planner named "arc" [NarrowArcs, Section 3], with all that `corridor_turn` adds.

    It recognises an L corridor, or a corridor and a door, between start and goal, whichever of
    the two is in the room, takes the arc with the greatest clearance, and joins it to start and
    goal by lines; where they stand off the turn's lines, by an S of two arcs on the leg. The
    chair stops or slows where the curvature jumps, at each end of an arc.

    What it does not find may still pass: by shunting, by curves of varying curvature. It never
    answers `impassable`.
    """

    def plan(self, scene: Scene) -> Plan:
        """Return a certified plan with one turn, or why one arc will not do."""
        begun = clock.now()

        def spent(**figures: float) -> dict[str, float]:
            return {"solve_time_s": clock.now() - begun, **figures}

        task = ArcTask.of(scene)
        if isinstance(task, str):
            return Plan(PlanStatus.NOT_FOUND, NAME, task, statistics=spent())
        figures = {"best_clearance_m": task.best.clearance, "best_radius_m": task.best.radius}
        if task.best.clearance <= 0.0:
            reason, missing = _impossible(task)
            figures["missing_mm"] = 1e3 * missing
            return Plan(PlanStatus.NOT_FOUND, NAME, reason, statistics=spent(**figures))
        chosen, path, problem = _clearest(scene, task)
        if chosen is None or path is None:
            reason = f"one arc would pass, but {problem}; other manoeuvres may do"
            return Plan(PlanStatus.NOT_FOUND, NAME, reason, statistics=spent(**figures))
        note = (
            f"one arc of radius {chosen.arc.radius:.2f} m, begun with C_r = "
            f"{chosen.side_gap:.2f} m and C_n = {chosen.axle_gap:.2f} m"
        )
        figures = spent(**figures, **_turn_figures(chosen))
        return finished_plan(scene, path, planner=NAME, statistics=figures, note=note)


def arc_guess(scene: Scene) -> Path | None:
    """Return a path line - arc - line for a scene, not certified, or None.

    For those who refine a path. It takes 0.7 ms in a corridor, up to 4 ms at a door, and is clear
    of the walls and the corner by the margin wherever an arc from start to goal is; what else
    stands there it does not look at.
    """
    task = ArcTask.of(scene)
    if isinstance(task, str):
        return None
    best: ArcCandidate | None = None
    for candidate in task.candidates():
        if isinstance(candidate, str):
            continue
        if best is None or candidate.arc.clearance > best.arc.clearance:
            best = candidate
        if best.arc.clearance >= scene.margin:
            break
    return None if best is None else path_of(scene.start, best.pieces, in_one=True)


def _clearest(scene: Scene, task: ArcTask) -> tuple[ArcCandidate | None, Path | None, str]:
    """Return the first path that clears enough, or the clearest; or what was in the way.

    Enough is the margin and a fair share of what any one arc clears: a path without aligning is
    worth some clearance, but not most of it.
    """
    enough = max(scene.margin, _SHARE * task.best.clearance)
    chosen: tuple[float, ArcCandidate, Path] | None = None
    problem = "the lines of start and goal leave it no room"
    tried = 0
    for candidate in task.candidates():
        if isinstance(candidate, str):
            problem = candidate
            continue
        path = path_of(scene.start, candidate.pieces)
        clearance = certify(scene.world, scene.vehicle, path).clearance
        if chosen is None or clearance > chosen[0]:
            chosen = (clearance, candidate, path)
        tried += 1
        if clearance >= enough or tried >= _MOST_PATHS:
            break
    return (None, None, problem) if chosen is None else (chosen[1], chosen[2], "")


def _turn_figures(candidate: ArcCandidate) -> dict[str, float]:
    x, y, heading = candidate.turn_start.tolist()
    return {
        "radius_m": candidate.arc.radius,
        "side_gap_m": candidate.side_gap,
        "axle_gap_m": candidate.axle_gap,
        "turn_start_x": x,
        "turn_start_y": y,
        "turn_start_heading": heading,
    }


def _impossible(task: ArcTask) -> tuple[str, float]:
    """Return what one arc is short of, in words and [m]."""
    body, shape, least = task.body, task.found.shape, task.least_radius
    other = "; other manoeuvres, such as shunting, may pass"
    if isinstance(shape, Corner):
        more = missing_width(body, shape, least_radius=least)
        return (
            f"impossible with one arc: it needs {1e3 * more:.0f} mm more corridor, on both legs of "
            f"{shape.before:.2f} and {shape.after:.2f} m{other}"
        ), more
    door = missing_door(body, shape, least_radius=least)
    corridor = missing_corridor(body, shape, least_radius=least)
    ways = [f"{1e3 * door:.0f} mm more door"] if math.isfinite(door) else []
    ways += [f"{1e3 * corridor:.0f} mm more corridor"] if math.isfinite(corridor) else []
    needs = " or ".join(ways) or "more of both door and corridor"
    return (
        f"impossible with one arc: it needs {needs} (door {shape.door:.2f} m, corridor "
        f"{shape.corridor:.2f} m){other}"
    ), min(door, corridor)
