"""The planners that DoorBench compares, each as a function from a scene to what it claims."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

from ..interfaces import Plan
from ..path import Path
from ..planners.guess import forward_guesses
from ..planners.ladder import plan
from ..planners.search import SearchPlanner
from ..scene import Scene
from .obca import TOUCH, obca
from .ompl_baseline import is_installed, ompl_path


@dataclass(frozen=True, eq=False)
class Claim:
    """What a planner says about a scene.

    Attributes:
        path: The way it claims, or None if it claims none.
        reason: In the planner's words.
        statistics: Counts that do not depend on the machine.
    """

    path: Path | None
    reason: str
    statistics: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Contestant:
    """A planner in the comparison.

    Attributes:
        label: One line about it.
        claim: The planner.
        reversing: Whether the chair may reverse in its scenes.
        is_ours: Whether its claims must never be invalid.
        is_repeatable: Whether it gives the same answer every time.
    """

    label: str
    claim: Callable[[Scene], Claim]
    reversing: bool = False
    is_ours: bool = False
    is_repeatable: bool = True


def _ladder(scene: Scene) -> Claim:
    return _claim(plan(scene))


def _touching(scene: Scene) -> Claim:
    """Plan with no more clearance than OBCA is asked for: the same task, the same freedom."""
    return _claim(plan(replace(scene, margin=TOUCH)))


def _search(scene: Scene) -> Claim:
    return _claim(SearchPlanner().plan(scene))


def _claim(found: Plan) -> Claim:
    counts = {k: v for k, v in found.statistics.items() if not k.endswith("_s")}
    return Claim(found.path, f"{found.status.value}: {found.reason}", counts)


def _obca(scene: Scene, *, keep: float | None, margin: float = TOUCH) -> Claim:
    """Run OBCA from the search's way, or from a curve through the door where there is none."""
    found = SearchPlanner().search(scene).manoeuvre
    guess = found.path if found is not None else forward_guesses(scene)[0][1]
    result = obca(scene, guess, keep=keep, margin=margin)
    counts = {"iterations": float(result.iterations), "solves": float(result.solves)}
    return Claim(result.path, result.reason, counts)


def _obca_once(scene: Scene) -> Claim:
    return _obca(scene, keep=None)


def _obca_rechecked(scene: Scene) -> Claim:
    return _obca(scene, keep=0.0)


def _obca_margin(scene: Scene) -> Claim:
    return _obca(scene, keep=scene.margin, margin=scene.margin)


def _ompl(scene: Scene) -> Claim:
    path = ompl_path(scene)
    return Claim(path, "an exact solution" if path is not None else "no exact solution in time")


CONTESTANTS: Mapping[str, Contestant] = {
    "narrows": Contestant("`narrows.plan`, forward only", _ladder, is_ours=True),
    "narrows-reversing": Contestant(
        "`narrows.plan`, may reverse", _ladder, reversing=True, is_ours=True
    ),
    "narrows-1mm": Contestant(
        "`narrows.plan`, forward only, asked for 1 mm as OBCA is", _touching, is_ours=True
    ),
    "search": Contestant("our coarse search alone, forward only", _search, is_ours=True),
    "search-reversing": Contestant(
        "our coarse search alone, may reverse", _search, reversing=True, is_ours=True
    ),
    "obca": Contestant("OBCA from the search's way, solved once, taken at its word", _obca_once),
    "obca-rechecked": Contestant(
        "the same, certified, and solved again with more clearance where it cuts", _obca_rechecked
    ),
    "obca-margin": Contestant(
        "the same, solved until it keeps the scene's margin, as `narrows` does", _obca_margin
    ),
    "ompl-rrt": Contestant("OMPL's RRT on Dubins curves, simplified", _ompl, is_repeatable=False),
}
"""Planners by name; all but OMPL are there always."""


def available() -> tuple[str, ...]:
    """Return the names of the planners that can run here."""
    return tuple(name for name in CONTESTANTS if name != "ompl-rrt" or is_installed())
