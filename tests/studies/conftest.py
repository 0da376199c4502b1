"""What the tests of the studies share."""

import importlib
from pathlib import Path

import pytest


@pytest.fixture
def functions(monkeypatch):
    """Case functions in a module that worker processes find on the path they inherit."""
    monkeypatch.syspath_prepend(str(Path(__file__).parent))
    return importlib.import_module("sweep_cases")
