"""Feedback linearisation of the distance to a path [NarrowArcs, Section 4]."""

from __future__ import annotations

from ..path import Path
from ..trajectory import Trajectory
from ..vehicle import Vehicle
from .following import LawTracker, Place, mean_curvature, travel_angle
from .legs import Leg
from .level import Jet
from .linearizing_law import LinearizingLaw, LinearizingOptions

_REACH = 0.15  # m: how far from its last place a foot is looked for, several periods of travel
_LEAST_SCALE = 0.2  # 1 - kappa f near the centre of the path's curvature, where f has no gradient


class _Projection:
    """The law on a leg: f is the signed distance to the leg, found by projection."""

    def __init__(self, law: LinearizingLaw) -> None:
        self._law = law
        self._near = 0.0

    def begin(self, leg: Leg) -> None:
        """See `SteeringLaw`."""
        self._near = leg.start
        self._law.reset()

    def locate(self, leg: Leg, x: float, y: float, heading: float) -> Place:
        """See `SteeringLaw`; the point is the foot of the chair."""
        foot = leg.project(x, y, near=self._near, reach=_REACH)
        self._near = foot.progress
        angle = travel_angle(leg, foot.progress, heading)
        return Place(foot.progress, 0.0, foot.offset, angle)

    def steer(self, leg: Leg, place: Place, rate: float, period: float) -> tuple[float, float]:
        """See `SteeringLaw`. Seen from the travel the path runs along x, its left along y."""
        kappa = mean_curvature(leg, place.progress, rate * period)
        # The Hessian of a signed distance is -kappa / (1 - kappa f) along the path, 0 across.
        scale = max(1.0 - kappa * place.left, _LEAST_SCALE)
        jet = Jet(place.left, 0.0, 1.0, -kappa / scale, 0.0, 0.0)
        return self._law.steer(jet, place.angle, place.angle, rate)


class LinearizingTracker(LawTracker):
    """Feedback linearisation of the distance to the path [NarrowArcs, Eqs. (4.3), (4.4)].

    With critical gains and no delay the distance f to the path decays as (1 + s/d) exp(-s/d) over
    the way s, the curvature fed forward exactly. Beyond the paper: gains follow the speed, so that
    errors decay over the same distance at every speed; large f is held to what an approach at
    `approach` corrects; where the chair heads across the path or backward along it (Delta <= 0)
    it first turns, on the spot if it may; the travel of each leg is the one planned.

    It assumes poses at least every 0.1 s, a start within 0.15 m along the path of where it begins,
    and errors smaller than the path's radius: at the centre of curvature the distance has no
    gradient.
    """

    def __init__(
        self,
        motion: Path | Trajectory,
        vehicle: Vehicle,
        options: LinearizingOptions | None = None,
    ) -> None:
        """Table the path.

        Args:
            motion: The path, driven at the cruising speed; or a trajectory, driven at its own.
            vehicle: Its limits bound the commands.
            options: Default `LinearizingOptions()`.
        """
        self.options = LinearizingOptions() if options is None else options
        law = _Projection(LinearizingLaw(vehicle, self.options))
        super().__init__(motion, vehicle, law, self.options.following)
