# SPDX-License-Identifier: Apache-2.0
"""What effects tell beside their forces: bounds, contacts, opposites and warnings, by hand."""

import math

import numpy as np
import pytest
from near import near

from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.effects import EFFECTS, sliding_friction
from rigid_body_sim.scene.effects.protocol import (
    Acting,
    Bounds,
    Contact,
    Effect,
    Formulas,
    Pull,
)
from rigid_body_sim.scene.expressions.tree import ZERO
from rigid_body_sim.scene.scene import parse_scene

TENSOR = np.array([[0.3, 0.01, 0.02], [0.01, 0.4, -0.03], [0.02, -0.03, 0.5]])
CENTER, THROUGH, AT = np.array([[0.1, -0.2, 0.3], [0.2, 0.1, -0.1], [0.4, -0.1, 0.7]])
CONSTRAINTS = {'free': 'free', 'pivot': 'pivot',
               'hinge': f'{{hinge: {{axis: [1, 2, 2], through: {THROUGH.tolist()}}}}}'}
POINTS = {'free': CENTER, 'pivot': np.zeros(3), 'hinge': THROUGH}
SLIDES = 'gravity: {g: 9.8}, sliding_friction: {mu: 0.2}'


def scene_of(effects, constraint='free', body=None):
    body = body or f'inertia: {TENSOR.tolist()}, center_of_mass: {CENTER.tolist()}'
    return parse_scene(
        f'scene: s\nparameters: {{k: 1.7}}\nbody: {{mass: 2, {body}}}\n'
        f'constraint: {CONSTRAINTS.get(constraint, constraint)}\neffects: [{effects}]\n'
        'initial: {}\n')


def bounds(effects, kind):
    scene = scene_of(effects, kind)
    return scene.effects[0].bounds(scene.body, scene.constraint)


def is_near(found, energy, torque):
    return found.energy == near(energy, 1e-13) and found.torque == near(torque, 1e-13)


@pytest.mark.parametrize('kind', CONSTRAINTS)
@pytest.mark.parametrize(('g', 'size'), [('9.81', 9.81), ('[2, -3, 6]', 7.0)])
def test_a_held_weight_has_half_the_range_of_its_energy(kind, g, size):
    """It is M g r, r from the point that is held to the centre of mass."""
    reach = np.linalg.norm(CENTER - POINTS[kind])    # 0 of a free body
    assert is_near(bounds(f'gravity: {{g: {g}}}', kind), 2.0 * size * reach, 0.0)


@pytest.mark.parametrize('kind', CONSTRAINTS)
@pytest.mark.parametrize(('at', 'point'), [('', CENTER), (f', at: {AT.tolist()}', AT)])
def test_a_force_has_a_potential_where_it_and_a_point_are_fixed_in_the_world(kind, at, point):
    most = 7.0 * np.linalg.norm(point - POINTS[kind])
    force = f'force: {{value: [2, -3, 6]{at}, frame: '
    held = kind != 'free'
    assert is_near(bounds(f'{force}world}}', kind), most * held, most * (not held))
    assert is_near(bounds(f'{force}body}}', kind), 0.0, most)
    assert scene_of(f'force: {{value: [2, "k*t", 6]{at}}}', kind).effects[0].bounds is None


def test_a_torque_in_pieces_is_bounded_by_its_largest_one():
    found = bounds('torque: {times: [1, 2.5, 4], values: [[2, -3, 6], [0, 3, 4], [1, 2, 2]]}',
                   'free')
    assert found[:3] == (0.0, 7.0, ((1.0, 7.0), (2.5, 5.0), (4.0, 3.0)))
    assert 0.0 < found.share < 1.0


def test_a_gradient_has_half_the_range_of_its_energy_and_on_an_orbit_a_torque():
    """U = (3 mu/(2 r^3)) n . I n between the least and the largest moment."""
    moments = np.linalg.eigvalsh(TENSOR)
    range_ = 1.5 * 5.0 / 27.0 * (moments[2] - moments[0])
    assert is_near(bounds('gravity_gradient: {mu: 5, position: [2, -1, 2]}', 'free'),
                   0.5 * range_, 0.0)
    range_ = 1.5 * 1.3 ** 2 * (moments[2] - moments[0])
    orbit = 'gravity_gradient: {orbit: {rate: 1.3, normal: [1, 2, -2], toward: [4, -4, -2]}}'
    assert is_near(bounds(orbit, 'free'), 0.5 * range_, range_)


