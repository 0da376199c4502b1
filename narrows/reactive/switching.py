"""Which of two controllers drives: hysteresis on the intrusion, as [FuzzyDVZ, Section 3] asks."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import IntEnum

from ..errors import ShapeError


class Active(IntEnum):
    """Who drives; the value is that of the signal `active`."""

    GOAL = 0
    ZONE = 1
    STOPPED = 2
    BACKING = 3


@dataclass(frozen=True)
class Thresholds:
    """Intrusions at which the controllers change.

    Attributes:
        enter: I_FLCtoDVZ: from here on the zone drives.
        leave: I_DVZtoFLC: below it the goal controller drives again; less than `enter`.
    """

    enter: float = 0.02
    leave: float = 0.007

    def __post_init__(self) -> None:
        """Check the order."""
        if not 0.0 <= self.leave < self.enter < math.inf:
            raise ShapeError(
                "the zone must be left at a smaller intrusion than it is entered at: "
                f"0 <= leave < enter, got leave {self.leave}, enter {self.enter}"
            )


class Switch:
    """Two controllers in turn, the goal's first.

    Attributes:
        thresholds: When they change.
        active: Who drives.
        count: How often they have changed.
    """

    def __init__(self, thresholds: Thresholds | None = None) -> None:
        """Begin with the goal controller."""
        self.thresholds = Thresholds() if thresholds is None else thresholds
        self.active = Active.GOAL
        self.count = 0

    def update(self, intrusion: float) -> Active:
        """Return who drives at an intrusion."""
        before = self.active
        if self.active is Active.GOAL and intrusion >= self.thresholds.enter:
            self.active = Active.ZONE
        elif self.active is Active.ZONE and intrusion < self.thresholds.leave:
            self.active = Active.GOAL
        self.count += self.active is not before
        return self.active
