"""Where a refinement stands: cost, constraints with fresh contacts, and derivatives."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from narrows.quadratic import times
from narrows.scene import Scene
from narrows.se2 import Array

from .bend_terms import BendTerms
from .body_program import Layout, ManoeuvreProgram, Weights
from .clearance_rows import Finder, fine_samples, rows_along
from .contact_finding import Samples, contacts_along
from .manoeuvre_shape import ManoeuvreShape
from .planning_clock import clock
from .row_terms import RowTerms
from .section_motion import SectionMotion
from .spline import Spline
from .thin_body import ThinBodies

_SAMPLES = 97  # coarse samples along a section
_BENDS = 20  # samples of the curvature on each cubic piece
_FAR_BEND = 1.0  # 1/m: curvature this far below the limit is not watched in a step
_MANY = 18  # evaluations from which compiling, or reading what was compiled, is worth it
_EXTRA = 3e-4  # m: required beyond the margin, for what lies between samples


@dataclass(frozen=True, eq=False)
class Constraints:
    """Values and derivatives of the constraints at a point, without the slacks' share.

    Attributes:
        goal: Offset of the goal along and across its heading, shape (2,), [m].
        goal_jacobian: Shape (2, size).
        bends: kappa or -kappa where it is not far below the limit, shape (B,), [1/m].
        bend_jacobian: Shape (B, size).
        clearances: Clearance less what is required, shape (R,), [m].
        clearance_jacobian: Shape (R, size).
    """

    goal: Array
    goal_jacobian: Array
    bends: Array
    bend_jacobian: Array
    clearances: Array
    clearance_jacobian: Array

    def seen_from(self, step: Array) -> Constraints:
        """Return the values these would have a step back if they were straight lines."""
        return Constraints(
            self.goal - times(self.goal_jacobian, step),
            self.goal_jacobian,
            self.bends - times(self.bend_jacobian, step),
            self.bend_jacobian,
            self.clearances - times(self.clearance_jacobian, step),
            self.clearance_jacobian,
        )


@dataclass(frozen=True, eq=False)
class Point:
    """Unknowns with what they cost and how they keep the constraints.

    Attributes:
        x: Unknowns; the slacks are what is missing, shape (size,).
        smooth: Cost without what is missing.
        cost: Cost with its price.
        gradient: Of the cost, prices included, shape (size,).
        hessian: Of the cost, shape (size, size).
        constraints: The constraints.
        terms: Rows of clearance of each section.
        bends: The curvatures of each section that are near the limit, and their signs.
        thinner: How far every side of the body is moved inward [m].
        least: That body's least clearance [m].
    """

    x: Array
    smooth: float
    cost: float
    gradient: Array
    hessian: Array
    constraints: Constraints
    terms: tuple[RowTerms, ...]
    bends: tuple[tuple[BendTerms, Array], ...]
    thinner: float
    least: float


@dataclass(frozen=True, eq=False)
class Multipliers:
    """What the constraints' bounds push with, positive at upper bounds.

    Attributes:
        bends: Shape (B,).
        clearances: Shape (R,).
    """

    bends: Array
    clearances: Array


@lru_cache(maxsize=16)
def _program(layout: Layout) -> ManoeuvreProgram:
    return ManoeuvreProgram(layout)


@lru_cache(maxsize=16)
def _bend_weights(segments: int) -> tuple[Array, Array]:
    """Return B' and B'' at the samples of the curvature."""
    spline, samples = Spline(segments), np.linspace(0.0, 1.0, _BENDS * segments + 1)
    return spline.basis(samples, 1), spline.basis(samples, 2)


@lru_cache(maxsize=16)
def _grid(segments: int) -> tuple[Array, Array, Array]:
    """Return the fine samples, B and B' there."""
    spline, fine = Spline(segments), fine_samples(_SAMPLES)
    return fine, spline.basis(fine), spline.basis(fine, 1)