def test_a_magnet_in_a_uniform_field_has_the_range_of_its_energy():
    magnet = 'magnetic: {moment: [2, -3, 6], field: '
    assert bounds(f'{magnet}[0.4, 0.4, -0.2]}}', 'pivot') == Bounds(near(4.2, 1e-15), 0.0)
    assert bounds(f'{magnet}[x, 0.4, -0.2]}}', 'free') == Bounds(0.0, 0.0)


@pytest.mark.parametrize('off', [0.0, 0.8e-9, -0.8e-9, 1.2e-9, -1.2e-9])
def test_the_direction_of_an_orbit_is_square_to_its_normal_up_to_rounding(off):
    toward = (np.array([4.0, -4.0, -2.0]) + 2.0 * off * np.array([1.0, 2.0, -2.0])).tolist()
    effects = f'gravity_gradient: {{orbit: {{rate: 1.3, normal: [1, 2, -2], toward: {toward}}}}}'
    if abs(off) < 1e-9:
        assert scene_of(effects).effects[0].rate == 1.3
        return
    with pytest.raises(BadInput, match='perpendicular to normal'):
        scene_of(effects)


@pytest.mark.parametrize(('effects', 'contact'), [
    ('sliding_friction: {mu: 0.2}', Contact(mu=0.2)),
    ('sliding_friction: {mu: .inf}', Contact(mu=math.inf)),
    ('rolling_friction: {dry: 0.1}', Contact(rolling=0.1)),
    ('rolling_friction: {viscous: 0.3}', Contact(rolling_viscous=0.3)),
    ('rolling_friction: {dry: 0.1, viscous: 0.3}', Contact(rolling=0.1, rolling_viscous=0.3)),
    ('spinning_friction: {radius: 0.01}', Contact(patch=0.01)),
    # pi eta R/4
    ('air_film: {viscosity: 2}', Contact(film=near(0.2 * math.pi, 1e-15)))])
def test_each_effect_of_a_contact_tells_its_own_coefficients(effects, contact):
    beside = 'gravity: {g: 9.8}'
    if not effects.startswith('sliding'):
        beside = SLIDES
    scene = scene_of(f'{effects}, {beside}', '{table: {}}', 'shape: {disk: {radius: 0.4}}')
    assert scene.effects[0].contact == contact


def test_a_ball_without_a_surface_is_pressed_by_the_gravity_of_its_friction():
    scene = scene_of('sliding_friction: {mu: 0, g: 3}', 'table',
                     'shape: {solid_sphere: {radius: 0.4}}')
    assert scene.effects[0].contact == Contact(mu=0.0, g=3.0)


@pytest.mark.parametrize(('effects', 'opposite'), [
    ('torque: {value: [1, -2, 3]}', 'torque: {value: [-1, 2, -3]}'),
    ('torque: {times: [1, 2], values: [[1, -2, 3], [4, 0, 1]], frame: world}',
     'torque: {times: [1, 2], values: [[-1, 2, -3], [-4, 0, -1]], frame: world}'),
    ('force: {value: [1, -2, 3], at: [1, 0, 2]}', 'force: {value: [-1, 2, -3], at: [1, 0, 2]}'),
    ('rotor: {axis: [4, -2, 4], momentum: 1.5}', 'rotor: {axis: [4, -2, 4], momentum: -1.5}'),
    ('rotor: {axis: [0, 0, 2], inertia: 2, rate: 3, torque: 0.7}',
     'rotor: {axis: [0, 0, 2], inertia: 2, rate: -3, torque: -0.7}')])
def test_the_opposite_of_an_effect_is_one_that_a_scene_can_list(effects, opposite):
    assert scene_of(effects).effects[0].opposite == scene_of(opposite).effects[0]


def test_what_an_expression_says_has_no_opposite():
    assert scene_of('force: {value: [1, "k*t", 3]}').effects[0].opposite is None
    assert scene_of('drag: {linear: 1}').effects[0].opposite is None


@pytest.mark.parametrize(('kind', 'at', 'warned'), [
    ('pivot', [0, 0, 0], True), ('pivot', [0, 0, 0.1], False), ('free', [0, 0, 0], False),
    # on an axis what is along it does not count
    ('{hinge: {axis: [0, 0, 1]}}', [0, 0, 0.3], True),
    ('{hinge: {axis: [0, 0, 1]}}', [0.1, 0, 0.3], False)])
def test_gravity_warns_of_a_body_that_is_held_at_its_centre_of_mass(kind, at, warned):
    scene = scene_of('gravity: {g: 9.8}', kind, f'inertia: [1, 2, 2.5], center_of_mass: {at}')
    notes = scene.effects[0].notes(scene.body, scene.constraint)
    assert len(notes) == warned
    assert all('at its centre of mass' in note for note in notes)


