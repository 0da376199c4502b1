"""A file read: every value with the line it stands on, and errors that point there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from .errors import SceneError

Step = str | int


@dataclass(frozen=True, eq=False)
class Located:
    """A value of a file and the line it stands on.

    Attributes:
        value: Text, number, truth value, None, list or dict with text keys.
        line: Line, counted from 1; for an entry of a mapping that of its key.
        items: The same for every entry of a list (by index) or mapping (by key).
        count: Number of values in it, itself included.
    """

    value: Any
    line: int
    items: dict[Step, Located] = field(default_factory=dict)
    count: int = 1


@dataclass(frozen=True, eq=False)
class Source:
    """A file read, able to point at its fields.

    Attributes:
        file: Name of the file for messages; None for text given in Python.
        root: What it says; None for values that come from no file.
    """

    file: str | None
    root: Located | None = None

    def error(
        self,
        path: Sequence[Step],
        problem: str,
        *,
        value: Any = None,
        allowed: str | None = None,
        others: Sequence[SceneError] = (),
    ) -> SceneError:
        """Return the error that names file, line and field of what a path leads to."""
        return SceneError(
            problem,
            file=self.file,
            line=self.line(path),
            field=field_name(path) or None,
            value=value,
            allowed=allowed,
            others=others,
        )

    def line(self, path: Sequence[Step]) -> int | None:
        """Return the line of a field, or of the nearest field around it that exists."""
        if self.root is None:
            return None
        here = self.root
        for step in path:
            if step not in here.items:
                break
            here = here.items[step]
        return here.line


def field_name(path: Sequence[Step]) -> str:
    """Return a path for people.

    >>> field_name(("world", "solids", 2, "z"))
    'world.solids[2].z'
    """
    text = "".join(f"[{s}]" if isinstance(s, int) else f".{printable(s)}" for s in path)
    return text.removeprefix(".")


def printable(text: str) -> str:
    """Return text shortened to 40 characters, with those escaped that a terminal cannot show."""
    short = text if len(text) <= 40 else text[:37] + "..."
    return short if short.isprintable() else repr(short)[1:-1]
