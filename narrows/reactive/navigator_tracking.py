"""A planned motion driven under guard: the tracker steers, the guard scales its commands or stops.

The zone is too wide for a door ten centimetres wider than the chair. On a planned path it is not
needed: the plan was proven clear of all it knew, so only what is new can be in the way. So the
command is the tracker's; the guard lets a share of it pass, on the same curve, from which the chair
can stop before anything new. Solids the plan knew are guarded against only in so far as the chair
must be badly off its path to come as near. Before something new on the path itself the chair
already stands back: whoever is there can come out, and the chair's camera still sees the place.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import ShapeError
from ..interfaces import Percept, Tracker
from ..path import Path
from ..se2 import Array, compose, invert
from ..vehicle import Vehicle
from .navigator_guard import Guard
from .navigator_guard_options import GuardOptions
from .navigator_sweep import Course


class GuardedTracker:
    """A tracker whose commands pass a guard; a `narrows.interfaces.Controller`.

    Attributes:
        guard: The guard.
        reason: How it stands, for people; the outcome once it has finished.
        arrived: Whether the tracker has come to its end.
    """

    def __init__(
        self,
        tracker: Tracker,
        vehicle: Vehicle,
        options: GuardOptions | None = None,
        *,
        known: Callable[[Array], NDArray[np.bool_]] | None = None,
        path: Path | None = None,
        patience: float = 60.0,
    ) -> None:
        """Guard a tracker.

        Args:
            tracker: Follows the plan; one that goes by progress, not by a clock, waits best.
            vehicle: The chair.
            options: Of the guard.
            known: Which points (N, 3) of the world frame the plan was proven clear of, such as
                `KnownSolids`; None: none.
            path: What the tracker follows: the chair stops on it, and stands back before what is
                new on it. None: it stops on the arcs of the tracker's commands.
            patience: How long it waits before something in its way until it gives up [s].
        """
        if not 0.0 < patience < math.inf:
            raise ShapeError(f"patience must be a positive number [s], got {patience}")
        self.guard = Guard(vehicle, options, known=known)
        self.reason, self.arrived = "on its way", False
        self._tracker, self._patience = tracker, patience
        self._path = path
        self._moved_at = math.nan
        self._gave_up = False

    @property
    def progress(self) -> float:
        """The tracker's."""
        return self._tracker.progress

    @property
    def finished(self) -> bool:
        """Whether the end is reached, or something stood in the way for too long."""
        return self._gave_up or self._tracker.finished

    @property
    def signals(self) -> Mapping[str, float]:
        """Share of the tracker's command that passed; whether it waits."""
        return {"guard_share": self.guard.share, "waits": float(self.guard.share == 0.0)}

    def step(self, time: float, pose: ArrayLike, percept: Percept) -> Array:
        """Return the command [v, omega] for the coming period, shape (2,), [m/s, rad/s]."""
        if math.isnan(self._moved_at):
            self._moved_at = time
        wanted = self._tracker.step(time, pose)
        if self.finished:
            if not self._gave_up:
                self.reason, self.arrived = "arrived", True
            return self.guard.stop(time)
        command = self.guard.limit(time, pose, percept, wanted, course=self._course())
        if self.guard.share > 0.0:
            self._moved_at = time
            self.reason = self.guard.reason or "on its way"
        elif time - self._moved_at > self._patience:
            self._gave_up = True
            self.reason = f"gave up after {self._patience:.0f} s: {self.guard.reason}"
        else:
            self.reason = f"waits: {self.guard.reason}"
        return command

    def _course(self) -> Course | None:
        """Return the path from where the chair is, carried along with the error it has."""
        if self._path is None:
            return None
        path, progress = self._path, self.progress
        origin = invert(path(progress))

        def course(distances: Array) -> Array:
            return compose(origin, path(np.minimum(progress + distances, path.span)))

        return course
