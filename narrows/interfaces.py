"""What planners, trackers, controllers and drivers look like from outside; what they exchange."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Protocol

import numpy as np
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


@dataclass(frozen=True, eq=False)
class Percept:
    """What the chair knows of what stands around it at a control step, seen now or remembered.

    Attributes:
        time: When the sensor that has been silent longest last spoke [s]; the difference to now is
            how blind the chair is. Minus infinity: none has spoken yet.
        points: Points of obstacles in the body frame, z above the floor, shape (N, 3), [m].
        spread: An obstacle may reach this far beyond a point, seen from above [m]: half the
            diagonal of a cell for a map, 0 for a sensor's own points.
        unknown: Places around the chair of which nothing is known, body frame, shape (M, 2), [m];
            never to be taken for free.
    """

    time: float
    points: Array
    spread: float = 0.0
    unknown: Array = field(default_factory=lambda: np.zeros((0, 2)))

    def __post_init__(self) -> None:
        """Check the shapes."""
        for name, width in (("points", 3), ("unknown", 2)):
            rows = np.asarray(getattr(self, name), dtype=float)
            if rows.ndim != 2 or rows.shape[1] != width:
                raise ShapeError(f"{name} must have shape (N, {width}), got {rows.shape}")
            object.__setattr__(self, name, rows)


class Controller(Protocol):
    """Anything that drives by what it perceives, one control period at a time."""

    @property
    def progress(self) -> float:
        """Progress the controller believes to have made; of its own measure, increasing."""
        ...

    @property
    def finished(self) -> bool:
        """Whether it has arrived or given up; a finished controller commands a stop."""
        ...

    @property
    def signals(self) -> Mapping[str, float]:
        """Figures of the last step for records and plots; the same names at every step."""
        ...

    def step(self, time: float, pose: ArrayLike, percept: Percept) -> Array:
        """Return the command [v, omega] for the coming control period, (2,), [m/s, rad/s].

        Args:
            time: Time since the start [s]; increases from call to call.
            pose: Pose the chair believes to have, shape (3,), [m, m, rad].
            percept: What it knows of its surroundings now.
        """
        ...
