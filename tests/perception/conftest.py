"""Where the real frames are, and a camera with something before it."""

import json
import os
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from narrows.perception.camera import Intrinsics

ROOT = Path(__file__).resolve().parents[2]
KINECT = Path(os.environ.get("NARROWS_DATA", ROOT.parent / "shared" / "data")) / "kinect"


@pytest.fixture(params=["rgrgb", "clorox", "capture4", "five_people", "grabber"])
def real(request):
    """Name, depth, intrinsics and reference of a real frame."""
    if not (KINECT / "intrinsics.json").is_file():
        pytest.skip(f"the real frames are not there: {KINECT}; set NARROWS_DATA")
    four = json.loads((KINECT / "intrinsics.json").read_text())[request.param]["fx_fy_cx_cy"]
    reference = json.loads((KINECT / "pcl_reference.json").read_text())["frames"][request.param]
    with Image.open(KINECT / f"{request.param}.png") as image:
        depth = np.asarray(image).astype(np.uint16)
    return request.param, depth, Intrinsics(*four), reference
