"""Planning with nothing but what the chair's sensors see, looking again where the seen ends.

From the first view a way to the goal is planned through what is seen to be free. If there is none,
one is planned as if the unknown were free, and driven as far as it leads through what is seen to
be free; there the chair stands, looks again, and plans again. Every leg is proven clear of all
that was sensed when it was driven, the unknown being solid. The whole is judged by the world as it
is, which no plan has seen.
"""

from __future__ import annotations

import math
import time as clock
from dataclasses import dataclass, field, replace

import numpy as np

from ..clearance import Certificate, certify, clearance_at
from ..errors import InputError
from ..interfaces import Plan, PlanStatus
from ..path import Path
from ..planners import plan
from ..profile import Profile
from ..scene import Goal, Scene
from ..se2 import Array
from ..trajectory import Trajectory
from ..verification import verify
from ..world import World
from .lookout import LookOptions, Lookout
from .sensed_space import SensedSpace

PLANNER = "sensed"
_WIDER = 2.0  # cells: by that much more a way that leads into the unknown keeps its distance
_TIGHT = 0.005  # m: a way into the seen is followed while it is that clear of the unseen


@dataclass(frozen=True)
class SensedOptions:
    """How the chair looks and how long it tries.

    Attributes:
        look: What it looks around with.
        views: Most looks around.
        least_step: A leg into the seen that leads less far ends the search [m].
        stop_short: How far before the end of the seen a leg ends [m].
        time_budget: CPU time after which a planning tries no further start [s].
    """

    look: LookOptions = field(default_factory=LookOptions)
    views: int = 30
    least_step: float = 0.1
    stop_short: float = 0.05
    time_budget: float = 3.0

    def __post_init__(self) -> None:
        """Refuse a journey without a look."""
        if self.views < 1:
            raise InputError("no look", field="views", value=self.views, allowed=">= 1")


@dataclass(frozen=True, eq=False)
class View:
    """What was known after a look around.

    Attributes:
        space: What the chair knew then, and where it stood.
        leg: The plan driven from there, certified in the world as sensed; None: there was none.
        into_the_unknown: Whether the leg ends where the seen ends, not at the goal.
    """

    space: SensedSpace
    leg: Plan | None = None
    into_the_unknown: bool = False


@dataclass(frozen=True, eq=False)
class SensedPlan:
    """Outcome of planning by what is sensed.

    Attributes:
        plan: The motion of all legs and its certificate in the true world, or why there is none.
        views: Each look around, in order.
    """

    plan: Plan
    views: tuple[View, ...]

    @property
    def replans(self) -> int:
        """How often a plan was made anew after the first."""
        return max(len(self.views) - 1, 0)


def plan_sensed(
    scene: Scene, options: SensedOptions | None = None, *, planner: str = "auto"
) -> SensedPlan:
    """Return the motion to a scene's goal planned by sensors alone, judged by the true world.

    Args:
        scene: The true scene: its world is looked at by simulated sensors and judges the motion;
            planned is with chair, goal, bounds and margin.
        options: How the chair looks.
        planner: Of each leg, as for `narrows.planners.plan`.

    Raises:
        InputError: If there is no planner of that name.
    """
    begun = clock.process_time()
    outcome = _Journey(scene, options or SensedOptions(), planner).go()
    spent = {"solve_time_s": clock.process_time() - begun}
    return replace(outcome, plan=replace(outcome.plan, statistics=spent))


