"""The ledger: what a body has now, what it had at the start, and what was given to it and taken from it in between must balance."""

import math

from rigid_body_sim.mechanics.energy import KINETIC, MOMENTUM, MOMENTUM_SQUARED, POTENTIAL
from rigid_body_sim.mechanics.exchange import ANGULAR_IMPULSE, DISSIPATED, WORK
from rigid_body_sim.numerics.functions import hypot3


def balance(start, now, given):
    """Return the balance of energy (J) and angular momentum, as a dict of floats.

    ``energy_residual`` is what the terms leave over, relative to the largest of |kinetic|, |potential|, |work|; ``momentum_residual`` is
    |L - L(0) - angular impulse| relative to the largest of the three.

    Parameters
    ----------
    start, now : array (6,)
        See energy.diagnose.
    given : array
        What was exchanged between the two (exchange.py).
    """
    work, dissipated, impulse = given[WORK], given[DISSIPATED], given[ANGULAR_IMPULSE]
    left = math.fsum((now[KINETIC], now[POTENTIAL], dissipated, -start[KINETIC], -start[POTENTIAL], -work))
    scale = max(now[KINETIC], abs(now[POTENTIAL]), abs(work), start[KINETIC], abs(start[POTENTIAL]))
    missing = hypot3(*(now[MOMENTUM:] - start[MOMENTUM:] - impulse))
    size = max(hypot3(*vector) for vector in (now[MOMENTUM:], start[MOMENTUM:], impulse))
    return {'kinetic': float(now[KINETIC]), 'potential': float(now[POTENTIAL]), 'dissipated': float(dissipated), 'work': float(work),
            'energy_residual': float(left / scale) if scale > 0.0 else 0.0,
            'angular_momentum_squared': float(now[MOMENTUM_SQUARED]),
            'momentum_residual': float(missing / size) if size > 0.0 else 0.0}
