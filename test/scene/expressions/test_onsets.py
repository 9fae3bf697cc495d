# SPDX-License-Identifier: Apache-2.0
"""Onsets of functions of time: where pulses and switches begin, and of what there are none."""

import numpy as np
import pytest

from rigid_body_sim.scene.expressions import onsets as onset_search
from rigid_body_sim.scene.expressions import reader
from rigid_body_sim.scene.expressions.onsets import MANY, MOST, STRETCHES, onsets
from rigid_body_sim.scene.scene import parse_scene


def of(*texts, **parameters):
    names = {'t', 'x', 'wx', 'angle', *parameters}
    return onsets(tuple(reader.read(text, names, 'x') for text in texts),
                  tuple(parameters.items()))


@pytest.mark.parametrize('width', [1.0, 0.3, 0.02, 1e-5])
@pytest.mark.parametrize('middle', [3.7, 50.0, 1e5])
@pytest.mark.parametrize('text', [
    'exp(-((t - {m})/{w})^2)', '0.1*sin(t) + 5*exp(-((t - {m})/{w})^2)*wx',
    '1/(1 + ((t - {m})/{w})^2)', 'tanh((t - {m})/{w}) - 1', '3/(1 + exp((t - {m})/{w}))'])
def test_steps_end_before_a_pulse_and_within_it(text, middle, width):
    """The first is where the pulse is nothing yet; then they come as close as it is wide."""
    if middle / width > 1e7:
        pytest.skip('the clock hardly resolves it')
    if middle < 40.0 * width:
        pytest.skip('not so long before')
    found = np.array(of(text.format(m=middle, w=width)))
    assert (np.diff(found) > 0.0).all()
    # six widths before its middle a pulse is nothing, but for one that falls with the square
    assert found[0] <= middle - (6.0 if 'exp(-' in text or 'tanh' in text else 2.0) * width
    near = found[np.abs(found - middle) <= 8.0 * width]
    assert len(near) >= 4
    assert np.diff(near).max() <= 4.0 * width
    # beyond the quiet time no gap is longer than what is left up to the pulse
    assert (np.diff(found)[found[1:] < middle - width] <= 1.01 * (
        middle - found[:-1][found[1:] < middle - width])).all()


@pytest.mark.parametrize('text', [
    '3', 't', 'sin(3*t)', 'sin(300*t)^2', 'exp(-t/10)', 'exp(-t)*sin(300*t)', 't*exp(-t)',
    'tanh(t)', 't^3 - 2*t', '1/t', 'log(t)/t', '1/(2 + cos(t))', 'sqrt(t)/(1 + t)', 'wx',
    'exp(-x^2)', 'exp(-((t - x)/0.02)^2)', 'cos(2*t)*exp(-t/5)', 'exp(3)'])
def test_what_changes_from_the_start_on_or_with_the_state_has_none(text):
    assert of(text) == ()


@pytest.mark.parametrize('text', [
    'where(t < 50, 0, 1)', 'exp(-(abs(t - 50)/0.02))', 'tanh(max(0, t - 50)/0.01)'])
def test_kinks_are_located_by_the_body_that_meets_them(text):
    assert of(text) == ()


def test_each_part_has_its_own_and_they_come_in_order():
    pulses = [f'exp(-((t - {middle})/0.02)^2)' for middle in (70, 20)]
    each = sorted({*of(pulses[0]), *of(pulses[1])})
    assert of(*pulses) == of(' + '.join(pulses)) == tuple(each)
    assert of('exp(-((t - m)/w)^2)', m=70.0, w=0.02) == of(pulses[0])


def test_pulses_that_come_again_and_again_are_found_up_to_so_many():
    """sin^64 is more than 1e-15 for 1.9 of each 3.14 s."""
    found = np.array(of('sin(t)^64'))
    assert len(found) == MANY
    middles = np.pi * (np.arange(18) + 0.5)
    assert found[-1] > middles[-1]
    for middle in middles:
        assert (np.abs(found - middle) < 0.95).sum() >= 6
        # before it is more than a hundredth
        assert found[found > middle - np.pi / 2 + 0.1][0] < middle - 0.38


PULSE = '1e-3*exp(-((t - 50)/0.02)^2)'


@pytest.mark.parametrize(('effect', 'constraint'), [
    (f"torque: {{value: [0, '{PULSE}', 0]}}", 'free'),
    (f"force: {{value: [0, '{PULSE}', 0], at: [1, 0, 0]}}", 'free'),
    (f"magnetic: {{moment: [0, 0, 1], field: ['{PULSE}', 0, 0]}}", 'pivot'),
    ('', f"{{pivot: {{motion: [0, 0, '{PULSE}']}}}}")])
def test_steps_end_there_whatever_acts(effect, constraint):
    """The acceleration of a path has the onsets of its own second derivative."""
    body = '{mass: 1, inertia: [1, 2, 3], center_of_mass: [0, 0, 1]}'
    scene = parse_scene(f'scene: s\nbody: {body}\nconstraint: {constraint}\n'
                        f'effects: [{effect}]\ninitial: {{}}\n')
    [acting] = [one for one in scene.acting if one.breakpoints]
    found = np.array(acting.breakpoints)
    assert found[0] < 49.88 and ((found > 49.88) & (found < 50.1)).sum() >= 6
    if effect:
        assert acting.breakpoints == of('exp(-((t - 50)/0.02)^2)')


def test_what_is_lively_throughout_is_one_short_part_from_there_on():
    """A sine of 1e6/s takes all values in any part that is looked at: the search ends at once."""
    def function(times):
        return -np.ones(len(times[0])), np.ones(len(times[0]))
    found = onset_search._parts(function)
    assert found == ([0.0], [STRETCHES[1] / MOST], [False])


def test_a_slope_that_is_constant_but_not_nothing_is_no_rest():
    slope, points = np.array([3.0, 0.0, -3.0]), np.ones((4, 3))
    rests, resolved = onset_search._judged((slope, slope), points * np.abs(slope), 3.0, False)
    assert (rests.tolist(), resolved.tolist()) == ([False, True, False], [True] * 3)
