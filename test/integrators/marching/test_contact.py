# SPDX-License-Identifier: Apache-2.0
"""What a body on a plane is bound to, and which scenes are refused there in one line."""

import numpy as np
import pytest
from near import near

from rigid_body_sim.errors import BadInput
from rigid_body_sim.integrators import METHODS
from rigid_body_sim.integrators.marching.contact import OnPlane, UnderWeight
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.scene import parse_scene

pytestmark = pytest.mark.without_numba
OF_TIME = "torque: {value: [0, 0, '0.01*sin(t)']}"
STEADY = 'torque: {value: [0, 0, 0.01]}'


def on_plane(effects='', surface='sphere: {radius: 0.1}', wrench=None, of=OnPlane, table='table'):
    scene = parse_scene(
        f'scene: a\nbody: {{mass: 0.5, inertia: [0.01, 0.01, 0.01], surface: {{{surface}}}}}\n'
        f'constraint: {table}\neffects: [gravity: {{g: 9.81}}, sliding_friction: {{mu: 0.3}}'
        f'{"".join(f", {one}" for one in effects)}]\ninitial: {{angular_velocity: [1, 0, 0]}}\n')
    return of(scene, METHODS['dop8'], *([wrench] if of is OnPlane else []), None)


@pytest.mark.parametrize(('effects', 'timed'), [
    ((), False), ((STEADY,), False), ((OF_TIME,), True), ((STEADY, OF_TIME), True)])
def test_one_effect_of_time_makes_it_timed(effects, timed):
    assert on_plane(effects).is_timed is timed


@pytest.mark.parametrize(('friction', 'refused'), [
    ('rolling_friction: {dry: 0.01}', True), ('rolling_friction: {viscous: 0.01}', False)])
def test_what_friction_may_stop_takes_nothing_of_time(friction, refused):
    if refused:
        with pytest.raises(BadInput, match='a: effects: an expression of time for a body on a pl'):
            on_plane((OF_TIME, friction))
    else:
        assert on_plane((OF_TIME, friction)).is_timed
    assert not on_plane((STEADY, friction)).is_timed


def test_kinks_and_what_turns_the_axes_are_refused():
    with pytest.raises(BadInput, match='a: effects: an expression with a kink'):
        on_plane((STEADY, "torque: {value: [0, 0, '0.01*abs(wz)']}"))
    with pytest.raises(BadInput, match=r'step: got 0\.01 for a body on a plane'):
        OnPlane(on_plane().scene, METHODS['dop8'], None, 0.01)


@pytest.mark.parametrize(('surface', 'disk', 'torus'), [
    ('sphere: {radius: 0.1}', False, False), ('disk: {radius: 0.1}', True, False),
    ('torus: {radius: 0.1, tube: 0.02}', False, True)])
def test_a_bound_knows_its_surface(surface, disk, torus):
    bound = on_plane(surface=surface)
    assert (bound.is_disk, bound.is_torus) == (disk, torus)
    assert bound.heaviness == near(9.81, rel=1e-15)


def test_values_of_what_acts_follow_the_numbers_of_the_contact_and_change_at_breakpoints():
    pieces = 'torque: {times: [1.0, 2.0], values: [[0.1, 0, 0], [0.2, 0.3, 0]]}'
    bound = on_plane((pieces,), wrench=Wrench((0.0, 0.0, 0.0), (0.0, 0.0, 0.7)))
    assert bound.breakpoints == [1.0, 2.0]
    before, first, last = (bound.parameters(time) for time in (0.5, 1.0, 2.5))
    number = len(bound._fixed)
    for values, torque in (before, (0, 0, 0)), (first, (0.1, 0, 0)), (last, (0.2, 0.3, 0)):
        assert values[:number].tolist() == bound._fixed.tolist()
        assert set(torque) <= set(values[number:].tolist())
        assert 0.7 in values[number:]
        assert len(values) == len(before)
    first[:] = 0.0    # the caller's own
    assert bound.parameters(1.5)[:number].tolist() == bound._fixed.tolist()


@pytest.mark.parametrize('table', ['table', '{table: {normal: [0.6, 0.0, 0.8]}}'])
def test_the_weight_stands_last_along_the_axes_of_the_plane(table):
    bound = on_plane(of=UnderWeight, table=table)
    tilted = table != 'table'
    weight = bound.parameters(0.0)[-3:]
    assert np.linalg.norm(weight) == near(0.5 * 9.81, rel=1e-15)
    assert weight[2] == near(-0.5 * 9.81 * (0.8 if tilted else 1.0), rel=4e-16)
