"""A tracker of one's own: any object with `step`, `finished` and `progress` can be driven."""

from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

import narrows
from narrows.simulation.judge import judge
from narrows.simulation.simulator import simulate

SCENE = Path(__file__).parent / "scenes" / "door.yaml"


class FeedForward:
    """Sends the planned commands by the clock and never looks where the chair is."""

    def __init__(self, trajectory: narrows.Trajectory) -> None:
        """Keep the plan."""
        self._trajectory = trajectory
        self._time = 0.0

    @property
    def progress(self) -> float:
        """Progress the plan has at this time."""
        return float(self._trajectory.progress(self._time))

    @property
    def finished(self) -> bool:
        """Whether the plan's time is over."""
        return self._time >= self._trajectory.duration

    def step(self, time: float, pose: ArrayLike) -> np.ndarray:
        """Return the planned command [v, omega], whatever the pose."""
        self._time = time
        return np.zeros(2) if self.finished else self._trajectory.command(time)


def main() -> None:
    """Drive the example door blind."""
    scene = narrows.load_scene(SCENE)
    trajectory = narrows.plan(scene).raise_for_status().trajectory
    record = simulate(scene, FeedForward(trajectory), reference=trajectory)
    verdict = judge(scene, record)
    error = 1e3 * (verdict.max_cross_track_error or 0.0)
    print(f"{verdict.reason}; at most {error:.0f} mm off the path")


if __name__ == "__main__":
    main()
