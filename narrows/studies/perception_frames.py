"""Depth frames for the study of perception: simulated boxes, or a folder of real ones."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import StudyError
from ..perception.camera import DepthCamera, Intrinsics, Mounting
from ..se2 import Array

Box = tuple[float, float, float, float, float, float]
"""x, y, z of the lower and of the upper corner, body frame [m]."""

_FLOOR: Box = (-1.0, -3.0, -0.1, 6.0, 3.0, 0.0)
_WALL: Box = (5.0, -3.0, 0.0, 5.1, 3.0, 2.5)
SIMULATED: dict[str, tuple[tuple[float, float], tuple[Box, ...]]] = {
    "cartons": (
        (0.80, 30.0),
        (_FLOOR, _WALL, (1.2, -0.4, 0.0, 1.5, -0.1, 0.35), (1.6, 0.2, 0.0, 1.9, 0.6, 0.12)),
    ),
    "table top": (
        (1.10, 26.0),
        (_FLOOR, _WALL, (0.55, -1.2, 0.70, 1.7, 1.2, 0.73), (0.6, -0.6, 0.0, 0.65, -0.55, 0.7)),
    ),
    "wall": ((0.80, 10.0), (_FLOOR, (1.1, -3.0, 0.0, 1.2, 1.2, 2.5))),
    "somebody's back": (
        (1.20, 10.0),
        (_FLOOR, _WALL, (1.0, -0.35, 0.0, 1.25, 0.35, 1.75)),
    ),
    "stairs down": (
        (0.80, 25.0),
        ((-1.0, -3.0, -0.1, 1.8, 3.0, 0.0), (1.8, -3.0, -0.6, 6.0, 3.0, -0.5)),
    ),
}
"""Height [m] and tilt [deg] of the camera, and boxes, by name."""

REAL_MOUNTINGS = {
    "rgrgb": (0.80, 30.0),
    "clorox": (0.47, 35.0),
    "capture4": (0.83, 5.0),
    "five_people": (1.29, 5.0),
    "grabber": (0.72, 45.0),
}
"""Height [m] and tilt [to 5 deg] of the camera in frames of the Point Cloud Library."""


@dataclass(frozen=True, eq=False)
class Frame:
    """A depth frame with its camera and what a reference makes of it.

    Attributes:
        name: Its name.
        depth: Millimetres, 0 where there is no return, shape (height, width).
        camera: The camera that took it.
        reference: Counts, plane and times of the reference library; empty if it was not run.
    """

    name: str
    depth: NDArray[np.uint16]
    camera: DepthCamera
    reference: dict[str, Any] = field(default_factory=dict)


def kinect(mounting: Mounting) -> DepthCamera:
    """Return a Kinect as it is mounted: 57 x 43 deg, 640 x 480 [FuzzyDVZ, 3.2]."""
    view = Intrinsics.from_field_of_view(math.radians(57.0), math.radians(43.0))
    return DepthCamera(view, mounting)


def depth_of_boxes(boxes: tuple[Box, ...], camera: DepthCamera) -> NDArray[np.uint16]:
    """Return what a camera sees of boxes, quantised in inverse depth, in millimetres.

    Args:
        boxes: In the body frame; a floor is a flat one.
        camera: The camera; nearer than 0.5 m and beyond 10 m nothing comes back.
    """
    lens, mounting = camera.intrinsics, camera.mounting
    u, v = np.meshgrid(np.arange(lens.width), np.arange(lens.height))
    x, y = (u - lens.cx) / lens.fx, (v - lens.cy) / lens.fy
    rays = np.stack([x, y, np.ones_like(x)], axis=-1) @ mounting.camera_to_body.T
    depth = np.full(u.shape, np.inf)
    for box in boxes:
        corners = np.array(box).reshape(2, 3)
        with np.errstate(divide="ignore", invalid="ignore"):
            crossed = (corners[:, None, None] - mounting.position) / rays
        enter = crossed.min(axis=0).max(axis=-1)
        leave = crossed.max(axis=0).min(axis=-1)
        hit = (enter <= leave) & (enter > 0.0) & (enter < depth)
        depth[hit] = enter[hit]
    return _as_returned(depth, camera.step)


def _as_returned(depth: Array, step: float) -> NDArray[np.uint16]:
    with np.errstate(divide="ignore"):
        stepped = 1.0 / (np.rint(1.0 / depth / step) * step)
    seen = np.isfinite(stepped) & (stepped >= 0.5) & (stepped <= 10.0)
    return np.where(seen, np.rint(1e3 * np.where(seen, stepped, 0.0)), 0.0).astype(np.uint16)


def frame_names(folder: Path | None) -> tuple[str, ...]:
    """Return the names of the frames: of a folder, or the simulated ones.

    Raises:
        StudyError: If the folder holds no `intrinsics.json` that can be read.
    """
    return tuple(SIMULATED) if folder is None else tuple(_json(folder / "intrinsics.json"))


def load_frame(name: str, folder: Path | None) -> Frame:
    """Return a frame by its name: `NAME.png` of a folder, or a simulated one.

    Raises:
        StudyError: If there is no such frame, or it cannot be read.
    """
    if folder is None:
        (height, tilt), boxes = SIMULATED[name]
        camera = kinect(Mounting(height, math.radians(tilt)))
        return Frame(name, depth_of_boxes(boxes, camera), camera)
    if name not in REAL_MOUNTINGS:
        allowed = ", ".join(REAL_MOUNTINGS)
        raise StudyError("no mounting known of this frame", value=name, allowed=allowed)
    height, tilt = REAL_MOUNTINGS[name]
    depth = _image(folder / f"{name}.png")
    fx, fy, cx, cy = _json(folder / "intrinsics.json")[name]["fx_fy_cx_cy"]
    lens = Intrinsics(fx, fy, cx, cy, width=depth.shape[1], height=depth.shape[0])
    file = folder / "pcl_reference.json"
    reference = _json(file)["frames"].get(name, {}) if file.is_file() else {}
    camera = DepthCamera(lens, Mounting(height, math.radians(tilt)))
    return Frame(name, depth, camera, reference)


def _image(file: Path) -> NDArray[np.uint16]:
    from PIL import Image

    try:
        with Image.open(file) as image:
            values = np.asarray(image)
    except OSError as error:
        raise StudyError(f"the frame cannot be read: {error}", file=str(file)) from error
    if values.ndim != 2 or values.dtype.kind not in "ui":
        raise StudyError("not a depth image", file=str(file), allowed="16-bit grey PNG")
    return values.astype(np.uint16)


def _json(file: Path) -> dict[str, Any]:
    try:
        content: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise StudyError(f"cannot be read: {error}", file=str(file)) from error
    return content
