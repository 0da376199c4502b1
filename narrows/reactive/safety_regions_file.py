"""Safety regions in files: written whole, read with distrust."""

from __future__ import annotations

import hashlib
import io
import json
import zipfile
from dataclasses import asdict, fields
from pathlib import Path as FilePath
from typing import Any

import numpy as np

from ..errors import InputError, ShapeError
from ..files import write_whole
from ..vehicle import Vehicle
from .safety_regions import RegionOptions, SafetyRegions

FORMAT = "narrows safety regions 2"
_TABLES = ("outline", "norms", "lower", "levels", "parts")
_ANEW = "compute them anew with SafetyRegions.compute"


def write_regions(regions: SafetyRegions, file: FilePath | str) -> None:
    """Write regions to a file: NumPy's .npz, and after it the SHA-256 of all that.

    Raises:
        InputError: If it cannot be written.
    """
    tables = {name: getattr(regions, name) for name in _TABLES}
    about = {"format": FORMAT, "track": regions.track, "options": asdict(regions.options)}
    stream = io.BytesIO()
    np.savez_compressed(stream, about=np.array(json.dumps(about)), **tables)
    write_whole(file, sealed(stream.getvalue()))


def read_regions(file: FilePath | str, vehicle: Vehicle) -> SafetyRegions:
    """Return regions from a file, checked against a chair.

    Raises:
        InputError: As `SafetyRegions.load`.
    """
    regions = _read(str(file))
    difference = regions.difference(vehicle)
    if difference:
        raise InputError(
            f"these safety regions belong to another chair than {vehicle.name}: {difference}; "
            f"{_ANEW}",
            file=str(file),
        )
    return regions


def sealed(content: bytes) -> bytes:
    """Return content with its digest behind it."""
    return content + hashlib.sha256(content).digest()


def _read(file: str) -> SafetyRegions:
    try:
        found = FilePath(file).read_bytes()
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", file=file) from error
    content = found[: -hashlib.sha256().digest_size]
    if not content or sealed(content) != found:
        raise InputError(
            f"no file of safety regions of this version, or a damaged one; {_ANEW}",
            file=file,
            allowed="a file written by SafetyRegions.save",
        )
    try:
        with np.load(io.BytesIO(content), allow_pickle=False) as archive:
            about = json.loads(str(archive["about"]))
            tables = {name: np.asarray(archive[name]) for name in _TABLES}
    except (ValueError, KeyError, zipfile.BadZipFile) as error:
        raise InputError(f"no tables of safety regions; {_ANEW}", file=file) from error
    version = about.get("format") if isinstance(about, dict) else None
    if version != FORMAT:
        raise InputError(
            f"not the format of this version; {_ANEW}",
            file=file,
            value=version,
            allowed=f"'{FORMAT}'",
        )
    return _built(about, tables, file)


def _built(about: dict[str, Any], tables: dict[str, Any], file: str) -> SafetyRegions:
    names = {field.name for field in fields(RegionOptions)}
    chosen = about.get("options")
    if not isinstance(chosen, dict) or set(chosen) != names:
        raise InputError("the options are not those of this version", file=file, value=chosen)
    try:
        options = RegionOptions(**chosen)
        return SafetyRegions(options, track=float(about["track"]), **tables)
    except (ShapeError, TypeError, ValueError, KeyError) as error:
        raise InputError(f"the tables do not fit each other: {error}", file=file) from error
