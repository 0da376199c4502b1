"""Scripted drivers: people who see the world, know their way, and err in ways that have names.

A driver sees the true surfaces around within their view (`driver_sight.py`), judges wrongly where
the chair points and where its sides are, knows their way as a line through doors
(`driver_route.py`), and moves a stick: [forward, left], each -1 to 1. They know neither the
assistant nor its map; what it does they notice by how the chair moves.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from ..se2 import Array, compose, exponential
from ..vehicle import Vehicle
from .driver_hand import LAG, Hand
from .driver_route import Route
from .driver_sight import Sight
from .driver_steering import Steering
from .driver_sticks import Stick
from .driver_traits import Traits
from .noise import GaussMarkov

ARRIVED = 0.35
"""Distance from the end of their way at which drivers are there and let go [m]."""

_THINKS = 0.1  # s: a hand is told where to go ten times a second
_MEMORIES = {"heading": 1.0, "judgement": 3.0}  # s
_PIVOT, _PIVOTED = math.radians(65.0), math.radians(25.0)  # from, until: they turn on the spot
_CHAIR = 0.1  # s: how late they know the chair to be
_PAST = 0.01  # m before the end of the way: whoever is beside it goes no further
_STILL = (0.04, 0.06)  # m/s, rad/s: slower is not moving


class Driver(Protocol):
    """Anybody who holds the stick."""

    @property
    def finished(self) -> bool:
        """Whether they are where they wanted to be; the hand then rests."""
        ...

    @property
    def progress(self) -> float:
        """How far along their way they are [m]."""
        ...

    def step(self, time: float, pose: ArrayLike, motion: ArrayLike) -> Array:
        """Return the stick [forward, left], each -1 to 1, shape (2,).

        Args:
            time: Time [s]; increases from call to call.
            pose: True pose of the chair they sit in, shape (3,), [m, m, rad].
            motion: How the chair moves, [v, omega], as they feel it [m/s, rad/s].
        """
        ...


@dataclass
class _Mind:
    """What a driver is about: one of driving, turning on the spot, backing off."""

    doing: str = "driving"
    leg: int = 0
    progress: float = 0.0
    furthest: float = 0.0
    tries: int = 0
    stuck_since: float = math.inf
    back_until: float = -math.inf
    back_left: float = 0.0
    side: float = 0.0


class ScriptedDriver:
    """A person of given traits on the way along routes, one after the other."""

    def __init__(
        self,
        traits: Traits,
        routes: tuple[Route, ...],
        sight: Sight,
        stick: Stick,
        vehicle: Vehicle,
        rng: np.random.Generator,
        *,
        arrived: float = ARRIVED,
    ) -> None:
        """Seat a driver.

        Args:
            traits: Who they are.
            routes: Their ways in order; at the end of one they turn round to the next.
            sight: Their eyes.
            stick: What they hold or wear.
            vehicle: The chair: its size as they know it, its speeds.
            rng: Source of their errors.
            arrived: Distance from the end of their way at which they are there [m]; they slow down
                for one that is less than `ARRIVED`.
        """
        self._traits, self._routes, self._sight, self._stick = traits, routes, sight, stick
        self._arrived = arrived
        self._rng = rng
        self._errors = {
            "heading": GaussMarkov(traits.heading_noise, _MEMORIES["heading"], rng),
            "judgement": GaussMarkov(traits.judgement, _MEMORIES["judgement"], rng),
        }
        self._hand = Hand(traits, rng)
        self._steering = Steering(traits, vehicle)
        self._meant = (0.0, 0.0)  # m/s, rad/s: what the hand was told last
        self._mind = _Mind()
        self._thought = -math.inf
        self._lapsed_until = -math.inf

    @property
    def finished(self) -> bool:
        """See `Driver`."""
        return self._mind.leg >= len(self._routes)

    @property
    def progress(self) -> float:
        """See `Driver`."""
        done = sum(route.length for route in self._routes[: self._mind.leg])
        return done if self.finished else done + self._mind.progress

    def step(self, time: float, pose: ArrayLike, motion: ArrayLike) -> Array:
        """See `Driver`."""
        if time >= self._thought + _THINKS - 1e-9:
            self._thought = time
            place = np.asarray(pose, dtype=float)
            self._think(time, place, np.asarray(motion, dtype=float))
        stick = self._hand.move(time)
        return np.zeros(2) if self.finished else stick

    def _think(self, time: float, pose: Array, motion: Array) -> None:
        """Decide where the hand shall go after the reaction time; nothing during a lapse."""
        if time < self._lapsed_until:
            return
        if self._rng.random() < self._traits.lapse_rate * _THINKS:
            self._lapsed_until = time + self._traits.lapse_time
            return
        self._meant = self._decide(time, pose, motion)
        self._hand.mean(time, self._stick.reach(*self._meant))

    def _decide(self, time: float, pose: Array, motion: Array) -> tuple[float, float]:
        """Return how the chair shall move, [v, omega]."""
        mind = self._mind
        self._advance(pose)
        if self.finished:
            return 0.0, 0.0
        heading_error = self._errors["heading"].step(_THINKS)
        aside = self._errors["judgement"].step(_THINKS)
        self._notice_standing(time, motion)
        if mind.doing == "backing":
            return self._back_off(time, pose, motion, aside)
        points = self._sight.look(time, pose) + np.array([0.0, aside])
        preview = self._traits.preview
        soon = self._foreseen(pose, motion)
        target = self._direction(soon, mind.progress + preview) + heading_error
        if mind.doing == "driving" and abs(target) > _PIVOT:
            mind.doing, mind.side = "turning", 0.0
        elif mind.doing == "turning" and abs(target) < _PIVOTED:
            mind.doing = "driving"
        if mind.doing == "turning":
            mind.side, rate = self._steering.turn(points, target, mind.side)
            return 0.0, mind.side * rate
        v, omega = self._steering.drive(points, self._curve(soon, heading_error), target)
        slower = self._slower_for_the_end(v)
        return slower * v, slower * omega

    def _advance(self, pose: Array) -> None:
        """Find out how far along the way the chair is, and whether it has arrived."""
        mind = self._mind
        route = self._routes[min(mind.leg, len(self._routes) - 1)]
        mind.progress = route.progress_of(float(pose[0]), float(pose[1]), mind.progress)
        if mind.progress > mind.furthest + 0.4:
            mind.furthest, mind.tries = mind.progress, 0
        end_x, end_y = route.at(route.length)
        off, left = math.hypot(pose[0] - end_x, pose[1] - end_y), route.length - mind.progress
        if (off < self._arrived and left < 2.0 * ARRIVED) or (off < ARRIVED and left < _PAST):
            mind.leg, mind.progress, mind.furthest, mind.tries = mind.leg + 1, 0.0, 0.0, 0

    def _slower_for_the_end(self, v: float) -> float:
        """Return the share of a speed at which the end of the way is not overrun."""
        if self._arrived >= ARRIVED or v <= 0.0:
            return 1.0
        left = self._routes[self._mind.leg].length - self._mind.progress
        return min(1.0, max(left, 0.5 * self._arrived) / (self._traits.headway * v))

    def _notice_standing(self, time: float, motion: Array) -> None:
        """Back off once the chair has not moved for as long as patience lasts."""
        mind = self._mind
        if abs(motion[0]) > _STILL[0] or abs(motion[1]) > _STILL[1] or mind.doing == "backing":
            mind.stuck_since = math.inf
            return
        mind.stuck_since = min(mind.stuck_since, time)
        if time - mind.stuck_since > self._traits.patience + self._traits.reaction_time:
            mind.tries += 1
            mind.doing = "backing"
            mind.back_left = 0.35 + 0.2 * min(mind.tries, 4) + 0.2 * self._rng.random()
            mind.back_until = time + 6.0
            mind.stuck_since = math.inf

    def _curve(self, pose: Array, misread: float) -> float:
        """Return the curvature that leads back to the way within about a preview [1/m].

        With y beside the way and th off its direction, kappa = kappa_way - 2 th / d - y / d^2:
        errors decay over d = 0.45 preview.
        """
        mind, d = self._mind, 0.45 * self._traits.preview
        route = self._routes[mind.leg]
        here = route.progress_of(float(pose[0]), float(pose[1]), mind.progress)
        x, y = route.at(here)
        heading = route.heading(here)
        beside = (pose[1] - y) * math.cos(heading) - (pose[0] - x) * math.sin(heading)
        off = math.remainder(pose[2] - misread - heading, 2.0 * math.pi)
        back = max(-0.9, min(0.9, -0.5 * float(beside) / d))  # rad: the angle to come back at
        return route.bend(here, 0.15) + 2.0 * (back - off) / d

    def _direction(self, pose: Array, progress: float) -> float:
        """Return the direction of a place of the route, from straight ahead [rad]."""
        x, y = self._routes[self._mind.leg].at(progress)
        return math.remainder(math.atan2(y - pose[1], x - pose[0]) - pose[2], 2.0 * math.pi)

    def _foreseen(self, pose: Array, motion: Array) -> Array:
        """Return where the chair will be once the hand has moved: everybody reckons with that."""
        half = 0.5 * (self._traits.reaction_time + LAG + _CHAIR)
        meant = np.array(self._meant)
        for moving in (motion, 0.5 * (motion + meant)):
            pose = compose(pose, exponential([moving[0] * half, 0.0, moving[1] * half]))
        return pose

    def _back_off(
        self, time: float, pose: Array, motion: Array, aside: float
    ) -> tuple[float, float]:
        """Back off for a while, looking over the shoulder; then try again."""
        mind = self._mind
        mind.back_left -= abs(float(motion[0])) * _THINKS
        points = self._sight.look(time, pose, behind=True) + np.array([0.0, aside])
        back = self._steering.back(points)
        if mind.back_left <= 0.0 or time > mind.back_until or back is None:
            mind.doing = "driving"
            return 0.0, 0.0
        return back
