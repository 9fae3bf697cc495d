"""Family of the symmetric compositions of flows: split2, split4, split6, split8.

The motion without torques (drift) and what acts at a fixed attitude (kick) are solved alone, exactly, in turn: flows_turning.py,
flows_flying.py, flows_hinged.py. A method is a module with DRIFTS, one more KICKS, and

    step(h) = kick(KICKS[0] h), drift(DRIFTS[0] h), kick(KICKS[1] h), ..., drift(DRIFTS[-1] h), kick(KICKS[-1] h)

Energy of a conservative scene oscillates and its truncation error has no trend (symplectic, symmetric); a forward step of the reversed
motion undoes a step. The sums of kicks are compensated (Kahan) and attitudes made unit; but the closed form of the free rotation is rounded
at each drift, and the energy of the asymmetric heavy top has walked by 1.6e-13 after 1e5 steps of split4 and 1.0e-12 after 1e6 (without the
compensation 3.0e-13 and 5e-13: drifts, not kicks, decide).

Caveats: drag and internal dissipation need kicks that depend on omega; they are solved to order 2 only, and cannot run backward, as the
negative steps of the higher compositions ask: split2 alone runs such scenes. The free rotation of a body of any inertia costs about as much
as eight steps of dop8: compositions are for their long-time behaviour, not for speed.
"""

import numpy as np

from rigid_body_sim.bodies import IDENTITY, Inertia
from rigid_body_sim.integrators import composed, flows_flying, flows_hinged, flows_turning, flying, hinged, quadrature
from rigid_body_sim.integrators.equations import Equations, force_source, torque_source, turning_source
from rigid_body_sim.integrators.one_step import begin, march  # noqa: F401
from rigid_body_sim.motions import free_body
from rigid_body_sim.motions.free_anchor import rotation_parameters
from rigid_body_sim.specialise import specialise


class Flows(Equations):
    """The equations of a scene, with the numbers that the free rotation needs behind the parameters."""

    def parameters(self, fixed, time):
        """Return the parameters that hold just after a time."""
        values = super().parameters(fixed, time)
        if self.kind is hinged:
            return values
        body = np.zeros(free_body.PARAMETER_SIZE)    # in its own frame, without gravity
        rotation = rotation_parameters(Inertia(self.frame.moments, IDENTITY))
        body[:len(rotation)] = rotation
        return np.concatenate([values, body])


equations = Flows


def step_source(method, bound):
    """Return the source of ``step(p, y, c, k0, h) -> (y, c)`` for equations."""
    flows = _flows(bound).__name__
    advance = specialise(composed, drift=f'{flows}:drift', kick=f'{flows}:{"kick_with_heat" if bound.makes_heat else "kick"}',
                         DRIFTS=f'DRIFTS = {method.DRIFTS!r}\n', KICKS=f'KICKS = {method.KICKS!r}\n')
    return f'from {advance.__name__} import advance\n' + quadrature.step_source(method.ORDER, bound.kind.UNKNOWNS, bound.extra)


def _flows(bound):
    """Return the module with drift and kick for equations."""
    if bound.kind is hinged:
        return specialise(flows_hinged, rate=f'{bound.kernels.__name__}:rate')
    acting = {'torque': torque_source(bound.calls), 'turning': turning_source(bound.calls)}
    rotation = specialise(flows_turning, BODY=f'BODY = {bound.parameter_count}\n', **acting)
    if bound.kind is not flying:
        return rotation
    shared = {f'rotation_{name}': f'{rotation.__name__}:{name}' for name in ('drift', 'added', 'turned')}
    return specialise(flows_flying, force=force_source(bound.calls), **acting, **shared)
