# SPDX-License-Identifier: Apache-2.0
"""The rates of the equations of every kind, from what acts: flying, turning, field, carried."""

import numpy as np
import pytest
from near import near

from rigid_body_sim.compilation.templates import specialise
from rigid_body_sim.integrators.equations import carried, euler, field, flying, turning
from rigid_body_sim.numerics.rotations import multiply

pytestmark = pytest.mark.without_numba

MASS, START = 2.5, euler.Start(0.3, (0.7, -0.8, 0.9), (1.1, -1.2, 1.3))
Q, OMEGA, PLACE, DRIFT, TIME = (
    (0.1, -0.5, 0.5, 0.7), (1.0, -2.0, 3.0), (4.0, -5.0, 6.0), (7.0, -8.0, 9.0), 0.4)
NONE = (0.0, 0.0, 0.0)
PATH = (0.21, 0.32, -0.43, 1.4, -1.5, 1.6, 17.0, 18.0, 19.0)    # place, velocity, acceleration
ROWS = {name: np.random.default_rng(seed).normal(size=(3, 15)).round(3)
        for seed, name in enumerate(('omega_rate', 'axes_rate', 'force'))}


def linear(name):
    """Return the source of a kernel that is another linear function of each argument."""
    return (f'def {name}(p, *state):\n    return tuple(sum(a * b for a, b in zip(row, state)) '
            f'for row in {ROWS[name].tolist()})\n')


def value(name, *state):
    """Return what such a kernel returns."""
    numbers = np.array([part for one in state for part in np.atleast_1d(one)])
    return ROWS[name][:, :len(numbers)] @ numbers


@pytest.mark.parametrize(('kind', 'unknowns', 'acts', 'moves'), [
    (turning, (Q, OMEGA), (Q, OMEGA, NONE), True),
    (flying, (Q, OMEGA, PLACE, DRIFT), (Q, OMEGA, DRIFT), True),
    (field, (Q, OMEGA, PLACE, DRIFT, TIME), (Q, OMEGA, DRIFT, TIME, PLACE), True),
    (field, (Q, OMEGA, PLACE, DRIFT, TIME), (Q, OMEGA, DRIFT, TIME, PLACE), False),
    (carried, (Q, OMEGA, TIME),
     (Q, OMEGA, PATH[3:6], TIME, np.add(START.place, PATH[:3])), False)],
    ids=['turning', 'flying', 'field', 'held in a field', 'carried'])
def test_the_rates_are_those_of_what_acts_at_the_state(kind, unknowns, acts, moves):
    """Q' = q a/2 for the rate a of the axes, omega' as it is told, x' = v, M v' = F, t' = 1.

    A point that a path carries has the place and the velocity of the path, from its start on.
    """
    bound = {name: linear(name) for name in ('omega_rate', 'axes_rate')}
    if kind in (flying, field):
        bound['force'] = linear('force')
    if kind is carried:
        bound['path'] = f'def path(p, t):\n    return {PATH} if t == {TIME} else None\n'
    p = np.zeros(euler.FIXED)
    p[euler.MASS], p[euler.MOVES] = MASS, float(moves)
    euler.store_start(p, START)
    expected = [*np.multiply(0.5, multiply(*Q, *value('axes_rate', *acts), 0.0)),
                *value('omega_rate', *acts)]
    if kind in (flying, field):
        expected += [*DRIFT, *(value('force', *acts) / MASS * moves)]
    if kind in (field, carried):
        expected += [1.0]
    y = tuple(np.concatenate([np.atleast_1d(one) for one in unknowns]).tolist())
    found = specialise(kind, **bound).rate(p, y)
    # measured: 4e-16
    assert found == near(np.array(expected), rel=4e-15)
