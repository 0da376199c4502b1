"""A plan through a door: its certificate, its trajectory as CSV, and a picture."""

from pathlib import Path

import narrows
from narrows.viewer.pictures import plan_picture, save_picture

SCENE = Path(__file__).parent / "scenes" / "door.yaml"
OUT = Path("out")


def main() -> None:
    """Plan, look, write."""
    scene = narrows.load_scene(SCENE)
    plan = narrows.plan(scene).raise_for_status()
    print(f"{plan.planner}: {plan.reason}")
    trajectory = plan.trajectory
    v, omega = trajectory.command(0.5 * trajectory.duration)
    print(f"half way through its {trajectory.duration:.1f} s: {v:.2f} m/s, {omega:.2f} rad/s")
    narrows.write_trajectory(trajectory, OUT / "door.csv", vehicle=scene.vehicle)
    save_picture(plan_picture(scene, plan), OUT / "door.png")


if __name__ == "__main__":
    main()
