"""From a rough manoeuvre to the smooth one: a trust-region method with fresh contacts each step.

Every step solves a quadratic program: the cost's curvature made positive, the constraints
linearised, the step bounded. Before each step the contacts are picked again along the current
curve, so that the rows of clearance are the true distances to first order. A step is kept if the
cost with the true clearance's price falls enough; the bound grows and shrinks with how well it
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
from functools import lru_cache, partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from narrows.bezier_section import BezierSection
from narrows.errors import ShapeError
from narrows.geometry import offset_polygon
from narrows.path import Path
from narrows.quadratic import solve_quadratic
from narrows.scene import Scene
from narrows.se2 import Array
from narrows.vehicle import Layer, Vehicle

from .body_program import Layout, ManoeuvreProgram, Weights
from .clearance_rows import Rows, rows_along

_BEHIND = 1e-3  # m: shortest leg; keeps the heading at a node defined
_EDGE = 0.98  # share of the goal's tolerance that is used
_CURVATURE_SHARE = 0.99  # share of the curvature limit asked for at samples
_CLEAR = 0.01  # m: a body thinner than the chair stays this clear, its contacts turn slowly
_SMALLEST = 1e-5  # m, rad: trust radius at which a search for a better step ends
_SLACK_CURVATURE = 10.0  # cost / m^2: 2e-3 at a slack of 20 mm
_DEARER = 10.0  # how much the price of clearance is raised where the margin is not kept
_WITHIN_REACH = 0.01  # m: beyond contact by more than this, it is not raised
_SHARPEST = 8.0  # 1/m: chairs that may turn on the spot bend no sharper while driving
_FAR_BEND = 1.0  # 1/m: curvature this far below the limit is not watched in a step
_SAMPLES = 97  # along a section while it moves; twice as many must agree in the end
_UNSEEN = 1e-4  # m: clearance that more samples may take away without another step
_EXTRA = 3e-4  # m: required beyond the margin, for what lies between samples


@dataclass(frozen=True)
class RefinementOptions:
    """How a manoeuvre is refined.

    Attributes:
        weights: What smoothness costs, and what a metre of missing clearance does.
        segments: Cubic pieces of each section.
        rows: Rows of clearance of each section.
        iterations: Largest number of steps.
        radius: First bound on a step [m, rad].
        enough: Stop when a step promises less than this share of the cost.
    """

    weights: Weights = field(default_factory=Weights)
    segments: int = 6
    rows: int = 128
    iterations: int = 45
    radius: float = 0.15
    enough: float = 1e-3


@dataclass(frozen=True, eq=False)
class Manoeuvre:
    """Sections of spline control points, driven one way each.

    Attributes:
        directions: +1 or -1 for each section, shape (K,).
        nodes: Poses where sections meet, shape (K + 1, 3), headings continuous, [m, m, rad].
        controls: Control points of each section's spline, shape (K, count, 2), [m].
    """

    directions: NDArray[np.int64]
    nodes: Array
    controls: Array


@dataclass(frozen=True, eq=False)
class Refined:
    """Where a refinement ended.

    Attributes:
        path: The smooth path, judged by nobody yet.
        cost: Cost with prices.
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


@lru_cache(maxsize=16)
def _program(layout: Layout) -> ManoeuvreProgram:
    return ManoeuvreProgram(layout)


@dataclass(frozen=True, eq=False)
class _State:
    """A point with its cost, derivatives and constraints.

    `thinner` is how far every side of the body is moved inward, `least` that body's clearance.
    """

    x: Array
    cost: float
    gradient: Array
    hessian: Array
    constraints: Array
    jacobian: Array
    thinner: float
    least: float


