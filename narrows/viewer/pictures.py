"""Pictures of plans, judged motions and drives: the scene to scale, and charts along the motion.

Pictures are 1200 px wide and the same in every run. A motion that is not certified is never drawn
as if it were: dashed, red, and called so in the title.
"""

from __future__ import annotations

import io
import textwrap
from dataclasses import dataclass
from pathlib import Path as FilePath
from typing import Any

import matplotlib
import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from narrows.clearance import Certificate
from narrows.errors import InputError
from narrows.files import write_whole
from narrows.interfaces import Plan, PlanStatus
from narrows.path import Path
from narrows.scene import Scene
from narrows.se2 import transform
from narrows.trajectory import Trajectory
from narrows.verification import Verification

from . import palette
from .charts import TrackingErrors, draw_clearance, draw_curvature, draw_speeds, draw_tracking
from .least_clearance import draw_least
from .motion_drawing import draw_motion, draw_planned, swept_area
from .picture_files import check_picture_suffix
from .scene_drawing import (
    door_label_areas,
    draw_ends,
    draw_moving,
    draw_scale,
    draw_world,
    solid_areas,
)
from .view_box import ViewBox, view_box

_WIDTH = 12.0  # in; 1200 px at 100 px/in
_PAD = 0.1  # inches around everything: titles and legends keep off what is beside them
_DPI = 100
_STYLE: dict[Any, Any] = {
    "font.family": ["DejaVu Sans"],
    "font.size": 11,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "hatch.linewidth": 0.8,
    "svg.hashsalt": "narrows",
    "path.simplify": True,
}


@dataclass(frozen=True, eq=False)
class _Content:
    """What a picture shows.

    Attributes:
        scene: The scene.
        heading: First line of the title.
        text: What was found, below it.
        motion: The motion that is swept, or None.
        certificate: Where its clearance is least, or None.
        fault: Why the motion must not be drawn as one that is clear: `not certified`; or empty.
        planned: The path a drive was to follow, or None.
        errors: Tracking errors of a drive, or None.
    """

    scene: Scene
    heading: str
    text: str
    motion: Path | Trajectory | None = None
    certificate: Certificate | None = None
    fault: str = ""
    planned: Path | None = None
    errors: TrackingErrors | None = None


def plan_picture(scene: Scene, plan: Plan) -> Figure:
    """Return the picture of a plan; without a certified path, of the scene and the reason."""
    heading = f"{scene.name or 'scene'}: {plan.status.value.replace('_', ' ')}"
    if plan.status is PlanStatus.CERTIFIED:
        heading += f" ({plan.planner} planner)"
    return _draw(_Content(scene, heading, plan.reason, plan.trajectory, plan.certificate))


def verification_picture(
    scene: Scene, motion: Path | Trajectory, verification: Verification
) -> Figure:
    """Return the picture of a judged motion, dashed and red if it is refused."""
    fault = "" if verification.is_certified else "not certified"
    heading = f"{scene.name or 'scene'}: {fault or 'certified'}"
    text = verification.reason
    return _draw(_Content(scene, heading, text, motion, verification.certificate, fault))


def drive_picture(
    scene: Scene,
    driven: Trajectory,
    certificate: Certificate,
    *,
    planned: Path | None,
    errors: TrackingErrors | None,
    text: str,
) -> Figure:
    """Return the picture of a drive.

    Args:
        scene: The scene.
        driven: The motion of the chair as it was, not as it was believed to be.
        certificate: Clearance of that motion.
        planned: The path it was to follow.
        errors: How far it was from it.
        text: What came of it, for people.
    """
    fault = "" if certificate.is_clear else "with contact"
    heading = f"{scene.name or 'scene'}: driven {fault or 'without contact'}"
    return _draw(_Content(scene, heading, text, driven, certificate, fault, planned, errors))


def save_picture(figure: Figure, file: FilePath | str) -> None:
    """Write a picture as PNG or SVG by the file's suffix, whole or not at all.

    Raises:
        InputError: If the suffix is another, or the file cannot be written.
    """
    suffix = check_picture_suffix(file)
    stream = io.BytesIO()
    with matplotlib.rc_context(_STYLE):
        if suffix == ".png":
            figure.savefig(stream, format="png", dpi=_DPI, metadata={"Software": None})
        elif suffix == ".svg":
            metadata = {"Date": None, "Creator": "narrows"}
            figure.savefig(stream, format="svg", metadata=metadata)
        else:
            raise InputError("no such kind of picture", file=str(file), value=suffix)
    write_whole(file, stream.getvalue())


