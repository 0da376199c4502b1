"""A scene from a file, one built in Python, and what a mistake in a file looks like."""

from pathlib import Path

import numpy as np

import narrows

SCENES = Path(__file__).parent / "scenes"


def main() -> None:
    """Read, build and break a scene."""
    scene = narrows.load_scene(SCENES / "door.yaml")
    print(f"{scene.name}: {scene.vehicle.length:.2f} x {scene.vehicle.width:.2f} m chair,")
    print(f"  {len(scene.world.solids)} solids, {len(scene.world.doors)} door")

    table = narrows.Solid.polygon(
        [[1.5, -0.5], [2.5, -0.5], [2.5, 0.5], [1.5, 0.5]], z=(0.70, 0.74), name="table top"
    )
    chair = narrows.load_vehicle("adaag")
    goal = narrows.Goal(np.array([3.0, 1.2, 0.0]))
    built = narrows.Scene(chair, narrows.World((table,)), np.zeros(3), goal, name="round a table")
    distance, against = narrows.clearance_at(built.world, chair, built.start)
    print(f"{built.name}: at the start {distance[0]:.2f} m from the {against[0]}")

    text = (SCENES / "door.yaml").read_text(encoding="utf-8").replace("door_width", "door_widht")
    try:
        narrows.read_scene(text, "door.yaml")
    except narrows.SceneError as error:
        print(f"a mistake: {error}")


if __name__ == "__main__":
    main()
