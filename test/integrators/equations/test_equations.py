# SPDX-License-Identifier: Apache-2.0
"""The source of the switches of what acts: each takes its own values and the state it asks for."""

import types

import numpy as np
import pytest

from rigid_body_sim.integrators.equations.equations import Equations

pytestmark = pytest.mark.without_numba


def two(*arguments):
    """Return what it was called with, for each of two switches."""
    return ('first', arguments), ('second', arguments)


def alone(*arguments):
    """Return what it was called with, for one switch."""
    return (('alone', arguments),)


def acting(kernel, values, modes, in_field):
    """Return what stands for an Acting."""
    return types.SimpleNamespace(switching=kernel and f'{__name__}:{kernel}',
                                 values=(0.0,) * values, modes=[0] * modes, in_field=in_field)


def test_switches_take_the_values_of_their_own_effects():
    """Values stand after the fixed parameters, those of effects without a switch among them."""
    equations = object.__new__(Equations)
    equations.fixed_count = 4
    equations._acting = lambda time: [
        acting('', 2, 0, False), acting('two', 3, 2, False), acting('', 1, 1, True),
        acting('alone', 1, 1, True), acting('alone', 2, 1, False)]
    names = {'compiled': lambda function: function}
    exec(equations.switching_source(), names)
    state, place = tuple(range(100, 110)), tuple(range(110, 114))
    assert names['switching'](np.arange(20.0), *state, *place) == (
        ('first', (6.0, 7.0, 8.0, *state)), ('second', (6.0, 7.0, 8.0, *state)),
        ('alone', (10.0, *state, *place)), ('alone', (11.0, 12.0, *state)))
