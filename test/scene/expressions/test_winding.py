# SPDX-License-Identifier: Apache-2.0
"""Which expressions are others after two turns of a hinge, where its angle goes on from -2 pi."""

import pytest

from rigid_body_sim.scene.expressions.reader import read
from rigid_body_sim.scene.expressions.winding import jumps

NAMES = {'angle', 't', 'k', 'half'}
KNOWN = ('k', 1.5), ('half', 0.5)


@pytest.mark.parametrize('text', [
    '3*t', 'sin(angle)', 'cos(angle/2 + t)', 'tan(2*angle)', 'sin(-angle)', 'sin(3 - angle)',
    'angle - angle', '2*angle - angle*2', '-angle + angle', 'angle/half - 2*angle',
    'sin(k*angle)', 'sin(angle*k)', 'cos(angle/half)', 'cos(angle*(2 - k))', 'sin(angle*(k + 2))',
    'sin(-k*angle)', 'sin(0.25*(2*angle))', 'cos(6/3*angle/4)', 'cos(k*half*angle + 0.75*angle)',
    'exp(sin(angle))', 'sin(angle)*t', 't/(2 + cos(angle))', '2*t*cos(angle)^3',
    'sin(angle + sin(angle))'])
def test_what_has_the_period_of_two_turns_does_not_jump(text):
    assert not jumps((read(text, NAMES, 'here'),), KNOWN)


@pytest.mark.parametrize('text', [
    'angle', 'angle + angle', '3 - angle', 'cos(angle/3)', 'sin(angle/4)', 'sin(angle/k)',
    'sin(half*half*angle)', 'sin(angle*(k - 1.2))', 'angle*cos(angle)', 't*angle', 'angle*t',
    'angle/t', '2/angle', 't/angle', 'exp(angle)', 'angle^2', 'cos(t*angle)', 'k*angle - angle',
    'sin(angle)*angle', 'cos(angle*(2*half/4))'])
def test_what_has_not_jumps(text):
    assert jumps((read(text, NAMES, 'here'),), KNOWN)
    # one of several is enough
    assert jumps((read('t', NAMES, 'here'), read(text, NAMES, 'here')), KNOWN)


def test_a_parameter_of_that_name_is_a_number():
    assert not jumps((read('angle^2', NAMES, 'here'),), (('angle', 2.0),))
