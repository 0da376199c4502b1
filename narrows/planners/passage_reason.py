"""A verdict about a passage, in words for people."""

from __future__ import annotations

import math

import numpy as np
import shapely

from ..scene import Scene
from ..se2 import Array
from .passage_refinement import Answer, Decision
from .spare import LARGEST, Limit, Spare

_MILLIMETRE = 1e-3


def reason_for(
    scene: Scene, decision: Decision, spare: Spare | None, narrowest: Array | None
) -> str:
    """Return why a body passes or not, where it is narrowest, and what the verdict leaves open.

    Args:
        scene: The scene asked about.
        decision: What was found for the body as it is.
        spare: The room to spare, where it was asked for.
        narrowest: The narrowest place in the world, shape (2,), [m], where it is known.
    """
    if decision.answer is Answer.JOINED:
        parts = [_passes(scene, spare), *_provisos(scene)]
    elif decision.answer is Answer.APART:
        parts = [_blocked(scene, decision, spare, narrowest)]
    elif decision.answer is Answer.TOO_FINE or decision.answer is Answer.OUTSIDE:
        parts = ["not decided: the body fits or fails by less than the resolution"]
        if spare is not None:
            parts.append(_bracket(spare))
    elif decision.answer is Answer.TOO_LONG:
        parts = ["not decided within the time given; a larger budget may decide"]
    else:
        raise ValueError(f"no words for {decision.answer}")
    if scene.world.moving:
        parts.append("solids that move are left out")
    return "; ".join(parts)


def _passes(scene: Scene, spare: Spare | None) -> str:
    if spare is None:
        return "the body passes"
    room = f"{1e3 * spare.proven:.0f} mm to spare"
    if spare.limit is Limit.NOTHING:
        exact = "" if spare.proven >= 2.0 * LARGEST else ", the search ended early"
        return f"the body passes with at least {room}{exact}"
    if spare.limit is Limit.START:
        text = f"the body passes with {room}, the least of it at the start"
    elif spare.limit is Limit.GOAL:
        text = f"the body passes with {room}, the least of it at the goal"
    elif spare.limit is Limit.BETWEEN:
        text = f"the body passes with {room}"
        if spare.narrowest is not None:
            text += f" at {place_name(scene, spare.narrowest)}"
    else:
        raise ValueError(f"a body that passes cannot be limited by: {spare.limit.value}")
    if spare.refuted - spare.proven > _MILLIMETRE:
        text += f" ({_bracket(spare)})"
    if spare.proven < 2.0 * scene.margin:
        text += f", less than the margin of {1e3 * scene.margin:.0f} mm on each side"
    return text


def _bracket(spare: Spare) -> str:
    return f"the room to spare is between {1e3 * spare.proven:.1f} and {1e3 * spare.refuted:.1f} mm"


def _provisos(scene: Scene) -> list[str]:
    limits = scene.vehicle.limits
    if limits.reverse_speed == 0.0:
        return ["that is with reversing, and this chair does not reverse"]
    if math.isfinite(limits.curvature):
        return ["it may take shunting, as the curvature is limited"]
    return []


def _blocked(scene: Scene, decision: Decision, spare: Spare | None, narrowest: Array | None) -> str:
    """Return where nothing passes, and how much larger than it may be the body is.

    That is for its width and length alike: a door that much wider may not be enough in a turn.
    """
    network, place = decision.network, ""
    if not network.start_is_possible:
        where = "it does not fit at the start"
    elif not network.goal_is_possible:
        where = "it does not fit at the goal"
    elif narrowest is None:
        where = "nothing gets through"
    else:
        name = place_name(scene, narrowest)
        where, place = f"it does not fit through {name}", f" for {name}"
    return f"no motion gets this body from start to goal: {_too_large(where, place, spare)}"


def _too_large(where: str, place: str, spare: Spare | None) -> str:
    if spare is None:
        return where
    if spare.limit is Limit.NO_WAY:
        return f"{where}, however small the body"
    if spare.limit is Limit.UNKNOWN:
        amount = f"at least {-1e3 * spare.refuted:.0f} mm"
    elif spare.refuted - spare.proven > _MILLIMETRE:
        amount = f"{-1e3 * spare.refuted:.0f} to {-1e3 * spare.proven:.0f} mm"
    else:
        amount = f"{-1e3 * spare.proven:.0f} mm"
    return f"it is {amount} too large{place}" if place else f"{where}, it is {amount} too large"


def place_name(scene: Scene, place: Array) -> str:
    """Return what people call a place: the door there, the solids it is between, or its x, y."""
    x, y = float(place[0]), float(place[1])
    for door in scene.world.doors:
        if math.dist(door.center, (x, y)) <= max(0.75 * door.width, 0.5):
            return f"the door at ({door.center[0]:.2f}, {door.center[1]:.2f})"
    named = [solid for solid in scene.world.solids if solid.name]
    if named:
        point = shapely.Point(x, y)
        gaps = [float(shapely.distance(s.shape, point)) - s.radius for s in named]
        near = [named[k].name for k in np.argsort(gaps) if gaps[k] < scene.vehicle.length]
        if near:
            return f"the place near {' and '.join(near[:2])} at ({x:.2f}, {y:.2f})"
    return f"the place at ({x:.2f}, {y:.2f})"
