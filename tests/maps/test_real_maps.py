"""Real maps: grids and vector maps agree, and straight drives through their doors are judged right.

The maps are third-party files outside the repository, in `../shared/data/maps` or under the
folder that NARROWS_DATA names. `cases.csv` there lists drives straight through a door, poses of
the body's centre, with the width up to which the sweep is free. That width was measured on a
sweep with rounded ends: the line from the body's rear to its front, grown by half the width.
"""

from __future__ import annotations

import csv
import functools
import os
import re
import time
from pathlib import Path

import numpy as np
import pytest
import shapely

from narrows.clearance import certify
from narrows.maps import load_map
from narrows.path import Path as Motion
from narrows.twist_section import TwistSection
from narrows.vehicle import Layer, Vehicle

ROOT = Path(__file__).resolve().parents[2]
MAPS = Path(os.environ.get("NARROWS_DATA", ROOT.parent / "shared" / "data")) / "maps"
CASES = MAPS / "cases.csv"

pytestmark = pytest.mark.skipif(
    not CASES.is_file(), reason=f"the real maps are not there: {CASES}; set NARROWS_DATA"
)

GRIDS = {
    "willow_garage": "01_willow_garage/raw/map.yaml",
    "office02": "02_mrpb/raw/office02.yaml",
    "room02": "02_mrpb/raw/room02.yaml",
    "shopping_mall": "02_mrpb/raw/shopping_mall.yaml",
    "gdc3ne": "06_gdc3_doors/raw/3ne.yaml",
    "pal_hospital": "09_care_hospital/raw/hospital.yaml",
}
VECTORS = {
    "willow_garage": "01_willow_garage/willow_garage.json",
    "office02": "02_mrpb/office02.json",
    "room02": "02_mrpb/room02.json",
    "shopping_mall": "02_mrpb/shopping_mall.json",
    "duplex_level1": "03_ifc_buildings/duplex_level1.json",
    "duplex_level2": "03_ifc_buildings/duplex_level2.json",
    "barn_001_x0.80": "04_barn/barn_001_x0.80.json",
    "barn_091_x0.75": "04_barn/barn_091_x0.75.json",
    "barn_151_x1.13": "04_barn/barn_151_x1.13.json",
    "barn_253_x1.20": "04_barn/barn_253_x1.20.json",
    "gdc3ne": "06_gdc3_doors/gdc3ne.json",
    "pal_hospital": "09_care_hospital/pal_hospital.json",
}
DRAWN_FROM_GRID = ("willow_garage", "gdc3ne", "pal_hospital")
SIMULATED = ("office02", "room02", "shopping_mall")
NOT_ON_THE_GRID = ("room02", "wall 1")  # a box of 0.92 x 0.40 m; the scanner looked over it
CELL = 0.05

WIDTH_TOLERANCE = 2e-3
"""Half a millimetre each: the stated width, the headings of 1 mrad over 1.1 m, the round ends'
polygon, the certificate's own tolerance."""


@functools.cache
def world_of(file):
    return load_map(MAPS / file)


def best_world(name):
    """Return the exact map, by its grid where the vector file is drawn from that: much faster."""
    return world_of(GRIDS[name] if name in DRAWN_FROM_GRID else VECTORS[name])


def cases(name, expect):
    with CASES.open(newline="") as table:
        rows = [row for row in csv.DictReader(table) if row["map"] == name]
    assert rows, f"cases.csv has no rows of {name}"
    return [row for row in rows if row["expect"] == expect]


def straight_drive(row):
    ends = [[float(row[f"{end}_{k}"]) for k in ("x", "y", "yaw")] for end in ("start", "goal")]
    return Motion((TwistSection(np.array(ends)),))


def rectangle(row, width):
    length = float(row["chair_length"])
    return Vehicle.rectangle(length, width, length / 2)


def round_ended(row, width):
    """Return the body that cases.csv swept: the rectangle with a half disc at either end."""
    half = float(row["chair_length"]) / 2
    outline = shapely.LineString([[-half, 0.0], [half, 0.0]]).buffer(width / 2, quad_segs=24)
    return Vehicle((Layer(np.asarray(outline.exterior.coords)[:-1], (0.0, 1.3)),))


def stated_width(row):
    return float(re.search(r"up to width ([\d.]+)", row["why"])[1])


MAPS_WITH_DRIVES = [name for name in VECTORS if not name.startswith("barn")]


@pytest.mark.slow
@pytest.mark.parametrize("name", MAPS_WITH_DRIVES)
def test_every_drive_that_must_succeed_is_certified(name):
    for row in cases(name, "must_succeed"):
        certificate = certify(
            best_world(name), rectangle(row, float(row["chair_width"])), straight_drive(row)
        )
        assert certificate.is_clear, (row, certificate.reason)


@pytest.mark.slow
@pytest.mark.parametrize("name", MAPS_WITH_DRIVES)
def test_the_sweep_that_was_measured_is_certified_up_to_its_width_and_no_further(name):
    for row in cases(name, "must_succeed"):
        world, drive, width = best_world(name), straight_drive(row), stated_width(row)
        below = round_ended(row, width - WIDTH_TOLERANCE)
        above = round_ended(row, width + WIDTH_TOLERANCE)
        assert certify(world, below, drive, tolerance=2e-4).is_clear, row
        assert not certify(world, above, drive, tolerance=2e-4).is_clear, row


