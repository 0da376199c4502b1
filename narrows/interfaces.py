"""What planners and trackers look like from outside, and the outcome of a plan."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Protocol

from numpy.typing import ArrayLike

from .clearance import Certificate
from .errors import PlanningFailed, ShapeError
from .path import Path
from .scene import Scene
from .se2 import Array
from .trajectory import Trajectory


class PlanStatus(Enum):
    """Outcome of a planning attempt; the value is its name in files and on the command line."""

    CERTIFIED = "certified"
    IMPASSABLE = "impassable"
    NOT_FOUND = "not_found"


@dataclass(frozen=True, eq=False)
class Plan:
    """Outcome of a planning attempt. Only a certified plan carries a path.

    Attributes:
        status: Certified, impassable (proven), or not found (neither proven nor found).
        planner: Which planner answered.
        reason: For people: how clear it is, what is missing, or what was tried and what blocked.
        path: The certified path; None unless certified.
        trajectory: The path with times, its limits checked; None unless certified.
        certificate: The proof of clearance; None unless certified.
        statistics: Figures for reports, such as `solve_time_s` (CPU time of planning) and
            `missing_mm`.
    """

    status: PlanStatus
    planner: str
    reason: str
    path: Path | None = None
    trajectory: Trajectory | None = None
    certificate: Certificate | None = None
    statistics: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Check that a path is carried by certified plans, and by them only."""
        parts = (self.path, self.trajectory, self.certificate)
        certified = self.status is PlanStatus.CERTIFIED
        complete = all(part is not None for part in parts)
        empty = all(part is None for part in parts)
        if (certified and not complete) or (not certified and not empty):
            raise ShapeError("a certified plan carries path, trajectory and certificate, no other")
        if self.certificate is not None and not self.certificate.is_clear:
            raise ShapeError("a plan whose certificate is not clear cannot be certified")

    def raise_for_status(self) -> Plan:
        """Return the plan itself if it is certified.

        Raises:
            PlanningFailed: If it is not; the message gives status and reason.
        """
        if self.status is not PlanStatus.CERTIFIED:
            raise PlanningFailed(f"{self.status.value}: {self.reason}")
        return self


class Planner(Protocol):
    """Anything that looks for a motion through a scene."""

    def plan(self, scene: Scene) -> Plan:
        """Return a certified plan, or why there is none."""
        ...


class Tracker(Protocol):
    """Anything that follows a planned motion, one control period at a time."""

    @property
    def progress(self) -> float:
        """Progress along the path the tracker believes to have reached."""
        ...

    @property
    def finished(self) -> bool:
        """Whether the end of the motion is reached."""
        ...

    def step(self, time: float, pose: ArrayLike) -> Array:
        """Return the command [v, omega] for the coming control period, (2,), [m/s, rad/s].

        Args:
            time: Time since the start [s]; increases from call to call.
            pose: Pose the chair believes to have, shape (3,), [m, m, rad].
        """
        ...
