"""What the tests of the studies share."""

import importlib
import json
from pathlib import Path

import pytest
from PIL import Image

from narrows.studies.perception_frames import load_frame


@pytest.fixture
def functions(monkeypatch):
    """Case functions in a module that worker processes find on the path they inherit."""
    monkeypatch.syspath_prepend(str(Path(__file__).parent))
    return importlib.import_module("sweep_cases")


@pytest.fixture
def frames_folder(tmp_path):
    """A folder of frames as people have them: one that stands for a real one, and its lens."""
    folder = tmp_path / "frames"
    folder.mkdir()
    frame = load_frame("cartons", None)
    Image.fromarray(frame.depth).save(folder / "rgrgb.png")
    lens = frame.camera.intrinsics
    four = {"fx_fy_cx_cy": [lens.fx, lens.fy, lens.cx, lens.cy]}
    (folder / "intrinsics.json").write_text(json.dumps({"rgrgb": four}))
    return folder
