"""How a timed motion feels to who sits in the chair: accelerations, jerk, weighted vibration."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from narrows.limit_check import LimitCheck
from narrows.se2 import Array
from narrows.trajectory import Trajectory

_RATE = 250.0  # Hz; the weighting ends at 100 Hz, and little is left there
_TAIL = 10.0  # s of silence after the motion, in which the filter rings out


@dataclass(frozen=True)
class RideComfort:
    """What the chair's motion does to its occupant.

    Accelerations are those of the body origin, midway between the drive wheels: dv/dt along the
    chair and v omega across it. Turning on the spot has neither.

    Attributes:
        rms_acceleration: Root mean square over time of both together [m/s^2].
        rms_jerk: Root mean square over time of the third derivative of the distance travelled,
            turns on the spot at rest [m/s^3].
        weighted_acceleration: Root mean square of both, weighted by frequency for seated people
            in horizontal directions (W_d of ISO 2631-1) [m/s^2].
    """

    rms_acceleration: float
    rms_jerk: float
    weighted_acceleration: float


def ride_comfort(trajectory: Trajectory) -> RideComfort:
    """Return the comfort figures of a smooth trajectory."""
    path, profile = trajectory.path, trajectory.profile
    time = np.arange(0.0, trajectory.duration, 1.0 / _RATE)
    s, rate = trajectory.progress(time), trajectory.progress(time, 1)
    direction = path.directions[path.section_index(s)]
    kappa, _ = path.curvature_table(s)
    along = direction * trajectory.progress(time, 2)
    across = np.where(direction == 0, 0.0, direction * kappa * rate**2)
    steps = np.diff(profile.breaks)
    middle = 0.5 * (profile.breaks[1:] + profile.breaks[:-1])
    driven = path.directions[path.section_index(trajectory.progress(middle))] != 0
    jerk = 6.0 * profile.coefficients[driven, 3]
    return RideComfort(
        float(np.sqrt((along**2 + across**2).sum() / _RATE / trajectory.duration)),
        float(np.sqrt((jerk**2 * steps[driven]).sum() / trajectory.duration)),
        weighted_rms(np.stack([along, across]), _RATE, trajectory.duration),
    )


def horizontal_weighting(frequency: ArrayLike) -> Array:
    """Return the frequency weighting W_d of horizontal vibration of seated people, (...).

    The magnitude of three filters in a row: second-order Butterworth high pass at 0.4 Hz and low
    pass at 100 Hz, and the step from acceleration to velocity
    (1 + s / w3) / (1 + s / (Q4 w4) + s^2 / w4^2) with w3 = w4 = 2 pi 2 Hz, Q4 = 0.63
    [HVM200, Table 3.1].

    >>> horizontal_weighting([1.0, 15.915]).round(3)
    array([1.011, 0.126])

    Args:
        frequency: Frequencies, shape (...), 0 or more [Hz].
    """
    f = np.asarray(frequency, dtype=float)
    high = f**2 / np.sqrt(f**4 + 0.4**4)
    low = 1.0 / np.sqrt(1.0 + (f / 100.0) ** 4)
    x = f / 2.0
    step = np.sqrt((1.0 + x**2) / ((1.0 - x**2) ** 2 + (x / 0.63) ** 2))
    return np.asarray(high * low * step)


def weighted_rms(acceleration: ArrayLike, rate: float, duration: float) -> float:
    """Return the root mean square of weighted accelerations, over directions and a duration.

    By Parseval's theorem, with silence appended for the filter to ring out in: what rings after
    the motion's end counts as its.

    Args:
        acceleration: Samples in D directions, shape (D, N), [m/s^2].
        rate: Samples a second [Hz].
        duration: Duration of the motion [s].
    """
    samples = np.asarray(acceleration, dtype=float)
    count = 1 << int(np.ceil(np.log2(samples.shape[1] + _TAIL * rate)))
    spectrum = np.fft.rfft(samples, count) * horizontal_weighting(
        np.fft.rfftfreq(count, 1.0 / rate)
    )
    power = np.abs(spectrum) ** 2
    total = 2.0 * power.sum() - power[:, [0, -1]].sum()  # both halves of the spectrum
    return float(np.sqrt(total / count / rate / duration))


def ride_figures(trajectory: Trajectory, check: LimitCheck) -> dict[str, float]:
    """Return the figures of a plan's ride, for `Plan.statistics`."""
    comfort = ride_comfort(trajectory)
    return {
        "peak_acceleration_m_s2": check.peaks["acceleration"],
        "peak_jerk_m_s3": check.peaks["jerk"],
        "rms_acceleration_m_s2": comfort.rms_acceleration,
        "rms_jerk_m_s3": comfort.rms_jerk,
        "weighted_acceleration_m_s2": comfort.weighted_acceleration,
    }
