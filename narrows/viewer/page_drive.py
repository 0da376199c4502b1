"""Who drives, on the page."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from viser import GuiApi

from narrows.tracking.registry import tracker_names


class DrivePanel:
    """The choice of who drives, and the button."""

    def __init__(self, gui: GuiApi, drive: Callable[[Any], None]) -> None:
        """Add them.

        Args:
            gui: The page.
            drive: Called when somebody presses the button.
        """
        self.choice = gui.add_dropdown("who drives", tracker_names(), hint="Who steers the chair")
        gui.add_button("Drive", color="green").on_click(drive)

    @property
    def tracker(self) -> str:
        """The tracker chosen."""
        return str(self.choice.value)
