"""Where the page listens, and to whom."""

import signal
import socket
import subprocess
import sys

import pytest

from narrows.cli import run
from narrows.errors import InputError
from narrows.viewer.page import check_address, is_own_site


@pytest.mark.parametrize(
    ("origin", "host", "served", "own"),
    [
        ("http://localhost:8080", "localhost:8080", "127.0.0.1", True),
        ("http://127.0.0.1:8080", "127.0.0.1:8080", "127.0.0.1", True),
        ("http://elsewhere.example", "localhost:8080", "127.0.0.1", False),
        ("http://localhost:9090", "localhost:8080", "127.0.0.1", False),
        ("null", "localhost:8080", "127.0.0.1", False),
        # A name of somebody else that was made to lead to this machine:
        ("http://rebound.example:8080", "rebound.example:8080", "127.0.0.1", False),
        ("http://workshop:8080", "workshop:8080", "0.0.0.0", True),
        (None, "localhost:8080", "127.0.0.1", True),
        ("http://localhost:8080", None, "127.0.0.1", False),
    ],
)
def test_only_the_page_itself_is_served(origin, host, served, own):
    assert is_own_site(origin, host, served) is own


@pytest.mark.parametrize(
    ("host", "port", "field"),
    [
        ("no.such.host.invalid", 8080, "--host"),
        ("203.0.113.7", 8080, "--host"),  # an address of documentation, not of this machine
        ("127.0.0.1", 70000, "--port"),
        ("127.0.0.1", -1, "--port"),
    ],
)
def test_an_address_nothing_can_listen_on_is_an_error(host, port, field):
    with pytest.raises(InputError) as caught:
        check_address(host, port)
    assert caught.value.field == field


def test_without_viser_one_line_says_how_to_install_it(monkeypatch, capsys):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    assert run(["view", "--no-open"]) == 2
    told = capsys.readouterr()
    assert told.out == ""
    assert told.err.startswith("narrows: viser is not installed; in narrows' folder, pip")


@pytest.mark.slow
def test_a_port_that_is_taken_is_said_and_the_next_one_served(tmp_path):
    with socket.create_server(("127.0.0.1", 0)) as other:
        taken = other.getsockname()[1]
        command = [sys.executable, "-m", "narrows.cli", "view", "--no-open", "--port", str(taken)]
        page = subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, text=True)
        with page:
            line = page.stdout.readline()
            page.send_signal(signal.SIGINT)
            assert page.wait(60) == 0
    assert f"(port {taken} is taken)" in line
    assert f":{taken} " not in line


@pytest.mark.slow
@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["nowhere.yaml"], "nowhere.yaml: the file cannot be read"),
        (["--host", "203.0.113.7"], "--host: nothing can listen there"),
    ],
)
def test_a_page_that_cannot_be_served_ends_with_a_message(arguments, words):
    command = [sys.executable, "-m", "narrows.cli", "view", "--no-open", *arguments]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert done.returncode == 2
    assert words in done.stderr
    assert "Traceback" not in done.stderr
