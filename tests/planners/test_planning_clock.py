"""The clock of planning leaves out imports, and nothing else."""

import time

import pytest

from narrows.planners.planning_clock import PlanningClock


def burn(seconds: float) -> None:
    end = time.process_time() + seconds
    while time.process_time() < end:
        pass


def test_what_is_loaded_is_left_out_once_and_the_rest_counts() -> None:
    clock = PlanningClock()
    begun, all_begun = clock.now(), time.process_time()
    burn(0.02)
    with clock.loading():
        burn(0.03)
        with clock.loading():
            burn(0.05)
    counted, spent = clock.now() - begun, time.process_time() - all_begun
    # 0.08 s were left out, and a little for entering and leaving
    assert counted == pytest.approx(spent - 0.08, abs=5e-3)


def test_an_import_that_fails_is_left_out_too() -> None:
    clock = PlanningClock()
    with pytest.raises(ImportError), clock.loading():
        raise ImportError
    begun = clock.now()
    burn(0.01)
    assert clock.now() - begun >= 0.01


def test_the_first_call_of_compiled_code_is_left_out_and_later_ones_count() -> None:
    class Compiled:
        signatures: tuple[str, ...] = ()

    clock, function = PlanningClock(), Compiled()
    begun = clock.now()
    with clock.loading_of(function):
        burn(0.03)
    assert clock.now() - begun < 5e-3
    function.signatures = ("float64(float64)",)
    with clock.loading_of(function):
        burn(0.03)
    assert clock.now() - begun >= 0.03
