"""What tells one scripted driver from another: traits with names, bounds and units."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from ..errors import ShapeError

BOUNDS: dict[str, tuple[float, float]] = {
    "pace": (0.1, 1.0),
    "reaction_time": (0.0, 0.6),
    "preview": (0.4, 2.0),
    "heading_noise": (0.0, math.radians(15.0)),
    "judgement": (0.0, 0.15),
    "tremor": (0.0, 0.3),
    "over_steer": (0.6, 2.0),
    "lapse_rate": (0.0, 0.2),
    "lapse_time": (0.0, 2.0),
    "headway": (0.5, 4.0),
    "patience": (0.5, 5.0),
}
"""Least and greatest value of every trait; a driver beyond them is refused."""


@dataclass(frozen=True)
class Traits:
    """How a person drives. The defaults are an attentive person of steady hand.

    Attributes:
        pace: Share of the joystick's full speed they choose where nothing is near.
        reaction_time: From seeing to moving the hand [s].
        preview: How far ahead along their way they look while cruising [m].
        heading_noise: Standard deviation of their error in judging where the chair points
            [rad]; it changes over a second.
        judgement: Standard deviation of their error in judging where the chair's sides are [m];
            it changes over three seconds.
        tremor: Standard deviation of the hand's unrest, as a share of full deflection; it
            changes over a tenth of a second.
        over_steer: What they multiply the curve by that would do.
        lapse_rate: Lapses of attention a second of driving [1/s]; the hand then stays as it is.
        lapse_time: How long a lapse lasts [s].
        headway: Time to what is ahead below which they slow down [s].
        patience: How long they push a chair that does not move before they try otherwise [s].
    """

    pace: float = 0.85
    reaction_time: float = 0.20
    preview: float = 1.0
    heading_noise: float = math.radians(1.0)
    judgement: float = 0.01
    tremor: float = 0.02
    over_steer: float = 1.0
    lapse_rate: float = 0.0
    lapse_time: float = 0.5
    headway: float = 1.2
    patience: float = 1.5

    def __post_init__(self) -> None:
        """Check every trait against its bounds."""
        for name, (low, high) in BOUNDS.items():
            value = getattr(self, name)
            if not low <= value <= high:
                raise ShapeError(f"trait {name} must lie between {low:g} and {high:g}, got {value}")


def _degrees(angle: float) -> float:
    return math.radians(angle)


DRIVERS: dict[str, Traits] = {
    "steady": Traits(),
    "brisk": Traits(pace=0.95, reaction_time=0.15, headway=0.9),
    "cautious": Traits(pace=0.7, headway=1.6, over_steer=0.95),
    "hasty": Traits(pace=1.0, heading_noise=_degrees(1.8), judgement=0.02, headway=0.8),
    "shaky": Traits(pace=0.8, tremor=0.05, heading_noise=_degrees(1.4)),
    "dreamy": Traits(pace=0.85, lapse_rate=0.03, lapse_time=0.6, reaction_time=0.25),
    "short-sighted": Traits(pace=0.75, preview=0.7, judgement=0.03, heading_noise=_degrees(1.6)),
    "heavy-handed": Traits(pace=0.88, over_steer=1.35, tremor=0.03),
}
"""Eight drivers by what is most noticeable about them; ours, not the paper's subjects."""


def by_head(traits: Traits) -> Traits:
    """Return how the same person drives with the head instead of the hand.

    Slower, later and less precise: the neck lags and trembles more than the wrist does, and it
    turns a little whenever its owner looks around.
    """
    return replace(
        traits,
        pace=0.66 * traits.pace,
        reaction_time=min(traits.reaction_time + 0.06, BOUNDS["reaction_time"][1]),
        heading_noise=1.15 * traits.heading_noise,
        judgement=1.1 * traits.judgement,
        tremor=min(1.25 * traits.tremor + 0.005, BOUNDS["tremor"][1]),
    )
