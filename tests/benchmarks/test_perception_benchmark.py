"""How long a depth frame takes: the chain, its stages, and the fast route."""

import pytest

from narrows.perception.cloud import run_chain
from narrows.perception.clusters import find_clusters
from narrows.perception.obstacles import ObstacleFinder
from narrows.perception.plane import find_plane
from narrows.perception.voxel_grid import voxel_grid
from narrows.studies.perception_frames import SIMULATED, load_frame


@pytest.fixture(params=sorted(SIMULATED))
def frame(request):
    return load_frame(request.param, None)


def test_the_chain(benchmark, frame):
    stages = benchmark(run_chain, frame.depth, frame.camera.intrinsics)
    assert stages.plane is not None


def test_the_fast_route(benchmark, frame):
    seen = benchmark(ObstacleFinder(frame.camera).see, frame.depth)
    assert seen.obstacles or seen.drop_offs


@pytest.mark.parametrize("stage", ["voxel", "plane", "clusters"])
def test_a_stage(benchmark, stage):
    frame = load_frame("cartons", None)
    stages = run_chain(frame.depth, frame.camera.intrinsics)
    call, points = {
        "voxel": (voxel_grid, stages.valid),
        "plane": (find_plane, stages.near),
        "clusters": (find_clusters, stages.rest),
    }[stage]
    assert benchmark(call, points) is not None
