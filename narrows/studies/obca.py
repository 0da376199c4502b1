"""A plain OBCA, solved once and taken at its word, or again until its whole motion fits.

[OBCA] keeps the body clear at the nodes alone (`obca_program`). How much a motion loses between
them is known only afterwards, by the certificate.
"""

from __future__ import annotations

from dataclasses import dataclass

from ..clearance import certify
from ..errors import ShapeError
from ..path import Path
from ..scene import Scene
from ..se2 import Array
from .obca_program import HalfPlanes, ObcaProgram, ProgramShape, half_planes

_RESOLVES = 6  # solves after the first that a motion cutting between nodes is given
_EXTRA = 2e-4  # m: asked for beyond what was missing
_SHORT = 5e-4  # m: of the clearance wanted, not worth another solve
_CERTIFIED = 2e-4  # m: how far the proven clearance may stay below the true one
TOUCH = 1e-3
"""Clearance asked for at the nodes [m]: nobody should fail for touching."""


@dataclass(frozen=True, eq=False)
class ObcaResult:
    """What OBCA claims.

    Attributes:
        path: The arcs, or None where the solver failed.
        reason: The solver's outcome, for people.
        iterations: IPOPT's iterations in all.
        solves: Programs solved.
    """

    path: Path | None
    reason: str
    iterations: int
    solves: int


def obca(scene: Scene, guess: Path, *, keep: float | None, margin: float = TOUCH) -> ObcaResult:
    """Return the motion OBCA finds from a rough forward path.

    Args:
        scene: The scene, its body of one layer.
        guess: A rough path that drives forward.
        keep: Clearance that the whole motion must be certified to keep, but for half a millimetre;
            while it does not, it is solved again with more at the nodes [m]. None: the solver's
            word is taken.
        margin: Clearance asked for at the nodes at first [m].

    Raises:
        ShapeError: If the body has several layers.
    """
    if len(scene.vehicle.layers) != 1:
        raise ShapeError("OBCA here knows bodies of one layer")
    if (guess.directions != 1).any():
        return ObcaResult(None, "the start reverses or turns on the spot", 0, 0)
    body = half_planes(scene.vehicle.layers[0].polygon, 0.0)
    solids = _solids(scene)
    program = ObcaProgram.of(ProgramShape(body.edges, tuple(solid.edges for solid in solids)))
    start: Array = program.start(scene, guess, body, solids)
    iterations = 0
    for count in range(1, _RESOLVES + 2):
        solution = program.solve(scene, body, solids, start, margin)
        iterations += solution.statistics.iterations
        if not solution.is_solved:
            return ObcaResult(None, solution.message, iterations, count)
        path = program.path(solution)
        certificate = certify(scene.world, scene.vehicle, path, tolerance=_CERTIFIED)
        if keep is None or (certificate.is_clear and certificate.clearance > keep - _SHORT):
            return ObcaResult(path, solution.message, iterations, count)
        margin += max(keep - certificate.attained, 0.0) + _EXTRA
        start = solution.unknowns
    return ObcaResult(None, f"still {certificate.reason}", iterations, count)


def _solids(scene: Scene) -> list[HalfPlanes]:
    pieces = scene.world.pieces_between(*scene.vehicle.layers[0].z)
    return [
        half_planes(corners, float(radius))
        for corners, radius in zip(pieces.corners, pieces.radius, strict=True)
    ]
