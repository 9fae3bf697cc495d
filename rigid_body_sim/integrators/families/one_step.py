# SPDX-License-Identifier: Apache-2.0
"""The common part of families with a kernel ``step``: adaptive and fixed-step marches.

A method with an error estimate is marched by adaptive.py, every other one by fixed.py.
"""

import numpy as np

from rigid_body_sim.compilation.templates import specialise
from rigid_body_sim.integrators.equations.equations import Equations
from rigid_body_sim.integrators.marching import adaptive, bound, fixed, unroll
from rigid_body_sim.integrators.marching.points import SCALES, VALUES, Control
from rigid_body_sim.mechanics.bounds import borne, cancelling

ROUNDING = 2.0 ** -51    # share of the largest angular acceleration
CANCELLED = 2.0 ** -50   # share of an acceleration whose terms may cancel, with that of the place


def equations_of(scene, wrench):
    """Return the equations of a scene that `march` is for."""
    return Equations(scene, wrench)


def bind(method, stepped):
    """Return the method's kernels on the equations of a scene."""
    return bound.Bound(method, stepped)


def march(method, equations, adapts):
    """Return the module that marches: adaptive.py or fixed.py bound to equations and step."""
    groups, kernels = equations.groups, equations.kernels.__name__
    size = equations.kind.UNKNOWNS
    bindings = {'rate': f'{kernels}:rate', 'settled': f'{kernels}:settled',
                'SIZE': f'SIZE = {size}\n',
                'load': unroll.load_source('load', size), 'put': unroll.put_source('put', size)}
    if not adapts:
        return specialise(fixed, step=method.FAMILY.step_source(method, equations), **bindings)
    relative = sum(not absolute for _, _, absolute in groups)
    return specialise(
        adaptive, FLIGHT=f'FLIGHT = {unroll.flight(groups)!r}\n',
        balanced=unroll.balanced_source(groups), fastest=unroll.fastest_source(groups),
        ORDER=f'ORDER = {method.ORDER}\n',
        trial=unroll.trial_source(method, size, 0, groups),
        load_scales=unroll.load_source('load_scales', relative),
        put_scales=unroll.put_source('put_scales', relative), **bindings)


def begin(stepped, march):
    """Return (control, point) of a march, to be copied for each start."""
    point = np.zeros(VALUES + 2 * march.SIZE)
    if stepped.step is None:
        turning, moving = cancelling(stepped.scene, stepped.horizon)
        rounding = ROUNDING * (turning + borne(stepped.scene))
        control = Control(stepped.accuracy / stepped.horizon, 0.0, 0.0)
        set_least_scales(stepped, moving, march.FLIGHT, point)
        return np.array([*control, rounding, moving, *unroll.weights(stepped.method)]), point
    return np.array(Control(0.0, stepped.step, 0.0)), point


def set_least_scales(stepped, acceleration, flight, point):
    """Set the least scales of place and velocity in a point: what rounding makes of them.

    An error of a velocity that is relative to less than a u/tolerance would be the rounding of
    terms that cancel, and so would one of a place relative to that velocity times the horizon.

    Parameters
    ----------
    stepped : Stepped
        It has an accuracy.
    acceleration : float
        a, that of the terms, m/s^2.
    flight : tuple of 2 ints
        Which scales they are (unroll.py); () where there are none.
    point : array
        Changed.
    """
    speed = CANCELLED * acceleration * stepped.horizon / stepped.accuracy
    for place, scale in zip(flight, (speed * stepped.horizon, speed), strict=False):
        point[SCALES + place] = scale * scale
