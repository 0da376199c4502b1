"""Compile a plain loop on its first call and keep the machine code on disk.

Kernels are imported where they are needed, never at `import narrows`. Their machine code is renewed
when their own file changes, not when that of a kernel they call does: touch the callers' files too.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar, cast

import numba

Function = TypeVar("Function", bound=Callable[..., object])


def compiled(function: Function) -> Function:
    """Return the function compiled on its first call, division by zero giving infinity."""
    return cast(Function, numba.njit(cache=True, error_model="numpy")(function))
