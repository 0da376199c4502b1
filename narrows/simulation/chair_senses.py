"""A chair's own senses: sensors that answer by schedule, late and with faults, into a local map."""

from __future__ import annotations

import heapq
import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ..errors import InputError, ShapeError
from ..interfaces import Percept
from ..perception.map_options import MapOptions
from ..perception.obstacle_map import ObstacleMap
from ..scene import Scene
from ..se2 import Array
from .fitted_sensors import FittedLaser, FittedSensor, Schedule, holds
from .laser import front_and_rear
from .surfaces import SensedWorld, checked_pose

_SOON = 1e-9  # s: times of control steps are sums of periods


class ChairSenses:
    """Sensors at work on one drive, and the map their answers go into.

    A sensor measures at the first control step at which it is due, from the true pose; its answer
    arrives later and is entered where the chair believed to be when it was measured. An answer
    that arrives after a newer one of the same sensor is left out. What the chair remembers is thus
    as good as its odometry, and its percept says how long the most silent sensor has been silent.

    Attributes:
        map: What is known around the chair.
        answers: The answer of each sensor that was entered last, by its name.
    """

    def __init__(
        self,
        scene: Scene,
        sensors: Sequence[FittedSensor[Any]],
        *,
        options: MapOptions | None = None,
        invisible: Collection[str] = (),
        reach: float = 3.0,
        rng: np.random.Generator | None = None,
    ) -> None:
        """Fit sensors to the chair of a scene.

        Args:
            scene: World, chair, and where it starts.
            sensors: At least one, with names of their own.
            options: Of the map; its `sensors` are those fitted. Default `MapOptions()`.
            invisible: Names of solids that send no light back, such as glass.
            reach: Distance from the body's origin up to which percepts tell of obstacles [m].
            rng: Source of noise and faults; each sensor draws from a stream of its own. Default
                a generator of seed 0.

        Raises:
            InputError: If there is no sensor, or two of the same name; if a name of `invisible`
                is nothing's.
        """
        names = tuple(sensor.name for sensor in sensors)
        if not names or len(set(names)) < len(names):
            raise InputError("a chair needs sensors of different names", value=", ".join(names))
        if not reach > 0.0:
            raise InputError("no reach", field="reach", value=reach, allowed="> 0 m")
        chosen = replace(MapOptions() if options is None else options, sensors=names)
        rng = np.random.default_rng(0) if rng is None else rng
        self.map = ObstacleMap(chosen, vehicle=scene.vehicle, pose=scene.start)
        self.answers: dict[str, Any] = {}
        self._world = SensedWorld(scene.world, invisible=invisible)
        self._heights = (0.0, scene.vehicle.height)
        self._reach = reach
        streams = zip(sensors, rng.spawn(len(names)), strict=True)
        self._channels = [_Channel(sensor, stream) for sensor, stream in streams]

    @property
    def heard(self) -> Mapping[str, float]:
        """When the answer of each sensor that was entered last was measured [s]; -inf: none."""
        return self.map.heard

    def perceive(self, time: float, true_pose: Array, believed_pose: Array) -> Percept:
        """Return what the map knows now: seen or remembered, by the pose believed.

        Raises:
            ShapeError: If a pose is not three finite numbers, or the time is not finite.
        """
        if not math.isfinite(time):
            raise ShapeError(f"a time must be a finite number [s], got {time}")
        true_pose, believed_pose = checked_pose(true_pose), checked_pose(believed_pose)
        arrived: list[_Sent] = []
        for channel in self._channels:
            channel.measure(self._world, time, true_pose, believed_pose)
            arrived += channel.receive(time)
        for sent in sorted(arrived):
            self.map.move_to(sent.believed_pose)
            sent.sensor.enter(sent.answer, self.map)
            self.answers[sent.sensor.name] = sent.answer
        self.map.move_to(believed_pose)
        return self.map.percept(reach=self._reach, heights=self._heights)


class _Sent:
    """An answer on its way, in the order of arrival."""

    def __init__(
        self,
        arrival: float,
        time: float,
        believed_pose: Array,
        sensor: FittedSensor[Any],
        answer: Any,
    ) -> None:
        self.arrival = arrival
        self.time = time
        self.believed_pose = believed_pose
        self.sensor = sensor
        self.answer = answer

    def __lt__(self, other: _Sent) -> bool:
        return (self.arrival, self.time) < (other.arrival, other.time)


class _Channel:
    """A sensor, and its answers on their way."""

    def __init__(self, sensor: FittedSensor[Any], rng: np.random.Generator) -> None:
        self._sensor = sensor
        self._rng = rng
        self._taken = 0
        self._newest = -math.inf
        self._on_the_way: list[_Sent] = []

    def measure(
        self, world: SensedWorld, time: float, true_pose: Array, believed_pose: Array
    ) -> None:
        """Measure if it is due."""
        schedule = self._sensor.schedule
        due = math.floor((time - schedule.phase) * schedule.rate + _SOON) + 1
        if due <= self._taken:
            return
        self._taken = due  # control steps further apart than the rate: once
        faults = schedule.faults
        chance, wait = self._rng.random(2)
        if holds(faults.silent, time) or chance < faults.lost:
            return
        answer = self._sensor.measure(world, true_pose, time, self._rng)
        if holds(faults.invalid, time):
            answer = self._sensor.spoilt(answer)
        arrival = time + schedule.latency + faults.delay(time) + wait * faults.jitter
        sent = _Sent(arrival, time, believed_pose, self._sensor, answer)
        heapq.heappush(self._on_the_way, sent)

    def receive(self, time: float) -> list[_Sent]:
        """Return the answers that have arrived, without those overtaken by a newer one."""
        arrived = []
        while self._on_the_way and self._on_the_way[0].arrival <= time + _SOON:
            sent = heapq.heappop(self._on_the_way)
            if sent.time > self._newest:
                self._newest = sent.time
                arrived.append(sent)
        return arrived


def two_lasers(
    scene: Scene,
    *,
    schedule: Schedule | None = None,
    options: MapOptions | None = None,
    rng: np.random.Generator | None = None,
) -> ChairSenses:
    """Return the senses of [DrivingAssistant]'s chair: two laser scanners, front and rear.

    Args:
        scene: World, chair, and where it starts.
        schedule: Of both; default 12.5 Hz, 0.04 s late.
        options: Of the map.
        rng: Source of noise and faults.
    """
    plan = Schedule() if schedule is None else schedule
    fitted = [FittedLaser(scanner, plan) for scanner in front_and_rear(scene.vehicle)]
    return ChairSenses(scene, fitted, options=options, rng=rng)
