"""How wide must a door be for a chair, from a corridor of 1.20 m? A proof for each width."""

from math import floor

import narrows

SCENE = """
vehicle: {chair}
doorway: {{corridor_width: 1.2, door_width: {width}, wall_thickness: 0.1}}
"""
CHAIRS = ("adaag", "dft")
WIDTHS = (0.70, 0.75, 0.80)


def main() -> None:
    """Print a small table: millimetres to spare (+) or missing (-)."""
    print("door [m]  " + "".join(f"{chair:>12}" for chair in CHAIRS))
    for width in WIDTHS:
        row = []
        for chair in CHAIRS:
            verdict = narrows.passable(narrows.read_scene(SCENE.format(chair=chair, width=width)))
            spare = "?" if verdict.spare_m is None else f"{floor(1e3 * verdict.spare_m):+d} mm"
            row.append(f"{spare:>12}")
        print(f"{width:8.2f}  {''.join(row)}")


if __name__ == "__main__":
    main()
