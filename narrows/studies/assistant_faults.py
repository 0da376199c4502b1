"""What becomes of an assisted drive when sensors or odometry fail."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ..errors import StudyError
from ..simulation.fitted_sensors import Faults
from ..simulation.judge import judge
from ..simulation.record import Record
from .assistant_course import course_routes, course_scene
from .assistant_drives import PLANT, Conditions, drive, drive_figures, regions_of
from .case import Case, Scalar

_LIMIT = 250.0  # s
_SPELLS = tuple((float(t), t + 1.5) for t in range(8, 400, 12))
_DEAD = 25.0  # s: when the scanners die

TROUBLES: dict[str, Conditions] = {
    "nothing": Conditions(time_limit=_LIMIT),
    "nothing; what is unknown counts as an obstacle": Conditions(
        unknown_is_free=False, time_limit=_LIMIT
    ),
    "scans 0.2 s late, jitter 0.1 s": Conditions(
        faults=Faults(late=((0.0, math.inf, 0.2),), jitter=0.1), time_limit=_LIMIT
    ),
    "40 % of scans missing": Conditions(faults=Faults(lost=0.4), time_limit=_LIMIT),
    "NaN for 1.5 s every 12 s": Conditions(faults=Faults(invalid=_SPELLS), time_limit=_LIMIT),
    "scanners dead after 25 s": Conditions(
        faults=Faults(silent=((_DEAD, math.inf),)), time_limit=60.0
    ),
    "wheels slip 10 %": Conditions(plant=replace(PLANT, slip=0.1), time_limit=_LIMIT),
    "left wheel 3 % small": Conditions(
        plant=replace(PLANT, left_radius_error=-0.03), time_limit=_LIMIT
    ),
}
"""What goes wrong, by name."""


def trouble_case(case: Case, rng: np.random.Generator, regions: str) -> Mapping[str, Scalar]:
    """Return the figures of one drive there and back with something wrong.

    Args:
        case: `trouble`, `driver`.
        rng: Source of everything random.
        regions: File of the safety regions.

    Raises:
        StudyError: If there is no such trouble.
    """
    name = str(case["trouble"])
    if name not in TROUBLES:
        raise StudyError("no such trouble", value=name, allowed=", ".join(TROUBLES))
    scene = course_scene()
    record, driver = drive(
        scene, str(case["driver"]), course_routes(), TROUBLES[name], regions_of(regions), rng
    )
    verdict = judge(scene, record)
    return {
        **drive_figures(record, driver, verdict),
        "stands_at_end": bool(np.abs(record.wheel_speeds[-1]).max() < 0.01),
        "blind_m": blind_travel(record),
    }


def blind_travel(record: Record) -> float | None:
    """Return the longest way a chair went on while its assistant trusted nothing it knew [m].

    None without an assistant.
    """
    trust = record.signals.get("trust")
    if trust is None:
        return None
    longest = went = 0.0
    moved = np.abs(record.wheel_speeds[:-1]).max(axis=1) * np.diff(record.times)
    for share, way in zip(trust[:-1].tolist(), moved.tolist(), strict=True):
        went = went + way if share <= 0.0 else 0.0
        longest = max(longest, went)
    return longest
