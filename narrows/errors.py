"""Everything narrows raises.

::

    NarrowsError
    ├── InputError          what was given is wrong; says where, what was found, what is allowed
    │   ├── SceneError      a scene file, a vehicle or a map
    │   ├── TrajectoryError a trajectory file or array
    │   └── StudyError      a study's name, options or stored table
    ├── ShapeError          an array of the wrong shape or with values outside their range
    ├── PlanningFailed      asked for the trajectory of a plan that has none
    └── MissingExtra        an optional dependency is not installed

Not finding a path is not an error: planners return a status (`narrows.interfaces.PlanStatus`).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

_OTHERS_SHOWN = 3  # further errors spelled out in a message


class NarrowsError(Exception):
    """Base of every exception narrows raises on purpose."""


class InputError(NarrowsError, ValueError):
    """Input that cannot be used, located as closely as it can be.

    Attributes:
        problem: What is wrong, in one sentence without its place.
        file: File it was read from, or None for values given in Python.
        line: Line in that file, counted from 1, or None.
        field: Dotted path of the field, such as `vehicle.body.width`, or None.
        value: The value found, or None where it says nothing.
        allowed: What would be accepted, or None where the problem says it.
        others: Further errors found in the same input, in the order of its lines.
    """

    def __init__(
        self,
        problem: str,
        *,
        file: str | None = None,
        line: int | None = None,
        field: str | None = None,
        value: Any = None,
        allowed: str | None = None,
        others: Sequence[InputError] = (),
    ) -> None:
        """Keep the parts and compose the message."""
        self.problem = problem
        self.file = file
        self.line = line
        self.field = field
        self.value = value
        self.allowed = allowed
        self.others = tuple(others)
        super().__init__("\n".join(self._lines()))

    def _lines(self) -> list[str]:
        shown = [self._message(), *(f"also {other}" for other in self.others[:_OTHERS_SHOWN])]
        hidden = len(self.others) - _OTHERS_SHOWN
        return [*shown, f"and {hidden} more"] if hidden > 0 else shown

    def _message(self) -> str:
        where_in_file = [str(part) for part in (self.file, self.line) if part is not None]
        if self.file is None and self.line is not None:
            where_in_file = [f"line {self.line}"]
        place = f"{':'.join(where_in_file)}: " if where_in_file else ""
        where = f"{self.field}: " if self.field else ""
        found = ""
        if self.value is not None:
            text = repr(self.value)
            found = f"; found {text if len(text) <= 80 else text[:77] + '...'}"
        allowed = f"; allowed: {self.allowed}" if self.allowed else ""
        return f"{place}{where}{self.problem}{found}{allowed}"


class SceneError(InputError):
    """A scene, a vehicle or a map that cannot be used."""


class TrajectoryError(InputError):
    """A trajectory that cannot be read or judged."""


class StudyError(InputError):
    """A study that does not exist, or whose stored table does not fit it."""


class ShapeError(NarrowsError, ValueError):
    """An array whose shape or values do not fit what the function computes."""


class PlanningFailed(NarrowsError):
    """The trajectory of a plan was asked for, and the plan has none."""


class MissingExtra(NarrowsError):
    """An optional dependency is needed and not installed."""

    def __init__(self, package: str, extra: str) -> None:
        """Say which extra brings the package."""
        command = f"pip install -e '.[{extra}]'"
        super().__init__(f"{package} is not installed; in narrows' folder, {command} brings it")
