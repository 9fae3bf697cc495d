# SPDX-License-Identifier: Apache-2.0
"""Check of a top in the minimum of its effective potential.

Notes, "Small oscillations about equilibrium": slow and fast precession without nutation.
"""

import numpy as np

from rigid_body_sim.errors import BadInput
from rigid_body_sim.study.scenes import instruments
from rigid_body_sim.study.scenes.heavy_top import Top, small_nutation
from rigid_body_sim.study.scenes.quantity import Quantity
from rigid_body_sim.theory import heavy_top as theory

SECONDS = 10.0


def check(run):
    """Yield the quantities of both steady precessions at the tilt and spin of the scene.

    Small nutations about the slow one follow.
    """
    top = Top(run)
    spin = top.P_gamma / top.I3
    with np.errstate(invalid='ignore'):
        rates = theory.steady_precession_rates(top.beta, spin, top.I1, top.I3, top.Mgl)
    if not np.all(np.isfinite(rates)):
        raise BadInput(run.scene.name, f'tilt {top.beta:.6g} rad, spin {spin:.6g} rad/s',
                       'steady precession at this tilt needs more spin')
    for name, rate in zip(('slow', 'fast'), rates, strict=True):
        steady = run.variant(_start(top.beta, rate, spin))
        times = np.linspace(0.0, SECONDS, 501)
        states = steady.states(times)
        momenta = Top(steady).momenta
        yield Quantity(f'tilt at 501 times, {name} precession',
                       np.full(501, theory.equilibrium_tilt(*momenta, top.I1, top.Mgl)),
                       instruments.beta(states), 1e-11, 'rad')
        turned = np.unwrap(instruments.alpha(steady.states(np.linspace(
            0.0, SECONDS, int(8 * abs(rate) * SECONDS) + 9))))
        yield Quantity(
            f"alpha', {name} precession", rate, (turned[-1] - turned[0]) / SECONDS, 1e-11, 'rad/s')
    slow = run.variant(_start(top.beta, rates[0], spin))
    top = Top(slow)
    Omega = theory.nutation_frequency(top.beta, *top.momenta, top.I1, top.Mgl)
    yield Quantity(
        'Omega^2 of the notes at beta_0',
        theory.nutation_frequency_squared_of_notes(top.beta, *top.momenta, top.I1, top.Mgl),
        Omega**2, 1e-9, '(rad/s)^2',
        detail='against the curvature of V_eff, which the small nutations below confirm')
    yield from small_nutation(run, top, rates[0])
    yield from _level(run, top)


def _start(tilt, rate, spin):
    """Return the start of a steady precession: no beta', and alpha' = rate."""
    return {'initial.euler_zyz': [0.0, tilt, 0.0],
            'initial.angular_velocity': [-rate * np.sin(tilt), 0.0, spin]}


def _level(run, top):
    """Yield the same at 90 degrees, where the notes' formula has a zero in its denominator."""
    tilt, spin = 0.5 * np.pi, top.P_gamma / top.I3
    rate = theory.steady_precession_rates(tilt, spin, top.I1, top.I3, top.Mgl)[0]
    level = run.variant(_start(tilt, rate, spin))
    for quantity in small_nutation(level, Top(level), rate):
        yield Quantity(
            f'at 90 degrees: {quantity.name}', quantity.predicted, quantity.measured,
            quantity.tolerance, quantity.unit, absolute=quantity.absolute, detail=quantity.detail)
