"""`narrows passable`: can any motion of this chair get from start to goal?"""

from __future__ import annotations

import math

from ..scene import load_scene
from .outcome import IMPASSABLE, NOT_FOUND, OK, Outcome, lines
from .plan import check_picture


def run_passable(scene_file: str, *, picture: str | None = None) -> Outcome:
    """Decide whether a scene can be passed at all; draw the verdict if asked."""
    check_picture(picture)
    scene = load_scene(scene_file)
    from ..planners.passage import PassageStatus, passable

    codes = {
        PassageStatus.PASSABLE: OK,
        PassageStatus.IMPASSABLE: IMPASSABLE,
        PassageStatus.UNDECIDED: NOT_FOUND,
    }
    verdict = passable(scene)
    if picture is not None:
        from ..viewer.pictures import save_picture
        from ..viewer.verdict_pictures import verdict_picture

        save_picture(verdict_picture(scene, verdict), picture)
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
        f"{scene.name or scene_file}: {verdict.status.value}",
        f"  {verdict.reason}",
        "" if spare is None or verdict.status is PassageStatus.UNDECIDED else _room(spare),
        "" if where is None else ("narrowest", f"at ({where[0]:.2f}, {where[1]:.2f})"),
        ("decided in", f"{verdict.time_s:.1f} s"),
        ("written", picture) if picture is not None else "",
    )
    return Outcome(codes[verdict.status], fields, text)


def _room(spare: float) -> tuple[str, str]:
    """Return the spare room or what is missing [m], to 0.1 mm on the careful side."""
    if not math.isfinite(spare):
        return "to spare" if spare > 0.0 else "missing", "more than was looked for"
    if spare >= 0.0:
        return "to spare", f"{math.floor(1e4 * spare) / 10:.1f} mm"
    return "missing", f"{math.ceil(-1e4 * spare) / 10:.1f} mm"
