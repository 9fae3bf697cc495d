# SPDX-License-Identifier: Apache-2.0
"""The table of scenes: the check of each, and how long its two ways of solving are compared."""

from dataclasses import dataclass

from rigid_body_sim.study.scenes import (
    asymmetric_top,
    baseball_bat,
    billiard,
    chandler_wobble,
    convex_body,
    degenerate,
    driven_body,
    fast_top,
    free_body,
    heavy_top,
    kapitza_pendulum,
    kater_pendulum,
    librating_satellite,
    major_axis_relaxation,
    sleeping_top,
    steady_precession,
    symmetric_top,
    tennis_racket,
)
from rigid_body_sim.study.scenes.experiment import ACCURACY


@dataclass(frozen=True)
class System:
    """The check of a scene.

    Attributes
    ----------
    check : callable
        (Experiment) -> Quantities.
    seconds : float
        Span over which the exact motion and the smooth method on the full equations are compared.
    tolerance : float
        Tolerance of that comparison: attitude in rad, omega relative to its largest size.
    accuracy : float
        Accuracy asked of the smooth method, rad in 100 s.
    """

    check: object
    seconds: float
    tolerance: float = 1e-9
    accuracy: float = ACCURACY


SYSTEMS = {
    **{
        f'billiard_{name}': System(billiard.check, 2.0)
        for name in ('center', 'low', 'natural_roll', 'follow')
    },
    **dict.fromkeys(
        ('kater_pendulum', 'kater_pendulum_from_p'), System(kater_pendulum.check, 20.0)
    ),
    'baseball_bat': System(baseball_bat.check, 10.0),
    'driven_body': System(driven_body.check, 10.0),
    'free_body': System(free_body.check, 100.0),
    'symmetric_top': System(symmetric_top.check, 100.0),
    'chandler_wobble': System(chandler_wobble.check, 3.0 * 305.0 * 86164.0905, accuracy=1e-15),
    'asymmetric_top': System(asymmetric_top.check, 100.0),
    'tennis_racket': System(tennis_racket.check, 40.0),
    'major_axis_relaxation': System(major_axis_relaxation.check, 100.0),
    'heavy_top': System(heavy_top.check, 20.0),
    'steady_precession': System(steady_precession.check, 20.0),
    'fast_top': System(fast_top.check, 20.0),
    **dict.fromkeys(('sleeping_top', 'falling_top'), System(sleeping_top.check, 40.0)),
    **{
        name: System(getattr(convex_body, name), 10.0)
        for name in ('rolling_disk', 'euler_disk', 'rattleback', 'tippe_top', 'rising_egg',
                     'routh_sphere', 'chaplygin_sphere', 'tossed_coin')
    },
    'kapitza_pendulum': System(kapitza_pendulum.check, 2.0),
    'librating_satellite': System(librating_satellite.check, 20000.0),
    **{
        name: System(getattr(degenerate, name), 20.0)
        for name in ('thin_rod', 'sphere', 'needle', 'spherical_pendulum')
    },
}
