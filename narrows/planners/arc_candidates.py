"""Paths line - arc - line for a scene whose turn is known, the simplest first."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

from ..scene import Goal, Scene
from ..se2 import Array, rotate, wrap
from .arc_geometry import ArcBody
from .arc_path import Piece, leg_pose, turn_pieces
from .corner_finding import FoundTurn, find_turn
from .corridor_turn import Corner, TurnArc, best_arc
from .door_arc import DoorTurn, best_door_arc

_LEAST_RADIUS = 0.02  # m: of the axle's middle; below it the chair turns on the spot
_THICKEST = 1.0  # m: of a door's wall; beyond it is a side corridor
_OFF = 1.3  # rad: of start or goal from the legs' directions, beyond it nothing is tried
_BLENDS = ((1.0, 1.0), (0.0, 0.0), (0.5, 0.5), (1.0, 0.0), (0.0, 1.0))
_SHARES = (1.0, 0.55)  # of the way to the turn that aligning may take


@dataclass(frozen=True, eq=False)
class ArcCandidate:
    """A path line - arc - line, not certified.

    Attributes:
        pieces: Lengths and curvatures from the scene's start.
        arc: The turn; its clearance from walls and corner alone.
        side_gap: C_r, from the inner side to the inner wall where the turn begins [m].
        axle_gap: C_n, from the drive axle to the inner corner along the leg there [m].
        turn_start: Pose where the turn begins, shape (3,).
    """

    pieces: list[Piece]
    arc: TurnArc
    side_gap: float
    axle_gap: float
    turn_start: Array


@dataclass(frozen=True, eq=False)
class ArcTask:
    """A turn and the body that drives it.

    From a room into a corridor the arc is that from the corridor into the room, driven the other
    way round, rear first; then all but `least_radius` is told that way round.

    Attributes:
        found: The turn with start and goal in its frame.
        body: The chair's rectangle.
        least_radius: The chair's, of the drive axle's middle [m].
        is_reversed: Whether start and goal are swapped.
    """

    found: FoundTurn
    body: ArcBody
    least_radius: float
    is_reversed: bool

    @classmethod
    def of(cls, scene: Scene) -> ArcTask | str:
        """Return the task of a scene, or why there is none."""
        body, bend = ArcBody.of(scene.vehicle), scene.vehicle.limits.curvature
        least = max(_LEAST_RADIUS, 0.0 if math.isinf(bend) else (1.0 + 1e-9) / bend)
        found = find_turn(scene)
        if isinstance(found, FoundTurn) and (isinstance(found.shape, DoorTurn) or not found.opens):
            return cls(found, body, least, False)
        backwards = find_turn(_backwards(scene))
        if isinstance(backwards, FoundTurn) and isinstance(backwards.shape, DoorTurn):
            swapped = ArcBody(body.rear, body.front, body.width)
            return cls(backwards, swapped, least, True)
        return found if isinstance(found, str) else cls(found, body, least, False)

    @cached_property
    def best(self) -> TurnArc:
        """The arc with the greatest clearance, wherever start and goal are."""
        shape = self.found.shape
        if isinstance(shape, Corner):
            return best_arc(self.body, shape, least_radius=self.least_radius)
        return best_door_arc(self.body, shape, least_radius=self.least_radius)

    def on_lines(self, lines: tuple[float, float]) -> TurnArc:
        """Return the arc with the greatest clearance that joins two lines of travel.

        Args:
            lines: Their distances from the inner walls before and after the turn [m].
        """
        shape, least = self.found.shape, self.least_radius
        if isinstance(shape, Corner):
            return best_arc(self.body, shape, least_radius=least, offsets=lines)
        return best_door_arc(self.body, shape, least_radius=least, line=lines[0], side=lines[1])

    def candidates(self) -> Iterator[ArcCandidate | str]:
        """Yield paths, or why a turn cannot be reached.

        First on the lines through start and goal as they stand, then on those of the best arc,
        then between.
        """
        found = self.found
        start, end = found.start, leg_pose(found.goal, found.turn)
        if max(abs(start[2]), abs(end[2])) > _OFF:
            yield "start or goal stand too far off the directions of the legs"
            return
        for blend in _BLENDS:
            arc = self._blended((-start[1], -end[1]), blend)
            if arc.clearance <= 0.0:
                continue
            for share in _SHARES:
                pieces = turn_pieces(
                    arc,
                    found.start,
                    found.goal,
                    self.least_radius,
                    share=share,
                    straight=self._straight_after(arc),
                )
                if isinstance(pieces, str):
                    yield pieces
                    continue
                yield self._candidate(arc, pieces)
                if sum(bend != 0.0 for _, bend in pieces) == 1:
                    break  # nothing is aligned: the other share is the same path

    def _straight_after(self, arc: TurnArc) -> float:
        """Return how far the chair drives straight behind an arc until it is out of a door [m]."""
        shape = self.found.shape
        if isinstance(shape, Corner) or shape.thickness > _THICKEST:
            return 0.0
        return max(shape.thickness + self.body.rear - arc.behind_before, 0.0)

    def _blended(self, own: tuple[float, float], blend: tuple[float, float]) -> TurnArc:
        """Return the arc on lines between the best arc's (0) and given ones (1)."""
        if blend == (1.0, 1.0):
            return self.on_lines(own)
        if blend == (0.0, 0.0):
            return self.best
        ideal = (
            self.best.radius - self.best.behind_before,
            self.best.radius - self.best.behind_after,
        )
        first, second = (b * o + (1.0 - b) * i for b, o, i in zip(blend, own, ideal, strict=True))
        return self.on_lines((first, second))

    def _candidate(self, arc: TurnArc, pieces: list[Piece]) -> ArcCandidate:
        (x, y), frame = arc.centre, self.found.frame
        inner = arc.radius - 0.5 * self.body.width
        if not self.is_reversed:
            pieces = [(length, frame.side * bend) for length, bend in pieces]
            begin = frame.pose_in_world(x, y - arc.radius, 0.0)
            return ArcCandidate(pieces, arc, inner - arc.behind_before, arc.axle_gap, begin)
        pieces = [(length, -frame.side * bend) for length, bend in reversed(pieces)]
        out = rotate(arc.turn, [0.0, -arc.radius])
        begin = frame.pose_in_world(x + out[0], y + out[1], arc.turn + math.pi)
        begin[2] = wrap(begin[2])
        return ArcCandidate(pieces, arc, inner - arc.behind_after, arc.behind_before, begin)


def _backwards(scene: Scene) -> Scene:
    """Return the scene driven the other way round."""
    start, goal = scene.start.copy(), scene.goal.pose.copy()
    start[2] += math.pi
    goal[2] += math.pi
    return replace(scene, start=goal, goal=Goal(start))
