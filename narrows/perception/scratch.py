"""Room for intermediate results, kept from call to call.

What the operating system hands out anew it hands out page by page, cleared, and takes back after
the call: for the chain on a frame that costs as much as the work itself.
"""

from __future__ import annotations

import threading
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

_LARGEST = 1 << 24  # bytes of an array that are kept; more is not worth holding on to


class Scratch(threading.local):
    """Arrays by name, one of each in a thread: valid until the same name is asked for again."""

    def __init__(self) -> None:
        """Keep nothing yet."""
        self._kept: dict[str, NDArray[np.uint8]] = {}

    def array(self, name: str, shape: tuple[int, ...], dtype: DTypeLike) -> NDArray[Any]:
        """Return an array that holds anything.

        Args:
            name: What it is for.
            shape: Its shape.
            dtype: Its type.
        """
        size = int(np.prod(shape)) * np.dtype(dtype).itemsize
        if size > _LARGEST:
            return np.empty(shape, dtype=dtype)
        if name not in self._kept or self._kept[name].nbytes < size:
            self._kept[name] = np.empty(size, dtype=np.uint8)
        return self._kept[name][:size].view(dtype).reshape(shape)
