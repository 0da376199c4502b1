"""The picture of a verdict: a way for the body or how far it can get, and the narrowest place."""

from __future__ import annotations

import textwrap
from itertools import pairwise

import matplotlib
import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch

from narrows.planners.passage import PassageStatus, SeparationProof, Verdict
from narrows.scene import Scene
from narrows.se2 import Array, transform

from . import palette
from .least_clearance import draw_label
from .scene_drawing import (
    door_label_areas,
    draw_ends,
    draw_scale,
    draw_world,
    outline_of,
    solid_areas,
)
from .study_axes import new_figure, study_style
from .view_box import ViewBox, view_box

_APART = 0.25  # m between the bodies drawn on a way
_TURN = np.deg2rad(15.0)  # and the angle between them


def verdict_picture(scene: Scene, verdict: Verdict) -> Figure:
    """Return the picture of what `passable` found.

    Of a body that passes: a way it may take, sliding and turning freely (how to drive it is the
    planner's). Of one that does not: where the middle of it can possibly be brought from the start.

    Args:
        scene: The scene asked about.
        verdict: The answer.
    """
    view = view_box(scene, [], verdict.witness)
    aspect = (view[3] - view[1]) / (view[2] - view[0])
    with matplotlib.rc_context(study_style()):
        figure = new_figure(12.0, min(max(10.8 * aspect, 3.0), 9.0) + 1.6)
        figure.set_layout_engine("constrained", h_pad=0.1, w_pad=0.1)
        axes = figure.subplots()
        draw_world(axes, scene, view)
        crowded = _draw_found(axes, scene, verdict)
        draw_ends(axes, scene)
        axes.set(xlim=(view[0], view[2]), ylim=(view[1], view[3]), xlabel="x [m]", ylabel="y [m]")
        axes.set_aspect("equal")
        draw_scale(axes, view)
        figure.suptitle(
            f"{scene.name or 'scene'}: {verdict.status.value}", fontsize=15, fontweight="bold"
        )
        axes.set_title(textwrap.fill(verdict.reason, 125), fontsize=11.5)
        handles, labels = axes.get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=5, fontsize=11)
        _draw_narrowest(figure, axes, scene, verdict, crowded, view)
    return figure


def _draw_found(axes: Axes, scene: Scene, verdict: Verdict) -> list[shapely.Geometry]:
    """Draw the way, or the places reached; return the areas a label better leaves free."""
    if verdict.witness is not None:
        area = _draw_way(axes, scene, verdict.witness)
        return [area]
    if verdict.proof is not None:
        _draw_reached(axes, verdict.proof)
    return []


def _draw_way(axes: Axes, scene: Scene, witness: Array) -> shapely.Geometry:
    """Draw the body along poses (N, 3) between which it slides or turns a little."""
    bodies = transform(witness, scene.vehicle.outline)
    hulls = [shapely.MultiPoint(np.concatenate(pair)).convex_hull for pair in pairwise(bodies)]
    area = shapely.union_all(hulls)
    patch = PathPatch(outline_of([p for p in shapely.get_parts(area) if p.geom_type == "Polygon"]))
    patch.set(facecolor=palette.SKY, alpha=0.25, edgecolor="none", zorder=1)
    patch.set_label("a way for the body, which may slide and turn freely")
    axes.add_patch(patch)
    last = witness[0]
    for pose, body in zip(witness, bodies, strict=True):
        if np.hypot(*(pose - last)[:2]) > _APART or abs(pose[2] - last[2]) > _TURN:
            closed = np.concatenate([body, body[:1]])
            axes.plot(*closed.T, color=palette.SKY, alpha=0.7, linewidth=0.8, zorder=3)
            last = pose
    return area


def _draw_reached(axes: Axes, proof: SeparationProof) -> None:
    """Draw where the body's middle can possibly get, at any heading, in what was looked at."""
    x_min, y_min, x_max, y_max = proof.window
    places = [place for place in proof.start_side if not place.is_empty]
    area = shapely.clip_by_rect(shapely.union_all(places), x_min, y_min, x_max, y_max)
    patch = PathPatch(outline_of([p for p in shapely.get_parts(area) if p.geom_type == "Polygon"]))
    patch.set(facecolor=palette.SKY, alpha=0.45, edgecolor=palette.BLUE, linewidth=1.0, zorder=1)
    patch.set_label("where the body's middle can be brought from the start, at most")
    axes.add_patch(patch)


def _draw_narrowest(
    figure: Figure,
    axes: Axes,
    scene: Scene,
    verdict: Verdict,
    crowded: list[shapely.Geometry],
    view: ViewBox,
) -> None:
    """Mark the narrowest place and say what is to spare or missing there, if there is one."""
    if verdict.narrowest is None:
        return
    figure.draw_without_rendering()
    at, text = verdict.narrowest, _room(verdict)
    ends = transform(np.array([scene.start, scene.goal.pose]), scene.vehicle.outline)
    areas = [*crowded, *solid_areas(scene.world, view), *map(shapely.Polygon, ends)]
    draw_label(axes, at, text, areas, door_label_areas(scene, view))


def _room(verdict: Verdict) -> str:
    spare = verdict.spare_m
    if spare is None or not np.isfinite(spare) or verdict.status is PassageStatus.UNDECIDED:
        return "the narrowest place"
    if verdict.status is PassageStatus.IMPASSABLE:
        return f"{-1e3 * spare:.0f} mm missing"
    return f"{1e3 * spare:.0f} mm to spare"