def test_without_strength_or_arm_nothing_acts():
    nothing = [('gravity: {g: 0}', 'free'), ('gravity: {g: 0}', 'pivot'),
               ('torque: {value: [0, 0, 0]}', 'free'), ('drag: {linear: 0}', 'free'),
               ('rotor: {axis: [1, 0, 0], momentum: 0}', 'free'),
               ('torque: {times: [1, 2], values: [[0, 0, 0], [0, 0, 0]]}', 'free')]
    for effects, kind in nothing:
        scene = scene_of(effects, kind)
        assert scene.effects[0].acting(scene.frame, 0.0) == (), effects
    for g in ('9.8', '[1, 0, 0]'):
        held = scene_of(f'gravity: {{g: {g}}}, drag: {{linear: 1}}', 'pivot',
                        'inertia: [1, 2, 2.5]')
        assert [effect.acting(held.frame, 0.0) for effect in held.effects] == [(), ()]
    sphere = scene_of('internal_dissipation: {coefficient: 1}', 'free', 'inertia: [1, 1, 1]')
    assert sphere.effects[0].acting(sphere.frame, 0.0) == ()
    round_ = scene_of('gravity_gradient: {mu: 5, position: [2, -1, 2]}', 'free',
                      'inertia: [1, 1, 1]')
    assert round_.effects[0].acting(round_.frame, 0.0) == ()
    # a piece that begins later acts from the start on, with zeros
    later = scene_of('torque: {times: [1], values: [[0, 0, 2]]}')
    assert later.effects[0].acting(later.frame, 0.0)[0].values == (0.0, 0.0, 0.0)


def test_what_acts_has_none_of_the_traits_that_it_does_not_tell():
    acting = Acting('kernel', (1.0,), 'torque', 'work')
    assert not any(acting[4:])
    pull, formulas = Pull(), Formulas((ZERO, ZERO, ZERO))
    assert (pull.constant, pull.slowing, pull.formulas) == ((0.0, 0.0, 0.0), 0.0, ())
    assert (pull.force, pull.couple, pull.drag) == (None, None, None)
    assert (formulas.force, formulas.of_frame) == ((ZERO, ZERO, ZERO), False)
    assert not any(Contact())


def test_the_contract_without_views_says_nothing():
    class Plain(Effect):
        name, SCHEMA, mechanisms = 'plain', {}, ()

    plain = Plain()
    assert (plain.breakpoints, plain.inner_dissipation, plain.grip) == ((), 0.0, 0.0)
    assert plain.notes(None, None) == []
    assert not plain.repeatable
    for view in ('acting', 'opposite', 'series', 'damping', 'potential', 'momentum',
                 'uniform_field', 'as_impulse', 'bounds', 'contact'):
        assert getattr(plain, view) is None
    for name in ('grip', 'notes', 'from_scene'):
        with pytest.raises(TypeError, match=f'{name} is a setting with the name of a view'):
            type('Hidden', (Effect,), {'__annotations__': {name: float}})


def test_a_component_or_a_piece_that_is_not_zero_acts():
    """Of the arm to a centre of mass straight above a pivot, of a torque, and of its pieces."""
    above = 'inertia: [1, 2, 2.5], center_of_mass: [0, 0, 0.3]'
    for effects in ('gravity: {g: 9.8}', 'gravity: {g: [0, 3, 0]}', 'drag: {linear: 1}',
                    'drag: {quadratic: 1}', "torque: {value: [0, 0, 'k*t']}",
                    'force: {value: [0, 3, 0]}', 'torque: {value: [0, 2, 0]}',
                    'torque: {times: [0, 1], values: [[0, 0, 0], [0, 0, 2]]}'):
        scene = scene_of(effects, 'pivot', above)
        assert len(scene.effects[0].acting(scene.frame, 0.0)) == 1, effects
    # two moments of a symmetric body do not differ
    top = scene_of('gravity_gradient: {mu: 5, position: [2, -1, 2]}', 'free', 'inertia: [1, 1, 2]')
    assert len(top.effects[0].acting(top.frame, 0.0)) == 1


@pytest.mark.parametrize('effects', [
    "torque: {value: ['angle', 0, 0]}", "force: {value: [0, 'rate', 0]}",
    'potential: {energy: angle}'])
def test_the_angle_of_a_hinge_is_known_on_hinges_only(effects):
    known = scene_of(effects, 'hinge')
    assert known.effects[0].acting(known.frame, 0.0)
    with pytest.raises(BadInput, match=r'depends on (angle|rate); on constraint .pivot. there is'):
        scene_of(effects, 'pivot')


