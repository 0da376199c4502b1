"""The picture of a motion planned by what is sensed: each look around, and the true world."""

from __future__ import annotations

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

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
_UNKNOWN, _FREE = "#DADADA", "#FFFFFF"


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
        height = min(rows * (12.0 / columns * shape + 0.6) + 1.0, 24.0)
        figure = new_figure(12.0, height)
        panels = figure.subplots(rows, columns, squeeze=False).ravel()
        for axes, index in zip(panels, chosen.tolist(), strict=False):
            _draw_view(axes, scene, outcome.views[index], index, box)
        _draw_truth(panels[len(chosen)], scene, outcome, box)
        for axes in panels[len(chosen) + 1 :]:
            axes.set_axis_off()
        status = outcome.plan.status.value.replace("_", " ")
        figure.suptitle(f"{scene.name or 'scene'}, planned by what is sensed: {status}")
    return figure


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
        axes.plot(*_opening(door).T, color=palette.ORANGE, linewidth=3.0)
    goal = _closed(transform(scene.goal.pose, scene.vehicle.outline))
    axes.plot(*goal.T, color=palette.GOAL, linestyle=(0, (4, 1.5)), linewidth=1.5)
    ends = "stops where the seen ends" if view.into_the_unknown else "to the goal"
    if view.leg is None:
        ends = "no way on"
    _frame(axes, f"look {index + 1}: {ends}", box)
    if index == 0:
        names = (("unknown", _UNKNOWN), ("seen to be free", _FREE), ("obstacle", palette.INK))
        handles = [Patch(facecolor=c, edgecolor=palette.OUTLINE, label=n) for n, c in names]
        handles.append(Patch(facecolor=palette.ORANGE, label="door found"))
        axes.legend(handles=handles, loc="best", fontsize=8, framealpha=0.9)


def _draw_truth(axes: Axes, scene: Scene, outcome: SensedPlan, box: ViewBox) -> None:
    """Draw the true world and the whole motion, if it is certified."""
    draw_world(axes, scene, box)
    draw_ends(axes, scene)
    trajectory, certificate = outcome.plan.trajectory, outcome.plan.certificate
    title = "the true world"
    if trajectory is not None and certificate is not None:
        draw_motion(axes, scene.vehicle, trajectory.path, fault="")
        title += f": clear by {1e3 * certificate.clearance:.0f} mm"
    for view in outcome.views:
        axes.plot(*view.space.pose[:2], "o", color=palette.RED, markersize=5, zorder=6)
    _frame(axes, title, box)


def _frame(axes: Axes, title: str, box: ViewBox) -> None:
    axes.set_aspect("equal")
    axes.set_xlim(box[0], box[2])
    axes.set_ylim(box[1], box[3])
    axes.set_title(title, fontsize=11)


def _closed(corners: Array) -> Array:
    return np.concatenate([corners, corners[:1]])


def _opening(door: Door) -> Array:
    """Return the ends of a door's clear width, shape (2, 2), [m]."""
    left = np.array([-np.sin(door.heading), np.cos(door.heading)])
    return np.array(door.center) + 0.5 * door.width * np.stack([-left, left])
