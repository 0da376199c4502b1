"""The memory of the obstacle map, and the rules by which hits and rays change a cell.

The map is a ring: world cell (i, j) lives at (i mod n, j mod n), so that a move of the chair costs
only the lines that leave. `origin` is the world cell in the window's lower corner. Heights are
bands; a cell keeps a certainty for each, side by side, and a bit for each in `occupied`, `free` and
`settled` repeats what it says, so that a glance at a column of cells is one comparison.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..se2 import Array
from .compiled import compiled

_LAST_MARK = 254


class Cells(NamedTuple):
    """The map's memory, n by n cells and K bands of height.

    Attributes:
        certainty: Of each cell and band, shape (n, n, K): `hit` and more is occupied, less than 0
            is free, anything between is not known.
        touched: Mark of the update that touched each last, shape (n, n, K): `mark` if a ray of it
            passed, mark + 1 if it was hit.
        mark: Mark of the update at work, even, shape (1,).
        occupied: Bit k: band k is occupied, shape (n, n).
        free: Bit k: band k is free, shape (n, n).
        settled: Bit k: band k is as free as can be, another ray changes nothing, shape (n, n).
        edges: Heights between the bands, shape (K + 1,), [m].
        cell: Edge of a cell [m].
        hit: What a hit adds.
        miss: What a ray that passes takes away.
        most: The greatest certainty.
    """

    certainty: NDArray[np.int8]
    touched: NDArray[np.uint8]
    mark: NDArray[np.uint8]
    occupied: NDArray[np.uint32]
    free: NDArray[np.uint32]
    settled: NDArray[np.uint32]
    edges: Array
    cell: float
    hit: int
    miss: int
    most: int


Origin = NDArray[np.int64]


def unknown_cells(count: int, edges: Array, cell: float, hit: int, miss: int, most: int) -> Cells:
    """Return the memory of a map of `count` by `count` cells of which nothing is known."""
    shape = (count, count, len(edges) - 1)
    words = np.zeros((3, count, count), dtype=np.uint32)
    return Cells(
        np.zeros(shape, dtype=np.int8),
        np.zeros(shape, dtype=np.uint8),
        np.zeros(1, dtype=np.uint8),
        words[0],
        words[1],
        words[2],
        edges,
        cell,
        hit,
        miss,
        most,
    )


def begin_update(cells: Cells) -> None:
    """Let every cell be touched anew."""
    if cells.mark[0] >= _LAST_MARK:
        cells.touched[:] = 0
        cells.mark[0] = 0
    cells.mark[0] += 2


def forget_lines(cells: Cells, first: int, count: int, axis: int) -> None:
    """Make lines of the ring unknown: rows for axis 0, columns for axis 1."""
    lines = (first + np.arange(count)) % len(cells.free)
    chosen = (lines,) if axis == 0 else (slice(None), lines)
    for memory in (cells.certainty, cells.occupied, cells.free, cells.settled):
        memory[chosen] = 0


@compiled
def judge(cells: Cells, i: int, j: int, band: int, value: int) -> None:
    """Give a cell of the ring a certainty, and its bits what follows from it."""
    cells.certainty[i, j, band] = value
    bit = np.uint32(1) << np.uint32(band)
    cells.occupied[i, j] = _with(cells.occupied[i, j], bit, value >= cells.hit)
    cells.free[i, j] = _with(cells.free[i, j], bit, value < 0)
    cells.settled[i, j] = _with(cells.settled[i, j], bit, value <= -cells.hit)


@compiled
def _with(word: np.uint32, bit: np.uint32, is_set: bool) -> np.uint32:
    return word | bit if is_set else word & ~bit


@compiled
def mark_hit(cells: Cells, i: int, j: int, band: int) -> None:
    """Make a cell surer to be occupied, once an update; what seemed free is forgotten at once."""
    hit = int(cells.mark[0]) + 1
    if cells.touched[i, j, band] == hit:
        return
    cells.touched[i, j, band] = hit
    value = int(cells.certainty[i, j, band])
    cells.certainty[i, j, band] = min((value if value > 0 else 0) + cells.hit, cells.most)
    if value < cells.hit:
        bit = np.uint32(1) << np.uint32(band)
        cells.occupied[i, j] |= bit
        cells.free[i, j] &= ~bit
        cells.settled[i, j] &= ~bit


@compiled
def mark_passed(cells: Cells, i: int, j: int, band: int) -> None:
    """Make a cell surer to be free, once an update, unless it was hit in the same."""
    if cells.settled[i, j] & (np.uint32(1) << np.uint32(band)):
        return
    mark, last = int(cells.mark[0]), int(cells.touched[i, j, band])
    if last != mark and last != mark + 1:
        cells.touched[i, j, band] = mark
        value = int(cells.certainty[i, j, band])
        judge(cells, i, j, band, max(value - cells.miss, -cells.hit))


@compiled
def mark_passed_bands(cells: Cells, i: int, j: int, bands: np.uint32) -> None:
    """Make a cell surer to be free in several bands, unless it was hit in the same update.

    Each cell once an update: unlike `mark_passed` this does not remember that it did.
    """
    hit, touched = int(cells.mark[0]) + 1, cells.touched
    certainty, miss, least = cells.certainty, cells.miss, -cells.hit
    occupied, free, settled = cells.occupied[i, j], cells.free[i, j], cells.settled[i, j]
    left, band = np.uint64(bands & ~settled), -1
    while left:
        band += 1
        is_passed = left & np.uint64(1)
        left >>= np.uint64(1)
        bit = np.uint32(1) << np.uint32(band)
        # A cell hit in this update is occupied: only then is its mark looked at.
        if not is_passed or (occupied & bit and touched[i, j, band] == hit):
            continue
        value = max(int(certainty[i, j, band]) - miss, least)
        certainty[i, j, band] = value
        if value < cells.hit:
            occupied &= ~bit
        if value < 0:
            free |= bit
        if value == least:
            settled |= bit
    cells.occupied[i, j], cells.free[i, j], cells.settled[i, j] = occupied, free, settled


@compiled
def band_of(z: float, edges: Array, guess: int = 0) -> int:
    """Return the band that holds a height, or -1; quickest if it is the one guessed."""
    if not (edges[0] <= z < edges[-1]):
        return -1
    band = max(guess, 0)
    while z < edges[band]:
        band -= 1
    while z >= edges[band + 1]:
        band += 1
    return band


@compiled
def ring_line(offset: int, start: int, size: int) -> int:
    """Return where a line of the window is in the ring, without a division.

    Args:
        offset: Of the line from the window's first, 0 <= offset < size.
        start: Where the window's first line is in the ring.
        size: Number of lines.
    """
    line = start + offset
    return line - size if line >= size else line


@compiled
def line_beside(line: int, step: int, size: int) -> int:
    """Return the line of the ring before or after one."""
    following = line + step
    if following == size:
        return 0
    return size - 1 if following < 0 else following