class Refinement:
    """One scene's refinement for manoeuvres of one number of sections."""

    def __init__(
        self, scene: Scene, directions: ArrayLike, options: RefinementOptions | None = None
    ) -> None:
        """Get the compiled program for this number of sections."""
        self.scene = scene
        self.options = RefinementOptions() if options is None else options
        self.directions = np.array(directions, dtype=np.int64)
        if not len(self.directions) or (np.abs(self.directions) != 1).any():
            raise ShapeError(f"directions must be +1 or -1, got {directions!r}")
        chosen = self.options
        self.layout = Layout(len(self.directions), chosen.segments, chosen.rows)
        self.program = _program(self.layout)
        self.spline = self.program.spline
        self.evaluations = 0
        self.tried = 0
        self.goal = scene.goal.pose  # its heading by whole turns as the guess has it
        self.weights = self.options.weights
        self.samples = _SAMPLES
        self.thinnest = 0.8 * min(_inradius(layer.polygon) for layer in scene.vehicle.layers)
        self._thinner: dict[float, Vehicle] = {}
        self.allowed = min(scene.vehicle.limits.curvature, _SHARPEST)
        self.limit = _CURVATURE_SHARE * self.allowed

    def run(self, guess: Manoeuvre) -> Refined:
        """Return the smooth manoeuvre reached from a guess.

        Where that lacks some of the margin, the price of clearance is raised and the descent goes
        on: a high price from the start makes the way there long.
        """
        state = self._evaluate(self._pack(guess), 0.0)
        if state.least < _CLEAR:
            state = self._evaluate(state.x, min(_CLEAR - state.least, self.thinnest))
        state = self._descended(state)
        if _UNSEEN < state.x[-2] < self.scene.margin + _WITHIN_REACH:
            dearer = _DEARER * self.weights.price
            self.weights = replace(self.weights, price=dearer)
            state = self._descended(self._evaluate(state.x, 0.0))
        for _ in range(2):
            beyond = self._path(state.x).max_curvature - self.allowed
            if not 0.0 < beyond < self.allowed:
                break
            self.limit -= 1.5 * beyond  # what lies between the samples of the curvature
            state = self._descended(self._evaluate(state.x, 0.0))
        return Refined(
            self._path(state.x),
            state.cost,
            float(state.x[-2]),
            float(state.x[-1]),
            self.tried,
            self.evaluations,
        )

    def _descended(self, state: _State) -> _State:
        """Return where the trust-region method ends, seen with the chair's own body."""
        options = self.options
        radius, last = options.radius, self.tried + options.iterations
        while self.tried < last:
            self.tried += 1
            found = self._step(state, radius)
            step, promised = found if found is not None else (None, np.inf)
            if step is None and radius > _SMALLEST:
                radius *= 0.25
            elif step is None or promised < self._enough(state) or radius < _SMALLEST:
                closer = self._closer(state)
                if closer is None:
                    break
                state, radius = closer, max(radius, 0.3 * options.radius)
            else:
                trial = self._evaluate(state.x + step, state.thinner)
                ratio = (state.cost - trial.cost) / promised
                longest = float(np.abs(step[:-2]).max())
                state = trial if ratio > 0.1 else state
                if ratio < 0.25:
                    radius = 0.35 * min(radius, longest)
                elif ratio > 0.7 and longest > 0.9 * radius:
                    radius = min(2.0 * radius, options.radius)
                thinner = self._grown_back(state)
                if thinner < 0.6 * state.thinner - 0.1 * _CLEAR:
                    state = self._evaluate(state.x, thinner)
        return state if state.thinner == 0.0 else self._evaluate(state.x, 0.0)

    def _enough(self, state: _State) -> float:
        """Return the promise below which a step is not worth trying; more on the way there."""
        share = self.options.enough * (10.0 if state.thinner > 0.0 else 1.0)
        return share * max(1.0, abs(state.cost))

    def _closer(self, state: _State) -> _State | None:
        """Return the state seen more truly where that asks for further steps, else None.

        First with the body grown back as far as it may, then with the chair's own body and twice
        the samples.
        """
        thinner = self._grown_back(state)
        if thinner < 0.9 * state.thinner - 0.1 * _CLEAR:
            return self._evaluate(state.x, thinner)
        if self.samples > _SAMPLES:
            return None
        self.samples = 2 * _SAMPLES - 1
        true = self._evaluate(state.x, 0.0)
        return true if true.x[-2] > state.x[-2] + _UNSEEN else None

    def _grown_back(self, state: _State) -> float:
        """Return how much thinner the body must stay for the curve to be clear of it.

        Growing every side by e brings it nearer to anything by sqrt(2) e at most (a mitred right
        angle; flatter corners less).
        """
        return max(0.0, state.thinner - (state.least - _CLEAR) / math.sqrt(2.0))

    def _vehicle(self, thinner: float) -> Vehicle:
        """Return the chair with every side moved inward."""
        if thinner == 0.0:
            return self.scene.vehicle
        if thinner not in self._thinner:
            layers = tuple(
                Layer(offset_polygon(layer.polygon, -thinner), layer.z)
                for layer in self.scene.vehicle.layers
            )
            self._thinner[thinner] = replace(self.scene.vehicle, layers=layers)
        return self._thinner[thinner]

    def _pack(self, guess: Manoeuvre) -> Array:
        """Return the unknowns of a manoeuvre."""
        count = self.spline.count
        if guess.controls.shape != (len(self.directions), count, 2):
            raise ShapeError(f"controls must be {(len(self.directions), count, 2)}")
        x = np.zeros(self.layout.size)
        turns = np.rint((guess.nodes[-1, 2] - self.scene.goal.pose[2]) / (2.0 * np.pi))
        self.goal = self.scene.goal.pose + np.array([0.0, 0.0, 2.0 * np.pi * turns])
        for k, control in enumerate(guess.controls):
            x[3 * k : 3 * k + 3] = guess.nodes[k + 1]
            first = np.linalg.norm(control[1] - control[0])
            last = np.linalg.norm(control[-1] - control[-2])
            x[self.layout.section(k)] = [
                max(first, 10.0 * _BEHIND),
                max(last, 10.0 * _BEHIND),
                *control[2:-2].ravel(),
            ]
        return x

    def _controls(self, x: Array) -> list[Array]:
        """Return the control points of every section."""
        controls, first = [], self.scene.start
        for k, direction in enumerate(self.directions):
            last, own = x[3 * k : 3 * k + 3], x[self.layout.section(k)]
            ahead = direction * np.array([np.cos(first[2]), np.sin(first[2])])
            back = direction * np.array([np.cos(last[2]), np.sin(last[2])])
            ends = [first[:2], first[:2] + own[0] * ahead, last[:2] - own[1] * back, last[:2]]
            controls.append(np.vstack([ends[:2], own[2:].reshape(-1, 2), ends[2:]]))
            first = last
        return controls

    def _path(self, x: Array) -> Path:
        return Path(
            tuple(
                BezierSection(self.spline.to_bezier(control), int(direction))
                for control, direction in zip(self._controls(x), self.directions, strict=True)
            )
        )

    def _poses(self, control: Array, direction: int, parameter: Array) -> Array:
        position = self.spline.basis(parameter) @ control
        slope = direction * (self.spline.basis(parameter, 1) @ control)
        return np.column_stack([position, np.arctan2(slope[:, 1], slope[:, 0])])

    def _evaluate(self, x: Array, thinner: float) -> _State:
        """Return cost and constraints with fresh contacts; the slacks become what is missing."""
        self.evaluations += 1
        scene, layout = self.scene, self.layout
        blocks, used, least = [], [], np.inf
        vehicle = self._vehicle(thinner)
        for control, direction in zip(self._controls(x), self.directions, strict=True):
            rows, found = rows_along(
                scene.world,
                vehicle,
                partial(self._poses, control, int(direction)),
                scene.margin + _EXTRA + thinner,
                samples=self.samples,
            )
            least = min(least, found)
            rows = rows.nearest(layout.rows)
            blocks.append(self._block(rows))
            used.append(np.arange(layout.rows) < len(rows.gap))
        parameters = np.concatenate(
            [
                scene.start,
                self.goal,
                [scene.goal.position_tolerance],
                self.directions,
                self.weights.values,
                *blocks,
            ]
        )
        x = x.copy()
        x[-2:] = 0.0
        cost, gradient, hessian, g, jacobian = self.program.evaluate(x, parameters)
        bends, watched = self._split(g, np.concatenate(used))
        slack = max(0.0, float(-watched.min(initial=0.0)))
        excess = max(0.0, float(bends.max()) - self.limit)
        x[-2:] = slack, excess
        weights = self.weights
        total = cost + weights.price * slack + weights.bend_price * excess
        g[2 : 2 + len(bends)] -= excess
        g[2 + len(bends) :] += slack
        g[2 + len(bends) :][~np.concatenate(used)] = np.inf
        return _State(x, total, gradient, _convex(hessian), g, jacobian, thinner, least)

    def _split(self, g: Array, used: NDArray[np.bool_]) -> tuple[Array, Array]:
        """Return curvature rows and the clearance rows in use."""
        count = 2 * self.layout.bends * self.layout.sections
        return g[2 : 2 + count], g[2 + count :][used]

    def _block(self, rows: Rows) -> Array:
        """Return the parameters of a section's rows, unused ones harmless at t = 0."""
        layout, count = self.layout, self.spline.count
        block = np.zeros((layout.rows, layout.row_width))
        block[:, :count] = self.spline.basis([0.0])
        block[:, count : 2 * count] = self.spline.basis([0.0], 1)
        n = len(rows.gap)
        if n:
            block[:n, :count] = self.spline.basis(rows.parameter)
            block[:n, count : 2 * count] = self.spline.basis(rows.parameter, 1)
            block[:n, 2 * count :] = rows.fields
        return block.ravel()

    def _step(self, state: _State, radius: float) -> tuple[Array, float] | None:
        """Return the step within the trust radius, and the fall of the cost it promises."""
        layout, scene = self.layout, self.scene
        bends = 2 * layout.bends * layout.sections
        used = np.isfinite(state.constraints)
        used[2 : 2 + bends] &= state.constraints[2 : 2 + bends] > self.limit - _FAR_BEND
        upper = np.full(len(state.constraints), np.inf)
        lower = np.full(len(state.constraints), -np.inf)
        reach = _EDGE * scene.goal.position_tolerance / np.sqrt(2.0)
        lower[:2], upper[:2] = -reach, reach
        upper[2 : 2 + bends] = self.limit
        lower[2 + bends :] = 0.0
        step_lower = np.full(layout.size, -radius)
        step_upper = np.full(layout.size, radius)
        for k in range(layout.sections):
            begin = layout.section(k).start
            legs = slice(begin, begin + 2)
            step_lower[legs] = np.minimum(0.0, np.maximum(-radius, _BEHIND - state.x[legs]))
        goal = 3 * layout.sections - 1
        turn = _EDGE * scene.goal.heading_tolerance
        off = state.x[goal] - self.goal[2]
        step_lower[goal] = max(-radius, min(0.0, -turn - off))
        step_upper[goal] = min(radius, max(0.0, turn - off))
        step_lower[-2:], step_upper[-2:] = -state.x[-2:], 1e3
        g = state.constraints[used]
        # A start beyond the goal's tolerance must be able to step at all.
        low = np.minimum(lower[used] - g, np.where(np.arange(len(g)) < 2, radius, np.inf))
        high = np.maximum(upper[used] - g, np.where(np.arange(len(g)) < 2, -radius, -np.inf))
        step = solve_quadratic(
            state.hessian,
            state.gradient,
            state.jacobian[used],
            low,
            high,
            step_lower,
            step_upper,
        )
        if step is None:
            return None
        return step, -float(state.gradient @ step + 0.5 * step @ state.hessian @ step)


def _inradius(polygon: Array) -> float:
    """Return a distance by which every edge can move inward at least [m]."""
    low, high = 0.0, float(np.ptp(polygon, axis=0).min())
    for _ in range(12):
        middle = 0.5 * (low + high)
        try:
            offset_polygon(polygon, -middle)
        except ShapeError:
            high = middle
        else:
            low = middle
    return low


def _convex(hessian: Array) -> Array:
    """Return the Hessian with its eigenvalues' absolute values, at least a little."""
    values, vectors = np.linalg.eigh(0.5 * (hessian + hessian.T))
    convex = (vectors * np.maximum(np.abs(values), 1e-2)) @ vectors.T
    # The slacks enter linearly; a little curvature keeps the quadratic program well scaled.
    convex[[-2, -1], [-2, -1]] = _SLACK_CURVATURE
    return np.asarray(convex)
