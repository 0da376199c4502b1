"""One drive of the [FuzzyDVZ] study: simulated, judged, put into a row."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from ..errors import StudyError
from ..interfaces import Controller, Percept
from ..reactive.navigator import Navigator, NavigatorOptions
from ..reactive.navigator_guard_options import GuardOptions
from ..reactive.switching import Active, Thresholds
from ..scene import Scene
from ..se2 import Array
from ..simulation.judge import Judgement, judge
from ..simulation.named_senses import Silenced
from ..simulation.record import Record
from ..simulation.senses import IdealOptions, IdealSenses, Senses
from ..simulation.simulator import SimulationOptions, simulate
from ..world import World
from .case import Case, Scalar
from .fuzzy_dvz_plausible import disc_way, holding_disc, is_plausible
from .fuzzy_dvz_printed import VARIANTS, UnguardedNavigator
from .fuzzy_dvz_scenes import (
    GLASS,
    PAPER_SCENES,
    cluttered,
    glass_table,
    peopled,
    trap,
    velocities_of,
)

DRIVE = SimulationOptions(step=0.05, period=0.05, time_limit=240.0)
"""How drives are simulated: control at 20 Hz."""

REACH = 4.0
"""How far from the body's origin the ideal senses tell of obstacles [m]."""

GUARDED = "navigator"
"""The whole navigator; the other variants have no guard."""

BLIND = "goal controller alone"
"""Without the zone, as the paper's first figure shows it."""


@dataclass(frozen=True, eq=False)
class Drive:
    """A drive of a scene.

    Attributes:
        scene: Where.
        record: What happened.
        verdict: What is true of it.
        reason: What the controller says of it.
        arrived: Whether the controller says it has arrived.
    """

    scene: Scene
    record: Record
    verdict: Judgement
    reason: str
    arrived: bool


def drive(
    scene: Scene,
    variant: str = GUARDED,
    *,
    senses: Senses | None = None,
    knows_velocities: bool = False,
    reach: float = REACH,
    options: SimulationOptions = DRIVE,
) -> Drive:
    """Return a drive.

    Args:
        scene: Where.
        variant: `GUARDED`, `BLIND` or one of `VARIANTS`.
        senses: What it perceives with; default ideal senses.
        knows_velocities: Whether the zone is told how fast people walk.
        reach: How far from the body's origin the senses tell of obstacles [m].
        options: How it is simulated.
    """
    target = scene.goal.pose[:2]
    controller: Controller
    if variant == GUARDED:
        velocities = velocities_of(scene.world) if knows_velocities else None
        chosen = guarded_options(reach)
        controller = Navigator(scene.vehicle, target, chosen, velocities=velocities)
    elif variant == BLIND:
        blind = replace(guarded_options(math.inf), thresholds=Thresholds(1e9, 0.0))
        controller = Navigator(scene.vehicle, target, blind)
        senses = _Blindfold()
    elif variant in VARIANTS:
        controller = UnguardedNavigator(scene.vehicle, target, variant)
    else:
        allowed = ", ".join((GUARDED, BLIND, *VARIANTS))
        raise StudyError("no such variant", value=variant, allowed=allowed)
    record = simulate(
        scene, controller, senses=senses or ideal_senses(scene.world), options=options
    )
    off = float(np.hypot(*(record.poses[-1, :2] - target)))
    reason = controller.reason if isinstance(controller, Navigator) else "on its way"
    if not controller.finished:
        reason = f"time is up, {off:.2f} m from the target"
    return Drive(scene, record, judge(scene, record), reason, off <= scene.goal.position_tolerance)


def ideal_senses(world: World) -> IdealSenses:
    """Return senses that know all outlines within `REACH`."""
    return IdealSenses(world, IdealOptions(reach=REACH))


def guarded_options(reach: float = REACH) -> NavigatorOptions:
    """Return the navigator's options with a guard that knows the simulated chair.

    Args:
        reach: How far from the body's origin its senses tell of obstacles [m].
    """
    plant = DRIVE.plant
    guard = GuardOptions(
        latency=plant.latency, lag=plant.motor_lag, period=DRIVE.period, reach=reach
    )
    return NavigatorOptions(guard=guard)


class _Blindfold:
    """Senses that report nothing about, always in time."""

    def perceive(self, time: float, true_pose: Array, believed_pose: Array) -> Percept:
        """Return an empty percept."""
        return Percept(time, np.zeros((0, 3)))


