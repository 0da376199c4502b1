"""What the compiled loops of the manoeuvre search read and write: arrays with names."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..se2 import Array


class Rules(NamedTuple):
    """What a search may do and what it costs.

    Attributes:
        drives: The moves from a pose: v in {-1, 0, 1}, heading rate per length, length,
            shape (M, 3).
        radius: Radius of the arcs that connect [m]; 0 where the chair may turn on the spot.
        cell: Size of the cells of position [m].
        sectors: Number of cells of heading on a full turn.
        floor: Gap below which a move is refused [m].
        care: Gap from which on more is no better [m].
        crowding: Cost of driving a metre at no gap, falling linearly to 0 at `care` [m].
        spot: Cost of turning on the spot by a radian [m].
        change: Cost of a change of direction [m].
        weight: Factor on the estimate of what is left; 1 keeps the search admissible.
        budget: Most expansions.
        attempts: Connections are tried every `attempts` metres of estimate, at least.
    """

    drives: Array
    radius: float
    cell: float
    sectors: int
    floor: float
    care: float
    crowding: float
    spot: float
    change: float
    weight: float
    budget: int
    attempts: float


class Field(NamedTuple):
    """Lower bound on the way left to the target over the plane.

    Attributes:
        way: Length still to drive from each cell, shape (columns, rows), [m].
        origin: Lower corner, shape (2,), [m].
        cell: Cell size [m].
    """

    way: Array
    origin: Array
    cell: float


class Tree(NamedTuple):
    """What a search grew; rows are nodes, the first the root.

    Attributes:
        pose: Shape (N, 3).
        drive: v, heading rate and length of the move that led to each node, and the direction
            last driven in, -1, 0 (none yet) or 1; shape (N, 4).
        parent: Shape (N,), -1 for the root.
        cost: Shape (N,), [m].
    """

    pose: Array
    drive: Array
    parent: NDArray[np.int64]
    cost: Array


class Room(NamedTuple):
    """Working arrays of a search, for N nodes.

    Attributes:
        tree: The nodes.
        left: Estimate of what is left from each node, shape (N,), [m].
        is_closed: Whether a node is expanded or outdone, shape (N,).
        keys: The queue's keys, shape (N,).
        items: The queue's nodes, shape (N,).
        table: Cell and node, shape (2^m >= 2 N, 2), filled with -1.
        outline: Corners of one layer of the body, shape (V, 4).
        curve: Drives of a connection that is tried, shape (3, 3).
        last: Drives of the connection found, shape (3, 3).
    """

    tree: Tree
    left: Array
    is_closed: NDArray[np.bool_]
    keys: Array
    items: NDArray[np.int64]
    table: NDArray[np.int64]
    outline: Array
    curve: Array
    last: Array
