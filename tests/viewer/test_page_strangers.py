"""Whoever speaks to the page without being it gets nothing, and does not end it."""

import time
import urllib.error
import urllib.request

import pytest

pytestmark = pytest.mark.slow
pytest.importorskip("viser", reason="viser is not installed (extra view)")

PATIENCE = 20.0  # s


def connected(harassed, origin):
    import viser
    from websockets.sync.client import connect

    address = harassed.url.replace("http:", "ws:")
    return connect(address, origin=origin, subprotocols=[f"viser-v{viser.__version__}"])


def camera():
    """Return what a browser says first: where its camera is."""
    import msgspec

    return msgspec.msgpack.encode(
        {
            "type": "ViewerCameraMessage",
            "wxyz": (1.0, 0.0, 0.0, 0.0),
            "position": (0.0, 0.0, 5.0),
            "fov": 1.0,
            "near": 0.1,
            "far": 100.0,
            "image_height": 600,
            "image_width": 800,
            "look_at": (0.0, 0.0, 0.0),
            "up_direction": (0.0, 1.0, 0.0),
        }
    )


def kinds(socket, seconds):
    """Return the kinds of messages that come within some seconds, or until a button comes."""
    import msgspec
    import zstandard

    found, end = set(), time.monotonic() + seconds
    while time.monotonic() < end and "GuiButtonMessage" not in found:
        try:
            raw = socket.recv(timeout=max(0.0, end - time.monotonic()))
        except TimeoutError:
            break
        packed = raw[16 : 16 + int.from_bytes(raw[8:16], "little")]
        inner = zstandard.ZstdDecompressor().decompress(packed)
        found |= {message["type"] for message in msgspec.msgpack.decode(inner)["messages"]}
    return found


def test_a_page_of_another_site_gets_no_buttons_and_the_own_page_does(harassed):
    with connected(harassed, "http://elsewhere.example") as socket:
        socket.send(camera())
        assert not {kind for kind in kinds(socket, 1.0) if kind.startswith("GuiButton")}
    with connected(harassed, harassed.url) as socket:
        socket.send(camera())
        assert "GuiButtonMessage" in kinds(socket, PATIENCE)


@pytest.mark.parametrize(
    "message",
    [
        b"",
        b"\xc1\xff garbage",
        b"\x81\xa4type\xa7nothing",
        "text",
        b"\x82\xa4type\xb0GuiUpdateMessage\xa4uuid\xc0",
    ],
)
def test_nonsense_ends_its_own_connection_at_most(harassed, message):
    from websockets.exceptions import ConnectionClosed

    with connected(harassed, harassed.url) as socket:
        try:
            socket.send(message)
            socket.send(camera())
            kinds(socket, 1.0)
        except ConnectionClosed:
            pass
    with urllib.request.urlopen(harassed.url, timeout=PATIENCE) as answer:
        assert answer.status == 200
    assert harassed.process.poll() is None


@pytest.mark.parametrize(
    "path", ["/../../../../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd", "/door.yaml"]
)
def test_files_are_not_handed_out(harassed, path):
    with pytest.raises(urllib.error.HTTPError) as caught:
        urllib.request.urlopen(harassed.url + path, timeout=PATIENCE)
    with caught.value as answer:
        assert answer.code == 404


def test_asking_for_a_way_in_from_outside_opens_none(harassed):
    import msgspec

    with connected(harassed, harassed.url) as socket:
        socket.send(camera())
        kinds(socket, PATIENCE)
        socket.send(msgspec.msgpack.encode({"type": "ShareUrlRequest"}))
        assert "ShareUrlUpdated" not in kinds(socket, 0.5)
