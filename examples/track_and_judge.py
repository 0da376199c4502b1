"""Drive a plan with slipping wheels and a poor sense of place; judge it on the swept body."""

from pathlib import Path

import numpy as np

import narrows
from narrows.simulation.judge import judge
from narrows.simulation.localisation import NoisyPose
from narrows.simulation.plant import PlantOptions
from narrows.simulation.record import write_record
from narrows.simulation.simulator import SimulationOptions, simulate
from narrows.tracking.lookahead import LookaheadTracker

SCENE = Path(__file__).parent / "scenes" / "door.yaml"
OUT = Path("out")


def main() -> None:
    """Drive twice: as if all were known, and in a worse world."""
    scene = narrows.load_scene(SCENE)
    trajectory = narrows.plan(scene).raise_for_status().trajectory
    worse = SimulationOptions(
        plant=PlantOptions(slip=0.02, left_radius_error=0.01),
        localisation=NoisyPose(position=0.01, memory=0.5),
    )
    for name, options in (("all known", SimulationOptions()), ("a worse world", worse)):
        tracker = LookaheadTracker(trajectory, scene.vehicle)
        rng = np.random.default_rng(7)
        record = simulate(scene, tracker, reference=trajectory, options=options, rng=rng)
        verdict = judge(scene, record)
        error = 1e3 * (verdict.max_cross_track_error or 0.0)
        clearance = 1e3 * verdict.min_clearance
        print(f"{name}: {verdict.reason}")
        print(f"  at most {error:.0f} mm off the path, proven clearance {clearance:.0f} mm")
    write_record(record, OUT / "worse-drive.csv")


if __name__ == "__main__":
    main()
