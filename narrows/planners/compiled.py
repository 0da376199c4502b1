"""Compile a plain loop to machine code the first time it is called, and keep the result on disk.

Modules that use this are imported by their callers where they are needed, never at
`import narrows`: numba's import alone costs as much as a plan.

The cache is renewed when the file a function stands in changes, not when a function it calls in
another file does: after editing one kernel file, touch those that call it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar, cast

import numba

Function = TypeVar("Function", bound=Callable[..., object])


def compiled(function: Function) -> Function:
    """Return the function compiled on its first call, division by zero giving infinity."""
    return cast(Function, numba.njit(cache=True, error_model="numpy")(function))
