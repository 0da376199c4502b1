"""Who is in control, by colour: of the words, of the body and in a replay's legend."""

from __future__ import annotations

import html
from collections.abc import Mapping
from enum import IntEnum

from narrows.se2 import Array

from . import palette

STATES = {
    "goal": palette.BLUE,
    "zone": "#B35900",
    "stopped": palette.WALL,
    "backing": palette.RED,
    "full user control": palette.BLUE,
    "braking": palette.RED,
    "obstacle avoidance": "#B35900",
    "restoring orientation": palette.GREEN,
}
"""Colour of each state that a controller tells of."""


def state_colour(state: str) -> str:
    """Return the colour of who is in control; blue for what has no colour of its own."""
    return STATES.get(state, palette.BLUE)


def state_chip(state: str) -> str:
    """Return the word for who is in control on its colour, as HTML."""
    looks = f"background:{state_colour(state)};color:#fff;padding:0 6px;border-radius:3px"
    looks += ";display:inline-block"  # never broken between two lines
    return f'<b style="{looks}">{html.escape(state)}</b>'


def states_told(signals: Mapping[str, Array]) -> tuple[str, ...]:
    """Return who was in control at each row of a controller's signals; empty: it tells of nobody.

    Args:
        signals: Values of each signal, shape (N,).
    """
    from narrows.reactive.assistant_options import AssistantState
    from narrows.reactive.switching import Active

    told: dict[str, type[IntEnum]] = {"active": Active, "state": AssistantState}
    for signal, kind in told.items():
        if signal in signals:
            values = signals[signal].astype(int).tolist()
            return tuple(kind(value).name.lower().replace("_", " ") for value in values)
    return ()
