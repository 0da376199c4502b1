"""What a path is worth, by the same yardstick whoever planned it."""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np

from ..clearance import certify
from ..errors import ShapeError
from ..limit_check import check_limits
from ..path import Path
from ..planners.timing import time_path
from ..scene import Scene
from ..se2 import Array, wrap
from ..verification import verify

WINDOW = 0.02
"""Length over which curvature is averaged [m]."""

_TOLERANCE = 1e-4  # m: how far below the true clearance the figure may stay
_START = (0.01, float(np.deg2rad(1.0)))  # m, rad: as the benchmark's referee allows


@dataclass(frozen=True)
class Figures:
    """What a path is worth; columns of the study's table.

    Attributes:
        is_valid: Proven clear and inside the bounds, rolling without slip, curvature and direction
            of travel allowed, from start to goal.
        problem: Why not, one line; empty if valid.
        clearance_mm: Proven clearance; negative: how deep it cuts [mm].
        length_m: Length driven [m].
        max_curvature: Greatest mean curvature over any window [1/m].
        integral_k2: Integral of the squared curvature over the length driven [1/m].
        curvature_jump: Greatest change of curvature from a window to the next while the direction
            of travel stays the same, stops or not [1/m].
        direction_changes: Changes between driving forward and in reverse.
        duration_s: How long it takes within the chair's limits, jerk included [s]; None where no
            speed keeps them, as on a path whose curvature jumps.
        peak_jerk: Greatest jerk of that drive [m/s^3].
    """

    is_valid: bool
    problem: str
    clearance_mm: float
    length_m: float
    max_curvature: float
    integral_k2: float
    curvature_jump: float
    direction_changes: int
    duration_s: float | None
    peak_jerk: float | None

    @property
    def columns(self) -> dict[str, float | str | bool | int | None]:
        """The figures by name."""
        return asdict(self)


def figures_of(scene: Scene, path: Path) -> Figures:
    """Return what a path is worth in a scene.

    The verdict is the certificate's; nobody's word is taken. The curvature is the change of
    heading over successive windows of `WINDOW`, so that arcs, splines and poses compare.

    Args:
        scene: The scene.
        path: What some planner claims to be a way through.
    """
    verdict = verify(scene, path)
    certificate = certify(scene.world, scene.vehicle, path, tolerance=_TOLERANCE)
    problems = [*_ends(scene, path), *verdict.problems]
    runs = _curvature_runs(path)
    bends = np.concatenate([bend for bend, _ in runs] or [np.zeros(1)])
    squares = sum(float(np.sum(bend**2 * length)) for bend, length in runs)
    jump = max((float(np.abs(np.diff(bend)).max(initial=0.0)) for bend, _ in runs), default=0.0)
    duration, jerk = _timed(scene, path)
    clearance = certificate.clearance if certificate.is_clear else certificate.attained
    return Figures(
        is_valid=not problems,
        problem="; ".join(problems),
        clearance_mm=1e3 * clearance,
        length_m=path.length,
        max_curvature=float(np.abs(bends).max()),
        integral_k2=squares,
        curvature_jump=jump,
        direction_changes=path.direction_changes,
        duration_s=duration,
        peak_jerk=jerk,
    )


def window_curvatures(path: Path) -> tuple[Array, Array]:
    """Return progress at the middles of the windows, (N,), and the mean curvature there, (N,)."""
    places, bends = [np.zeros(0)], [np.zeros(0)]
    for k in np.flatnonzero(path.directions).tolist():
        bend, length = _section_windows(path, k)
        places.append(path.section_bounds[k] + np.cumsum(length) - 0.5 * length)
        bends.append(bend)
    return np.concatenate(places), np.concatenate(bends)


def _curvature_runs(path: Path) -> list[tuple[Array, Array]]:
    """Return the windows of each run in one direction of travel: curvatures and lengths."""
    runs: list[tuple[Array, Array]] = []
    before = 0
    for k, direction in enumerate(path.directions.tolist()):
        if direction != 0:
            found = _section_windows(path, k)
            if direction == before:
                last = runs.pop()
                found = (np.concatenate([last[0], found[0]]), np.concatenate([last[1], found[1]]))
            runs.append(found)
        before = direction
    return runs


def _section_windows(path: Path, section: int) -> tuple[Array, Array]:
    """Return the mean curvature over equal windows of a section, and their lengths [m]."""
    driven = path.sections[section]
    count = max(1, round(driven.span / WINDOW))
    heading = driven.evaluate(np.linspace(0.0, driven.span, count + 1))[:, 2]
    length = driven.span / count
    return wrap(np.diff(heading)) / length, np.full(count, length)


def _ends(scene: Scene, path: Path) -> list[str]:
    """Return what is wrong with a path's ends."""
    problems = []
    goal = (scene.goal.position_tolerance, scene.goal.heading_tolerance)
    ends = [
        ("starts", "start", path.start, scene.start, _START),
        ("ends", "goal", path.goal, scene.goal.pose, goal),
    ]
    for verb, name, pose, wanted, (most, widest) in ends:
        off = float(np.hypot(*(pose - wanted)[:2]))
        turned = abs(float(wrap(pose[2] - wanted[2])))
        if off > most * (1.0 + 1e-6) or turned > widest * (1.0 + 1e-6):
            problems.append(
                f"it {verb} {1e3 * off:.0f} mm and {np.degrees(turned):.1f} deg off the {name}"
            )
    return problems


def _timed(scene: Scene, path: Path) -> tuple[float | None, float | None]:
    """Return duration [s] and peak jerk [m/s^3] of the drive, or None where none is possible."""
    try:
        trajectory = time_path(path, scene.vehicle)
    except ShapeError:
        return None, None
    return trajectory.duration, check_limits(trajectory, scene.vehicle).peaks["jerk"]
