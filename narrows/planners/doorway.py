"""Through a door on two cubic Bezier segments [DoorBezier].

The paper's own way (`DoorwayOptions.paper()`): the segment from the start to the door's middle,
then the one from there to the goal, each the smoothest completely convex cubic with its control
points in the corridor or the room, kept from obstacles as a point with a radius. Its heading at
the door is the door's normal, so the two join with one tangent but with a jump in curvature, and
the chair's body is not known to it: its curves may cut the jambs, and the certificate then says so.

The default goes beyond the paper, each step by its own switch: curvature bounded by what the chair
can drive, curvature continuous at the join, and the exact body kept at the scene's margin. These
tie the segments together, so all legs are found by one program, and the join may leave the door's
middle: a chair with a long front is straight well before its axle reaches the door.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from .. import bezier
from ..bezier_section import BezierSection
from ..clearance import Certificate, certify
from ..errors import ShapeError
from ..interfaces import Plan, PlanStatus
from ..nlp import SolverOptions
from ..path import Path
from ..scene import Scene
from ..se2 import Array
from .bezier_segment import Obstacle, Segment, SegmentOptions, solve_segment
from .door_regions import Passage, choose_door, describe_passage
from .doorway_curve import DoorwayBounds
from .doorway_search import DoorwayCurve, DoorwayTask, search_doorway
from .finish import finished_plan
from .planning_clock import clock
from .smoothness import Smoothness

NAME = "doorway"
_SAMPLED = 0.995  # the curvature is bounded at samples; between them it may rise by this


@dataclass(frozen=True)
class DoorwayOptions:
    """What the two segments have to satisfy.

    Attributes:
        smoothness: The cost, (10a) by default.
        convex: Complete convexity (8), (11e). The body's margin and the curvature bound do what it
            is for and allow more curves.
        curvature_bound: Keep the vehicle's curvature limit; not in the paper.
        continuous: Curvature continuous at the join; not in the paper.
        body: Keep the exact body at the scene's margin; not in the paper.
        join_along: How far the join may lie from the door's middle along the door's normal [m].
        join_aside: The same across [m].
        join_tilt: How far its heading may leave the normal [rad].
        keep_off: What the paper's d_r (12) takes of the chair: "half_width" or "circumscribed".
        samples: Parameters at which the paper's obstacles (12) are kept, on each segment.
        starts: Starts of the optimiser for both segments together.
        solver: How to solve.
    """

    smoothness: Smoothness = field(default_factory=Smoothness)
    convex: bool = False
    curvature_bound: bool = True
    continuous: bool = True
    body: bool = True
    join_along: float = 1.0
    join_aside: float = 0.25
    join_tilt: float = math.radians(20.0)
    keep_off: str = "half_width"
    samples: int = 101
    starts: int = 3
    solver: SolverOptions = field(
        default_factory=lambda: SolverOptions(tolerance=1e-6, iteration_limit=60)
    )

    def __post_init__(self) -> None:
        """Check the choices."""
        if self.keep_off not in ("half_width", "circumscribed"):
            raise ShapeError(
                f"keep_off must be 'half_width' or 'circumscribed', got {self.keep_off!r}"
            )
        if self.starts < 1 or self.samples < 2:
            raise ShapeError("starts must be at least 1 and samples at least 2")
        if min(self.join_along, self.join_aside, self.join_tilt) < 0.0:
            raise ShapeError("the join's freedom must not be negative")

    @classmethod
    def paper(cls) -> DoorwayOptions:
        """Return what the paper does and no more."""
        return cls(
            convex=True,
            curvature_bound=False,
            continuous=False,
            body=False,
            join_along=0.0,
            join_aside=0.0,
            join_tilt=0.0,
            solver=SolverOptions(iteration_limit=60),
        )

    @property
    def one_after_the_other(self) -> bool:
        """Whether the segments are independent: nothing ties them but the door's middle."""
        free = self.join_along > 0.0 or self.join_aside > 0.0 or self.join_tilt > 0.0
        return not (self.continuous or self.body or free)

    def segment(self, scene: Scene) -> SegmentOptions:
        """Return the options of one segment alone."""
        return SegmentOptions(
            smoothness=self.smoothness,
            convex=self.convex,
            curvature=_SAMPLED * scene.vehicle.limits.curvature
            if self.curvature_bound
            else math.inf,
            samples=self.samples,
            solver=self.solver,
        )


