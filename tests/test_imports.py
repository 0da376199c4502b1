"""Imports point down, method rooms stand apart, heavy libraries stay where they belong."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1] / "narrows"

LEVELS = [
    {"", "errors", "files", "se2", "geometry", "bezier"},
    {
        "vehicle",
        "world",
        "section",
        "bezier_section",
        "twist_section",
        "curvature_table",
        "path",
        "profile",
        "trajectory",
        "motion_intervals",
        "moving_clearance",
        "clearance_search",
        "clearance",
        "limit_check",
        "solution",
        "nlp",
        "quadratic",
    },
    {
        "maps",
        "scene_source",
        "scene_text",
        "scene_problems",
        "scene_model",
        "short_forms",
        "vehicle_presets",
        "scene_build",
        "scene_write",
        "scene",
        "interfaces",
        "verification",
    },
    {"planners", "tracking", "perception", "reactive"},
    {"simulation", "formats"},
    {"viewer"},
    {"studies"},
    {"commands", "terminal", "cli"},
]
"""Rooms and files of `narrows` from the ground up; a level knows itself and those below."""

METHOD_ROOMS = LEVELS[3]

OWNERS = {
    "matplotlib": {"viewer"},
    "casadi": {"nlp", "quadratic", "planners", "tracking", "studies"},
    "click": {"cli", "terminal"},
    "tqdm": {"terminal", "studies"},
    "numba": {"planners", "perception", "reactive", "simulation"},
    "pydantic": {"scene_model", "scene_problems"},
    "ruamel": {"scene_text", "scene_write", "maps"},
    "ruckig": {"planners"},
    "viser": {"viewer"},
    "PIL": {"maps", "studies"},
}
"""Libraries that only some rooms may import, at any depth."""

FILES = sorted(ROOT.rglob("*.py"))


def level_of(room: str) -> int:
    found = [number for number, rooms in enumerate(LEVELS) if room in rooms]
    assert found, f"narrows.{room} has no level yet: give it one in this test"
    return found[0]


def module_of(file: Path) -> list[str]:
    parts = list(file.relative_to(ROOT).with_suffix("").parts)
    return parts[:-1] if parts[-1] == "__init__" else parts


def imports_of(file: Path, *, runtime_only: bool = False) -> list[tuple[str, ...]]:
    """Return what a file imports, absolute, such as ("narrows", "planners", "timing")."""
    tree = ast.parse(file.read_text(encoding="utf-8"))
    hidden = {
        id(node)
        for block in ast.walk(tree)
        if isinstance(block, ast.If) and "TYPE_CHECKING" in ast.unparse(block.test)
        for node in ast.walk(block)
    }
    found: list[tuple[str, ...]] = []
    for node in ast.walk(tree):
        if runtime_only and id(node) in hidden:
            continue
        if isinstance(node, ast.Import):
            found += [tuple(alias.name.split(".")) for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = node.module.split(".") if node.module else []
            if node.level:
                package = ["narrows", *module_of(file)]
                if file.name != "__init__.py":
                    package = package[:-1]
                base = package[: len(package) - node.level + 1] + base
            found += [(*base, alias.name) for alias in node.names]
    return found


def room_of(imported: tuple[str, ...]) -> str:
    return imported[1] if len(imported) > 1 else ""


def is_room(name: str) -> bool:
    return (ROOT / name).is_dir() or (ROOT / f"{name}.py").is_file()


@pytest.mark.parametrize("file", FILES, ids=lambda file: str(file.relative_to(ROOT)))
def test_imports_point_down(file):
    module = module_of(file)
    if not module:
        return  # the public names: nothing of it runs at import
    own = level_of(module[0])
    for imported in imports_of(file):
        if imported[0] == "narrows" and is_room(room_of(imported)):
            assert level_of(room_of(imported)) <= own, f"{file.name} looks up to {imported}"


@pytest.mark.parametrize("file", FILES, ids=lambda file: str(file.relative_to(ROOT)))
def test_method_rooms_never_import_each_other(file):
    module = module_of(file)
    if module and module[0] in METHOD_ROOMS:
        others = METHOD_ROOMS - {module[0]}
        rooms = {room_of(imported) for imported in imports_of(file) if imported[0] == "narrows"}
        assert not rooms & others


def test_the_certificate_shares_no_code_with_those_it_judges():
    for name in ("clearance", "motion_intervals", "moving_clearance", "limit_check"):
        rooms = {room_of(i) for i in imports_of(ROOT / f"{name}.py") if i[0] == "narrows"}
        assert not rooms & (METHOD_ROOMS | {"nlp"})


@pytest.mark.parametrize("file", FILES, ids=lambda file: str(file.relative_to(ROOT)))
def test_libraries_stay_where_they_belong(file):
    module = module_of(file)
    for imported in imports_of(file, runtime_only=True):
        owners = OWNERS.get(imported[0])
        assert owners is None or (module and module[0] in owners), f"{file.name}: {imported}"


def test_there_are_no_import_cycles_between_the_files_of_the_vocabulary():
    vocabulary = set().union(*LEVELS[:3]) - {""}
    edges: dict[str, set[str]] = {}
    for file in FILES:
        module = module_of(file)
        if module and module[0] in vocabulary:
            tree = ast.parse(file.read_text(encoding="utf-8"))
            at_import = {id(node) for node in tree.body}
            edges.setdefault(module[0], set()).update(
                room_of(i)
                for i in _imports_of_nodes(file, tree, at_import)
                if room_of(i) in vocabulary and room_of(i) != module[0]
            )
    done: set[str] = set()
    while len(done) < len(edges):
        free = {name for name, needs in edges.items() if name not in done and needs <= done}
        assert free, f"these import each other: {sorted(set(edges) - done)}"
        done |= free


def _imports_of_nodes(file: Path, tree: ast.Module, wanted: set[int]) -> list[tuple[str, ...]]:
    """Return what statements at the top of a file import: what runs when it is imported."""
    found: list[tuple[str, ...]] = []
    for node in tree.body:
        if id(node) in wanted and isinstance(node, ast.ImportFrom) and node.level:
            package = ["narrows", *module_of(file)]
            if file.name != "__init__.py":
                package = package[:-1]
            base = package[: len(package) - node.level + 1]
            base += node.module.split(".") if node.module else []
            found += [(*base, alias.name) for alias in node.names]
    return found


def loaded_by(code: str) -> set[str]:
    """Return the names of the top modules a fresh interpreter has loaded after some code."""
    script = f"import sys\n{code}\nprint(*{{name.split('.')[0] for name in sys.modules}})"
    result = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True, timeout=600
    )
    return set(result.stdout.split())


def test_importing_narrows_loads_nothing_heavy():
    assert not loaded_by("import narrows") & {"numpy", "shapely", "casadi", "matplotlib", "numba"}


def test_the_help_loads_nothing_heavy():
    code = "from narrows.cli import run\nimport io, contextlib\n"
    code += "with contextlib.redirect_stdout(io.StringIO()): run(['--help'])"
    heavy = {"numpy", "shapely", "casadi", "matplotlib", "numba", "scipy", "pydantic", "tqdm"}
    assert not loaded_by(code) & heavy


def test_judging_a_trajectory_needs_no_optimiser_and_no_plots():
    loaded = loaded_by("import narrows.commands.verify")
    assert not loaded & {"casadi", "matplotlib", "numba", "scipy"}