@pytest.mark.parametrize('books', ['heat', 'work'])
@pytest.mark.parametrize('kind', ['torque', 'force'])
def test_the_heat_of_an_expression_may_have_either_sign(kind, books):
    scene = scene_of(f"{kind}: {{value: ['k*t', 0, 0], books: {books}}}", 'pivot')
    [acting] = scene.effects[0].acting(scene.frame, 0.0)
    assert (acting.books, acting.both_ways) == (books, books == 'heat')


@pytest.mark.parametrize(('effects', 'said'), [
    ("magnetic: {moment: [1, 0, 0], field: ['wx', 0, 0]}", 'depends on wx; a field of the place'),
    ("potential: {energy: 'x*t + vy'}", 'depends on t, vy; a potential'),
    ('rotor: {axis: [0, 0, 0], momentum: 1}', 'not all zero'),
    ('rotor: {axis: [1, 0, 0], momentum: 1, inertia: 1}', 'give momentum alone'),
    ('rotor: {axis: [1, 0, 0], inertia: 1}', 'give momentum alone'),
    ('rotor: {axis: [1, 0, 0], rate: 1, torque: 1}', 'give momentum alone'),
    ('gravity_gradient: {mu: 5}', "the key 'position' is missing"),
    ('gravity_gradient: {mu: 5, position: [0, 0, 0]}', 'not the attracting point'),
    ('gravity_gradient: {mu: 5, orbit: {rate: 1, normal: [1, 0, 0], toward: [0, 1, 0]}}',
     'give one of the two'),
    ('gravity_gradient: {orbit: {rate: 1, normal: [0, 0, 0], toward: [0, 1, 0]}}',
     r'normal: got \[0, 0, 0\]; a direction'),
    ('torque: {value: [1, 0, 0], times: [1]}', 'give value alone'),
    ('torque: {times: [1, 2], values: [[1, 0, 0]]}', '2 times and 1 values'),
    ('torque: {times: [1, 1], values: [[1, 0, 0], [0, 0, 1]]}', 'times rise'),
    ('drag: {}', 'no coefficient'),
    ('spring: {stiffness: 1, at: [1, 0, 0]}', "the key 'anchor' is missing"),
    ('spring: {stiffness: 1, angle: 1, at: [1, 0, 0], anchor: [0, 0, 0]}',
     'has no meaning on constraint')])
def test_settings_that_say_nothing_are_refused(effects, said):
    with pytest.raises(BadInput, match=said):
        scene_of(effects)


def test_an_angle_of_a_spring_on_a_hinge_stands_alone():
    with pytest.raises(BadInput, match='angle: is given together with at, anchor or length'):
        scene_of('spring: {stiffness: 1, angle: 1, length: 2}', 'hinge')


def test_friction_warns_of_painleves_paradox_from_its_bound_on(monkeypatch):
    monkeypatch.setattr(sliding_friction, 'painleve_bound', lambda body: 1.25)

    def warned(scene):
        return ['mu_P = 1.25' in note for note in
                scene.effects[0].notes(scene.body, scene.constraint)]
    disk, ball = 'shape: {disk: {radius: 0.4}}', 'shape: {solid_sphere: {radius: 0.4}}'
    found = [warned(scene_of(f'sliding_friction: {{mu: {mu}}}, gravity: {{g: 9.8}}',
                             '{table: {}}', disk)) for mu in (0.0, 1.2499, 1.25, 1.26, '.inf')]
    assert found == [[], [], [True], [True], []]
    # a ball without a surface meets none
    assert warned(scene_of('sliding_friction: {mu: 1.26, g: 9.8}', 'table', ball)) == []


TWICE = {
    'torque': '{value: [1, 0, 0]}', 'force': '{value: [1, 0, 0]}', 'potential': '{energy: qx}',
    'strike': '{impulse: [1, 0, 0]}', 'magnetic': '{moment: [1, 0, 0], field: [0, 1, 0]}',
    'spring': '{at: [1, 0, 0], anchor: [0, 0, 0], stiffness: 1}',
    'rotor': '{axis: [1, 0, 0], momentum: 1}'}


@pytest.mark.parametrize('name', EFFECTS)
def test_some_effects_may_be_listed_twice(name):
    assert EFFECTS[name].repeatable == (name in TWICE)
    if name in TWICE:
        assert len(scene_of(', '.join([f'{{{name}: {TWICE[name]}}}'] * 2)).effects) == 2
