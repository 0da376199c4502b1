"""Rule tables of the fuzzy goal controller: data files, read and checked.

The 35 rules of [FuzzyDVZ] and its membership functions are lost with its figures. The table that
comes along, `derived-D`, is derived, not the paper's; any other file of the same form may stand in.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import InputError
from ..se2 import Array

DERIVED = "derived-d"
"""Name of the table that comes along."""


@dataclass(frozen=True, eq=False)
class RuleTable:
    """Membership peaks and the wheels' outputs of every rule.

    Attributes:
        name: Its name.
        origin: Where its numbers come from.
        distances: Peaks of the distance sets, shape (D,), increasing from 0, [m]. The last set
            stays 1 beyond its peak.
        angles: Peaks of the angle sets, shape (A,), increasing within -pi..pi, [rad]. The outer
            sets stay 1 up to -pi and pi.
        left: Output of each rule for the left wheel, share of the top speed, shape (A, D).
        right: The same for the right wheel, shape (A, D).
    """

    name: str
    origin: str
    distances: Array
    angles: Array
    left: Array
    right: Array

    def __post_init__(self) -> None:
        """Check shapes, order and ranges; keep read-only copies."""
        for field in ("distances", "angles", "left", "right"):
            values = np.array(getattr(self, field), dtype=float)
            if not np.isfinite(values).all():
                raise InputError("a rule table's numbers must be finite", field=field)
            values.setflags(write=False)
            object.__setattr__(self, field, values)
        for field in ("distances", "angles"):
            peaks = getattr(self, field)
            if peaks.ndim != 1 or len(peaks) < 2 or (np.diff(peaks) <= 0.0).any():
                raise InputError(
                    "peaks must increase", field=field, value=peaks.tolist(), allowed="two or more"
                )
        if self.distances[0] != 0.0:
            raise InputError("the first distance set must peak at the target", field="distances")
        if np.abs(self.angles).max() > math.pi:
            raise InputError("angles must lie within a half turn", field="angles")
        shape = (len(self.angles), len(self.distances))
        for field in ("left", "right"):
            values = getattr(self, field)
            if values.shape != shape:
                raise InputError("one output for each rule", field=field, allowed=str(shape))
            if values.min() < 0.0 or values.max() > 1.0:
                raise InputError(
                    "outputs are shares of the top speed and never reverse",
                    field=field,
                    value=[float(values.min()), float(values.max())],
                    allowed="0 to 1",
                )


def read_rule_table(file: Path | str = DERIVED) -> RuleTable:
    """Return the rule table in a JSON file, or the one that comes along.

    A table that is read may still circle its target; `FuzzyGoalController` refuses it then.

    >>> read_rule_table().name
    'derived-D'

    Args:
        file: A file, or `DERIVED`. Its entries are those of `narrows/reactive/rules/*.json`.

    Raises:
        InputError: If it cannot be read; says file, field, value, what is allowed.
    """
    if file == DERIVED:
        text = (resources.files("narrows") / "reactive/rules/derived-d.json").read_text("utf-8")
    else:
        try:
            text = Path(file).read_text("utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise InputError(f"the rule table cannot be read: {error}", file=str(file)) from error
    try:
        entries = json.loads(text)
    except json.JSONDecodeError as error:
        raise InputError(
            f"this is not JSON: {error.msg}", file=str(file), line=error.lineno
        ) from error
    return _table(entries, str(file))


def _table(entries: Any, file: str) -> RuleTable:
    distance_peaks = _numbers(entries, "distance_peaks_m", file)
    angle_peaks = _numbers(entries, "angle_peaks_deg", file)
    outputs = _numbers(entries, "outputs", file)
    sides = {}
    for side in ("left", "right"):
        rows = _entry(entries, side, file)
        if not isinstance(rows, Mapping) or set(rows) != set(angle_peaks):
            raise InputError(
                "one row for each angle set", file=file, field=side, allowed=", ".join(angle_peaks)
            )
        sides[side] = [
            _row(rows[angle], f"{side}.{angle}", outputs, len(distance_peaks), file)
            for angle in angle_peaks
        ]
    try:
        return RuleTable(
            name=str(entries.get("name", file)),
            origin=str(entries.get("origin", "")),
            distances=np.array(list(distance_peaks.values())),
            angles=np.radians(list(angle_peaks.values())),
            left=np.array(sides["left"]),
            right=np.array(sides["right"]),
        )
    except InputError as error:
        raise InputError(
            error.problem, file=file, field=error.field, value=error.value, allowed=error.allowed
        ) from error


def _entry(entries: Any, field: str, file: str) -> Any:
    if not isinstance(entries, Mapping) or field not in entries:
        raise InputError("the rule table lacks an entry", file=file, field=field)
    return entries[field]


def _numbers(entries: Any, field: str, file: str) -> dict[str, float]:
    found = _entry(entries, field, file)
    if not isinstance(found, Mapping) or not found:
        raise InputError("expected numbers by the names of the sets", file=file, field=field)
    for name, value in found.items():
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise InputError("expected a number", file=file, field=f"{field}.{name}", value=value)
    return {str(name): float(value) for name, value in found.items()}


def _row(row: Any, field: str, outputs: Mapping[str, float], length: int, file: str) -> list[float]:
    if not isinstance(row, list) or len(row) != length:
        raise InputError(
            "one output for each distance set",
            file=file,
            field=field,
            value=row,
            allowed=str(length),
        )
    for name in row:
        if name not in outputs:
            raise InputError(
                "no such output", file=file, field=field, value=name, allowed=", ".join(outputs)
            )
    return [outputs[name] for name in row]
