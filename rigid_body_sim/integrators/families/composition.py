# SPDX-License-Identifier: Apache-2.0
"""Family of the symmetric compositions of flows: split2, split4, split6, split8.

The motion without torques (drift) and what acts at a fixed attitude (kick) are solved in turn,
each alone and exactly: flows_turning.py, flows_flying.py, flows_hinged.py. A method is a module
with DRIFTS, one more KICKS, and

    step(h) = kick(KICKS[0] h), drift(DRIFTS[0] h), kick(KICKS[1] h), ..., drift(DRIFTS[-1] h),
    kick(KICKS[-1] h)

Energy of a conservative scene oscillates and its truncation error has no trend (symplectic,
symmetric); a forward step of the reversed motion undoes a step. Its rounding error has no trend
either: flows give increments that err by their own rounding, sums carry what they lose, and drifts
hold the kinetic energy with 32 digits (free_turn.py). After a million steps of split4 the energy
of an asymmetric heavy top is within 2e-15 of its scale, most of it truncation and reading; with
plain sums it has lost 3e-13 (bench/energy.py).

Caveats: drag and internal dissipation need kicks that depend on omega; they are solved to order 2
only, and cannot run backward, as the negative steps of the higher compositions would: only split2
runs such scenes. A drift costs about as much as two steps of dop8: compositions are for their
long-time behaviour, not for speed. They take fixed steps only, so they need `step`.
"""

from rigid_body_sim.compilation.templates import specialise
from rigid_body_sim.integrators.equations import (
    flows_flying,
    flows_hinged,
    flows_turning,
    flying,
    hinged,
)
from rigid_body_sim.integrators.equations.equations import (
    force_source,
    torque_source,
    turning_source,
)
from rigid_body_sim.integrators.families.one_step import (  # noqa: F401
    begin,
    bind,
    equations_of,
    march,
)
from rigid_body_sim.integrators.marching import composed
from rigid_body_sim.integrators.protocols import FINEST  # noqa: F401

# what every composition declares as a method (integrators/protocols.py), for its page to import;
# HEAT is that of the higher orders
PRESERVES = ('symplectic form', 'reversal of time')
NEEDS = 'acting'
HEAT = False
FIELD = False
STIFF = ()
TABLE = False
TAKES = ('step',)

ASKS = {'step': ('DRIFTS', 'KICKS')}
TAKES_WRENCH = True
LANES = False
KINKS = True
ROOTS = True


def step_source(method, equations):
    """Return the source of ``step(p, y, c, k0, h) -> (y, c)`` for equations."""
    name = flows(equations).__name__
    return composed_source(
        method,
        f'{name}:drift',
        f'{name}:{"kick_with_heat" if equations.makes_heat else "kick"}',
    )


def composed_source(method, drift, kick):
    """Return the source of a step of other flows, given as `specialise` takes them."""
    made = specialise(
        composed,
        drift=drift,
        kick=kick,
        DRIFTS=f'DRIFTS = {method.DRIFTS!r}\n',
        KICKS=f'KICKS = {method.KICKS!r}\n',
    )
    return f'from {made.__name__} import step\n'


def flows(equations):
    """Return the module with drift and kick for equations."""
    if equations.kind is hinged:
        return specialise(flows_hinged, rate=f'{equations.kernels.__name__}:rate')
    acting = {'torque': torque_source(equations.calls), 'turning': turning_source(equations.calls)}
    rotation = specialise(flows_turning, **acting)
    if equations.kind is not flying:
        return rotation
    shared = {
        f'rotation_{name}': f'{rotation.__name__}:{name}' for name in ('drift', 'added', 'turned')
    }
    return specialise(flows_flying, force=force_source(equations.calls), **acting, **shared)
