"""`narrows passable`: can any motion of this chair get from start to goal?"""

from __future__ import annotations

from ..scene import load_scene
from .outcome import IMPASSABLE, NOT_FOUND, OK, Outcome, lines

_CODES = {"passable": OK, "impassable": IMPASSABLE, "undecided": NOT_FOUND}


def run_passable(scene_file: str) -> Outcome:
    """Decide whether a scene can be passed at all."""
    from ..planners.passage import passable

    verdict = passable(load_scene(scene_file))
    status = getattr(verdict.status, "value", verdict.status)
    spare, narrowest = verdict.spare_mm, verdict.narrowest
    where = None if narrowest is None else [float(value) for value in narrowest]
    fields = {
        "status": status,
        "spare_mm": spare,
        "narrowest": where,
        "reason": verdict.reason,
        "time_s": verdict.time_s,
    }
    width = "unknown" if spare is None else f"{abs(spare):.0f} mm {'missing' * (spare < 0)}".strip()
    text = lines(
        f"{scene_file}: {status}",
        f"  {verdict.reason}",
        ("to spare" if spare is None or spare >= 0 else "width", width),
        "" if where is None else ("narrowest", f"at ({where[0]:.2f}, {where[1]:.2f})"),
    )
    return Outcome(_CODES[status], fields, text)
