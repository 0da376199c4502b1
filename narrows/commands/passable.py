"""`narrows passable`: can any motion of this chair get from start to goal?"""

from __future__ import annotations

import math

from ..scene import load_scene
from .outcome import IMPASSABLE, NOT_FOUND, OK, Outcome, lines


def run_passable(scene_file: str) -> Outcome:
    """Decide whether a scene can be passed at all."""
    from ..planners.passage import PassageStatus, passable

    codes = {
        PassageStatus.PASSABLE: OK,
        PassageStatus.IMPASSABLE: IMPASSABLE,
        PassageStatus.UNDECIDED: NOT_FOUND,
    }
    verdict = passable(load_scene(scene_file))
    spare, narrowest = verdict.spare_m, verdict.narrowest
    where = None if narrowest is None else [float(value) for value in narrowest]
    fields = {
        "status": verdict.status.value,
        "spare_mm": None if spare is None else 1e3 * spare,
        "narrowest": where,
        "reason": verdict.reason,
        "time_s": verdict.time_s,
    }
    text = lines(
        f"{scene_file}: {verdict.status.value}",
        f"  {verdict.reason}",
        "" if spare is None else _room(spare),
        "" if where is None else ("narrowest", f"at ({where[0]:.2f}, {where[1]:.2f})"),
        ("decided in", f"{verdict.time_s:.1f} s"),
    )
    return Outcome(codes[verdict.status], fields, text)


def _room(spare: float) -> tuple[str, str]:
    """Return the spare room or what is missing [m], rounded to the careful side."""
    if spare >= 0.0:
        return "to spare", f"{math.floor(1e3 * spare)} mm"
    return "missing", f"{math.ceil(-1e3 * spare)} mm"
