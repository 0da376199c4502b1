"""Tables I and II of [DrivingAssistant]: to which side an obstacle is avoided."""

from __future__ import annotations

import tomllib
from enum import IntEnum
from functools import cache
from importlib import resources

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError

PARTS = (
    "front_left",
    "front_right",
    "front_left_side",
    "front_right_side",
    "rear_left_side",
    "rear_right_side",
    "rear_left",
    "rear_right",
)
"""Parts of the body by their codes: sides ahead of and behind the drive axle."""


class Side(IntEnum):
    """To which side an obstacle is avoided; seen from the chair, whichever way it drives."""

    NONE = 0
    STRAIGHT = 1
    LEFT = 2
    RIGHT = 3
    BOTH = 4


class Indicated(IntEnum):
    """To which side the way bends that the user indicates."""

    LEFT = 0
    STRAIGHT = 1
    RIGHT = 2


def table_names() -> tuple[str, ...]:
    """Return the names of the tables.

    >>> table_names()
    ('printed', 'corrected')
    """
    return tuple(_content())


@cache
def side_table(name: str) -> NDArray[np.uint8]:
    """Return a table of `Side`, shape (2: forward, backward; 8 parts; 3 indicated), read-only.

    >>> Side(side_table("corrected")[0, PARTS.index("front_left_side"), Indicated.LEFT]).name
    'RIGHT'

    Args:
        name: `corrected` or `printed`.

    Raises:
        InputError: If there is no table of that name.
    """
    if name not in table_names():
        raise InputError("no such table of sides", value=name, allowed=" or ".join(table_names()))
    rows = [
        [[Side[side.upper()] for side in _content()[name][way][part]] for part in PARTS]
        for way in ("forward", "backward")
    ]
    table = np.array(rows, dtype=np.uint8)
    table.setflags(write=False)
    return table


def mechanical_side(x: float, y: float, *, forward: bool) -> Side:
    """Return the side to steer to so that a side contact at (x, y) is relieved.

    The contact moves outward at omega x sign(y): steer so that omega x sign(y) < 0. Backwards, a
    way that bends to the left has omega < 0.

    >>> mechanical_side(0.5, 0.3, forward=True).name
    'RIGHT'

    Args:
        x: Where the contact is, ahead of the drive axle [m].
        y: To the left of the chair's middle [m].
        forward: Whether the chair drives forward.
    """
    turn_left = x * y < 0.0
    return Side.LEFT if turn_left == forward else Side.RIGHT


@cache
def _content() -> dict[str, dict[str, dict[str, list[str]]]]:
    text = (resources.files("narrows.reactive") / "side_tables.toml").read_text(encoding="utf-8")
    return tomllib.loads(text)
