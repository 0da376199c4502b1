"""Who drives, on the page; and its joystick."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from viser import GuiApi

from narrows.tracking.registry import tracker_names

from .page_controllers import ALONE, ASSISTANT, CONTROLLERS, driver_names
from .page_driver import BY_HAND
from .page_guard import Guard


class DrivePanel:
    """The choice of who drives, the button, and the stick while the page is driven by hand."""

    def __init__(
        self,
        gui: GuiApi,
        guard: Guard,
        commanded: tuple[str, ...],
        drive: Callable[[Any], None],
        tell: Callable[[Any], None],
    ) -> None:
        """Add them.

        Args:
            gui: The page.
            guard: Makes callbacks wait for each other.
            commanded: Names of the command line's controllers.
            drive: Called when somebody presses the button.
            tell: Called with the stick (forward, left), each -1 to 1, or with `stop`.
        """
        self._tell = tell
        names = (*tracker_names(), *commanded, *CONTROLLERS)
        self.choice = gui.add_dropdown("who drives", names, hint="Trackers follow the plan")
        self.choice.on_update(self._chosen)
        self.person = gui.add_dropdown("driver", driver_names(), visible=False)
        gui.add_button("Drive", color="green").on_click(drive)
        self._forward: Any = gui.add_slider("forward", -1.0, 1.0, 0.05, 0.0, visible=False)
        self._left: Any = gui.add_slider("left", -1.0, 1.0, 0.05, 0.0, visible=False)
        self._middle = gui.add_button("Let go", visible=False, color="orange")
        self._stop = gui.add_button("Stop driving", visible=False, color="red")
        for slider in (self._forward, self._left):
            slider.on_update(guard(self._moved))
        self._middle.on_click(guard(self._let_go))
        self._stop.on_click(lambda _: tell("stop"))

    @property
    def who(self) -> str:
        """The tracker or controller chosen."""
        return str(self.choice.value)

    @property
    def driver(self) -> str:
        """Who sits in the chair, for a controller that has a driver."""
        return str(self.person.value)

    @property
    def by_hand(self) -> bool:
        """Whether the stick of the page drives."""
        return self.who in (ASSISTANT, ALONE) and self.driver == BY_HAND

    def hold_stick(self, *, on: bool) -> None:
        """Show the stick, at rest, or put it away."""
        self._forward.value = self._left.value = 0.0
        for part in (self._forward, self._left, self._middle, self._stop):
            part.visible = on

    def _chosen(self, event: Any) -> None:
        self.person.visible = self.who in (ASSISTANT, ALONE)

    def _let_go(self, event: Any) -> None:
        self._forward.value = self._left.value = 0.0
        self._tell((0.0, 0.0))

    def _moved(self, event: Any) -> None:
        if event.client is not None:
            self._tell((float(self._forward.value), float(self._left.value)))