def row_of(driven: Drive) -> dict[str, Scalar]:
    """Return what a table says of a drive."""
    record, verdict = driven.record, driven.verdict
    active, share = record.signals["active"], record.signals["guard_share"]
    clearance = verdict.min_clearance
    collided = bool(verdict.collisions)
    if collided:
        outcome = "collision"
    elif driven.arrived:
        outcome = "arrived"
    elif driven.reason.startswith("time"):
        outcome = "timeout"
    else:
        outcome = "gave up"
    return {
        "outcome": outcome,
        "arrived": driven.arrived and not collided,
        "collisions": len(verdict.collisions),
        "walked_into": len(verdict.walked_into),
        "clearance_m": clearance if math.isfinite(clearance) else None,
        "duration_s": record.duration,
        "length_m": record.length,
        "switches": int(record.signals["switches"][-1]),
        "zone_share": float(np.mean(active == Active.ZONE)),
        "backing_share": float(np.mean(active == Active.BACKING)),
        "guard_share": float(np.mean(share[active != Active.STOPPED] < 1.0)),
        "why": verdict.collisions[0].reason if collided else driven.reason,
    }


def paper_case(case: Case, rng: np.random.Generator) -> Mapping[str, Scalar]:
    """Return a row: one of the paper's runs."""
    return row_of(drive(PAPER_SCENES[str(case["scene"])](), str(case["variant"])))


def clutter_case(case: Case, rng: np.random.Generator) -> Mapping[str, Scalar]:
    """Return a row: a random world; variants of the same world share their seed."""
    scene = cluttered(np.random.default_rng([int(str(case["base"])), int(str(case["world"]))]))
    way = disc_way(scene, holding_disc(scene))
    found = row_of(drive(scene, str(case["variant"])))
    return {
        **found,
        "disc_way": way if math.isfinite(way) else None,
        "plausible": is_plausible(scene),
    }


def people_case(case: Case, rng: np.random.Generator) -> Mapping[str, Scalar]:
    """Return a row: a world with walking people."""
    world = [int(str(case["base"])), int(str(case["world"])), 1]
    scene = peopled(np.random.default_rng(world), str(case["kind"]))
    return row_of(drive(scene, knows_velocities=bool(case["knows"])))


def odd_case(case: Case, rng: np.random.Generator) -> Mapping[str, Scalar]:
    """Return a row: a trap, a glass table, silence."""
    name = str(case["case"])
    if name.startswith("U-trap"):
        return row_of(drive(trap(float(name.split()[1]))))
    if name.startswith("glass"):
        scene = glass_table()
        unseen = {
            "glass table, seen": (),
            "glass table, its top not": (GLASS,),
            "glass table, not at all": (GLASS, "a leg"),
        }[name]
        solids = tuple(solid for solid in scene.world.solids if solid.name not in unseen)
        senses = ideal_senses(replace(scene.world, solids=solids))
        return row_of(drive(scene, senses=senses))
    raise StudyError("no such case", value=name)


def dropout_case(case: Case, rng: np.random.Generator) -> Mapping[str, Scalar]:
    """Return a row: a random world in which the senses go silent now and then, and at last."""
    scene = cluttered(np.random.default_rng([int(str(case["base"])), int(str(case["world"]))]))
    begin = np.cumsum(rng.uniform(2.0, 10.0, 12))
    end = begin + np.minimum(rng.exponential(0.8, 12), 4.0)
    ends = float(rng.uniform(10.0, 30.0))
    silent = (*zip(begin.tolist(), end.tolist(), strict=True), (ends, math.inf))
    options = replace(DRIVE, time_limit=ends + 5.0)
    driven = drive(scene, senses=Silenced(ideal_senses(scene.world), silent), options=options)
    found = row_of(driven)
    record = driven.record
    last = int(np.searchsorted(record.times, ends))
    if last >= len(record.times) - 1:
        return {**found, "speed_then_m_s": None, "stopped_after_m": None, "allowed_m": None}
    way = np.hypot(*np.diff(record.poses[last:, :2], axis=0).T).sum()
    speed = float(abs(record.wheel_speeds[last].mean()))
    chosen = guarded_options().guard
    delay = chosen.oldest + chosen.latency + chosen.lag + 2.5 * chosen.period
    # The speed may still rise until the silence is noticed.
    top = speed + scene.vehicle.limits.acceleration * (chosen.oldest + chosen.period)
    top = min(top, guarded_options().speed)
    allowed = top * delay + 0.5 * top * top / chosen.deceleration
    return {
        **found,
        "speed_then_m_s": speed,
        "stopped_after_m": float(way),
        "allowed_m": allowed,
    }
