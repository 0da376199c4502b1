"""What a verb hands back to the command line."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

OK, WRONG_INPUT, IMPASSABLE, NOT_FOUND = 0, 2, 3, 4
"""Exit codes; see docs/command-line.md."""


@dataclass(frozen=True, eq=False)
class Outcome:
    """What came of a command.

    Attributes:
        code: Exit code.
        fields: What `--json` prints, by name.
        text: What people read, several lines.
        notes: What goes to standard error in both cases, one line each.
    """

    code: int
    fields: Mapping[str, Any]
    text: str
    notes: tuple[str, ...] = ()

    def as_json(self) -> str:
        """Return the fields as one JSON object on one line; numbers that are not finite are null.

        >>> Outcome(0, {"clearance_m": math.inf, "at": (1.0, math.nan)}, "").as_json()
        '{"clearance_m": null, "at": [1.0, null]}'
        """
        return json.dumps(_finite(dict(self.fields)), allow_nan=False)


def _finite(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(key): _finite(entry) for key, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(entry) for entry in value]
    if value is None or isinstance(value, (bool, int, str)):
        return value
    number = float(value)
    return number if math.isfinite(number) else None


def lines(*rows: tuple[str, str] | str) -> str:
    """Return rows of name and value as aligned text; rows that are plain text stand as they are."""
    texts = [row if isinstance(row, str) else f"  {row[0]:<22}{row[1]}" for row in rows]
    return "\n".join(text for text in texts if text)


def millimetres(length: float | None) -> str:
    """Return a length [m] for people."""
    if length is None or math.isnan(length):
        return "unknown"
    return "nothing to touch" if math.isinf(length) else f"{1e3 * length:.1f} mm"