def _draw(content: _Content) -> Figure:
    with matplotlib.rc_context(_STYLE):
        paths = [m for m in (_path(content.motion), content.planned) if m is not None]
        view = view_box(content.scene, paths)
        charts = 0 if content.motion is None else 3 if _timed(content) else 2
        figure, scene_axes, chart_axes = _layout(view, charts, content)
        _draw_scene(scene_axes, content, view)
        _draw_charts(chart_axes, content)
        handles, labels = scene_axes.get_legend_handles_labels()
        if handles:
            columns = min(len(handles), 5)
            figure.legend(handles, labels, loc="outside lower center", ncols=columns, fontsize=11)
        _draw_least(figure, scene_axes, content, view)
    return figure


def _path(motion: Path | Trajectory | None) -> Path | None:
    return motion.path if isinstance(motion, Trajectory) else motion


def _timed(content: _Content) -> bool:
    return isinstance(content.motion, Trajectory)


def _layout(view: ViewBox, charts: int, content: _Content) -> tuple[Figure, Axes, list[Axes]]:
    """Return a figure with the scene and its charts: beside a tall scene, below a wide one."""
    aspect = (view[3] - view[1]) / (view[2] - view[0])
    beside = charts > 0 and aspect > 0.75
    text = textwrap.fill(content.text, 80 if beside else 125)
    head = 0.7 + 0.2 * (text.count("\n") + 1)
    if beside:
        height = min(max(7.0 * aspect, 6.6), 11.0)
    else:
        height = min(max(10.8 * aspect, 3.0), 9.0) + (2.8 if charts else 0.0)
    layout = ConstrainedLayoutEngine(h_pad=_PAD, w_pad=_PAD)
    figure = Figure(figsize=(_WIDTH, height + head + 0.6), dpi=_DPI, layout=layout)
    FigureCanvasAgg(figure)
    if beside:
        grid = figure.add_gridspec(charts, 2, width_ratios=[1.65, 1.0])
        scene_axes = figure.add_subplot(grid[:, 0])
        chart_axes = [figure.add_subplot(grid[k, 1]) for k in range(charts)]
    elif charts:
        grid = figure.add_gridspec(2, charts, height_ratios=[height - 2.8, 2.3])
        scene_axes = figure.add_subplot(grid[0, :])
        chart_axes = [figure.add_subplot(grid[1, k]) for k in range(charts)]
    else:
        scene_axes, chart_axes = figure.add_subplot(), []
    figure.suptitle(content.heading, fontsize=15, fontweight="bold")
    scene_axes.set_title(text, fontsize=11.5)
    return figure, scene_axes, chart_axes


def _draw_scene(axes: Axes, content: _Content, view: ViewBox) -> None:
    scene, path = content.scene, _path(content.motion)
    draw_world(axes, scene, view)
    time = content.certificate.time if content.certificate is not None else None
    draw_moving(axes, scene.world.moving, time)
    if path is not None:
        draw_motion(axes, scene.vehicle, path, fault=content.fault)
    if content.planned is not None:
        draw_planned(axes, content.planned)
    draw_ends(axes, scene)
    axes.set_xlim(view[0], view[2])
    axes.set_ylim(view[1], view[3])
    axes.set_aspect("equal")
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")
    draw_scale(axes, view)


def _draw_least(figure: Figure, axes: Axes, content: _Content, view: ViewBox) -> None:
    """Draw the least clearance last: its label needs the layout to find a free place."""
    scene, path, certificate = content.scene, _path(content.motion), content.certificate
    if path is None or certificate is None:
        return
    figure.draw_without_rendering()
    ends = transform(np.array([scene.start, scene.goal.pose]), scene.vehicle.outline)
    crowded = [*map(shapely.Polygon, ends), *swept_area(scene.vehicle.outline, path)]
    crowded += solid_areas(scene.world, view)
    crowded += [
        shapely.MultiPoint(moving.path[:, 1:]).buffer(moving.radius)
        for moving in scene.world.moving
    ]
    labels = door_label_areas(scene, view)
    draw_least(axes, scene, path, certificate, crowded, labels)


def _draw_charts(charts: list[Axes], content: _Content) -> None:
    motion, scene = content.motion, content.scene
    if motion is None:
        return
    colour = palette.REFUSED if content.fault else palette.BLUE
    draw_curvature(charts[0], motion, scene.vehicle, colour)
    if isinstance(motion, Trajectory):
        draw_speeds(charts[1], motion, scene.vehicle, colour)
    if content.errors is not None:
        draw_tracking(charts[-1], content.errors)
    else:
        draw_clearance(charts[-1], motion, scene, colour)
