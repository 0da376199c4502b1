"""The nonlinear program of a manoeuvre: smooth sections, the exact body kept off the solids.

A manoeuvre is K sections, each a cubic spline driven one way, that meet at rest in the nodes
(x, y, theta). Unknown are the nodes but the first, the legs along the headings at both ends of
every section, the control points between, and two slacks. Minimised is

    sum over sections of INT [kappa^2 + l^2 kappa_s^2] ds + a L + b r
    + price * slack + bend_price * excess,

with L the length and r what keeps the parametrisation even. A row of clearance is one corner
against one axis at one parameter t of a section, all of them parameters of the program, so that
one compiled program serves every scene with as many sections:

    axis n fixed in the world:  h - n.(p + R v) >= required - share * slack
    axis m fixed in the body:   m.R'(q - p) - h >= required - share * slack

p and R are the pose at t, v a corner of the body, q a corner of the solid, h the support of the
other one along the axis. Each is exact for convex shapes where the axis separates them. The
curvature keeps |kappa| <= limit + excess at samples; both slacks are prices, not licences: what
they leave is found by the certificate and the limit check.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from functools import cached_property

os.environ.setdefault("OMP_NUM_THREADS", "1")

import casadi as ca
import numpy as np

from narrows.nlp import Problem
from narrows.quadratic import InPlace
from narrows.se2 import Array

from .spline import Spline

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(4)
_BENDS = 8  # samples of the curvature bound on each cubic piece


@dataclass(frozen=True)
class Weights:
    """What a manoeuvre costs.

    Attributes:
        rate_length: l [m]: a change of curvature of 1/m over l costs what 1/m costs over 1 m.
        length: a [cost / m].
        evenness: b [cost]: uneven parametrisation.
        goal: Cost of using the goal's whole tolerance [cost].
        price: Cost of clearance missing from what is required [cost / m].
        bend_price: Cost of curvature beyond the limit [cost m].
    """

    rate_length: float = 0.3
    length: float = 0.05
    evenness: float = 2e-2
    goal: float = 0.02
    price: float = 2000.0
    bend_price: float = 5000.0

    @property
    def values(self) -> list[float]:
        """The numbers in the program's order."""
        return [
            self.rate_length,
            self.length,
            self.evenness,
            self.goal,
            self.price,
            self.bend_price,
        ]


@dataclass(frozen=True)
class Layout:
    """Where the unknowns, parameters and constraints of a manoeuvre stand in their vectors.

    Attributes:
        sections: Number of sections K.
        segments: Cubic pieces of each section.
        rows: Rows of clearance of each section.
    """

    sections: int
    segments: int
    rows: int

    @property
    def per_section(self) -> int:
        """Unknowns of one section: two legs and the free control points."""
        return 2 + 2 * (self.segments - 1)

    @property
    def size(self) -> int:
        """Number of unknowns: the nodes but the first, the sections, slack and excess."""
        return (3 + self.per_section) * self.sections + 2

    def section(self, k: int) -> slice:
        """Unknowns of section k: first leg, last leg, control points."""
        begin = 3 * self.sections + k * self.per_section
        return slice(begin, begin + self.per_section)

    @property
    def bends(self) -> int:
        """Rows of curvature of each section."""
        return _BENDS * self.segments + 1

    @property
    def row_width(self) -> int:
        """Parameters of a row: weights, slopes, and `ROW_FIELDS`."""
        return 2 * Spline(self.segments).count + len(ROW_FIELDS)


ROW_FIELDS = (
    "axis_x",
    "axis_y",
    "corner_x",
    "corner_y",
    "support",
    "in_world",
    "required",
    "share",
)
"""What a row of clearance is told, after the weights of p and of its derivative at t."""


class Evaluation:
    """Dense values of some expressions of a program, in one array."""

    def __init__(self, problem: Problem, parts: list[ca.SX]) -> None:
        """Compile the expressions."""
        self._shapes = [part.shape for part in parts]
        model = ca.Function(
            "model",
            [problem.unknowns, problem.parameters],
            [ca.vertcat(*[ca.vec(ca.densify(part)) for part in parts])],
        )
        self._unknowns = np.zeros(problem.unknowns.numel())
        self._parameters = np.zeros(problem.parameters.numel())
        self._values = np.zeros(model.numel_out(0))
        given = {0: self._unknowns, 1: self._parameters}
        self._model = InPlace(model, given, {0: self._values})

    def __call__(self, x: Array, parameters: Array) -> list[Array]:
        """Return the values of the parts, each of its shape (rows, columns)."""
        self._unknowns[:], self._parameters[:] = x, parameters
        self._model.run()
        column, found, begin = self._values.copy(), [], 0
        for rows, columns in self._shapes:
            end = begin + rows * columns
            found.append(column[begin:end].reshape(columns, rows).T)
            begin = end
        return found