class RefinementModel:
    """One scene's program for manoeuvres of one sequence of directions.

    Attributes:
        scene: The scene.
        layout: Where the unknowns stand.
        shape: From unknowns to curves.
        bodies: The chair and thinner ones.
        goal: The goal's pose, its heading by whole turns as the guess has it.
        limit: Curvature asked for at samples [1/m].
        evaluations: Times the contacts were picked.
    """

    def __init__(
        self, scene: Scene, directions: NDArray[np.int64], segments: int, most_rows: int
    ) -> None:
        """Get the compiled program for this number of sections."""
        self.scene, self.directions, self.most_rows = scene, directions, most_rows
        self.layout = Layout(len(directions), segments, 0)
        self.shape = ManoeuvreShape(self.layout, directions, scene.start)
        self.bodies = ThinBodies(scene.vehicle)
        self.goal = scene.goal.pose
        self.limit = np.inf
        self.evaluations = 0
        self._finder: Finder = contacts_along
        self._program = _program(self.layout)
        self._bend_weights = _bend_weights(segments)
        cosine, sine = np.cos(self.goal[2]), np.sin(self.goal[2])
        self._goal_axes = np.array([[cosine, sine], [-sine, cosine]])
        self._goal_jacobian = np.zeros((2, self.layout.size))
        last = 3 * self.layout.sections - 3
        self._goal_jacobian[:, last : last + 2] = self._goal_axes

    def use_compiled(self) -> None:
        """Look for contacts in compiled loops from now on."""
        with clock.loading():  # numba takes longer than an easy plan
            from .contact_compiled import compiled_contacts

        self._finder = compiled_contacts

    def evaluate(self, x: Array, thinner: float, weights: Weights) -> Point:
        """Return the point with fresh contacts; the slacks become what is missing."""
        self.evaluations += 1
        if self.evaluations == _MANY:
            self.use_compiled()
        x = x.copy()
        x[-2:] = 0.0
        given = [self.scene.goal.position_tolerance], self.directions, weights.values
        parameters = np.concatenate([self.scene.start, self.goal, *given])
        smooth, gradient, hessian = self._program.cost(x, parameters)
        controls = self.shape.controls(x)
        found = [
            self._clearances(control, int(direction), thinner)
            for control, direction in zip(controls, self.directions, strict=True)
        ]
        terms = tuple(section for section, _ in found)
        bends = tuple(self._bends(control) for control in controls)
        carried, last = self.shape.carried, 3 * self.layout.sections - 3
        constraints = Constraints(
            self._goal_axes @ (x[last : last + 2] - self.goal[:2]),
            self._goal_jacobian,
            np.concatenate([sign * near.value for near, sign in bends]),
            np.concatenate(
                [
                    carried(sign[:, None] * near.jacobian, x, k)
                    for k, (near, sign) in enumerate(bends)
                ]
            ),
            np.concatenate([section.value for section in terms]),
            np.concatenate([carried(section.jacobian, x, k) for k, section in enumerate(terms)]),
        )
        slack = max(0.0, -float(constraints.clearances.min(initial=0.0)))
        excess = max(0.0, float(constraints.bends.max(initial=0.0)) - self.limit)
        x[-2:] = slack, excess
        cost = smooth + weights.price * slack + weights.bend_price * excess
        least = min(nearest for _, nearest in found)
        return Point(x, smooth, cost, gradient, hessian, constraints, terms, bends, thinner, least)

    def _bends(self, control: Array) -> tuple[BendTerms, Array]:
        """Return the curvature at samples where it is not far below the limit, and its sign."""
        terms = BendTerms.of(control, self._bend_weights)
        near = np.flatnonzero(np.abs(terms.value) > self.limit - _FAR_BEND)
        terms = terms.take(near)
        return terms, np.where(terms.value < 0.0, -1.0, 1.0)

    def _clearances(self, control: Array, direction: int, thinner: float) -> tuple[RowTerms, float]:
        """Return a section's rows of clearance, and the least clearance found."""
        motion = SectionMotion(self.shape.spline, control, direction)
        fine, basis, slopes = _grid(self.layout.segments)
        rows, least = rows_along(
            self.scene.world,
            self.bodies.thinner_by(thinner),
            motion,
            self.scene.margin + _EXTRA + thinner,
            samples=_SAMPLES,
            along=Samples.of(fine, motion.placed(basis, slopes)),
            finder=self._finder,
        )
        rows = rows.nearest(self.most_rows)
        first, second = (self.shape.spline.basis(rows.parameter, order) for order in (0, 1))
        return RowTerms.of(rows, control, direction, (first, second)), least

    def curving(self, point: Point, multipliers: Multipliers) -> Array:
        """Return the second derivative of the constraints times their multipliers."""
        total = np.zeros_like(point.hessian)
        begin = bend_begin = 0
        for k, (terms, (bends, sign)) in enumerate(zip(point.terms, point.bends, strict=True)):
            own = multipliers.clearances[begin : begin + len(terms.value)]
            bent = sign * multipliers.bends[bend_begin : bend_begin + len(sign)]
            begin, bend_begin = begin + len(own), bend_begin + len(bent)
            pushing, bending = np.flatnonzero(own), np.flatnonzero(bent)
            terms, own = terms.take(pushing), own[pushing]
            bends, bent = bends.take(bending), bent[bending]
            gradient = own @ terms.jacobian + bent @ bends.jacobian
            hessian = terms.hessian(own, self.shape.spline) + bends.hessian(bent)
            derivative = self.shape.derivative(point.x, k)
            total += derivative.T @ hessian @ derivative
            total += self.shape.bending(point.x, k, gradient)
        return total
