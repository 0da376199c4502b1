"""Can any motion of this body pass? Yes with a way, no with a proof, and by how many millimetres.

The body may translate and turn freely, so "impassable" holds for every drive. A way through open
free cells is also one for a differential drive that may reverse, with or without a bound on its
curvature: it can follow any curve of poses as closely as needed, by shunting (small-time local
controllability). For a chair that does not reverse, "passable" is necessary, not sufficient; the
reason then says so. The margin and solids that move play no part. See docs/passable.md.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np
import shapely

from ..scene import Scene
from ..se2 import Array
from .narrowest import blocked_end
from .passage_problem import PassageProblem
from .passage_reason import reason_for
from .passage_refinement import Answer, Decision
from .passage_windows import PassageDecider
from .passage_witness import witness_poses
from .planning_clock import clock
from .spare import Spare, find_spare

_FINEST = 2e-4  # m that the body's furthest point moves over the narrowest heading interval


class PassageStatus(Enum):
    """Whether a body can pass; the value is its name in files and on the command line."""

    PASSABLE = "passable"
    IMPASSABLE = "impassable"
    UNDECIDED = "undecided"


@dataclass(frozen=True, eq=False)
class SeparationProof:
    """Why no motion exists: a set of poses that holds the start, that no way leaves, goal outside.

    In each heading interval the obstacles are grown by a polygon inside the body at every
    heading of the interval; `start_side` holds all parts of what is left that the start can
    possibly reach. None of them meets the goal region, nor a free place outside them.

    Everything beyond the window counts as free, and as reached where the start side touches it.

    Attributes:
        window: x0, y0, x1, y1 of the places looked at, shape (4,), [m].
        pivot: The point of the body frame that the places are those of, shape (2,), [m].
        intervals: First and last heading of each interval, shape (H, 2), [rad].
        start_side: For each interval the places possibly reached, in the world, [m].
    """

    window: Array
    pivot: Array
    intervals: Array
    start_side: tuple[shapely.MultiPolygon, ...]


@dataclass(frozen=True, eq=False)
class Verdict:
    """Whether a body can pass, why, and by how much.

    Attributes:
        status: Passable, impassable (both proven), or undecided.
        reason: For people: what is to spare or missing, where, and what limits the verdict.
        time_s: Process time taken [s].
        resolution_rad: Width of the narrowest heading interval looked at [rad].
        spare: How much larger the body may be; None if it was not asked for.
        narrowest: The narrowest place, shape (2,), [m]: the middle of the body there. None
            where there is none to name: no limit, no way for any body, spare room not asked for
            (but for a start or goal the body does not fit at).
        witness: Poses from the start to the goal region, shape (N, 3); between two rows the body
            translates or turns about `pivot`. None unless passable.
        pivot: The point of the body frame it turns about, shape (2,), [m].
        proof: Why nothing passes; None unless impassable.
    """

    status: PassageStatus
    reason: str
    time_s: float
    resolution_rad: float
    spare: Spare | None
    narrowest: Array | None
    witness: Array | None
    pivot: Array
    proof: SeparationProof | None

    @property
    def spare_m(self) -> float | None:
        """Largest proven increase of length and width; negative: missing; None: not asked [m]."""
        return None if self.spare is None else self.spare.proven


_STATUS = {
    Answer.JOINED: PassageStatus.PASSABLE,
    Answer.APART: PassageStatus.IMPASSABLE,
    Answer.OUTSIDE: PassageStatus.UNDECIDED,
    Answer.TOO_FINE: PassageStatus.UNDECIDED,
    Answer.TOO_LONG: PassageStatus.UNDECIDED,
}


def passable(scene: Scene, *, time_budget: float = 10.0, spare: bool = True) -> Verdict:
    """Return whether the chair's body can get from start to goal at all, proven either way.

    Args:
        scene: Body, obstacles, start, and the region of poses that counts as the goal.
        time_budget: Process time after which what is then known is returned [s].
        spare: Whether to find how much larger the body may be, or must be smaller.
    """
    begin = clock.now()
    problem = PassageProblem.from_scene(scene)
    decider = PassageDecider(problem, _FINEST / problem.reach(0.0), begin + time_budget)
    decision = decider.decide(0.0)
    status = _STATUS[decision.answer]
    room = find_spare(decider, decision) if spare else None
    narrowest = None if room is None else room.narrowest
    if narrowest is None and status is PassageStatus.IMPASSABLE:
        end = blocked_end(decision)
        narrowest = None if end is None else end + problem.origin
    witness = None
    if status is PassageStatus.PASSABLE:
        witness = witness_poses(problem, decision.network.way())
    graph = decision.graph
    widths = [2.0 * graph.half_angle(k) for k in range(len(graph.headings))]
    return Verdict(
        status=status,
        reason=reason_for(scene, decision, room, narrowest),
        time_s=clock.now() - begin,
        resolution_rad=float(min(widths)),
        spare=room,
        narrowest=narrowest,
        witness=witness,
        pivot=problem.pivot,
        proof=_proof(decision) if status is PassageStatus.IMPASSABLE else None,
    )


def _proof(decision: Decision) -> SeparationProof:
    graph, network = decision.graph, decision.network
    problem = graph.problem
    width = np.array([2.0 * graph.half_angle(k) for k in range(len(graph.headings))])
    begin = np.array(graph.headings)
    sides = [shapely.MultiPolygon(network.start_side(heading)) for heading in graph.headings]
    moved = [shapely.transform(side, lambda xy: xy + problem.origin) for side in sides]
    return SeparationProof(
        window=graph.window + np.tile(problem.origin, 2),
        pivot=problem.pivot,
        intervals=np.stack([begin, begin + width], axis=-1),
        start_side=tuple(moved),
    )
