"""What the pages show is run: commands, Python, links and keys of references."""

import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from narrows.cli import run

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
SHOWN = [ROOT / "README.md", ROOT / "docs" / "command-line.md", ROOT / "docs" / "python.md"]


def blocks(page: Path, language: str) -> list[str]:
    """Return the fenced blocks of a language on a page."""
    text = page.read_text(encoding="utf-8")
    return re.findall(rf"^```{language}\n(.*?)^```", text, flags=re.MULTILINE | re.DOTALL)


def commands(page: Path) -> list[list[str]]:
    """Return the `narrows` commands a page shows, split into words."""
    lines = [line for block in blocks(page, "sh") for line in block.splitlines()]
    return [shlex.split(line, comments=True) for line in lines if line.startswith("narrows ")]


@pytest.fixture
def beside_the_examples(tmp_path, monkeypatch):
    """A folder that has the examples, as the pages assume, and may be written to."""
    shutil.copytree(ROOT / "examples", tmp_path / "examples")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.slow
@pytest.mark.parametrize("page", SHOWN, ids=lambda page: page.name)
def test_the_commands_shown_run_in_their_order(page, beside_the_examples, capsys):
    for words in commands(page):
        assert run(words[1:]) == 0, words
        assert "Traceback" not in capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.parametrize("page", SHOWN, ids=lambda page: page.name)
def test_the_python_shown_runs(page, beside_the_examples):
    for block in blocks(page, "python"):
        done = subprocess.run(
            [sys.executable, "-W", "error", "-c", block],
            capture_output=True,
            text=True,
            timeout=600,
            check=False,
        )
        assert done.returncode == 0, done.stderr


def test_pages_show_commands_and_python():
    assert len(commands(ROOT / "README.md")) >= 4
    assert len(commands(ROOT / "docs" / "command-line.md")) >= 8
    assert all(blocks(page, "python") for page in (SHOWN[0], SHOWN[2]))


def test_the_readme_begins_with_the_demo_and_then_the_tests():
    first, second = blocks(ROOT / "README.md", "sh")[0].splitlines()
    assert first.startswith("make demo ")
    assert second.startswith("make test ")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page):
    for target in re.findall(r"\]\(([^)#]+)[^)]*\)", page.read_text(encoding="utf-8")):
        if "://" not in target:
            assert (page.parent / target).exists(), f"{page.name}: {target}"


def test_every_key_cited_is_in_the_references():
    known = set(
        re.findall(r"\*\*\[(\w+)\]\*\*", (ROOT / "docs" / "references.md").read_text("utf-8"))
    )
    files = [*(ROOT / "narrows").rglob("*.py"), *(ROOT / "narrows").rglob("*.yaml")]
    cited = {
        key
        for file in files
        for key in re.findall(
            r"\[([A-Z][A-Za-z]+\d{0,4}), (?:Eq|Sec|Fig|Tab|Ch)", file.read_text("utf-8")
        )
    }
    assert "DoorBezier" in cited
    assert cited <= known, f"missing in docs/references.md: {sorted(cited - known)}"
