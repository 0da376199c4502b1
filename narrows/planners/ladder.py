"""The ladder: cheap answers first, proofs before long searches, one outcome in the end."""

from __future__ import annotations

import difflib
import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

import numpy as np

from narrows.errors import InputError
from narrows.interfaces import Plan, Planner, PlanStatus
from narrows.path import Path
from narrows.scene import Scene
from narrows.se2 import compose, invert, wrap
from narrows.vehicle import Vehicle

from .finish import CERTIFICATE_TOLERANCE
from .guess import forward_guesses
from .manoeuvre import Candidate, ManoeuvreOptions, best_candidates, plan_of
from .planning_clock import clock

TIME_BUDGET = 5.0
"""CPU time after which no further start is tried [s]."""

_ROLLING = 2.5  # 1/m: bends of a chair that may turn on the spot but need not
_NOTHING = 1e-6  # m, rad: no motion of a chair
_SEARCHED = 2  # manoeuvres of the search that are made smooth
_PROOF_SHARE = 0.6  # of the time budget, for each verdict of `passable`


def _doorway() -> Planner:
    from .doorway import DoorwayPlanner

    return DoorwayPlanner()


def _manoeuvre() -> Planner:
    from .manoeuvre import ManoeuvrePlanner

    return ManoeuvrePlanner()


def _search() -> Planner:
    from .search import SearchPlanner

    return SearchPlanner()


def _arc() -> Planner:
    from .arcs import ArcPlanner

    return ArcPlanner()


RUNGS: dict[str, Callable[[], Planner]] = {
    "arc": _arc,
    "doorway": _doorway,
    "manoeuvre": _manoeuvre,
    "search": _search,
}
"""Planners by the name that `plan` and the command line take, besides "auto"."""


def plan(scene: Scene, *, planner: str = "auto", time_budget: float = TIME_BUDGET) -> Plan:
    """Return a certified plan through a scene, the proof that there is none, or what was tried.

    With "auto": the smooth optimum from curves through known doors and straight on; where they lack
    more than a millimetre of the margin, the proof that no motion passes; where it fails, a search
    for other manoeuvres, each made smooth; the best certified one. The same scene gives the same
    plan, but for time budgets that end on a slow machine.

    Args:
        scene: The scene.
        planner: "auto", or one of `RUNGS`.
        time_budget: CPU time after which no further start is tried [s].

    Raises:
        InputError: If there is no planner of that name, or the start is the goal.
    """
    off = compose(invert(scene.start), scene.goal.pose)
    if np.abs(np.append(off[:2], wrap(off[2]))).max() < _NOTHING:
        raise InputError(
            "the chair stands at its goal: there is nothing to drive",
            field="goal",
            value=scene.goal.pose.tolist(),
            allowed="another pose than the start",
        )
    if planner == "auto":
        return _Ladder(scene, time_budget).climb()
    if planner not in RUNGS:
        names = ["auto", *RUNGS]
        near = difflib.get_close_matches(planner, names, n=1)
        hint = f"; did you mean {near[0]!r}?" if near else ""
        raise InputError(
            f"no planner of that name{hint}",
            field="planner",
            value=planner,
            allowed=", ".join(names),
        )
    return RUNGS[planner]().plan(scene)


@dataclass
class _Ladder:
    """One climb: the scene, and until when."""

    scene: Scene
    time_budget: float

    def __post_init__(self) -> None:
        """Start the clock."""
        self.begun = clock.now()
        self.options = ManoeuvreOptions()
        self.rough: list[Path] = []

    def climb(self) -> Plan:
        """Return the outcome of the first rung that settles it."""
        first = self._refined(forward_guesses(self.scene))
        best = plan_of(self.scene, first, self.begun)
        if best.status is PlanStatus.CERTIFIED and first[0].is_nearly_good:
            return best
        verdict = None
        if best.status is not PlanStatus.CERTIFIED:
            with clock.loading():
                from .passage import PassageStatus, passable

            verdict = passable(self.scene, time_budget=_PROOF_SHARE * self.time_budget, spare=False)
            if verdict.status is PassageStatus.IMPASSABLE:
                return self._impassable()
        searched = self._refined(self._searched())
        best = plan_of(self.scene, self._merged(first, searched), self.begun)
        if best.status is PlanStatus.CERTIFIED and not self.scene.vehicle.may_turn_on_the_spot:
            return best
        unsmoothed = self._unsmoothed()
        if unsmoothed is not None:
            return min(best, unsmoothed, key=self._merit)
        if best.status is PlanStatus.CERTIFIED:
            return best
        if verdict is not None:
            best = replace(best, reason=f"{best.reason}; {verdict.reason}")
        return best

    def _unsmoothed(self) -> Plan | None:
        """Return a way of the search as it is, stopping where it bends, if one is certified."""
        with clock.loading():
            from .search import SearchPlanner

        if not self.rough and not self.scene.vehicle.may_turn_on_the_spot:
            return None
        plan = SearchPlanner().plan(self.scene)
        if plan.status is not PlanStatus.CERTIFIED:
            return None
        figures = {**plan.statistics, "solve_time_s": clock.now() - self.begun}
        return replace(
            plan,
            reason=f"{plan.reason}; not smoothed: the chair stops where the way bends",
            statistics=figures,
        )

    def _merit(self, plan: Plan) -> tuple[bool, float]:
        """Return what is less for the better of two certified plans: margin lost, then time."""
        if plan.certificate is None or plan.trajectory is None:
            return True, math.inf
        lost = self.scene.margin - plan.certificate.clearance > CERTIFICATE_TOLERANCE
        return lost, plan.trajectory.duration

    def _refined(self, guesses: Iterable[tuple[str, Path]]) -> list[Candidate]:
        return best_candidates(self.scene, guesses, self.options, self.begun + self.time_budget)

    def _searched(self) -> Iterable[tuple[str, Path]]:
        """Yield rough manoeuvres from searches, those first that can best be made smooth."""
        with clock.loading():
            from .search import SearchPlanner, are_distinct

        planner = SearchPlanner()
        for search, vehicle in self._searches():
            scene = replace(self.scene, vehicle=vehicle)
            for k, found in enumerate(planner.search_many(scene, _SEARCHED)):
                if all(are_distinct(found.path, other) for other in self.rough):
                    self.rough.append(found.path)
                    yield f"manoeuvre {k + 1} of the {search}", found.path

    def _searches(self) -> Iterable[tuple[str, Vehicle]]:
        """Yield chairs to search with: rolling forward, reversing too, turning on the spot too."""
        vehicle = self.scene.vehicle
        rolling = vehicle
        if vehicle.may_turn_on_the_spot:
            rolling = vehicle.with_limits(curvature=_ROLLING)
        if vehicle.limits.reverse_speed > 0.0:
            yield "forward search", rolling.with_limits(reverse_speed=0.0)
        yield "search", rolling
        if vehicle.may_turn_on_the_spot:
            yield "search with turns", vehicle

    def _merged(self, *groups: list[Candidate]) -> list[Candidate]:
        every = [candidate for group in groups for candidate in group]
        return sorted(every, key=lambda candidate: candidate.refined.cost)

    def _impassable(self) -> Plan:
        """Return the proof as a plan's outcome, with the millimetres that are missing."""
        with clock.loading():
            from .passage import passable

        verdict = passable(self.scene, time_budget=_PROOF_SHARE * self.time_budget)
        figures = {"solve_time_s": clock.now() - self.begun}
        if verdict.spare_m is not None:
            figures["missing_mm"] = -1e3 * verdict.spare_m
        return Plan(PlanStatus.IMPASSABLE, "passage", verdict.reason, statistics=figures)
