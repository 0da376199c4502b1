"""The picture of a map_server map: which cells are occupied, free, or neither."""

from __future__ import annotations

import struct
import warnings
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from ..errors import SceneError
from .cells import Mask

MOST_CELLS = 64_000_000
_FORMATS = ("PNG", "PPM", "BMP")
_ALLOWED = "a PGM, PNG or BMP picture, grey or in colour"
_PILLOW_RAISES = (
    OSError,
    SyntaxError,
    ValueError,
    EOFError,
    IndexError,
    KeyError,
    TypeError,
    struct.error,
    Image.DecompressionBombError,
    Image.DecompressionBombWarning,
)


class Occupancy(NamedTuple):
    """What a map says about each of its cells, row 0 lowest, shape (rows, columns).

    Attributes:
        occupied: Whether the cell is known to be occupied.
        unknown: Whether the cell is neither known to be occupied nor known to be free.
    """

    occupied: Mask
    unknown: Mask


def read_occupancy(
    file: Path,
    *,
    negate: bool,
    occupied_threshold: float,
    free_threshold: float,
    transparent_is_unknown: bool,
) -> Occupancy:
    """Read a picture and compare each pixel's occupancy with two thresholds.

    The occupancy is p = 1 - brightness, or the brightness itself if negated; brightness is the
    mean of the channels, 0 (black) to 1 (white). As map_server's documentation has it, p > the
    occupied threshold is occupied, p < the free threshold is free, all else is unknown.

    Args:
        file: A PGM (plain or binary, 8 or 16 bit), PNG or BMP picture.
        negate: Whether white means occupied.
        occupied_threshold: Occupancy above which a cell is occupied, 0..1.
        free_threshold: Occupancy below which a cell is free, 0..1.
        transparent_is_unknown: Whether pixels that are not fully opaque are unknown
            (map_server's mode `scale`); otherwise opacity is one more channel to average over
            (its mode `trinary`).

    Raises:
        SceneError: If the file is missing, no picture, damaged or too large.
    """
    levels, full, opaque = _read_levels(file, transparent_is_unknown)
    scale = np.arange(full + 1) / full
    occupancy = scale if negate else (full - np.arange(full + 1)) / full
    levels = levels[::-1]  # pictures start at the top, maps at the bottom
    occupied = (occupancy > occupied_threshold)[levels]
    free = (occupancy < free_threshold)[levels]
    if opaque is not None:
        occupied &= opaque[::-1]
        free &= opaque[::-1]
    return Occupancy(occupied, ~(occupied | free))


def _read_levels(
    file: Path, split_alpha: bool
) -> tuple[NDArray[np.integer[Any]], int, Mask | None]:
    """Return the channels' sum of each pixel, its greatest possible value, and what is opaque."""
    image = _open(file)
    if image.mode in ("I", "I;16", "I;16B", "I;16L"):
        levels = np.asarray(image)
        if levels.min() < 0 or levels.max() > 65535:
            raise _refused(file, "the picture has more than 16 bits a pixel")
        return levels, 65535, None
    if image.mode == "1":
        image = image.convert("L")
    elif image.mode in ("P", "PA", "LA") or "transparency" in image.info:
        has_alpha = image.mode != "P" or "transparency" in image.info
        image = image.convert("RGBA" if has_alpha else "RGB")
    if image.mode == "L":
        return np.asarray(image), 255, None
    if image.mode not in ("RGB", "RGBA"):
        raise _refused(file, f"the picture's pixels are of a kind ({image.mode}) maps do not use")
    pixels = np.asarray(image)  # (rows, columns, channels)
    opaque = None
    if image.mode == "RGBA" and split_alpha:
        pixels, opaque = pixels[..., :3], pixels[..., 3] == 255
    return pixels.sum(axis=2, dtype=np.uint16), 255 * pixels.shape[2], opaque


def _open(file: Path) -> Image.Image:
    """Return the picture, decoded; every way Pillow has to refuse a file becomes a SceneError."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", Image.DecompressionBombWarning)
        try:
            image = Image.open(file, formats=_FORMATS)
        except (Image.DecompressionBombError, Image.DecompressionBombWarning) as error:
            raise _too_large(file, None) from error
        except _PILLOW_RAISES as error:
            raise _refused(file, "the file is not a picture that can be read") from error
        with image:
            if image.width * image.height > MOST_CELLS:
                raise _too_large(file, f"{image.width} x {image.height}")
            try:
                image.load()
            except _PILLOW_RAISES as error:
                raise _refused(file, f"the picture is damaged or cut short ({error})") from error
            return image.copy()


def _refused(file: Path, problem: str) -> SceneError:
    return SceneError(problem, file=str(file), field="image", allowed=_ALLOWED)


def _too_large(file: Path, size: str | None) -> SceneError:
    return SceneError(
        "the picture is too large",
        file=str(file),
        field="image",
        value=size,
        allowed=f"at most {MOST_CELLS / 1e6:.0f} million pixels; crop it or lower its resolution",
    )
