"""The last word on every command: the chair can stop before anything its body would sweep over.

At each control step the way to a stop is predicted, with the commands still under way, the lag of
the motors and the one period for which the command holds, and the body is swept along it. A
command passes only if no point comes nearer than a margin. If none passes, the chair brakes along
the way that was found free one period before. So in a world that stands still, where every
obstacle is among the points, it never touches anything while it moves.

What may walk is met with a margin that grows with time, so that it does not reach the moving
chair before the chair stands. Who cannot be told from furniture is not: see `trusted_after`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import ShapeError
from ..interfaces import Percept
from ..se2 import Array, transform
from ..vehicle import Vehicle
from .navigator_guard_options import GuardOptions
from .navigator_motion import CommandedMotion
from .navigator_places import Places
from .navigator_sweep import FREE, UNSEEN, Course, Obstacles, StoppingSweep


class Guard:
    """Lets commands pass that leave room to stop, less of them, or brakes.

    Attributes:
        options: What it reckons with.
        share: Share of the last wanted command that passed; 0: the chair brakes or stands.
        reason: Why the last command did not pass whole; empty if it did.
    """

    def __init__(
        self,
        vehicle: Vehicle,
        options: GuardOptions | None = None,
        *,
        known: Callable[[Array], NDArray[np.bool_]] | None = None,
    ) -> None:
        """Guard a chair that stands.

        Args:
            vehicle: The body, its layers by height.
            options: What the guard reckons with.
            known: Which points (N, 3) of the world frame belong to solids that were planned for:
                they stand, and `margin_known` is kept from them. None: nothing is known.
        """
        self.options = GuardOptions() if options is None else options
        self._known = known
        self.share, self.reason = 1.0, ""
        self._sweep = StoppingSweep(vehicle, self.options)
        self._motion = CommandedMotion(self.options.latency, self.options.lag)
        self._places = Places()

    @property
    def twist(self) -> Array:
        """The [v, omega] the chair has by its own reckoning, shape (2,), [m/s, rad/s]."""
        return self._motion.twist.copy()

    def stopping_distance(self, speed: float) -> float:
        """Return how far the chair goes until it stands, the period and the delays included [m].

        Args:
            speed: Now [m/s].
        """
        chosen = self.options
        delay = chosen.latency + chosen.lag + 1.5 * chosen.period
        return abs(speed) * delay + 0.5 * speed * speed / chosen.deceleration

    def limit(
        self,
        time: float,
        pose: ArrayLike,
        percept: Percept,
        wanted: ArrayLike,
        *,
        otherwise: Sequence[ArrayLike] = (),
        course: Course | None = None,
    ) -> Array:
        """Return the greatest share of a command that leaves room to stop, or braking, (2,).

        Args:
            time: Now [s].
            pose: Pose the chair believes to have, shape (3,), [m, m, rad].
            percept: What it knows of its surroundings.
            wanted: Command [v, omega] to be judged, shape (2,), [m/s, rad/s].
            otherwise: Commands to try whole, in this order, where no share of it passes.
            course: The way the wanted commands follow; the chair is taken to stop on it. While
                something that was not planned for stands on it within `berth`, nothing but braking
                passes. None: the chair stops on the arc of the command.
        """
        motion, goal = self._motion, _command(wanted)
        motion.advance(time)
        age = time - percept.time
        self.share, self.reason = 0.0, ""
        if not age <= self.options.oldest:
            self.reason = (
                "nothing has been seen yet" if math.isinf(age) else "the sensors are silent"
            )
            return motion.send(time, self._braked(goal if course else None))
        obstacles = self._obstacles(time, pose, percept)
        blocked = FREE if course is None else self._sweep.first_on_course(obstacles, course)
        tried = np.full(2, math.nan)
        for share in self.options.shares if blocked == FREE else ():
            command = self._reachable(share * goal, keeps_curve=course is not None)
            if (command == tried).all():
                continue
            tried = command
            blocked = self._sweep.first_in_way(obstacles, motion, command, max(age, 0.0), course)
            if blocked == FREE:
                self.share = share
                self.reason = "" if share == 1.0 else "slower, so as to be able to stop"
                return motion.send(time, command)
        self.reason = "too little is seen to drive that fast"
        if blocked != UNSEEN:
            x, y = obstacles.points[blocked, :2]
            self.reason = f"something is in the way, {x:.2f} m ahead, {y:+.2f} m to the left"
        for other in otherwise:
            command = self._reachable(_command(other))
            if self._sweep.first_in_way(obstacles, motion, command, max(age, 0.0)) == FREE:
                return motion.send(time, command)
        return motion.send(time, self._braked(goal if course else None))

    def stop(self, time: float) -> Array:
        """Return the command of braking, whatever is perceived, shape (2,)."""
        self._motion.advance(time)
        self.share = 0.0
        return self._motion.send(time, self._braked())

    def _braked(self, steered: Array | None = None) -> Array:
        """Return the command sent last, faded by one period's braking.

        Args:
            steered: A command (2,) whose curve is kept instead, so that the chair stops on it.
        """
        command, chosen = self._motion.command, self.options
        if steered is not None and steered[0] * command[0] > 0.0:
            speed = max(abs(command[0]) - chosen.deceleration * chosen.period, 0.0)
            return np.asarray(min(1.0, speed / abs(steered[0])) * steered)
        fade = math.inf
        if command[0]:
            fade = chosen.deceleration * chosen.period / abs(command[0])
        if command[1]:
            fade = min(fade, chosen.yaw_deceleration * chosen.period / abs(command[1]))
        return np.asarray(max(0.0, 1.0 - fade) * command if fade < math.inf else np.zeros(2))

    def _reachable(self, goal: Array, *, keeps_curve: bool = False) -> Array:
        """Return the command nearest to a wanted one that the rates allow after the last.

        Of its shares the greatest one, so that the curve stays; where none is allowed, v and
        omega are limited each by itself, or the curve is kept and v alone limited.
        """
        chosen = self.options
        rates = np.array([chosen.deceleration, chosen.yaw_deceleration]) * chosen.period
        low, high = self._motion.command - rates, self._motion.command + rates
        least, most = 0.0, 1.0
        if keeps_curve and goal[0] != 0.0:
            share = min(max(goal[0], low[0]), high[0]) / goal[0]
            return share * goal if share >= 0.0 else np.clip(goal, low, high)
        for part in (0, 1):
            if goal[part] == 0.0:
                if not low[part] <= 0.0 <= high[part]:
                    return np.clip(goal, low, high)
                continue
            ends = sorted((low[part] / goal[part], high[part] / goal[part]))
            least, most = max(least, ends[0]), min(most, ends[1])
        return most * goal if least <= most else np.clip(goal, low, high)

    def _obstacles(self, time: float, pose: ArrayLike, percept: Percept) -> Obstacles:
        """Return all points, unknown places too; those are taken to stand."""
        chosen = self.options
        seen, unknown = len(percept.points), percept.unknown
        low = np.full(len(unknown), self._sweep.lowest)
        points = np.vstack([percept.points, np.column_stack([unknown, low])])
        world = transform(np.asarray(pose, dtype=float), points[:, :2])
        long = chosen.trusted_after
        ages = self._places.ages(time, world[:seen], long=long, gap=2.0 * chosen.period)
        walking, margins = np.zeros(len(points)), np.full(len(points), chosen.margin)
        margins += percept.spread
        walking[:seen][ages < long] = chosen.walking
        is_new = np.arange(len(points)) < seen
        if self._known is not None and len(points):
            planned = self._known(np.column_stack([world, points[:, 2]]))
            walking[planned], is_new[planned] = 0.0, False
            margins[planned] = chosen.margin_known
        return Obstacles(np.ascontiguousarray(points), walking, margins, is_new)


def _command(wanted: ArrayLike) -> Array:
    command = np.array(wanted, dtype=float)
    if command.shape != (2,) or not np.isfinite(command).all():
        raise ShapeError(f"a command is finite [v, omega], got {command}")
    return command
