"""The curves of the `narrow-arcs` study, and what its four figures show of them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..planners.arc_geometry import paper_turn
from ..planners.arc_path import CornerFrame, path_of
from ..planners.corridor_turn import Corner, uniform_clearance
from ..planners.door_space import least_corridor_for_door
from ..se2 import Array
from ..short_forms import Corridor
from ..world import World
from .narrow_arcs_cases import (
    ARCS,
    DOOR,
    WIDTH,
    chairs,
    execute,
    named_arc,
    paper_body,
    paper_vehicle,
)
from .table import Table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..viewer.narrow_arcs_pictures import DrawnCurve, DrawnTurn

_CHAIRS = ("paper's formulas", "dft")
_DRIVES = 6  # drawn for each arc


def clearance_of_radius() -> dict[str, Array]:
    """Return the clearance over the inner radius in the experiment's corridor, by column."""
    radius = np.linspace(0.0, 2.2, 441)
    body, corner = paper_body(), Corner(WIDTH, WIDTH)
    on_bisector = [paper_turn(body.front, body.width, WIDTH, r).clearance for r in radius.tolist()]
    free = uniform_clearance(body, corner, radius + 0.5 * body.width)
    return {
        "inner_radius_m": radius,
        "bisector_mm": 1e3 * np.array(on_bisector),
        "free_mm": 1e3 * free,
    }


def door_trade_off() -> dict[str, Array]:
    """Return the narrowest corridor for doors of all widths, by column; nan: too narrow a door."""
    doors = np.round(np.arange(0.71, 1.1501, 0.01), 3)
    columns = {"door_m": doors}
    for name in _CHAIRS:
        body = chairs()[name]
        for kind, before in (("centre beyond the wall", False), ("centre anywhere", True)):
            columns[f"{name}, {kind}"] = np.array(
                [
                    least_corridor_for_door(body, door, before_wall=before).corridor
                    if door > body.width + 1e-9
                    else np.nan
                    for door in doors.tolist()
                ]
            )
    return columns


def draw(
    out: Path, radii: Mapping[str, Array], trade: Mapping[str, Array], turned: Table, seed: int
) -> None:
    """Draw the four figures into a folder."""
    from ..viewer import narrow_arcs_pictures as pictures
    from ..viewer.pictures import save_picture

    form = Corridor(WIDTH, length=4.0)
    walls, vehicle = World(form.world().solids[:2]), paper_vehicle()
    turns = [_drawn_turn(name) for name in ARCS]
    save_picture(pictures.turns_figure(walls, vehicle, turns), out / "turns.png")
    save_picture(_radius_figure(radii), out / "radius.png")
    save_picture(_trade_figure(trade), out / "door-corridor.png")
    generators = [np.random.default_rng([seed, number]) for number in range(_DRIVES * len(ARCS))]
    driven = {
        name: [execute(named_arc(name), rng).record.poses for rng in generators[k :: len(ARCS)]]
        for k, name in enumerate(ARCS)
    }
    cleared = {
        name: np.asarray(turned.where(arc=name).column("clearance_mm"), dtype=float)
        for name in ARCS
    }
    figure = pictures.executed_figure(walls, vehicle, driven, cleared)
    save_picture(figure, out / "executed.png")


def _drawn_turn(name: str) -> DrawnTurn:
    from ..viewer.narrow_arcs_pictures import DrawnTurn

    arc, half = named_arc(name), 0.5 * paper_body().width
    frame = CornerFrame(np.array([0.0, WIDTH]), 0.0, 1)
    x, y = arc.centre
    begin = frame.pose_in_world(x, y - arc.radius, 0.0)
    start = frame.pose_in_world(x - 2.5, y - arc.radius, 0.0)
    pieces = [(2.5, 0.0), (arc.radius * arc.turn, 1.0 / arc.radius), (2.5, 0.0)]
    text = (
        f"r = {arc.radius - half:.2f} m, C_r = {arc.side_gap(2.0 * half):.2f} m, "
        f"C_n = {arc.axle_gap:.2f} m\nclear by {1e3 * arc.clearance:.0f} mm"
    )
    touching = frame.point_in_world((0.0, 0.0)) if arc.clearance < 1e-6 else None
    return DrawnTurn(name, text, path_of(start, pieces), begin, touching)


def _radius_figure(radii: Mapping[str, Array]) -> Figure:
    from ..viewer.narrow_arcs_pictures import DrawnCurve, curves_figure

    r, half = radii["inner_radius_m"], 0.5 * paper_body().width
    paper, best, free = (named_arc(name) for name in ARCS)

    def curve(label: str, values: Array, arc_radius: float, gap: float, drop: float) -> DrawnCurve:
        text = f"best: {gap:.0f} mm at r = {arc_radius:.2f} m"
        return DrawnCurve(label, r, values, (arc_radius, gap), text, (24.0, drop))

    contact = np.array([paper.radius - half] * 2)
    curves = [
        DrawnCurve(
            "the paper's radius",
            contact,
            np.array([-60.0, 0.0]),
            (float(contact[0]), 0.0),
            f"the paper: 0 mm at r = {contact[0]:.2f} m",
            (24.0, 26.0),
        ),
        curve(
            "centre on the bisector",
            radii["bisector_mm"],
            best.radius - half,
            1e3 * best.clearance,
            -52.0,
        ),
        curve(
            "centre anywhere",
            radii["free_mm"],
            free.radius - half,
            1e3 * free.clearance,
            14.0,
        ),
    ]
    return curves_figure(
        curves,
        title="Clearance of the turn in the 1.30 m corridor over its inner radius",
        x="inner radius r [m]",
        y="clearance [mm]",
        y_from=-60.0,
        y_to=170.0,
    )


def _trade_figure(trade: Mapping[str, Array]) -> Figure:
    from ..viewer.narrow_arcs_pictures import DrawnCurve, curves_figure

    doors, curves = trade["door_m"], []
    names = [name for name in trade if name != "door_m"]
    for k, name in enumerate(names):
        mark, text = None, ""
        if k < 2:
            corridor = float(np.interp(DOOR, doors, trade[name]))
            mark, text = (DOOR, corridor), f"door {DOOR:.2f} m: corridor {corridor:.2f} m"
        curves.append(
            DrawnCurve(name, doors, trade[name], mark, text, (26.0, 22.0 if k == 0 else -40.0))
        )
    return curves_figure(
        curves,
        title="The narrowest corridor from which one arc leads through a door (thin wall, r >= 0)",
        x="door [m]",
        y="corridor [m]",
        y_from=0.8,
        y_to=3.6,
    )
