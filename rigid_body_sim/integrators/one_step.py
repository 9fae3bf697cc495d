"""What the families of methods with a kernel ``step`` share: marching, adaptive where the method estimates its error, or by fixed steps."""

import math

import numpy as np

from rigid_body_sim.integrators import adaptive, fixed, unroll
from rigid_body_sim.specialise import specialise


def march(method, bound, adapts):
    """Return the module that marches: adaptive.py or fixed.py bound to equations and to the step of the method."""
    size, groups, kernels = bound.kind.UNKNOWNS + bound.extra, bound.kind.GROUPS, bound.kernels.__name__
    bindings = {'rate': f'{kernels}:rate', 'settled': f'{kernels}:settled', 'SIZE': f'SIZE = {size}\n',
                'step': method.FAMILY.step_source(method, bound),
                'load': unroll.load_source('load', size), 'put': unroll.put_source('put', size)}
    if not adapts:
        return specialise(fixed, **bindings)
    relative = sum(not absolute for _, _, absolute in groups)
    return specialise(
        adaptive, trial=unroll.trial_source(method, bound.kind.UNKNOWNS, bound.extra, groups), ORDER=f'ORDER = {method.ORDER}\n',
        load_scales=unroll.load_source('load_scales', relative), put_scales=unroll.put_source('put_scales', relative), **bindings)


def begin(stepped, bound, kernels, p, y, time):
    """Return (control, node) at the start of a march from the unknowns y (books included)."""
    node = np.concatenate([np.zeros(adaptive.VALUES), y, np.zeros(len(y))])
    node[adaptive.TIME] = time
    if stepped.step is not None:
        return np.array([stepped.step, time]), node
    tolerance = stepped.accuracy / stepped.horizon
    node[adaptive.STEP] = math.pow(tolerance, 1.0 / stepped.method.ORDER) / fastest_rate(bound, p, y)
    return np.array([tolerance]), node


def fastest_rate(bound, p, y):
    """Return the largest rate of change of a group of unknowns relative to its scale, 1/s; 10 where nothing can be said."""
    rates = np.array(bound.kernels.rate(p, tuple(y.tolist())))
    found = [0.0]
    for first, last, absolute in bound.kind.GROUPS:
        scale, change = 1.0 if absolute else math.hypot(*y[first:last]), math.hypot(*rates[first:last])
        found.append(change / scale if scale > 0.0 else 0.0)
    return max(found) or 10.0