class ManoeuvreProgram:
    """The program for a number of sections, stated and compiled once.

    Attributes:
        layout: Where things stand.
        spline: The basis of every section.
        problem: The program in symbols; constraints are the goal's offset along and across its
            heading [m] (2), then for each section kappa - excess and -kappa - excess [1/m], then
            for each section its rows of clearance, less what is required [m].
    """

    def __init__(self, layout: Layout) -> None:
        """State the program; what is evaluated is compiled at its first use."""
        self.layout = layout
        self.spline = Spline(layout.segments)
        self.problem = self._state()

    @cached_property
    def _cost_parts(self) -> list[ca.SX]:
        hessian, gradient = ca.hessian(self.problem.objective, self.problem.unknowns)
        return [self.problem.objective, gradient, hessian]

    @cached_property
    def _cost(self) -> Evaluation:
        return Evaluation(self.problem, self._cost_parts)

    @cached_property
    def _everything(self) -> Evaluation:
        rows = self.problem.constraints
        jacobian = ca.jacobian(rows, self.problem.unknowns)
        return Evaluation(self.problem, [*self._cost_parts, rows, jacobian])

    def cost(self, x: Array, parameters: Array) -> tuple[float, Array, Array]:
        """Return cost, gradient (n,) and Hessian (n, n)."""
        cost, gradient, hessian = self._cost(x, parameters)
        return float(cost.item()), gradient.ravel(), hessian

    def evaluate(self, x: Array, parameters: Array) -> tuple[float, Array, Array, Array, Array]:
        """Return cost, gradient (n,), Hessian (n, n), constraints (m,) and Jacobian (m, n)."""
        cost, gradient, hessian, rows, jacobian = self._everything(x, parameters)
        return float(cost.item()), gradient.ravel(), hessian, rows.ravel(), jacobian

    def _state(self) -> Problem:
        layout = self.layout
        unknowns = ca.SX.sym("x", layout.size)
        start, goal = ca.SX.sym("start", 3), ca.SX.sym("goal", 4)  # the goal's 4th: its tolerance
        direction = ca.SX.sym("direction", layout.sections)
        weights = ca.SX.sym("weights", 6)
        rows = [
            ca.SX.sym(f"rows_{k}", layout.row_width, layout.rows) for k in range(layout.sections)
        ]
        slack, excess = unknowns[-2], unknowns[-1]
        cost = weights[4] * slack + weights[5] * excess
        bends, clearances = [], []
        for k in range(layout.sections):
            first = start if k == 0 else unknowns[3 * (k - 1) : 3 * k]
            last, own = unknowns[3 * k : 3 * k + 3], unknowns[layout.section(k)]
            control = self._control(first, last, own, direction[k])
            cost += self._roughness(control, weights)
            bend = self._curvature(control, np.linspace(0.0, 1.0, layout.bends))
            bends += [bend - excess, -bend - excess]
            clearances += [
                _clearance(control, direction[k], rows[k][:, i], slack) for i in range(layout.rows)
            ]
        last = unknowns[3 * (layout.sections - 1) : 3 * layout.sections]
        off = last[:2] - goal[:2]
        ahead = ca.vertcat(ca.cos(goal[2]), ca.sin(goal[2]))
        aside = ca.vertcat(-ahead[1], ahead[0])
        cost += weights[3] * (ca.sumsqr(off) / goal[3] ** 2 + (last[2] - goal[2]) ** 2 / 0.05**2)
        return Problem(
            unknowns,
            cost,
            ca.vertcat(ca.dot(off, ahead), ca.dot(off, aside), *bends, *clearances),
            ca.vertcat(start, goal, direction, weights, *[ca.vec(r) for r in rows]),
            name=f"manoeuvre of {layout.sections} sections",
        )

    def _control(self, first: ca.SX, last: ca.SX, own: ca.SX, direction: ca.SX) -> ca.SX:
        """Return the control points of a section, (count, 2)."""
        begin = first[:2] + own[0] * direction * ca.vertcat(ca.cos(first[2]), ca.sin(first[2]))
        end = last[:2] - own[1] * direction * ca.vertcat(ca.cos(last[2]), ca.sin(last[2]))
        free = ca.reshape(own[2:], 2, self.layout.segments - 1)
        return ca.horzcat(first[:2], begin, free, end, last[:2]).T

    def _curvature(self, control: ca.SX, parameter: Array) -> ca.SX:
        first = ca.DM(self.spline.basis(parameter, 1)) @ control
        second = ca.DM(self.spline.basis(parameter, 2)) @ control
        return _cross(first, second) / _norm(first) ** 3

    def _roughness(self, control: ca.SX, weights: ca.SX) -> ca.SX:
        """Return INT [kappa^2 + l^2 kappa_s^2] ds + a L + b r by Gauss-Legendre quadrature."""
        pieces = np.arange(self.layout.segments)[:, None]
        parameter = ((pieces + 0.5 * (1.0 + _NODES)) / self.layout.segments).ravel()
        weight = ca.DM(np.tile(0.5 * _WEIGHTS / self.layout.segments, self.layout.segments))
        first, second, third = (
            ca.DM(self.spline.basis(parameter, order)) @ control for order in (1, 2, 3)
        )
        speed = _norm(first)
        along = ca.sum2(first * second)
        bend = _cross(first, second) / speed**3
        rate = _cross(first, third) / speed**4 - 3.0 * bend * along / speed**3
        density = speed * (bend**2 + weights[0] ** 2 * rate**2 + weights[1])
        return ca.dot(weight, density + weights[2] * (along / speed**2) ** 2)


def _cross(a: ca.SX, b: ca.SX) -> ca.SX:
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]


def _norm(a: ca.SX) -> ca.SX:
    return ca.sqrt(ca.sum2(a**2))


def _clearance(control: ca.SX, direction: ca.SX, row: ca.SX, slack: ca.SX) -> ca.SX:
    """Return the clearance of one corner along one axis, less what is required."""
    count = control.shape[0]
    position = (row[:count].T @ control).T
    slope = (row[count : 2 * count].T @ control).T
    ahead = direction * slope / ca.norm_2(slope)
    aside = ca.vertcat(-ahead[1], ahead[0])
    axis, corner = row[2 * count : 2 * count + 2], row[2 * count + 2 : 2 * count + 4]
    support, in_world, required, share = (row[2 * count + i] for i in range(4, 8))
    in_body = ahead * corner[0] + aside * corner[1]
    world = support - ca.dot(axis, position + in_body)
    turned = ahead * axis[0] + aside * axis[1]
    body = ca.dot(turned, corner - position) - support
    return in_world * world + (1.0 - in_world) * body - required + share * slack