class DoorwayPlanner:
    """The planner named "doorway".

    Attributes:
        options: What the segments have to satisfy.
    """

    def __init__(self, options: DoorwayOptions | None = None) -> None:
        """Keep the options."""
        self.options = DoorwayOptions() if options is None else options

    def plan(self, scene: Scene) -> Plan:
        """Return a certified plan through the door between start and goal, or why there is none."""
        begun = clock.now()
        door = choose_door(scene)
        if isinstance(door, str):
            return Plan(PlanStatus.NOT_FOUND, NAME, door)
        passage = describe_passage(scene, door, keep_off=self.options.keep_off)
        if self.options.one_after_the_other:
            return self._plan_segments(scene, passage, begun)
        return self._plan_together(scene, passage, begun)

    def first_segment(self, scene: Scene, passage: Passage) -> Segment:
        """Return the segment from the start to the door's middle [DoorBezier, Eq. (10)]."""
        obstacles = passage.obstacles_before
        return solve_segment(
            scene.start, passage.pose, passage.corridor, obstacles, self.options.segment(scene)
        )

    def second_segment(self, scene: Scene, passage: Passage, arrived: Array) -> Segment:
        """Return the segment from where the chair truly is at the door [DoorBezier, Eq. (11)].

        Args:
            scene: The scene.
            passage: The door taken.
            arrived: Pose at the end of the first segment, shape (3,); its heading is adjusted to
                the door's normal first, as the paper asks.
        """
        start = np.array([arrived[0], arrived[1], passage.door.heading])
        region = _around(passage.room, start)
        obstacles: tuple[Obstacle, ...] = passage.obstacles_behind
        return solve_segment(start, scene.goal.pose, region, obstacles, self.options.segment(scene))

    def _plan_segments(self, scene: Scene, passage: Passage, begun: float) -> Plan:
        """Plan one segment after the other."""
        first = self.first_segment(scene, passage)
        if first.control is None:
            return _not_found(f"the segment to the door: {first.reason}", begun)
        second = self.second_segment(scene, passage, passage.pose)
        if second.control is None:
            return _not_found(f"the segment behind the door: {second.reason}", begun)
        control = np.stack([first.control, second.control])
        figures = {
            "cost": first.cost + second.cost,
            "iterations": float(first.iterations + second.iterations),
            "max_curvature_1_m": _sharpest(control),
            "solve_time_s": clock.now() - begun,
        }
        return finished_plan(scene, smooth_path(control), planner=NAME, statistics=figures)

    def _plan_together(self, scene: Scene, passage: Passage, begun: float) -> Plan:
        """Plan both segments with one program."""
        curve = search_doorway(self._task(scene, passage), starts=self.options.starts)
        if curve is None:
            return _not_found("no start of the optimiser led to a curve", begun)
        figures = {
            "cost": curve.cost,
            "iterations": float(curve.iterations),
            "solves": float(curve.solves),
            "max_curvature_1_m": _sharpest(curve.control),
            "solve_time_s": clock.now() - begun,
        }
        clear = curve.certificate.is_clear or not self.options.body
        if not (curve.is_drivable and clear):
            return Plan(PlanStatus.NOT_FOUND, NAME, _why_not(scene, curve), statistics=figures)
        return finished_plan(scene, smooth_path(curve.control), planner=NAME, statistics=figures)

    def _task(self, scene: Scene, passage: Passage) -> DoorwayTask:
        """Return what the search is asked."""
        options = self.options
        poses = (scene.start, scene.goal.pose, passage.pose)
        size = max(float(np.linalg.norm(p[:2] - passage.pose[:2])) for p in poses[:2])
        limit = scene.vehicle.limits.curvature if options.curvature_bound else math.inf
        bounds = DoorwayBounds(
            join=(options.join_along, options.join_aside, options.join_tilt),
            leg=2.0 * size,
            curvature=_SAMPLED * limit,
            continuous=options.continuous,
            convex=options.convex,
            margin=scene.margin,
        )
        return DoorwayTask(
            scene.world,
            scene.vehicle,
            poses,
            bounds,
            options.smoothness,
            options.solver,
            options.body,
        )


def smooth_path(control: Array) -> Path:
    """Return the path of composite cubics driven forward.

    Args:
        control: Control points, shape (K, 4, 2), [m].
    """
    return Path((BezierSection(control),))


def certify_segments(scene: Scene, control: Array) -> Certificate:
    """Return the certificate of curves whatever it says, for reports on curves that hit.

    Args:
        scene: World and chair.
        control: Control points, shape (K, 4, 2), [m].
    """
    return certify(scene.world, scene.vehicle, smooth_path(control))


def _around(region: Array, point: Array) -> Array:
    """Return the region widened to hold a point that lies a little outside of it.

    A chair that stops short of the door's plane starts the second segment outside the room.
    """
    widened = region.copy()
    widened[:, 2] = np.maximum(region[:, 2], region[:, :2] @ point[:2])
    return widened


def _sharpest(control: Array) -> float:
    return float(np.abs(bezier.curvature(control[:, None], np.linspace(0.0, 1.0, 201))).max())


def _not_found(reason: str, begun: float) -> Plan:
    spent = {"solve_time_s": clock.now() - begun}
    return Plan(PlanStatus.NOT_FOUND, NAME, reason, statistics=spent)


def _why_not(scene: Scene, curve: DoorwayCurve) -> str:
    """Return what the best curve breaks, in millimetres and 1/m, and what would help."""
    tried = "of all pairs of cubic segments tried, the best"
    if not curve.is_drivable:
        bend, limit = _sharpest(curve.control), scene.vehicle.limits.curvature
        if bend > limit:
            sharp = f"{bend:.2f} 1/m" if bend < 10.0 else "more than 10 1/m"
            problem = f"would have to bend with {sharp}, allowed are {limit:.2f} 1/m"
        else:
            problem = f"has a jump of {curve.excess:.2f} 1/m in its curvature at the join"
        return (
            f"{tried} {problem} (its body: {curve.certificate.reason}); more room before or behind "
            "the door, or a planner that shunts, would help"
        )
    return (
        f"{tried} is not clear: {curve.certificate.reason}; a wider door or more room, or a "
        "planner with more segments or shunting, would help"
    )
