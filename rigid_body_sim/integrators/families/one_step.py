"""What the families of methods with a kernel ``step`` share: marching, adaptive where the method estimates its error, or by fixed steps."""

import numpy as np

from rigid_body_sim.compilation.templates import specialise
from rigid_body_sim.integrators.marching import adaptive, fixed, unroll


def march(method, bound, adapts):
    """Return the module that marches: adaptive.py or fixed.py bound to equations and to the step of the method."""
    size, groups, kernels = bound.kind.UNKNOWNS + bound.extra, bound.kind.GROUPS, bound.kernels.__name__
    bindings = {'rate': f'{kernels}:rate', 'settled': f'{kernels}:settled', 'SIZE': f'SIZE = {size}\n',
                'load': unroll.load_source('load', size), 'put': unroll.put_source('put', size)}
    if not adapts:
        return specialise(fixed, step=method.FAMILY.step_source(method, bound), **bindings)
    relative = sum(not absolute for _, _, absolute in groups)
    return specialise(
        adaptive, fastest=unroll.fastest_source(groups), ORDER=f'ORDER = {method.ORDER}\n',
        trial=unroll.trial_source(method, bound.kind.UNKNOWNS, bound.extra, groups),
        load_scales=unroll.load_source('load_scales', relative), put_scales=unroll.put_source('put_scales', relative), **bindings)


def begin(stepped, kernels):
    """Return (control, node) of a march, to be copied for each start."""
    node = np.zeros(adaptive.VALUES + 2 * kernels.SIZE)
    return np.array([stepped.accuracy / stepped.horizon] if stepped.step is None else [stepped.step, 0.0]), node
