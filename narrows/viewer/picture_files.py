"""The files pictures are written to, known without importing what draws them."""

from __future__ import annotations

from pathlib import Path

from narrows.errors import InputError

SUFFIXES = (".png", ".svg")
"""Suffixes of the pictures that can be written."""


def check_picture_suffix(file: Path | str) -> str:
    """Return a picture's suffix in lower case.

    Raises:
        InputError: If it is not one of `SUFFIXES`.
    """
    suffix = Path(file).suffix.lower()
    if suffix not in SUFFIXES:
        raise InputError(
            "pictures of this kind are not drawn",
            file=str(file),
            value=suffix,
            allowed=" or ".join(SUFFIXES),
        )
    return suffix
