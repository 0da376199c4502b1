"""The smooth optimum with the exact body: several starts, the best certified one wins."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field, replace

from narrows.errors import ShapeError
from narrows.interfaces import Plan, PlanStatus
from narrows.path import Path
from narrows.scene import Scene

from .body_program import Weights
from .finish import finished_plan
from .fitting import fitted
from .guess import doors_between, forward_guesses
from .planning_clock import clock
from .refinement import Refined, Refinement, RefinementOptions

_PIECE = 0.45  # m: a cubic piece about half a chair long bends as sharply as a chair can
_SEGMENTS = {1: (6, 10), 2: (8,)}  # by number of sections, else 6: few programs to compile
_FINER = {6: 10, 8: 12, 10: 14}  # where the margin takes more
_TIGHT = 3.0  # times the margin on either side of the chair in a door: less takes finer pieces
_NARROW = 5.0  # likewise: less takes so many steps that contacts are looked for compiled
_NOTHING = 2e-4  # m: clearance missing from what is asked for, which is a little more
_LITTLE = 1e-3  # m: no other manoeuvre is looked for to win this much
_TOO_SHARP = 20.0  # 1/m: a radius of 5 cm is no curve to drive but a fold
_ROWS = {1: 256}  # rows of clearance by number of sections, else 128


@dataclass(frozen=True)
class ManoeuvreOptions:
    """How smooth manoeuvres are sought.

    Attributes:
        weights: What smoothness costs. `weights.price` is the smoothness, INT kappa^2 ds in 1/m,
            given up for a metre of clearance missing from the margin; as it is raised where the
            margin is not kept, what trades clearance for smoothness is the scene's margin.
        compare: How many starts that keep the margin are compared before the smoothest is taken.
    """

    weights: Weights = field(default_factory=Weights)
    compare: int = 1


@dataclass(frozen=True, eq=False)
class Candidate:
    """A refined manoeuvre.

    Attributes:
        name: Where it started from.
        refined: Where the optimiser ended.
    """

    name: str
    refined: Refined

    @property
    def is_good(self) -> bool:
        """Whether margin and curvature limit are kept, as far as the optimiser sees."""
        return self.refined.slack < _NOTHING and self.refined.excess < 1e-3

    @property
    def is_nearly_good(self) -> bool:
        """Whether at most a millimetre of the margin is missing, the curvature limit kept."""
        return self.refined.slack < _LITTLE and self.refined.excess < 1e-3


def segments_for(path: Path) -> int:
    """Return how many cubic pieces the longest section of a path without turns wants."""
    longest = max(section.span for section in path.sections)
    wanted = math.ceil(longest / _PIECE)
    sizes = _SEGMENTS.get(len(path.sections), (6,))
    return next((size for size in sizes if size >= wanted), sizes[-1])


def spare_in_doors(scene: Scene) -> float:
    """Return what the narrowest known door on the way leaves on either side of the chair [m]."""
    doors = [door for door, _ in doors_between(scene)]
    return min((0.5 * (door.width - scene.vehicle.width) for door in doors), default=math.inf)


def refine(scene: Scene, name: str, guess: Path, options: ManoeuvreOptions) -> Candidate:
    """Return the smooth manoeuvre reached from a rough path.

    Args:
        scene: The scene.
        name: What the guess is called in reasons.
        guess: A rough path without turns on the spot.
        options: The options.

    Raises:
        ShapeError: If the guess turns on the spot.
    """
    if any(section.direction == 0 for section in guess.sections):
        raise ShapeError("a guess that turns on the spot cannot be made smooth")
    segments = segments_for(guess)
    spare = spare_in_doors(scene)
    if spare < _TIGHT * scene.margin:
        segments = _FINER[segments]
    chosen = RefinementOptions(
        weights=options.weights,
        segments=segments,
        finer=_FINER.get(segments, segments),
        is_compiled=spare < _NARROW * scene.margin,
        rows=_ROWS.get(len(guess.sections), 128),
    )
    start = fitted(guess, scene, segments)
    return Candidate(name, Refinement(scene, start.directions, chosen).run(start))


def best_candidates(
    scene: Scene, guesses: Iterable[tuple[str, Path]], options: ManoeuvreOptions, until: float
) -> list[Candidate]:
    """Return refined manoeuvres, the best first, until enough of them keep the margin.

    Args:
        scene: The scene.
        guesses: Named rough paths; asked for one by one, so that costly ones may come last.
        options: The options.
        until: Value of `planning_clock.clock.now` after which no further guess is taken [s].
    """
    found: list[Candidate] = []
    good = 0
    for name, guess in guesses:
        try:
            candidate = refine(scene, name, guess, options)
        except ShapeError:
            continue  # a guess that folds over cannot be refined; the next one may
        found.append(candidate)
        good += candidate.is_good
        if good >= options.compare or clock.now() >= until:
            break
    return sorted(found, key=lambda candidate: candidate.refined.cost)


class ManoeuvrePlanner:
    """Plans by refining rough manoeuvres: through known doors, straight on, and those searched."""

    def __init__(self, options: ManoeuvreOptions | None = None, *, time_budget: float = 5.0):
        """Set the options and the CPU time after which no further start is tried [s]."""
        self.options = ManoeuvreOptions() if options is None else options
        self.time_budget = time_budget

    def plan(self, scene: Scene) -> Plan:
        """Return the best certified manoeuvre, or what blocked the best one tried."""
        begun = clock.now()
        candidates = best_candidates(
            scene, self._guesses(scene), self.options, begun + self.time_budget
        )
        return plan_of(scene, candidates, begun)

    def _guesses(self, scene: Scene) -> Iterable[tuple[str, Path]]:
        yield from forward_guesses(scene)


def plan_of(scene: Scene, candidates: list[Candidate], begun: float) -> Plan:
    """Return the first candidate that finishes as a certified plan, or why none does.

    Args:
        scene: The scene.
        candidates: Refined manoeuvres, the best first.
        begun: Value of `planning_clock.clock.now` when planning began [s].
    """
    refusals = []
    for candidate in candidates:
        if candidate.refined.path.max_curvature > _TOO_SHARP:
            refusals.append(f"{candidate.name}: the curve found folds over")
            continue
        plan = finished_plan(
            scene,
            candidate.refined.path,
            planner="manoeuvre",
            statistics={
                "cost": candidate.refined.cost,
                "iterations": float(sum(c.refined.iterations for c in candidates)),
                "starts": float(len(candidates)),
                "solve_time_s": clock.now() - begun,
            },
        )
        if plan.status is PlanStatus.CERTIFIED:
            statistics = {**plan.statistics, "solve_time_s": clock.now() - begun}
            return replace(plan, statistics=statistics)
        refusals.append(f"{candidate.name}: {plan.reason}")
    tried = "; ".join(refusals[:3]) if refusals else "no rough path could be refined"
    return Plan(
        PlanStatus.NOT_FOUND,
        "manoeuvre",
        f"{len(candidates)} manoeuvres tried, none certified: {tried}",
        statistics={
            "starts": float(len(candidates)),
            "solve_time_s": clock.now() - begun,
        },
    )
