"""Judging anybody's motion in a scene: clear, inside, rolling without slip, within the limits."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from .clearance import Certificate, certify
from .errors import TrajectoryError
from .limit_check import SLIP, LimitCheck, check_limits
from .path import Path
from .profile import Profile
from .scene import Scene
from .se2 import Array, wrap
from .trajectory import Trajectory
from .twist_section import TwistSection
from .vehicle import Vehicle

TOLERANCE = 2e-4
"""How far the proven clearance may stay below the true one [m]; the same as for plans."""

LONGEST = 2000.0
"""Progress [m or rad] beyond which a motion is not judged in one piece."""

_PATH_LIMITS = ("curvature", "slip")
_UNITS = range(3, 9)  # decimals [m] that are taken for rounding; fewer are taken as meant
_START_TOLERANCE = (0.005, float(np.deg2rad(0.5)))  # m, rad: what rounded files leave


@dataclass(frozen=True, eq=False)
class Verification:
    """What was found about a motion in a scene.

    Attributes:
        certificate: The proof of clearance.
        limits: What the motion asks of the chair; without times curvature and slip only.
        problems: Why the motion is refused, one sentence each; empty: it is certified.
        notes: What is worth knowing and no reason to refuse: other ends than the scene's, the
            margin not kept, moving things that could not be judged.
        timed: Whether the motion has times.
    """

    certificate: Certificate
    limits: LimitCheck
    problems: tuple[str, ...]
    notes: tuple[str, ...]
    timed: bool

    @property
    def is_certified(self) -> bool:
        """Whether the whole motion is proven clear and inside the bounds, and keeps the limits."""
        return not self.problems

    @property
    def status(self) -> str:
        """`certified` or `refused`."""
        return "certified" if self.is_certified else "refused"

    @property
    def clearance(self) -> float:
        """Proven lower bound on the swept body's clearance [m]; negative: overlap."""
        return self.certificate.clearance

    @property
    def is_clear(self) -> bool:
        """Whether the whole motion is proven free of contact and inside the bounds."""
        return self.certificate.is_clear

    @property
    def reason(self) -> str:
        """What was found, for people."""
        found = self.problems or (self.certificate.reason,)
        return "; ".join((*found, *self.notes))


def verify(scene: Scene, motion: Path | Trajectory | ArrayLike) -> Verification:
    """Return whether a motion is proven to be drivable in a scene.

    Certified is what is clear of everything over the continuous motion, stays inside the bounds,
    rolls without slip and keeps the chair's limits: curvature and forward-only driving always,
    speeds and accelerations where the motion has times.

    >>> from narrows.scene import Goal, Scene
    >>> from narrows.world import Solid, World
    >>> wall = Solid.polygon([[3, -1], [3.1, -1], [3.1, 1], [3, 1]], name="wall")
    >>> chair = Vehicle.rectangle(1.0, 0.8, 0.2)
    >>> scene = Scene(chair, World((wall,)), [0, 0, 0], Goal([2, 0, 0]))
    >>> verify(scene, [[0, 0, 0], [2, 0, 0]]).reason
    'clear by 200.0 mm, least against wall at (2.00, 0.00)'

    Args:
        scene: World, chair, and the ends that notes are about.
        motion: A path, a trajectory, or poses [x, y, heading], shape (N, 3), joined by constant
            twists, [m, m, rad].

    Raises:
        ShapeError: If an array of poses is no motion.
        TrajectoryError: If the motion is longer than `LONGEST`.
    """
    if not isinstance(motion, (Path, Trajectory)):
        motion = Path.from_poses(motion)
    path = motion.path if isinstance(motion, Trajectory) else motion
    if path.span > LONGEST:
        raise TrajectoryError(
            "the motion is too long to be judged in one piece",
            value=f"{path.span:.0f} m",
            allowed=f"up to {LONGEST:.0f} m; cut it into parts",
        )
    certificate = certify(scene.world, scene.vehicle, motion, tolerance=TOLERANCE)
    if isinstance(motion, Trajectory):
        limits = check_limits(motion, scene.vehicle)
    else:
        limits = _path_limits(motion, scene.vehicle)
    problems = [] if certificate.is_clear else [certificate.reason]
    notes = _notes(scene, path, certificate)
    if limits.violations and (rounding := _coarse_rounding(motion, scene.vehicle)):
        notes.append(
            f"its rows look rounded to {rounding:g} m, too coarse for rows so close to tell how it "
            "drives: give more decimals, or fewer rows"
        )
    if scene.world.moving and not isinstance(motion, Trajectory):
        notes.append("moving things were not judged, as the motion has no times")
    return Verification(
        certificate,
        limits,
        (*problems, *limits.violations),
        tuple(notes),
        isinstance(motion, Trajectory),
    )


