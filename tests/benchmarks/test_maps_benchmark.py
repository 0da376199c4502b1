"""How long maps take to be read and cut into convex pieces."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from narrows.maps import load_map
from narrows.maps.cells import regions

ROOT = Path(__file__).resolve().parents[2]
MAPS = Path(os.environ.get("NARROWS_DATA", ROOT.parent / "shared" / "data")) / "maps"
FLAT = ROOT / "examples" / "maps" / "flat.yaml"


def ready(file):
    return load_map(file).pieces_between(0.0, 1.3)


def test_reading_a_flat_of_9_by_6_m_at_2_5_cm(benchmark):
    assert len(benchmark(ready, FLAT)) < 40


@pytest.mark.parametrize(
    "file",
    [
        "01_willow_garage/raw/map.yaml",
        "02_mrpb/raw/office02.yaml",
        "06_gdc3_doors/raw/3ne.yaml",
        "09_care_hospital/raw/hospital.yaml",
        "03_ifc_buildings/duplex_level1.json",
    ],
)
def test_reading_a_real_map(benchmark, file):
    if not (MAPS / file).is_file():
        pytest.skip(f"the real maps are not there: {MAPS / file}; set NARROWS_DATA")
    pieces = benchmark.pedantic(ready, (MAPS / file,), rounds=3, warmup_rounds=1)
    assert len(pieces) > 200


def test_outlines_and_tiles_of_a_million_cells(benchmark):
    rng = np.random.default_rng(7)
    cells = np.kron(rng.random((50, 50)) < 0.4, np.ones((20, 20))).astype(bool)
    assert benchmark(regions, cells).outlines.size > 100
