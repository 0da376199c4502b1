"""Where a number came from: versions of what computed it, and the machine."""

from __future__ import annotations

import functools
import os
import platform
from importlib import metadata
from pathlib import Path

_PACKAGES = ("narrows", "numpy", "scipy", "casadi", "shapely", "ruckig", "numba")


@functools.cache
def versions() -> dict[str, str]:
    """Versions of Python and of the packages that decide a result, by name.

    Read from the installed metadata, so nothing is imported for it. A package that is not
    installed is left out; narrows itself, run from a bare source tree, is `unknown`.
    """
    found = {"python": platform.python_version()}
    for package in _PACKAGES:
        try:
            found[package] = metadata.version(package)
        except metadata.PackageNotFoundError:
            if package == "narrows":
                found[package] = "unknown"
    return found


@functools.cache
def machine() -> str:
    """One line on this machine: name, system, processor and number of processors."""
    system = f"{platform.system()} {platform.release()} {platform.machine()}"
    return f"{platform.node()}, {system}, {_processor()}, {os.cpu_count()} processors"


def _processor() -> str:
    """Name of the processor; its architecture where the system does not tell more."""
    listing = Path("/proc/cpuinfo")
    if listing.is_file():
        for line in listing.read_text(encoding="utf-8", errors="replace").splitlines():
            name, _, value = line.partition(":")
            if name.strip() == "model name":
                return value.strip()
    return platform.processor() or platform.machine()
