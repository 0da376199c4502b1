"""`narrows verify`: is anybody's motion proven to be drivable in a scene?"""

from __future__ import annotations

import math

from ..formats import read_trajectory
from ..scene import load_scene
from ..trajectory import Trajectory
from ..verification import Verification, verify
from .outcome import NOT_FOUND, OK, Outcome, lines, millimetres
from .plan import check_picture


def run_verify(scene_file: str, trajectory_file: str, *, picture: str | None) -> Outcome:
    """Judge a motion from a file; draw it if asked."""
    check_picture(picture)
    scene = load_scene(scene_file)
    motion = read_trajectory(trajectory_file)
    result = verify(scene, motion)
    if picture is not None:
        from ..viewer.pictures import save_picture, verification_picture

        save_picture(verification_picture(scene, motion, result), picture)
    timed = isinstance(motion, Trajectory)
    progress, x, y = result.certificate.at
    along = result.certificate.time if timed else progress
    fields = {
        "status": result.status,
        "clearance_m": result.clearance,
        "at": [along, x, y] if math.isfinite(result.clearance) else None,
        "against": result.certificate.against or None,
        "limits_kept": result.limits.kept,
        "reason": result.reason,
    }
    text = _describe(trajectory_file, result, timed)
    if picture is not None:
        text = lines(text, ("written", picture))
    return Outcome(OK if result.is_certified else NOT_FOUND, fields, text)


def _describe(file: str, result: Verification, timed: bool) -> str:
    peaks = result.limits.peaks
    speed = max(peaks["speed"], peaks["reverse_speed"]) if timed else None
    return lines(
        f"{file}: {result.status}",
        *(f"  {problem}" for problem in result.problems),
        *(f"  note: {note}" for note in result.notes),
        ("proven clearance", millimetres(result.clearance)),
        ("nearest", result.certificate.against) if result.certificate.against else "",
        ("greatest curvature", f"{peaks['curvature']:.2f} 1/m"),
        ("greatest speed", "unknown, no times" if speed is None else f"{speed:.2f} m/s"),
    )