def _path_limits(path: Path, vehicle: Vehicle) -> LimitCheck:
    """Return what a path without times asks of the chair: what does not depend on speed."""
    span = max(path.span, 1e-9)
    crawling = Trajectory(path, Profile(np.array([0.0, 1.0]), np.array([[0.0, span, 0.0, 0.0]])))
    check = check_limits(crawling, vehicle)
    wanted = [name.replace("_", " ") for name in _PATH_LIMITS]
    violations = [v for v in check.violations if v.startswith((*wanted, "it turns"))]
    if vehicle.limits.reverse_speed <= 0.0 and (path.directions < 0).any():
        violations.append("it drives in reverse, which the chair does not")
    peaks = {name: check.peaks[name] for name in _PATH_LIMITS}
    return LimitCheck(peaks, tuple(violations))


def _notes(scene: Scene, path: Path, certificate: Certificate) -> list[str]:
    notes = []
    if 0.0 < certificate.clearance < scene.margin:
        notes.append(f"the margin of {1e3 * scene.margin:.0f} mm asked for is not kept")
    off, turned = _difference(path.start, scene.start)
    if off > _START_TOLERANCE[0] or turned > _START_TOLERANCE[1]:
        notes.append(f"it starts {_apart(off, turned)} from the scene's start")
    off, turned = _difference(path.goal, scene.goal.pose)
    goal, slack = scene.goal, 1.0 + 1e-6
    if off > goal.position_tolerance * slack or turned > goal.heading_tolerance * slack:
        notes.append(f"it ends {_apart(off, turned)} from the scene's goal")
    return notes


def _difference(first: Array, second: Array) -> tuple[float, float]:
    """Return distance [m] and angle [rad] between two poses."""
    step = first - second
    return float(np.hypot(step[0], step[1])), abs(float(wrap(step[2])))


def _apart(distance: float, angle: float) -> str:
    return f"{1e3 * distance:.0f} mm and {np.degrees(angle):.1f} degrees"


def _coarse_rounding(motion: Path | Trajectory, vehicle: Vehicle) -> float:
    """Return what rows were rounded to [m] if that alone can look like slip or jerk, else 0.

    A position off by half a unit bends a step by up to a unit over its length, and the jerk from
    four rows by up to four units over the cube of their spacing in time.
    """
    path = motion.path if isinstance(motion, Trajectory) else motion
    rows = [s.poses[:, :2] for s in path.sections if isinstance(s, TwistSection)]
    if len(rows) < len(path.sections):
        return 0.0
    points = np.concatenate(rows)
    unit = next((u for u in _UNITS if np.allclose(points, points.round(u), rtol=0, atol=1e-11)), 0)
    if unit == 0:
        return 0.0
    rounding = 10.0**-unit
    steps = np.concatenate([np.hypot(*np.diff(part, axis=0).T) for part in rows])
    steps = steps[steps > 0.0]
    bends = len(steps) > 0 and rounding / float(np.median(steps)) > 0.25 * SLIP
    jerks = False
    if isinstance(motion, Trajectory) and motion.sampled:
        spacing = float(np.median(np.diff(motion.profile.breaks)))
        jerks = 4.0 * rounding / spacing**3 > 0.1 * vehicle.limits.jerk
    return rounding if bends or jerks else 0.0