def widest_sweep(solids, row):
    """Return the width to which a rectangle's straight sweep is free, by Shapely [m]."""
    start, goal = straight_drive(row).start[:2], straight_drive(row).goal[:2]
    along = (goal - start) / np.linalg.norm(goal - start) * float(row["chair_length"]) / 2
    line = shapely.LineString([start - along, goal + along])
    low, high = 0.3, 3.0
    while high - low > 1e-4:
        middle = 0.5 * (low + high)
        free = not solids.intersects(line.buffer(middle / 2, cap_style="flat"))
        low, high = (middle, high) if free else (low, middle)
    return low


@pytest.mark.slow
@pytest.mark.parametrize("name", MAPS_WITH_DRIVES)
def test_a_chair_is_refused_as_soon_as_it_is_wider_than_its_exact_sweep(name):
    world = best_world(name)
    solids = shapely.union_all([solid.shape for solid in world.solids])
    shapely.prepare(solids)
    for row in cases(name, "must_succeed"):
        width, drive = widest_sweep(solids, row), straight_drive(row)
        assert width > stated_width(row) - WIDTH_TOLERANCE, row
        below = rectangle(row, width - WIDTH_TOLERANCE)
        above = rectangle(row, width + WIDTH_TOLERANCE)
        assert certify(world, below, drive, tolerance=2e-4).is_clear, row
        assert not certify(world, above, drive, tolerance=2e-4).is_clear, row


@pytest.mark.slow
@pytest.mark.parametrize("name", [*MAPS_WITH_DRIVES, *(n for n in VECTORS if "barn" in n)])
def test_no_drive_that_must_fail_is_certified(name):
    for row in cases(name, "must_fail"):
        chair = rectangle(row, float(row["chair_width"]))
        assert not certify(best_world(name), chair, straight_drive(row)).is_clear, row


def test_an_office_of_56_by_49_m_at_5_cm_is_ready_soon():
    start = time.process_time()
    pieces = load_map(MAPS / GRIDS["willow_garage"]).pieces_between(0.0, 1.3)
    assert time.process_time() - start < 60.0  # 0.15 here; `make bench` measures it
    assert len(pieces) < 7000  # what keeps the certificate quick; 6788 when written


@pytest.mark.slow
@pytest.mark.parametrize(
    "file", [*GRIDS.values(), *(VECTORS[name] for name in VECTORS if name not in DRAWN_FROM_GRID)]
)
def test_pieces_of_a_real_map_tile_its_solids(file):
    pieces = world_of(file).pieces_between(0.0, 1.3)
    area = np.zeros(len(world_of(file).solids))
    np.add.at(area, pieces.owner, shapely.area(shapely.polygons(pieces.corners)))
    expected = shapely.area([solid.shape for solid in world_of(file).solids])
    np.testing.assert_allclose(area, expected, rtol=1e-9, atol=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "kind"), [*((name, "wall") for name in DRAWN_FROM_GRID), ("willow_garage", "unknown")]
)
def test_a_vector_map_drawn_from_a_grid_is_what_the_grid_gives(name, kind):
    vector, grid = world_of(VECTORS[name]), world_of(GRIDS[name])
    drawn = shapely.union_all([s.shape for s in vector.solids if s.name.startswith(kind)])
    cells = shapely.union_all([s.shape for s in grid.solids if s.name == kind])
    cells = cells.intersection(shapely.box(*vector.bounds))  # the vector files crop the margin
    difference = shapely.symmetric_difference(drawn, cells, grid_size=1e-4)
    assert drawn.area > 80.0
    assert difference.area < CELL**2


@pytest.mark.slow
@pytest.mark.parametrize("name", SIMULATED)
def test_a_simulators_grid_and_its_exact_walls_agree_within_a_cell(name):
    """Each wall cell meets an exact wall, and no free place is deeper than a cell in one."""
    seen = [
        solid.shape
        for solid in world_of(VECTORS[name]).solids
        if (name, solid.name) != NOT_ON_THE_GRID
    ]
    exact = shapely.union_all(seen)
    shapely.prepare(exact)
    grid = world_of(GRIDS[name])
    cells = shapely.box(*cell_corners([s for s in grid.solids if s.name == "wall"]))
    assert shapely.distance(shapely.centroid(cells), exact).max() < CELL * np.sqrt(0.5)
    solid = shapely.union_all([s.shape for s in grid.solids])
    free = shapely.box(*grid.bounds).difference(solid)
    assert free.area > 100.0
    assert free.intersection(exact.buffer(-CELL)).area == 0.0


def cell_corners(solids):
    """Return x_low, y_low, x_high, y_high of the cells of a grid map's solids, each (N,)."""
    found = []
    for solid in solids:
        for piece in solid.pieces:
            low, high = piece.min(axis=0), piece.max(axis=0)
            columns, rows = np.rint((high - low) / CELL).astype(int)
            steps = np.indices((columns, rows)).reshape(2, -1).T * CELL + low
            found.append(np.hstack([steps, steps + CELL]))
    return np.concatenate(found).T


@pytest.mark.slow
@pytest.mark.parametrize("name", SIMULATED)
def test_a_drives_clearance_by_grid_and_by_exact_walls_agrees_within_a_cells_diagonal(name):
    for row in cases(name, "must_succeed"):
        chair, drive = rectangle(row, float(row["chair_width"])), straight_drive(row)
        by_grid = certify(world_of(GRIDS[name]), chair, drive).clearance
        by_walls = certify(world_of(VECTORS[name]), chair, drive).clearance
        assert by_walls - CELL * np.sqrt(2.0) < by_grid < by_walls + 2e-3, row
