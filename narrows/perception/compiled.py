"""Compile a plain loop on its first call and keep the machine code on disk.

Kernels here are imported by their callers when they are needed, never at `import narrows`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar, cast

import numba

Function = TypeVar("Function", bound=Callable[..., object])


def compiled(function: Function) -> Function:
    """Return the function compiled on its first call, division by zero giving infinity."""
    return cast(Function, numba.njit(cache=True, error_model="numpy")(function))


def compiled_sums(function: Function) -> Function:
    """Return the function compiled, its sums in any order: for counts and moments of points."""
    flags = {"reassoc", "contract", "nsz"}  # never nnan or ninf: silence must stay silence
    return cast(Function, numba.njit(cache=True, error_model="numpy", fastmath=flags)(function))
