"""What the page says in large words, and in place of a field: text and its HTML."""

from __future__ import annotations

import html
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from narrows.interfaces import Plan, PlanStatus
from narrows.scene import Scene

from . import palette

if TYPE_CHECKING:
    from narrows.planners.passage import Verdict
    from narrows.simulation.judge import Judgement

_TONES = {
    "good": (palette.GREEN, "#e6f5f0"),
    "bad": (palette.RED, "#fdeee4"),
    "unsure": ("#8a6100", "#fdf4dc"),
    "busy": (palette.BLUE, "#e8f1f8"),
    "quiet": (palette.WALL, "#f2f2f0"),
}
"""Ink and paper of each tone; the words alone say the same."""


@dataclass(frozen=True)
class Words:
    """A verdict for people.

    Attributes:
        tone: `good`, `bad`, `unsure`, `busy` or `quiet`.
        headline: The verdict itself.
        figure: Its millimetres or seconds, or empty.
        text: The reason, one or two sentences.
    """

    tone: str
    headline: str
    figure: str = ""
    text: str = ""

    def html(self) -> str:
        """Return them as HTML; everything that came from a file or a person is escaped."""
        ink, paper = _TONES[self.tone]
        large = "font-weight:700;line-height:1.15;overflow-wrap:anywhere"
        rows = [
            f'<div style="font-size:22px;{large};color:{ink}">{html.escape(self.headline)}</div>'
        ]
        if self.figure:
            rows.append(f'<div style="font-size:18px;{large}">{html.escape(self.figure)}</div>')
        if self.text:
            rows.append(
                '<div style="font-size:12.5px;line-height:1.35;margin-top:3px;'
                f'overflow-wrap:anywhere">{html.escape(self.text)}</div>'
            )
        return (
            f'<div class="narrows-verdict" data-tone="{self.tone}" style="margin:0 .7em .5em;'
            f"padding:8px 10px;border-left:6px solid {ink};background:{paper};color:#222;"
            f'border-radius:3px">{"".join(rows)}</div>'
        )


def answer(text: str, *, good: bool = False) -> str:
    """Return an answer in place, as HTML; nothing for an empty text."""
    if not text:
        return ""
    ink, paper = _TONES["good" if good else "bad"]
    mark = "" if good else "! "
    return (
        f'<div class="narrows-answer" style="margin:0 .7em .5em;padding:4px 8px;font-size:12.5px;'
        f"line-height:1.35;background:{paper};color:#222;border-left:4px solid {ink};"
        f'overflow-wrap:anywhere">{mark}{html.escape(text)}</div>'
    )


def plan_words(plan: Plan) -> Words:
    """Return what came of planning."""
    if plan.status is PlanStatus.CERTIFIED and plan.certificate is not None:
        free = plan.certificate.clearance
        figure = "nothing to touch" if math.isinf(free) else f"{_down(free)} mm clear, proven"
        return Words("good", "certified", figure, plan.reason)
    if plan.status is PlanStatus.IMPASSABLE:
        missing = plan.statistics.get("missing_mm")
        figure = "" if missing is None else f"{missing:.0f} mm missing"
        return Words("bad", "impassable", figure, plan.reason)
    return Words("unsure", "not found", "neither a way nor a proof", plan.reason)


def passage_words(verdict: Verdict, scene: Scene) -> Words:
    """Return whether anything can pass."""
    spare = verdict.spare_m
    known = spare is not None and math.isfinite(spare)
    status = verdict.status.value
    if status == "passable":
        figure = f"{1e3 * spare:.0f} mm to spare" if known and spare is not None else ""
        if scene.vehicle.limits.reverse_speed > 0.0:
            return Words("good", "it can pass", figure, verdict.reason)
        return Words("unsure", "it can pass if it may reverse", figure, verdict.reason)
    if status == "impassable":
        figure = f"{-1e3 * spare:.0f} mm missing" if known and spare is not None else ""
        return Words("bad", "it cannot pass", figure, verdict.reason)
    return Words("unsure", "undecided", "", verdict.reason)


def drive_words(judgement: Judgement) -> Words:
    """Return what came of a drive."""
    free = judgement.min_clearance
    if judgement.collisions:
        figure = f"{len(judgement.collisions)} collision(s)"
        return Words("bad", "driven with contact", figure, judgement.reason)
    figure = "nothing to touch" if math.isinf(free) else f"{_down(free)} mm clear, driven"
    if judgement.reached:
        return Words("good", "reached", figure, judgement.reason)
    return Words("unsure", "not reached", figure, judgement.reason)


def _down(length: float) -> int:
    """Return a length [m] in whole millimetres, never more than it is."""
    return math.floor(1e3 * length + 1e-9)