class _Journey:
    """One way from the start: what is known, and the legs driven so far."""

    def __init__(self, scene: Scene, options: SensedOptions, planner: str) -> None:
        self._scene, self._options, self._planner = scene, options, planner
        self._lookout = Lookout(scene, options.look)
        self._pose, self._time = scene.start, 0.0
        self._views: list[View] = []
        self._legs: list[Trajectory] = []
        self._given_up = ""  # why it was given up, but for what is only remembered

    def go(self) -> SensedPlan:
        """Look, plan and drive until the goal is reached or nothing leads on."""
        for _ in range(self._options.views):
            view, reason = self._look_and_plan()
            if view.leg is None and self._legs and not self._given_up:
                self._given_up = reason
                self._lookout.map.forget()  # what is only remembered may have gone
                view, reason = self._look_and_plan()
            self._views.append(view)
            if view.leg is None or view.leg.trajectory is None:
                return self._failed(self._given_up or reason)
            self._drive(view.leg.trajectory)
            if not view.into_the_unknown:
                return self._judged()
        return self._failed(f"the goal was not reached within {self._options.views} views")

    def _look_and_plan(self) -> tuple[View, str]:
        """Return what is seen now with the leg that leads on, or why none does."""
        space = self._lookout.look(self._time)
        leg, reason = self._leg_to_goal(space)
        if leg is not None:
            return View(space, leg), reason
        leg, reason = self._leg_towards_goal(space, reason)
        return View(space, leg, leg is not None), reason

    def _leg_to_goal(self, space: SensedSpace) -> tuple[Plan | None, str]:
        """Return a plan to the goal through what is seen to be free, or why there is none."""
        goal = self._scene.goal
        free, against = clearance_at(space.cautious, self._scene.vehicle, goal.pose[None])
        if free[0] <= 0.0:
            return None, f"at the goal the chair would stand in {against[0] or 'a wall'}"
        if not space.leads_to(goal.pose):
            return None, "no way to the goal is seen to be free"
        return self._planned(space, goal)

    def _leg_towards_goal(self, space: SensedSpace, reason: str) -> tuple[Plan | None, str]:
        """Return a plan along a hopeful way as far as it is seen to be free, or why none is."""
        for wider in (_WIDER * space.cell, 0.0):  # the unknown beside the seen is to be avoided too
            hope = self._plan_in(space.hopeful, self._scene.goal, wider=wider)
            if hope.path is None:
                return None, f"what is seen leaves no way to the goal: {hope.reason}"
            stop, barred = self._end_of_sight(space, hope.path)
            if stop is not None:
                leg, why = self._planned(space, Goal(stop))
                if leg is not None:
                    return leg, why
        where = f"on the way hoped for at ({barred[0]:.2f}, {barred[1]:.2f})"
        return None, f"{reason}, and the chair comes no nearer: {where} it is not seen to be free"

    def _end_of_sight(self, space: SensedSpace, path: Path) -> tuple[Array | None, Array]:
        """Return the last pose of a path up to which it is seen to be free, and the one beyond.

        The former is None if it is too near to be worth the way.
        """
        progress = np.linspace(0.0, path.span, max(2, math.ceil(path.span / 0.02)))
        free, _ = clearance_at(space.cautious, self._scene.vehicle, path(progress))
        blocked = np.flatnonzero(free < min(self._scene.margin, _TIGHT))
        end = float(progress[blocked[0]]) if len(blocked) else path.span
        step = end - self._options.stop_short
        return (path(step) if step >= self._options.least_step else None), path(end)

    def _planned(self, space: SensedSpace, goal: Goal) -> tuple[Plan | None, str]:
        """Return a plan whose motion is proven clear of every cell that is not seen to be free."""
        reason = ""
        for wider in (0.0, space.cell):  # the outlines planned with are smoother than the cells
            leg = self._plan_in(space.cautious, goal, wider=wider)
            if leg.trajectory is None:
                return None, reason or leg.reason
            proof = certify(space.exact, self._scene.vehicle, leg.trajectory.path)
            if proof.is_clear:
                return leg, leg.reason
            reason = f"the way planned is not clear of what was sensed: {proof.reason}"
        return None, reason

    def _plan_in(self, world: World, goal: Goal, *, wider: float = 0.0) -> Plan:
        margin = self._scene.margin + wider
        scene = replace(self._scene, world=world, start=self._pose, goal=goal, margin=margin)
        if self._planner != "auto":
            return plan(scene, planner=self._planner)
        if np.hypot(*(goal.pose - self._pose)[:2]) < self._options.least_step:
            return plan(scene, planner="search")  # a turn on the spot is nothing to make smooth
        return plan(scene, time_budget=self._options.time_budget)

    def _drive(self, leg: Trajectory) -> None:
        self._legs.append(leg)
        self._lookout.drive(leg)
        self._time += leg.duration + self._options.look.duration
        self._pose = leg.path.goal

    def _judged(self) -> SensedPlan:
        """Judge the motion of all legs by the true world."""
        whole = joined(self._legs, self._options.look.duration)
        found = verify(self._scene, whole)
        if not found.is_certified:
            return self._failed(
                "the motion planned by what was sensed is refused by the world as it is: "
                f"{'; '.join(found.problems)}{self._hint(found.certificate)}"
            )
        reason = f"{found.reason}; {_views(len(self._views))}"
        parts = (whole.path, whole, found.certificate)
        return SensedPlan(Plan(PlanStatus.CERTIFIED, PLANNER, reason, *parts), tuple(self._views))

    def _narrow_doors(self) -> str:
        """Return what is to be said of doors that were seen and are narrower than the chair."""
        doors = self._views[-1].space.doors if self._views else ()
        width = self._scene.vehicle.width
        narrow = [f"{door.width:.2f} m" for door in doors if door.width < width]
        if not narrow:
            return ""
        return f"; seen to be narrower than the chair ({width:.2f} m): door of {', '.join(narrow)}"

    def _hint(self, proof: Certificate) -> str:
        """Return what to do about what the motion meets, if that is not plain."""
        if proof.is_clear:
            return ""
        if any(proof.against == moving.name for moving in self._scene.world.moving):
            return (
                ": it moved after the chair looked; a plan does not wait for what moves, "
                "`narrows drive --controller navigator` does"
            )
        return ": no sensor saw it from where the chair looked"

    def _failed(self, reason: str) -> SensedPlan:
        told = f"{reason} (after {_views(len(self._views))}){self._narrow_doors()}"
        return SensedPlan(Plan(PlanStatus.NOT_FOUND, PLANNER, told), tuple(self._views))


def _views(count: int) -> str:
    return f"{count} view" if count == 1 else f"{count} views"


def joined(legs: list[Trajectory], pause: float = 0.0) -> Trajectory:
    """Return one trajectory of several, each beginning where the one before came to rest.

    Args:
        legs: At least one.
        pause: How long the chair stands between two [s].
    """
    sections = tuple(section for leg in legs for section in leg.path.sections)
    breaks, coefficients = [np.zeros(1)], []
    time = progress = 0.0
    for leg in legs:
        if time > 0.0 and pause > 0.0:
            time += pause
            breaks.append(np.array([time]))
            coefficients.append(np.array([[progress, 0.0, 0.0, 0.0]]))
        rows = np.array(leg.profile.coefficients)
        rows[:, 0] += progress
        coefficients.append(rows)
        breaks.append(time + leg.profile.breaks[1:])
        time, progress = time + leg.duration, progress + leg.path.span
    return Trajectory(Path(sections), Profile(np.concatenate(breaks), np.concatenate(coefficients)))
