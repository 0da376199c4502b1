"""The smoothness cost of a cubic Bezier curve, in symbols for the optimiser and in numbers.

[DoorBezier, Eq. (10a)]: J = INT_0^1 kappa(u)^2 + (d kappa / du)^2 du, over the curve's parameter u
("parameter", unit 1/m^2). It depends on how the curve is parametrised; the form that does not is
J = INT kappa^2 + l^2 (d kappa / ds)^2 ds over arc length with a length weight l ("arc_length",
unit 1/m). Both by Gauss-Legendre quadrature with fixed nodes.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from .. import bezier
from ..errors import ShapeError
from ..se2 import Array

KINDS = ("parameter", "arc_length")


@dataclass(frozen=True)
class Smoothness:
    """Which cost, and how finely it is integrated.

    Attributes:
        kind: "parameter" as in the paper, or "arc_length".
        length_weight: l of the arc-length form [m]; unused by the other.
        nodes: Gauss-Legendre nodes; 24 integrate the curves of the paper's Table I to 1e-6.
    """

    kind: str = "parameter"
    length_weight: float = 1.0
    nodes: int = 24

    def __post_init__(self) -> None:
        """Check the choices."""
        if self.kind not in KINDS:
            raise ShapeError(f"cost must be one of {', '.join(KINDS)}, got {self.kind!r}")
        if self.nodes < 2 or not self.length_weight > 0.0:
            raise ShapeError("a cost needs at least 2 nodes and a positive length weight")

    def quadrature(self) -> tuple[Array, Array]:
        """Return nodes and weights on [0, 1], each shape (nodes,)."""
        node, weight = np.polynomial.legendre.leggauss(self.nodes)
        return np.asarray(0.5 * (node + 1.0)), np.asarray(0.5 * weight)


def bernstein(parameter: Array, order: int = 0) -> Array:
    """Return the weights of the four control points at parameters, shape (N, 4).

    >>> bernstein(np.array([0.5]))
    array([[0.125, 0.375, 0.375, 0.125]])

    Args:
        parameter: Parameters in [0, 1], shape (N,).
        order: Order of the derivative.
    """
    unit = np.stack([np.eye(4), np.zeros((4, 4))], axis=-1)  # (4, 4, 2)
    return np.asarray(bezier.evaluate(unit[:, None], parameter, order)[..., 0].T)


def curvature_symbols(control: ca.SX, parameter: Array) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Return curvature, its derivative by the parameter, and the speed |B'|, each (N,).

    [DoorBezier, Eq. (9), exponent restored].

    Args:
        control: Control points (4, 2).
        parameter: Parameters in [0, 1], shape (N,).
    """
    first, second, third = (
        ca.mtimes(ca.DM(bernstein(parameter, order)), control) for order in (1, 2, 3)
    )
    squared = first[:, 0] ** 2 + first[:, 1] ** 2
    speed = ca.sqrt(squared)
    across = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    across_rate = first[:, 0] * third[:, 1] - first[:, 1] * third[:, 0]
    along = first[:, 0] * second[:, 0] + first[:, 1] * second[:, 1]
    kappa = across / (squared * speed)
    rate = across_rate / (squared * speed) - 3.0 * kappa * along / squared
    return kappa, rate, speed


def cost_symbol(control: ca.SX, smoothness: Smoothness) -> ca.SX:
    """Return J of one curve as an expression.

    Args:
        control: Control points (4, 2).
        smoothness: Which cost.
    """
    node, weight = smoothness.quadrature()
    kappa, rate, speed = curvature_symbols(control, node)
    if smoothness.kind == "parameter":
        return ca.dot(ca.DM(weight), kappa**2 + rate**2)
    if smoothness.kind == "arc_length":
        density = kappa**2 * speed + smoothness.length_weight**2 * rate**2 / speed
        return ca.dot(ca.DM(weight), density)
    raise ShapeError(f"cost must be one of {', '.join(KINDS)}, got {smoothness.kind!r}")


def cost(control: Array, smoothness: Smoothness) -> Array:
    """Return J of curves, the same quadrature in NumPy.

    Args:
        control: Control points, shape (..., 4, 2), [m].
        smoothness: Which cost.

    Returns:
        Cost, shape (...); infinite or NaN where a curve has a cusp at a node.
    """
    node, weight = smoothness.quadrature()
    batch = np.asarray(control, dtype=float)[..., None, :, :]
    kappa = bezier.curvature(batch, node)
    rate = bezier.curvature_rate(batch, node)
    if smoothness.kind == "parameter":
        return np.asarray((kappa**2 + rate**2) @ weight)
    if smoothness.kind == "arc_length":
        speed = np.linalg.norm(bezier.evaluate(batch, node, 1), axis=-1)
        with np.errstate(divide="ignore", invalid="ignore"):
            density = kappa**2 * speed + smoothness.length_weight**2 * rate**2 / speed
        return np.asarray(density @ weight)
    raise ShapeError(f"cost must be one of {', '.join(KINDS)}, got {smoothness.kind!r}")
