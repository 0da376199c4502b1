"""Split a cloud where it is apart: Euclidean clusters [FuzzyDVZ, 3.2.5].

Two points are of one cluster if steps from point to point, none longer than the tolerance, lead
from one to the other. Points are sorted into cells whose diagonal is the tolerance: all points of
a cell are of one cluster, and only cells two apart or less need to be compared.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .cluster_kernels import component_of_each
from .depth_image import Points
from .point_rows import rows_and_reach


def find_clusters(
    points: Points, *, tolerance: float = 0.03, least: int = 50
) -> tuple[NDArray[np.int64], ...]:
    """Return the clusters with enough points, the largest first.

    Args:
        points: Shape (N, 3), [m].
        tolerance: Longest step between points of one cluster [m].
        least: Fewest points of a cluster.

    Returns:
        Rows of the points of each cluster, ascending; equal sizes in the order of their first rows.

    Raises:
        ShapeError: If the points are not (N, 3) or not finite.
        InputError: If the tolerance is not positive, or the cloud a million of it wide.
    """
    rows, reach = rows_and_reach(points)
    if not 0.0 < tolerance < np.inf:
        raise InputError("not a distance", field="tolerance", value=tolerance, allowed="> 0 m")
    if not len(rows):
        return ()
    if reach / tolerance > 5e5:
        raise InputError("too wide a cloud for it", field="tolerance", value=tolerance)
    component = component_of_each(rows, tolerance)
    sizes = np.bincount(component)
    kept = np.nonzero(sizes >= max(least, 1))[0]
    kept = kept[np.argsort(-sizes[kept], kind="stable")]
    order = np.argsort(component, kind="stable")
    starts = np.concatenate([[0], np.cumsum(sizes)])
    return tuple(order[starts[one] : starts[one + 1]] for one in kept)
