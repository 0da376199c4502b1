"""Switches of the layers that show what the chair knew; they follow the time."""

from __future__ import annotations

from typing import Any

from viser import GuiApi, SceneApi

from .layer_drawing import LAYERS, LayerDrawing
from .page_motion import Motion
from .page_senses import Moment


class Layers:
    """Layers that can be switched on and off, and follow the time."""

    def __init__(self, gui: GuiApi, api: SceneApi) -> None:
        """Add the switches; nothing to show yet."""
        self._drawing = LayerDrawing(api)
        self._motion: Motion | None = None
        self._shown: Moment | None = None
        self._folder = gui.add_folder("Layers", visible=False)
        self._boxes: dict[str, Any] = {}
        with self._folder:
            for name, says in LAYERS.items():
                box = gui.add_checkbox(name, name in ("points", "zone"), hint=says)
                box.on_update(lambda _: self._redraw())
                self._boxes[name] = box

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the layers that are switched on."""
        return tuple(name for name, box in self._boxes.items() if box.value)

    def load(self, motion: Motion | None) -> None:
        """Take a motion; one without moments has no layers."""
        self._motion, self._shown = motion, None
        self._folder.visible = bool(motion is not None and motion.moments)
        self._redraw()

    def show(self, at: float) -> None:
        """Show what was known at a time [s]."""
        moment = None if self._motion is None else self._motion.moment(at)
        if moment is not self._shown:
            self._shown = moment
            self._redraw()

    def _redraw(self) -> None:
        self._drawing.show(self._shown, self.names)
