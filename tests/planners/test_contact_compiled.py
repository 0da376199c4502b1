"""Compiled or not, the same contacts are found."""

import math
import subprocess
import sys
from pathlib import Path as File

import numpy as np
import pytest

from narrows.planners.clearance_rows import Rows, rows_along
from narrows.planners.contact_compiled import compiled_contacts
from narrows.planners.contact_finding import WATCH
from narrows.planners.section_motion import SectionMotion
from narrows.planners.spline import Spline
from narrows.vehicle import Vehicle
from narrows.world import Solid, World

SCENES = File(__file__).parents[2] / "examples" / "scenes"
CHAIR = Vehicle.rectangle(1.0, 0.67, 0.25)


def motion(seed: int) -> SectionMotion:
    """Two to three metres that bend within half a metre, either way."""
    rng = np.random.default_rng(seed)
    heading = rng.uniform(-math.pi, math.pi) + np.cumsum(rng.normal(scale=0.25, size=8))
    step = rng.uniform(0.25, 0.4, size=(8, 1))
    legs = step * np.column_stack([np.cos(heading), np.sin(heading)])
    control = np.vstack([[0.0, 0.0], np.cumsum(legs, axis=0)])
    return SectionMotion(Spline(6), control - control[4], int(rng.choice([-1, 1])))


def world(seed: int) -> World:
    """Posts and blocks near the origin, some in the way."""
    rng = np.random.default_rng(seed + 100)
    solids = []
    for _ in range(6):
        x, y = rng.uniform(-1.5, 1.5, 2)
        if rng.random() < 0.5:
            solids.append(Solid.circle(x, y, rng.uniform(0.02, 0.2)))
        else:
            shape = np.array([[0, 0], [0.3, -0.1], [0.35, 0.15], [0.1, 0.2]])
            solids.append(Solid.polygon(shape + np.array([x, y])))
    return World(tuple(solids))


def both(seed: int) -> tuple[Rows, float, Rows, float]:
    course, scene = motion(seed), world(seed)
    plain = rows_along(scene, CHAIR, course, 0.02, samples=97)
    fast = rows_along(scene, CHAIR, course, 0.02, samples=97, finder=compiled_contacts)
    return *plain, *fast


@pytest.mark.parametrize("seed", range(12))
def test_the_least_clearance_is_the_same(seed: int) -> None:
    """To what the plain search narrows it down to: 0.1 mm apart, 1 mm deep in a solid."""
    _, plain, _, fast = both(seed)
    if plain == fast == math.inf:
        return
    assert fast == pytest.approx(plain, abs=1e-4 if plain > 0.0 else 1e-3)
    assert fast <= plain + 1e-9 or plain < 0.0


@pytest.mark.parametrize("seed", range(12))
def test_what_is_near_along_the_way_is_the_same(seed: int) -> None:
    """Places where it is not least stand at the same samples with the same axes."""
    plain, _, fast, _ = both(seed)
    kept = []
    for rows in (plain, fast):
        grid = np.isclose(rows.parameter * 576, np.rint(rows.parameter * 576), atol=1e-9)
        own = rows.take(np.flatnonzero(grid & ~rows.is_least))
        places = zip(own.parameter * 576, own.gap, strict=True)
        kept.append({(round(t), round(g, 7)) for t, g in places if g < WATCH.near})
    common = kept[0] & kept[1]
    assert len(common) >= 0.8 * max(len(kept[0]), len(kept[1]))


def test_a_first_plan_through_an_easy_door_waits_for_no_compiler() -> None:
    """Loading numba takes longer than the whole plan; without its cache, seconds."""
    code = (
        "import sys, narrows;"
        f"plan = narrows.plan(narrows.load_scene({str(SCENES / 'door.yaml')!r}));"
        "print(plan.status.value, 'numba' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["certified", "False"]
