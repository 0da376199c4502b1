"""A motion as one HTML file that plays in any browser, without network and without narrows."""

from __future__ import annotations

import html
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import rich
from viser import ViserServer

from narrows.clearance import Certificate
from narrows.path import Path
from narrows.scene import Scene

from .control_colours import state_chip, state_colour
from .layer_drawing import LayerDrawing, has_layer
from .motion_shapes import nearest_place, spread, thinned
from .page_camera import camera
from .page_drawing import SceneDrawing
from .page_motion import Motion
from .page_report import Report
from .page_words import Words

RATE = 20.0
"""Frames a second."""

_BANNER = """<details open id="narrows-banner" style="position:fixed;right:12px;top:12px;
width:min(320px,45vw);z-index:100;font-family:Inter,system-ui,sans-serif;background:#fff;
border-radius:4px;padding:8px 4px 2px;box-shadow:0 1px 4px #0004">
<summary style="font-size:13px;font-weight:600;padding:0 12px 6px;cursor:pointer">{title}</summary>
{words}<div style="font-size:12px;line-height:1.6;padding:0 12px 4px">{legend}</div></details>"""


@dataclass(frozen=True, eq=False)
class Show:
    """What a replay shows.

    Attributes:
        scene: The scene.
        motion: What is played.
        words: What is said of it.
        path: The certified path, drawn on the floor, or None.
        certificate: Its certificate, or None.
        layers: Names of the layers that show what the chair knew.
    """

    scene: Scene
    motion: Motion
    words: Words
    path: Path | None
    certificate: Certificate | None
    layers: tuple[str, ...] = ()


def replay_html(report: Report, show: Show) -> str:
    """Return the HTML of a replay; starts a server of its own on loopback to record it."""
    rich.reconfigure(quiet=True)
    server = ViserServer(host="127.0.0.1", port=0, verbose=False)
    place = camera(show.scene)
    server.initial_camera.position = place.position
    server.initial_camera.look_at = place.look_at
    server.initial_camera.fov = place.fov
    drawing = SceneDrawing(server.scene)
    _draw_still(drawing, show)
    recording = server.get_scene_serializer()
    for share in _frames(drawing, LayerDrawing(server.scene), show):
        recording.insert_sleep(1.0 / RATE)
        report(share)
    page = recording.as_html()
    server.stop()
    title = html.escape(
        f"{show.scene.name or 'scene'}: {show.motion.name}, {show.motion.duration:.1f} s"
    )
    banner = _BANNER.format(title=title, words=show.words.html(), legend=_legend(show))
    end = page.rindex("</body>")
    return f"{page[:end]}{banner}{page[end:]}"


def _draw_still(drawing: SceneDrawing, show: Show) -> None:
    """Draw what stands still in a replay, and the chair where it begins."""
    scene, motion = show.scene, show.motion
    drawing.stage()
    drawing.world(scene)
    drawing.things(scene)
    drawing.people(scene)
    for name, pose in (("start", scene.start), ("goal", scene.goal.pose)):
        drawing.end(name, scene.vehicle, pose)
    if show.path is not None and show.certificate is not None:
        drawing.motion("plan", scene.vehicle, spread(show.path))
        at, text = nearest_place(scene, show.path, show.certificate)
        drawing.mark(at, text, bad=False)
    if motion.name == "drive":
        drawing.motion("drive", scene.vehicle, thinned(motion.poses), fault=motion.fault)
    drawing.chair(scene.vehicle)
    drawing.place(motion.poses[0])


def _frames(drawing: SceneDrawing, layers: LayerDrawing, show: Show) -> Iterator[float]:
    """Draw what moves, frame by frame, and yield the share of the time after each."""
    motion, known = show.motion, None
    for time in np.linspace(0.0, motion.duration, max(2, round(RATE * motion.duration))).tolist():
        drawing.place(motion.pose(time))
        drawing.at_time(show.scene, time)
        drawing.tint(state_colour(motion.state(time)))
        if motion.moment(time) is not known:
            known = motion.moment(time)
            layers.show(known, show.layers)
        yield time / max(motion.duration, 1e-9)


def _legend(show: Show) -> str:
    """Return what colours and layers mean, as HTML; empty if there are none."""
    rows = []
    if show.motion.states:
        states = " ".join(map(state_chip, dict.fromkeys(show.motion.states)))
        rows.append(f"in control: {states}")
    moments = show.motion.moments
    known = [name for name in show.layers if any(has_layer(m, name) for m in moments)]
    if known:
        rows.append(f"shown: {', '.join(known)}")
    return "<br>".join(rows)
