"""Judge somebody else's motion: rows of x, y, heading, as CSV or in memory."""

from pathlib import Path

import numpy as np

import narrows

SCENE = Path(__file__).parent / "scenes" / "door.yaml"
OUT = Path("out")


def main() -> None:
    """Drive straight ahead, then on an arc, then straight on; ask for the truth."""
    scene = narrows.load_scene(SCENE)
    for radius in (1.0, 1.4):
        turn = np.linspace(0.0, np.pi / 2, 40)
        x = scene.goal.pose[0] - radius + radius * np.sin(turn)
        y = scene.start[1] + radius - radius * np.cos(turn)
        arc = np.column_stack([x, y, turn])
        poses = np.vstack([scene.start, arc, scene.goal.pose])
        found = narrows.verify(scene, poses)
        print(f"arc of {radius:.1f} m: {found.status}, {found.reason}")

    file = OUT / "arc.csv"
    file.parent.mkdir(exist_ok=True)
    np.savetxt(file, poses, delimiter=",", header="x,y,heading", comments="")
    print(f"from {file}: {narrows.verify(scene, narrows.read_trajectory(file)).status}")


if __name__ == "__main__":
    main()
