"""Number fields of the page: unit, range, and an answer in place to what makes no sense."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from viser import GuiApi

_DECIMALS = 4  # shown and kept


@dataclass(frozen=True)
class Field:
    """A number that can be typed.

    Attributes:
        name: Its key in the entry it belongs to.
        label: What it is, with its unit in brackets.
        low: Least value taken, in that unit.
        high: Greatest value taken.
        step: What the arrows beside it add.
        says: What it means, for the hint.
    """

    name: str
    label: str
    low: float
    high: float
    step: float = 0.01
    says: str = ""

    @property
    def span(self) -> str:
        """The range for people, with its unit."""
        unit = self.label[self.label.find("[") + 1 : -1] if "[" in self.label else ""
        return f"{self.low:g} to {self.high:g} {unit}".strip()

    def complaint(self, value: float) -> str:
        """Return what is wrong with a value, or nothing."""
        if self.low <= value <= self.high:
            return ""
        found = f"{value:g}" if math.isfinite(value) else "no number"
        name = self.label.split(" [")[0]
        return f"{name}: found {found}; allowed: {self.span}"


class FieldGroup:
    """Some fields, shown one below the other.

    Somebody may type on while what was typed before is still being dealt with. So a field is only
    written when the value to show is another than the one last read from it or shown in it.
    """

    def __init__(
        self, gui: GuiApi, fields: Sequence[Field], changed: Callable[[Any], None]
    ) -> None:
        """Add the fields to the page.

        Args:
            gui: The page.
            fields: What can be typed.
            changed: Called after somebody changed something.
        """
        self.fields = tuple(fields)
        self._inputs: dict[str, Any] = {}
        self._known: dict[str, float] = {}
        for field in fields:
            says = f"{field.says}; {field.span}" if field.says else field.span
            says = says[0].upper() + says[1:]
            first = float(max(field.low, 0.0))
            handle = gui.add_number(field.label, first, step=field.step, hint=says)
            handle.precision = _DECIMALS - 1
            handle.on_update(by_hand(changed))
            self._inputs[field.name], self._known[field.name] = handle, first

    @property
    def known(self) -> dict[str, float]:
        """What was last read or shown."""
        return dict(self._known)

    def read(self) -> set[str]:
        """Read the fields; return the names of those that changed since."""
        now = {name: float(handle.value) for name, handle in self._inputs.items()}
        changed = {name for name, value in now.items() if value != self._known[name]}
        self._known = now
        return changed

    @property
    def complaint(self) -> str:
        """What is wrong with the first value read that makes no sense, or nothing."""
        found = (
            field.complaint(self._known[field.name])
            for field in self.fields
            if not self._inputs[field.name].disabled
        )
        return next((text for text in found if text), "")

    def show(self, values: Mapping[str, float]) -> None:
        """Show values, rounded to what can be typed; fields that are not named keep theirs."""
        for name, value in values.items():
            rounded = rounded_number(value)
            if rounded != self._known[name]:
                self._known[name] = self._inputs[name].value = rounded

    def enable(self, *, on: bool, names: Sequence[str] | None = None) -> None:
        """Let fields be typed in, or not."""
        for name, handle in self._inputs.items():
            if names is None or name in names:
                handle.disabled = not on


def by_hand(changed: Callable[[Any], None]) -> Callable[[Any], None]:
    """Return a callback that hears of what somebody does, not of what the page itself sets."""

    def hear(event: Any) -> None:
        if event.client is not None:
            changed(event)

    return hear


def rounded_number(value: float) -> float:
    """Return a number as a field shows it.

    >>> rounded_number(0.30000000000000004)
    0.3
    """
    return round(float(value), _DECIMALS)
