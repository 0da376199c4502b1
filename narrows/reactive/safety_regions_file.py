"""Safety regions in files: written whole, read with distrust."""

from __future__ import annotations

import hashlib
import io
import json
import zipfile
import zlib
from dataclasses import asdict, fields
from pathlib import Path as FilePath
from typing import Any

import numpy as np

from ..errors import InputError, ShapeError
from ..files import write_whole
from ..se2 import Array
from ..vehicle import Vehicle
from .safety_regions import RegionOptions, SafetyRegions, top_norm

FORMAT = "narrows safety regions 1"
_TABLES = ("outline", "norms", "lower", "levels", "parts")
_SAME = 1e-6  # m: lengths of one chair that differ less are the same


def write_regions(regions: SafetyRegions, file: FilePath | str) -> None:
    """Write regions to a file.

    Raises:
        InputError: If it cannot be written.
    """
    tables = {name: getattr(regions, name) for name in _TABLES}
    about = {"format": FORMAT, "track": regions.track, "options": asdict(regions.options)}
    about["checksum"] = _checksum(tables)
    stream = io.BytesIO()
    np.savez_compressed(stream, about=np.array(json.dumps(about)), **tables)
    write_whole(file, stream.getvalue())


def read_regions(file: FilePath | str, vehicle: Vehicle) -> SafetyRegions:
    """Return regions from a file, checked against a chair.

    Raises:
        InputError: As `SafetyRegions.load`.
    """
    regions = _read(str(file))
    difference = _difference(regions, vehicle)
    if difference:
        raise InputError(
            f"these safety regions belong to another chair than {vehicle.name}: {difference}; "
            "compute them anew with SafetyRegions.compute",
            file=str(file),
        )
    return regions


def _read(file: str) -> SafetyRegions:
    try:
        content = FilePath(file).read_bytes()
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", file=file) from error
    try:
        with np.load(io.BytesIO(content), allow_pickle=False) as archive:
            about = json.loads(str(archive["about"]))
            tables = {name: np.asarray(archive[name]) for name in _TABLES}
    except (ValueError, KeyError, OSError, EOFError, zipfile.BadZipFile, zlib.error) as error:
        raise InputError(
            f"no file of safety regions, or a damaged one ({error})",
            file=file,
            allowed="a file written by SafetyRegions.save",
        ) from error
    found = about.get("format") if isinstance(about, dict) else None
    if found != FORMAT:
        raise InputError(
            "not the format of this version", file=file, value=found, allowed=f"'{FORMAT}'"
        )
    if about.get("checksum") != _checksum(tables):
        raise InputError("the tables are damaged: their checksum differs", file=file)
    return _built(about, tables, file)


def _built(about: dict[str, Any], tables: dict[str, Any], file: str) -> SafetyRegions:
    names = {field.name for field in fields(RegionOptions)}
    chosen = about.get("options")
    if not isinstance(chosen, dict) or set(chosen) != names:
        raise InputError("the options are not those of this version", file=file, value=chosen)
    try:
        options = RegionOptions(**chosen)
        return SafetyRegions(options, track=float(about["track"]), **tables)
    except (ShapeError, TypeError, KeyError) as error:
        raise InputError(f"the tables do not fit each other: {error}", file=file) from error


def _difference(regions: SafetyRegions, vehicle: Vehicle) -> str:
    """Return in words how a chair differs from the one regions were computed for; or nothing."""
    outline = vehicle.outline
    if outline.shape != regions.outline.shape or np.abs(outline - regions.outline).max() > _SAME:
        return f"their body is {_size(regions.outline)}, the chair's {_size(outline)}"
    if abs(vehicle.track - regions.track) > _SAME:
        return f"their track is {regions.track:.4g} m, the chair's {vehicle.track:.4g} m"
    top = top_norm(vehicle)
    if regions.norms[-1] < top - _SAME:
        least, asked = 0.5 * regions.norms[-1], 0.5 * top
        return f"they end at a rim speed of {least:.4g} m/s, the chair may reach {asked:.4g} m/s"
    return ""


def _size(outline: Array) -> str:
    low, high = outline.min(axis=0), outline.max(axis=0)
    return (
        f"{high[0] - low[0]:.4g} x {high[1] - low[1]:.4g} m from x = {low[0]:.4g} m "
        f"with {len(outline)} corners"
    )


def _checksum(tables: dict[str, Any]) -> str:
    digest = hashlib.sha256()
    for name in _TABLES:
        table = np.ascontiguousarray(tables[name])
        digest.update(f"{name} {table.dtype.str} {table.shape}".encode())
        digest.update(table.tobytes())
    return digest.hexdigest()
