"""Whoever holds the joystick of the page, as a driver of the simulator."""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import ArrayLike

from narrows.scene import Scene
from narrows.se2 import Array

from .control_colours import states_told
from .page_report import Report

BY_HAND = "joystick of this page"
"""Their name among the drivers."""


class PageDriver:
    """Whoever holds the joystick of the page: in real time, until they press stop.

    A `narrows.simulation.drivers.Driver` that waits for the clock, so that a simulated second
    takes one.

    Attributes:
        signals: Returns what the controller tells that the stick goes through.
    """

    def __init__(self, report: Report, scene: Scene) -> None:
        """Begin when the first step is asked for."""
        self._report = report
        self._goal = np.asarray(scene.goal.pose[:2])
        self._begun: float | None = None
        self._stopped = False
        self._start = np.asarray(scene.start[:2])
        self._progress = 0.0
        self.signals: Callable[[], Mapping[str, float]] = dict

    @property
    def finished(self) -> bool:
        """Whether stop was pressed."""
        return self._stopped

    @property
    def progress(self) -> float:
        """How much nearer to the goal than at the start [m]."""
        return self._progress

    def step(self, time: float, pose: ArrayLike, motion: ArrayLike) -> Array:
        """Return the stick [forward, left] as it is held now."""
        now = clock.monotonic()
        self._begun = now if self._begun is None else self._begun
        clock.sleep(max(0.0, self._begun + time - now))
        place = np.asarray(pose, dtype=float)
        before, left = self._start - self._goal, place[:2] - self._goal
        self._progress = float(np.hypot(*before) - np.hypot(*left))
        signals = {name: np.array([value]) for name, value in self.signals().items()}
        state = next(iter(states_told(signals)), "")
        self._report({"time": time, "pose": place, "state": state})
        held = self._report.latest()
        if held == "stop":
            self._stopped = True
        if not isinstance(held, tuple):
            return np.zeros(2)
        return np.asarray(np.clip(np.asarray(held, dtype=float), -1.0, 1.0))
