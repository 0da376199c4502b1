"""The paper's chain from a depth image to obstacles, stage by stage [FuzzyDVZ, 3.2].

Drop what is no return, thin to one point a voxel, keep what is near, take the largest plane away,
split the rest where it is apart. Each stage means what it means in the Point Cloud Library.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .camera import Intrinsics
from .clusters import find_clusters
from .compiled import compiled
from .depth_image import Points, points_from_depth
from .plane import PlaneFit, find_plane
from .point_rows import point_rows
from .voxel_grid import voxel_grid


@dataclass(frozen=True)
class ChainOptions:
    """Settings of the chain; the paper prints the first two.

    Attributes:
        leaf: Edge of a voxel [m].
        reach: Depth up to which points are kept [m].
        plane_tolerance: Distance up to which a point is on a plane [m].
        plane_iterations: Most samples in the search for it.
        plane_probability: That the samples drawn hold one without an outlier, in (0, 1).
        cluster_tolerance: Longest step between points of one cluster [m].
        cluster_least: Fewest voxels of a cluster.
        seed: Of the samples.
    """

    leaf: float = 0.01
    reach: float = 2.0
    plane_tolerance: float = 0.02
    plane_iterations: int = 1000
    plane_probability: float = 0.99
    cluster_tolerance: float = 0.03
    cluster_least: int = 50
    seed: int = 0


@dataclass(frozen=True, eq=False)
class CloudStages:
    """What the stages leave, in the camera frame.

    Attributes:
        valid: The returns, shape (N, 3), [m].
        voxels: A centroid a voxel, shape (M, 3).
        near: Those within reach, shape (K, 3).
        plane: The plane found among them, or None if there are fewer than three or only a line.
        rest: Those not on the plane, shape (L, 3).
        clusters: Rows of `rest` of each cluster, the largest first.
    """

    valid: Points
    voxels: Points
    near: Points
    plane: PlaneFit | None
    rest: Points
    clusters: tuple[NDArray[np.int64], ...]

    @property
    def counts(self) -> dict[str, int]:
        """Number of points after each stage, and of clusters."""
        return {
            "valid": len(self.valid),
            "voxel": len(self.voxels),
            "pass": len(self.near),
            "plane": len(self.near) - len(self.rest),
            "rest": len(self.rest),
            "clusters": len(self.clusters),
        }


def pass_through(points: Points, low: float, high: float, *, axis: int = 2) -> Points:
    """Return the points with a coordinate in [low, high].

    Args:
        points: Shape (N, 3), [m].
        low: Least value [m].
        high: Greatest value [m].
        axis: Which coordinate; 2 is the depth.

    Raises:
        ShapeError: If the points are not (N, 3) or not finite.
        InputError: If there is no such axis, or nothing between low and high.
    """
    rows = point_rows(points)
    if axis not in (0, 1, 2):
        raise InputError("no such axis", field="axis", value=axis, allowed="0, 1, 2")
    if not low <= high:
        raise InputError("nothing lies between", value=f"{low} and {high} m", allowed="low <= high")
    return _rows_within(rows, axis, np.float32(low), np.float32(high))


@compiled
def _rows_within(rows: Points, axis: int, low: np.float32, high: np.float32) -> Points:
    kept = np.empty_like(rows)
    count = 0
    for row in range(len(rows)):
        for place in range(3):
            kept[count, place] = rows[row, place]
        count += int(low <= rows[row, axis] <= high)
    return kept[:count]


def run_chain(
    depth: Any, intrinsics: Intrinsics, options: ChainOptions | None = None
) -> CloudStages:
    """Run the chain on a depth image; without a single return every stage is empty.

    Args:
        depth: As `narrows.perception.depth_image.depth_frame` takes it.
        intrinsics: The camera.
        options: Settings.

    Raises:
        ShapeError: If the image is not of the camera's size.
        InputError: If its values are of another type, or an option is outside its range.
    """
    chosen = options or ChainOptions()
    valid = points_from_depth(depth, intrinsics)
    voxels = voxel_grid(valid, chosen.leaf)
    near = pass_through(voxels, 0.0, chosen.reach)
    fit = find_plane(
        near,
        tolerance=chosen.plane_tolerance,
        most_iterations=chosen.plane_iterations,
        probability=chosen.plane_probability,
        seed=chosen.seed,
    )
    rest = near if fit is None else near[np.flatnonzero(~fit.is_on_plane)]
    clusters = find_clusters(rest, tolerance=chosen.cluster_tolerance, least=chosen.cluster_least)
    return CloudStages(valid, voxels, near, fit, rest, clusters)
