"""The control clock."""

import pytest

from narrows.errors import ShapeError
from narrows.tracking.clock import Clock


def test_a_period_is_the_time_since_the_last_step_and_the_first_is_given() -> None:
    clock = Clock(0.1)
    assert clock.tick(7.0) == 0.1
    assert clock.tick(7.25) == 0.25
    assert clock.tick(7.5) == 0.25


@pytest.mark.parametrize("time", [1.0, 0.5, float("nan")])
def test_a_time_that_does_not_increase_is_refused(time: float) -> None:
    clock = Clock()
    clock.tick(1.0)
    with pytest.raises(ShapeError, match="must increase"):
        clock.tick(time)
