"""From a rough manoeuvre to the smooth one: a trust-region method with fresh contacts each step.

Every step solves a quadratic program: the cost with the curvature of the constraints that pushed
in the step before, made positive; the constraints linearised; the step bounded. Before each step
the contacts are picked again along the current curve, so that the rows of clearance are the true
distances to first order. Where the cost with the true clearance's price falls much less than
promised, the step is taken again with the constraints found at its end (a second-order
correction). A step is kept if the cost falls enough; the bound grows and shrinks with how well it
was predicted. Missing clearance has a price and no step is infeasible: where the margin cannot be
had the clearance is the largest the price pays for.

Two corners that pass each other at a few millimetres turn the axis between them by a right angle
within as much of the way, and inside a solid the way out is often back where the chair came from:
straight-line models say little there. So a body thinner on all sides takes the chair's place, thin
enough to stay well clear, and what it lacks is added to what is required; as the curve gives way
the body grows back. Where sides or corners pass something the two ask for the same; in the end the
chair's own body has the last word.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike

from narrows.errors import ShapeError
from narrows.path import Path
from narrows.scene import Scene

from .body_program import Weights
from .fitting import fitted
from .manoeuvre_shape import Manoeuvre
from .refinement_point import Point, RefinementModel
from .trust_step import Step, convex, trust_step

_CURVATURE_SHARE = 0.998  # share of the curvature limit asked for at samples
_CLEAR = 0.01  # m: a body thinner than the chair stays this clear, its contacts turn slowly
_SMALLEST = 1e-5  # m, rad: trust radius at which a search for a better step ends
_DEARER = 10.0  # how much the price of clearance is raised where the margin is not kept
_WITHIN_REACH = 0.01  # m: beyond contact by more than this, it is not raised
_SHARPEST = 8.0  # 1/m: chairs that may turn on the spot bend no sharper while driving
_FAR_SHORT = 0.1  # m: clearance missing beyond this does not make steps count less
_UNSEEN = 1e-4  # m: clearance whose lack is not worth a higher price
_KEPT, _POOR, _FAIR, _GOOD = 0.1, 0.25, 0.5, 0.7  # shares of the promised fall


@dataclass(frozen=True)
class RefinementOptions:
    """How a manoeuvre is refined.

    Attributes:
        weights: What smoothness costs, and what a metre of missing clearance does.
        segments: Cubic pieces of each section.
        finer: Pieces of each section where the margin is not kept with so many.
        rows: Most rows of clearance of each section.
        is_compiled: Whether contacts are looked for in compiled loops from the start, as many
            steps are to be expected.
        iterations: Largest number of steps of each descent.
        radius: First bound on a step [m, rad].
        enough: Stop when a step promises less than this share of the cost.
    """

    weights: Weights = field(default_factory=Weights)
    segments: int = 10
    finer: int = 14
    rows: int = 256
    is_compiled: bool = False
    iterations: int = 45
    radius: float = 0.15
    enough: float = 2e-3


@dataclass(frozen=True, eq=False)
class Refined:
    """Where a refinement ended.

    Attributes:
        path: The smooth path, judged by nobody yet.
        cost: Cost with prices, that of clearance raised: comparable between refinements.
        slack: Clearance missing from what was required, as found at samples [m].
        excess: Curvature beyond the limit, at samples [1/m].
        iterations: Steps tried.
        evaluations: Times the contacts were picked.
    """

    path: Path
    cost: float
    slack: float
    excess: float
    iterations: int
    evaluations: int


class Refinement:
    """One scene's refinement for manoeuvres of one number of sections."""

    def __init__(
        self, scene: Scene, directions: ArrayLike, options: RefinementOptions | None = None
    ) -> None:
        """Get the compiled program for this number of sections."""
        self.scene = scene
        self.options = RefinementOptions() if options is None else options
        ways = np.array(directions, dtype=np.int64)
        if not len(ways) or (np.abs(ways) != 1).any():
            raise ShapeError(f"directions must be +1 or -1, got {directions!r}")
        self.allowed = min(scene.vehicle.limits.curvature, _SHARPEST)
        self.ways, self.weights = ways, self.options.weights
        self.tried = self.evaluations = 0
        self.model = self._model_of(self.options.segments, is_compiled=self.options.is_compiled)

    def run(self, guess: Manoeuvre) -> Refined:
        """Return the smooth manoeuvre reached from a guess.

        Where that lacks some of the margin, the curve is cut into more pieces, the price of
        clearance raised, and the descent goes on: a high price from the start makes the way there
        long, and most curves need no more pieces.
        """
        point = self._started(guess)
        if point.least < _CLEAR:
            thinner = min(_CLEAR - point.least, self.model.bodies.thinnest)
            point = self._seen(point.x, thinner)
        point = self._descended(point)
        if _UNSEEN < point.x[-2] < self.scene.margin + _WITHIN_REACH:
            self.weights = replace(self.weights, price=_DEARER * self.weights.price)
            point = self._descended(self._finer(point))
        return self._ended(self._within_curvature(point))

    def _finer(self, point: Point) -> Point:
        """Return a point's curve in finer pieces, where it is not in such pieces yet."""
        if self.options.finer == self.options.segments:
            self.model.use_compiled()
            return self._seen(point.x, 0.0)
        path, self.evaluations = self.model.shape.path(point.x), self.model.evaluations
        self.model = self._model_of(self.options.finer, is_compiled=True)
        return self._started(fitted(path, self.scene, self.options.finer))

    def _model_of(self, segments: int, *, is_compiled: bool) -> RefinementModel:
        model = RefinementModel(self.scene, self.ways, segments, self.options.rows)
        model.limit = _CURVATURE_SHARE * self.allowed
        if is_compiled:
            model.use_compiled()
        return model

    def _started(self, guess: Manoeuvre) -> Point:
        turns = np.rint((guess.nodes[-1, 2] - self.scene.goal.pose[2]) / (2.0 * np.pi))
        self.model.goal = self.scene.goal.pose + np.array([0.0, 0.0, 2.0 * np.pi * turns])
        return self._seen(self.model.shape.unknowns(guess), 0.0)

    def _within_curvature(self, point: Point) -> Point:
        """Return a point whose curvature is within the limit between the samples too."""
        for _ in range(2):
            beyond = self.model.shape.path(point.x).max_curvature - self.allowed
            if not 0.0 < beyond < self.allowed:
                break
            self.model.limit -= 1.5 * beyond
            point = self._descended(self._seen(point.x, 0.0))
        return point

    def _ended(self, point: Point) -> Refined:
        slack, excess = (float(missing) for missing in point.x[-2:])
        weights = self.options.weights
        missing = _DEARER * weights.price * max(0.0, slack - _UNSEEN)
        return Refined(
            self.model.shape.path(point.x),
            point.smooth + missing + weights.bend_price * excess,
            slack,
            excess,
            self.tried,
            self.evaluations + self.model.evaluations,
        )

    def _seen(self, x: np.ndarray, thinner: float) -> Point:
        return self.model.evaluate(x, thinner, self.weights)

    def _descended(self, point: Point) -> Point:
        """Return where the trust-region method ends, seen with the chair's own body."""
        options = self.options
        radius, last = options.radius, self.tried + options.iterations
        curving = np.zeros_like(point.hessian)
        while self.tried < last:
            self.tried += 1
            hessian = convex(point.hessian + curving)
            step = self._step(point, hessian, radius)
            if step is None and radius > _SMALLEST:
                radius *= 0.25
            elif step is None or step.promised < self._enough(point) or radius < _SMALLEST:
                thinner = self._grown_back(point)
                if thinner >= 0.9 * point.thinner - 0.1 * _CLEAR:
                    break
                point, radius = self._seen(point.x, thinner), max(radius, 0.3 * options.radius)
            else:
                curving = self.model.curving(point, step.multipliers)
                trial, longest = self._tried(point, step, hessian, radius)
                ratio = (point.cost - trial.cost) / step.promised
                point = trial if ratio > _KEPT else point
                if ratio < _POOR:
                    radius = 0.35 * min(radius, longest)
                elif ratio > _GOOD and longest > 0.9 * radius:
                    radius = min(2.0 * radius, options.radius)
                thinner = self._grown_back(point)
                if thinner < 0.6 * point.thinner - 0.1 * _CLEAR:
                    point = self._seen(point.x, thinner)
        return point if point.thinner == 0.0 else self._seen(point.x, 0.0)

    def _step(self, point: Point, hessian: np.ndarray, radius: float) -> Step | None:
        return trust_step(self.model, point, point.constraints, hessian, radius, self.weights)

    def _tried(
        self, point: Point, step: Step, hessian: np.ndarray, radius: float
    ) -> tuple[Point, float]:
        """Return where a step leads, and its length, corrected where it keeps little promise."""
        trial = self._seen(point.x + step.move, point.thinner)
        if point.cost - trial.cost >= _FAIR * step.promised or trial.x[-2] <= 1e-5:
            return trial, step.longest
        seen = trial.constraints.seen_from(trial.x - point.x)
        again = trust_step(self.model, point, seen, hessian, radius, self.weights)
        if again is None:
            return trial, step.longest
        second = self._seen(point.x + again.move, point.thinner)
        return (second, again.longest) if second.cost < trial.cost else (trial, step.longest)

    def _enough(self, point: Point) -> float:
        """Return the promise below which a step is not worth trying; more on the way there.

        A share of the cost, but however much of the margin is missing a step still counts.
        """
        share = self.options.enough * (10.0 if point.thinner > 0.0 else 1.0)
        beyond = self.weights.price * max(0.0, float(point.x[-2]) - _FAR_SHORT)
        return share * max(1.0, abs(point.cost - beyond))

    def _grown_back(self, point: Point) -> float:
        """Return how much thinner the body must stay for the curve to be clear of it.

        Growing every side by e brings it nearer to anything by sqrt(2) e at most (a mitred right
        angle; flatter corners less).
        """
        return max(0.0, point.thinner - (point.least - _CLEAR) / math.sqrt(2.0))
