"""Colours that people with any colour vision tell apart, and what they stand for.

The colours are those of Okabe and Ito's palette, see docs/references.md [OkabeIto].
"""

from __future__ import annotations

BLUE = "#0072B2"
SKY = "#56B4E9"
GREEN = "#009E73"
ORANGE = "#E69F00"
RED = "#D55E00"
PINK = "#CC79A7"
INK = "#222222"

WALL = "#4A4A4A"
OUTLINE = "#777777"
PALE = "#C8C8C8"

FORWARD = BLUE
REVERSE = ORANGE
START = GREEN
GOAL = PINK
LEAST = RED
REFUSED = RED
