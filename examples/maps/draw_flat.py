"""Draw the map of a small flat, as map_server would save it: flat.pgm and flat.yaml.

A corridor 1.50 m wide with a bathroom (door 0.90 m), a bedroom (0.80 m) and a living room
(0.85 m). One pixel is 2.5 cm; what lies outside of the walls is unknown.
"""

from pathlib import Path

import numpy as np
from PIL import Image

RESOLUTION = 0.025  # m
ORIGIN = (-0.5, -0.5)  # m, of the picture's lower left corner
SIZE = (9.0, 6.0)  # m
OCCUPIED, UNKNOWN, FREE = 0, 205, 254

# Boxes x_low, y_low, x_high, y_high [m], each drawn over the ones before it.
HOUSE = (-0.2, -0.2, 8.2, 5.2)
ROOMS = {
    "corridor": (0.0, 0.0, 8.0, 1.5),
    "bathroom": (0.0, 1.6, 2.2, 5.0),
    "bathroom door": (0.65, 1.5, 1.55, 1.6),
    "bedroom": (2.3, 1.6, 5.3, 5.0),
    "bedroom door": (3.4, 1.5, 4.2, 1.6),
    "living room": (5.4, 1.6, 8.0, 5.0),
    "living room door": (6.275, 1.5, 7.125, 1.6),
}
FURNITURE = {
    "toilet": (0.0, 4.0, 0.7, 4.4),
    "wash basin": (1.7, 3.4, 2.2, 4.0),
    "bed": (2.3, 2.9, 4.3, 4.4),
    "wardrobe": (4.7, 3.4, 5.3, 5.0),
    "table": (6.3, 3.2, 7.5, 4.0),
    "coats": (7.7, 0.0, 8.0, 0.9),
}


def draw() -> np.ndarray:
    """Return the pixels, topmost row first."""
    columns, rows = (round(side / RESOLUTION) for side in SIZE)
    cells = np.full((rows, columns), UNKNOWN, dtype=np.uint8)
    boxes = [(HOUSE, OCCUPIED)]
    boxes += [(box, FREE) for box in ROOMS.values()]
    boxes += [(box, OCCUPIED) for box in FURNITURE.values()]
    for box, value in boxes:
        (left, bottom), (right, top) = (
            [round((box[k + axis] - ORIGIN[axis]) / RESOLUTION) for axis in (0, 1)] for k in (0, 2)
        )
        cells[bottom:top, left:right] = value
    return cells[::-1]


def write(folder: Path) -> None:
    """Write the picture and the file that describes it."""
    Image.fromarray(draw()).save(folder / "flat.pgm")
    lines = [
        "image: flat.pgm",
        "mode: trinary",
        f"resolution: {RESOLUTION}",
        f"origin: [{ORIGIN[0]}, {ORIGIN[1]}, 0.0]",
        "negate: 0",
        "occupied_thresh: 0.65",
        "free_thresh: 0.196",
    ]
    (folder / "flat.yaml").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    write(Path(__file__).parent)
