"""A motion as one HTML file that plays in any browser, without network and without narrows."""

from __future__ import annotations

import html
from dataclasses import dataclass

import numpy as np
import rich
from viser import ViserServer

from narrows.clearance import Certificate
from narrows.path import Path
from narrows.scene import Scene

from .page_drawing import SceneDrawing, camera, nearest_place, spread, thinned
from .page_motion import Motion
from .page_report import Report
from .page_words import Words

RATE = 20.0
"""Frames a second."""

_BANNER = """<div id="narrows-banner" style="position:fixed;right:12px;top:12px;
width:min(320px,45vw);z-index:100;font-family:Inter,system-ui,sans-serif;pointer-events:none;background:#fff;
border-radius:4px;padding:8px 4px 2px;box-shadow:0 1px 4px #0004">
<div style="font-size:13px;font-weight:600;padding:0 12px 6px">{title}</div>{words}</div>"""


@dataclass(frozen=True, eq=False)
class Show:
    """What a replay shows.

    Attributes:
        scene: The scene.
        motion: What is played.
        words: What is said of it.
        path: The certified path, drawn on the floor, or None.
        certificate: Its certificate, or None.
    """

    scene: Scene
    motion: Motion
    words: Words
    path: Path | None
    certificate: Certificate | None


def replay_html(report: Report, show: Show) -> str:
    """Return the HTML of a replay; starts a server of its own on loopback to record it."""
    rich.reconfigure(quiet=True)
    server = ViserServer(host="127.0.0.1", port=0, verbose=False)
    scene, motion = show.scene, show.motion
    place = camera(scene)
    server.initial_camera.position = place.position
    server.initial_camera.look_at = place.look_at
    server.initial_camera.fov = place.fov
    drawing = SceneDrawing(server.scene)
    drawing.stage()
    drawing.world(scene)
    drawing.things(scene)
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
    recording = server.get_scene_serializer()
    for time in np.linspace(0.0, motion.duration, max(2, round(RATE * motion.duration))):
        drawing.place(motion.pose(float(time)))
        drawing.at_time(scene, float(time))
        recording.insert_sleep(1.0 / RATE)
        report(float(time) / max(motion.duration, 1e-9))
    page = recording.as_html()
    server.stop()
    title = html.escape(f"{scene.name or 'scene'}: {motion.name}, {motion.duration:.1f} s")
    banner = _BANNER.format(title=title, words=show.words.html())
    end = page.rindex("</body>")
    return f"{page[:end]}{banner}{page[end:]}"
