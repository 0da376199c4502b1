"""Every script in `examples/` runs as it is shown, and says something."""

import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parents[1] / "examples"
SCRIPTS = sorted(path.relative_to(EXAMPLES) for path in EXAMPLES.rglob("*.py"))


@pytest.mark.slow
@pytest.mark.parametrize("script", SCRIPTS, ids=str)
def test_the_example_runs(script, tmp_path):
    command = [sys.executable, "-W", "error", str(EXAMPLES / script)]
    done = subprocess.run(
        command, cwd=tmp_path, capture_output=True, text=True, timeout=600, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    if script.parent == Path("."):
        assert done.stdout.strip()


def test_every_example_is_named_in_the_list():
    listed = (EXAMPLES / "README.md").read_text(encoding="utf-8")
    for script in SCRIPTS:
        if script.parent == Path("."):
            assert f"`{script}`" in listed
