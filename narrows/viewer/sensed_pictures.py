"""The picture of a motion planned by what is sensed: each look around, and the true world."""

from __future__ import annotations

import textwrap

import matplotlib
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Patch

from narrows.interfaces import PlanStatus
from narrows.scene import Scene
from narrows.se2 import Array, transform
from narrows.simulation.sensed_plan import SensedPlan, View
from narrows.world import Door

from . import palette
from .motion_drawing import draw_motion
from .scene_drawing import draw_ends, draw_world
from .study_axes import new_figure, study_style
from .view_box import ViewBox, view_box

_MOST = 5  # looks that are drawn, the first and the last among them
_UNKNOWN, _FREE, _DOOR = "#DADADA", "#FFFFFF", palette.RED


def sensed_figure(scene: Scene, outcome: SensedPlan) -> Figure:
    """Return the picture of a plan by sensors: what was known at its looks, and what came of it.

    Args:
        scene: The true scene.
        outcome: The plan and its looks around.
    """
    count = len(outcome.views)
    chosen = np.unique(np.linspace(0, count - 1, min(count, _MOST)).round().astype(int))
    columns = 2 if len(chosen) < 2 else 3
    rows = -(-(len(chosen) + 1) // columns)
    trajectory = outcome.plan.trajectory
    paths = [] if trajectory is None else [trajectory.path]
    paths += [v.leg.path for v in outcome.views if v.leg is not None and v.leg.path is not None]
    box = view_box(scene, paths)
    shape = (box[3] - box[1]) / (box[2] - box[0])
    with matplotlib.rc_context(study_style()):
        title = _title(scene, outcome)
        height = rows * ((12.0 / columns - 0.6) * shape + 0.8) + 1.2 + 0.2 * title.count("\n")
        figure = new_figure(12.0, min(height, 24.0))
        panels = figure.subplots(rows, columns, squeeze=False).ravel()
        for axes, index in zip(panels, chosen.tolist(), strict=False):
            _draw_view(axes, scene, outcome.views[index], index, box)
        _draw_truth(panels[len(chosen)], scene, outcome, box)
        for axes in panels[len(chosen) + 1 :]:
            axes.set_axis_off()
        figure.suptitle(title, fontsize=11)
        figure.legend(handles=_legend(), loc="outside lower center", ncols=5, fontsize=9)
    return figure


def _title(scene: Scene, outcome: SensedPlan) -> str:
    """Return what came of it, and why if it is not certified."""
    status = outcome.plan.status
    title = f"{scene.name or 'scene'}, planned by what is sensed: {status.value.replace('_', ' ')}"
    if status is PlanStatus.CERTIFIED:
        return title
    return "\n".join([title, *textwrap.wrap(outcome.plan.reason, 120)])


def _legend() -> list[Artist]:
    """Return what the colours stand for, in all panels."""
    cells = (("unknown", _UNKNOWN), ("seen to be free", _FREE), ("obstacle seen", palette.INK))
    handles: list[Artist] = [
        Patch(facecolor=colour, edgecolor=palette.OUTLINE, label=name) for name, colour in cells
    ]
    lines = (
        ("door found", _DOOR, "-"),
        ("where it stands and looks around", palette.START, "-"),
        ("goal", palette.GOAL, "--"),
        ("driven forwards", palette.FORWARD, "-"),
        ("backwards", palette.REVERSE, "--"),
    )
    handles += [Line2D([], [], color=c, ls=style, lw=2, label=n) for n, c, style in lines]
    turn = Line2D([], [], color=palette.INK, marker="D", ls="", label="changes direction")
    return [*handles, turn]


def _draw_view(axes: Axes, scene: Scene, view: View, index: int, box: ViewBox) -> None:
    """Draw what was known after a look, and the leg driven from there."""
    space = view.space
    low, size = space.corner, space.cell * len(space.known)
    cells = np.where(space.occupied.any(axis=0), 2, np.where(space.known, 1, 0))
    axes.imshow(
        cells,
        cmap=ListedColormap([_UNKNOWN, _FREE, palette.INK]),
        vmin=0,
        vmax=2,
        extent=(low[0], low[0] + size, low[1], low[1] + size),
        origin="lower",
        interpolation="nearest",
    )
    if view.leg is not None and view.leg.path is not None:
        draw_motion(axes, scene.vehicle, view.leg.path, fault="")
    axes.plot(*_closed(transform(space.pose, scene.vehicle.outline)).T, color=palette.START, lw=2)
    for door in space.doors:
        axes.plot(*_opening(door).T, color=_DOOR, linewidth=3.0)
    goal = _closed(transform(scene.goal.pose, scene.vehicle.outline))
    axes.plot(*goal.T, color=palette.GOAL, linestyle=(0, (4, 1.5)), linewidth=1.5)
    ends = "stops where the seen ends" if view.into_the_unknown else "to the goal"
    if view.leg is None:
        ends = "no way on"
    _frame(axes, f"look {index + 1}: {ends}", box)


def _draw_truth(axes: Axes, scene: Scene, outcome: SensedPlan, box: ViewBox) -> None:
    """Draw the true world, those who move in it, and the motion: certified, or what was refused."""
    draw_world(axes, scene, box)
    draw_ends(axes, scene)
    for solid in scene.world.moving:
        axes.plot(*solid.path[:, 1:].T, color=palette.INK, linestyle=":", linewidth=1.5, zorder=4)
        place = (float(solid.path[0, 1]), float(solid.path[0, 2]))
        axes.add_patch(Circle(place, solid.radius, facecolor=palette.INK, alpha=0.5, zorder=4))
    trajectory, certificate = outcome.plan.trajectory, outcome.plan.certificate
    legs = [v.leg.path for v in outcome.views if v.leg is not None and v.leg.path is not None]
    title, fault = "the true world", ""
    if trajectory is not None and certificate is not None:
        legs = [trajectory.path]
        title += f": clear by {1e3 * certificate.clearance:.0f} mm"
    elif legs:
        fault = "not certified"
        title += f": {fault}"
    for path in legs:
        draw_motion(axes, scene.vehicle, path, fault=fault)
    for view in outcome.views:
        axes.plot(*view.space.pose[:2], "o", color=palette.START, markersize=6, zorder=6)
    _frame(axes, title, box)


def _frame(axes: Axes, title: str, box: ViewBox) -> None:
    axes.set_aspect("equal")
    axes.set_xlim(box[0], box[2])
    axes.set_ylim(box[1], box[3])
    axes.set_title(title, fontsize=11)
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")


def _closed(corners: Array) -> Array:
    return np.concatenate([corners, corners[:1]])


def _opening(door: Door) -> Array:
    """Return the ends of a door's clear width, shape (2, 2), [m]."""
    left = np.array([-np.sin(door.heading), np.cos(door.heading)])
    return np.array(door.center) + 0.5 * door.width * np.stack([-left, left])
