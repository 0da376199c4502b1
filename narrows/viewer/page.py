"""The page in the browser: a server on this machine, a session for every tab."""

from __future__ import annotations

import asyncio
import logging
import socket
import threading
import warnings
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import rich
from viser import ClientHandle, ViserServer

from narrows.errors import InputError

from .page_camera import camera
from .page_controllers import CommandControllers
from .page_drawing import SceneDrawing
from .page_jobs import JobRunner
from .page_session import Session
from .page_state import SceneState
from .page_work import WARM

_VIEW = 1.0  # s a browser has to draw what it was sent, before planning warms up
_LOOK = 0.25  # s between looks for Ctrl-C
LOOPBACK = ("localhost", "127.0.0.1", "::1")

_log = logging.getLogger(__name__)


class Page:
    """A page that is being served.

    Attributes:
        state: The scene every tab starts with.
        folder: The only folder that is written to.
        url: Where it is.
        port: Its port there.
    """

    def __init__(
        self,
        state: SceneState,
        *,
        host: str,
        port: int,
        folder: Path,
        commanded: CommandControllers | None = None,
    ) -> None:
        """Start serving.

        Args:
            state: The scene every tab starts with.
            host: Name or address to listen on.
            port: Port, 0 for any; the next free one if it is taken.
            folder: The only folder that is written to.
            commanded: The controllers of the command line.

        Raises:
            InputError: If nothing can listen there.
        """
        self.state = state
        self.folder = folder.resolve()
        self._commanded = CommandControllers() if commanded is None else commanded
        self._host = host
        self._sessions: dict[int, Session] = {}
        self._lock = threading.Lock()
        self._ended = threading.Event()
        check_address(host, port)
        self._runner = JobRunner(WARM)
        rich.reconfigure(quiet=True)  # what viser prints is not for the terminal of this command
        warnings.filterwarnings("ignore", "Queued a .* on a closed connection")  # a tab was closed
        self._server = ViserServer(host=host, port=port, label="narrows", verbose=False)
        self._server.request_share_url = _refuse_sharing  # type: ignore[method-assign]
        self._dress()
        self._server.on_client_connect(self._opened)
        self._server.on_client_disconnect(self._closed)
        shown = "localhost" if host in ("0.0.0.0", "::", *LOOPBACK) else host
        self.port = self._server.get_port()
        self.url = f"http://{shown}:{self.port}"

    def wait(self) -> None:
        """Serve until stopped.

        A signal that another thread happens to receive does not end a wait; so it is a short one.
        """
        while not self._ended.wait(_LOOK):
            pass

    def stop(self) -> None:
        """End all work and the server."""
        with self._lock:
            sessions, self._sessions = list(self._sessions.values()), {}
        for session in sessions:
            session.close()
        self._runner.close()
        self._hang_up()
        self._server.stop()
        self._ended.set()

    def _hang_up(self) -> None:
        """End all connections: a browser keeps some in store, which the server would wait for."""
        loop = self._server._websock_server._background_event_loop
        if loop is not None and loop.is_running():
            loop.call_soon_threadsafe(_end_connections, loop)

    def _dress(self) -> None:
        server, place = self._server, camera(self.state.scene)
        SceneDrawing(server.scene).stage()
        server.initial_camera.near = 0.1  # m: closer, and what lies on the floor flickers
        server.initial_camera.fov = place.fov
        server.initial_camera.position = place.position
        server.initial_camera.look_at = place.look_at

    def _opened(self, client: ClientHandle) -> None:
        if not self._is_own(client):
            _log.warning("a page of another site was refused")
            return
        with client.atomic():  # sent in pieces, the browser would lay the page out for each
            client.gui.configure_theme(
                control_layout="fixed",
                control_width="medium",
                show_logo=False,
                show_share_button=False,
                brand_color=(0, 114, 178),
            )
            session = Session(client, self.state, self._runner, self.folder, self._commanded)
        with self._lock:
            self._sessions[client.client_id] = session
        later = threading.Timer(_VIEW, self._runner.begin)  # a browser needs both cores to draw
        later.daemon = True
        later.start()

    def _closed(self, client: ClientHandle) -> None:
        with self._lock:
            session = self._sessions.pop(client.client_id, None)
        if session is not None:
            session.close()

    def _is_own(self, client: ClientHandle) -> bool:
        """Return whether the tab shows this server's page and not one of another web site.

        Browsers let every web site open a socket to this machine, and say which site it was.
        """
        connection = self._server._websock_server._live_connections.get(client.client_id)
        headers: Any = {} if connection is None else getattr(connection.request, "headers", {})
        return is_own_site(headers.get("Origin"), headers.get("Host"), self._host)


def _end_connections(loop: asyncio.AbstractEventLoop) -> None:
    """End what a server does for each of its connections; in the thread of its loop.

    What still waits when the loop ends, such as a connection's pulse, is dropped without a word.
    """
    loop.set_exception_handler(lambda _, context: _log.debug("dropped: %s", context["message"]))
    for task in asyncio.all_tasks(loop):
        if getattr(task.get_coro(), "__name__", "") == "conn_handler":
            task.cancel()


def is_own_site(origin: str | None, host: str | None, served: str) -> bool:
    """Return whether a socket was opened by the page of this server.

    >>> is_own_site("http://localhost:8080", "localhost:8080", "127.0.0.1")
    True
    >>> is_own_site("http://elsewhere.example", "localhost:8080", "127.0.0.1")
    False

    Args:
        origin: Site that opened the socket, by the browser; None: no browser did.
        host: What the browser takes this server for.
        served: What the server listens on; on loopback only its names are taken.
    """
    if origin is None:
        return True
    if host is None or urlsplit(origin).netloc != host:
        return False
    return served not in LOOPBACK or urlsplit(origin).hostname in LOOPBACK


def check_address(host: str, port: int) -> None:
    """Say early that nothing can listen on an address; a port that is taken is no hindrance.

    Raises:
        InputError: If the name is unknown, the address not of this machine, or the port none.
    """
    try:
        kind, _, _, _, address = socket.getaddrinfo(host, None, type=socket.SOCK_STREAM)[0]
        with socket.socket(kind, socket.SOCK_STREAM) as probe:
            probe.bind((address[0], 0))
    except (OSError, UnicodeError) as error:
        raise InputError(
            f"nothing can listen there: {error}",
            field="--host",
            value=host,
            allowed="a name or address of this machine; 127.0.0.1 for this machine only",
        ) from error
    if not (port == 0 or 1 <= port <= 64535):
        allowed = "1 to 64535, or 0 for any that is free"
        raise InputError("no such port", field="--port", value=port, allowed=allowed)


def _refuse_sharing(verbose: bool = True) -> None:
    """Do not open a way to this page from outside, whoever asks."""
