"""`narrows view`: the scene, the chair, the plan and the drive in 3-D, in the browser."""

from __future__ import annotations

import importlib.util
import os
import webbrowser
from collections.abc import Callable
from pathlib import Path

from ..errors import MissingExtra
from .outcome import OK, Outcome

PORT = 8080


def run_view(
    scene_file: str | None,
    *,
    host: str,
    port: int,
    open_browser: bool,
    say: Callable[[str], None],
) -> Outcome:
    """Serve the page until the process is interrupted.

    Args:
        scene_file: The scene; None: a door off a corridor.
        host: What to listen on.
        port: Port; the next free one if it is taken.
        open_browser: Whether to open the page.
        say: Prints a line for people at once.
    """
    if importlib.util.find_spec("viser") is None:
        raise MissingExtra("viser", "view")
    os.environ.setdefault("OMP_NUM_THREADS", "1")  # before NumPy: jobs are forked, without threads
    from ..viewer.page import Page
    from ..viewer.page_controllers import CONTROLLERS, CommandControllers
    from ..viewer.page_state import load_state
    from .controllers import controller_names, make_controller

    others = tuple(name for name in controller_names() if name not in CONTROLLERS)
    page = Page(
        load_state(scene_file),
        host=host,
        port=port,
        folder=Path.cwd(),
        commanded=CommandControllers(others, make_controller),
    )
    try:
        taken = "" if port in (0, page.port) else f" (port {port} is taken)"
        say(f"serving {page.url}{taken} - press Ctrl-C to end")
        if open_browser:
            webbrowser.open(page.url)
        page.wait()
    except KeyboardInterrupt:
        say("ended")
    finally:
        page.stop()
    return Outcome(OK, {}, "")
