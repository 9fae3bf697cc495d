# SPDX-License-Identifier: Apache-2.0
"""Which torques drive a body in closed form, and the numbers of the drive by hand."""

from fractions import Fraction

import numpy as np
import pytest
from near import near
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from rigid_body_sim.mechanics.pulls import total_pull
from rigid_body_sim.motions import driven_body
from rigid_body_sim.motions.driven_body import IN_BODY, IN_WORLD, Drive, absorbs, drive
from rigid_body_sim.numerics.rotations import multiply
from rigid_body_sim.scene.scene import parse_scene

pytestmark = pytest.mark.without_numba

I, I1 = 0.5, 0.3


def scene_of(inertia, torque=None, rotor=None, frame='body'):
    """Return a free body under a torque, with a rotor of a momentum (kg m^2/s)."""
    effects = []
    if torque is not None:
        effects += [f'{{torque: {{value: {list(torque)}, frame: {frame}}}}}']
    if rotor is not None:
        effects += [f'{{rotor: {{axis: {list(rotor)}, '
                    f'momentum: {float(np.linalg.norm(rotor))}}}}}']
    return parse_scene(f'scene: s\nbody: {{mass: 1.0, inertia: {list(inertia)}}}\n'
                       f'constraint: free\neffects: [{", ".join(effects)}]\ninitial: {{}}\n')


def exactly(pair):
    """Return the sum of a pair."""
    return Fraction(pair[0]) + Fraction(pair[1])


def along(k, size):
    """Return a vector along an axis."""
    return tuple(size if axis == k else 0.0 for axis in range(3))


def test_pairs_of_any_sign_are_summed_with_what_they_lost():
    for p, q in (((1.0, 3e-17), (-1.0, 5e-17)), ((0.3, -1e-17), (0.5, 2e-17))):
        total = exactly(driven_body.plus_any(p, q))
        assert abs(float(total - exactly(p) - exactly(q))) < 1e-32    # measured: 6.2e-33


@pytest.mark.parametrize('k', [0, 1, 2])
@pytest.mark.parametrize('torque', [0.5, -0.5, None])
@pytest.mark.parametrize('momentum', [0.11, -0.11, None])
def test_a_torque_along_the_axis_of_a_symmetric_body_drives_its_spin(k, torque, momentum):
    """With a along the torque: growth N/I, ratio I/I1, excess (I - I1)/I1, rotor h.a/I1."""
    scene = scene_of([I if axis == k else I1 for axis in range(3)],
                     *(None if size is None else along(k, size) for size in (torque, momentum)))
    found = drive(scene)
    if torque is None and momentum is None:
        assert found is None
        return
    sign = -1.0 if torque == -0.5 else 1.0
    moment, equal = Fraction(I), Fraction(I1)
    assert found.axes == IN_BODY
    assert found.a == along(k, sign)
    assert float(exactly(found.growth) - Fraction(abs(torque or 0.0)) / moment) == (
        pytest.approx(0.0, abs=1e-31))
    assert found.ratio == near(I / I1, rel=1e-15)
    assert float(exactly(found.excess) / ((moment - equal) / equal) - 1) == pytest.approx(
        0.0, abs=1e-31)
    carried = sign * total_pull(scene).carried[k]
    assert found.rotor[0] == near(carried / I1, rel=1e-15) if momentum else found.rotor[0] == 0.0


@pytest.mark.parametrize('torque', [(0.3, 0.0, 0.4), None])
@pytest.mark.parametrize('turned', [1.0, -1.0])
def test_a_sphere_has_its_axis_along_the_torque_and_else_along_its_rotors(torque, turned):
    rotor = (0.06 * turned, 0.0, 0.08 * turned)
    found = drive(scene_of((I1, I1, I1), torque, rotor))
    assert found.axes == IN_BODY
    way = 1.0 if torque else turned
    assert found.a == near((0.6 * way, 0.0, 0.8 * way), rel=1e-15)
    assert found.growth[0] == near(0.5 / I1 if torque else 0.0, rel=1e-15)
    assert (found.ratio, found.excess) == (1.0, (0.0, 0.0))
    # h . a is positive along the rotors themselves
    assert found.rotor[0] == near(0.1 * turned * way / I1, rel=1e-14)


def test_a_torque_fixed_in_the_world_drives_a_sphere():
    found = drive(scene_of((I1, I1, I1), (0.3, 0.0, -0.4), frame='world'))
    assert found == Drive(IN_WORLD, near([0.6, 0.0, -0.8], rel=1e-15), found.growth, 1.0,
                          (0.0, 0.0), (0.0, 0.0))
    assert found.growth[0] == near(0.5 / I1, rel=1e-15)


@pytest.mark.parametrize(('inertia', 'torque', 'rotor', 'frame'), [
    ((I1, I1, I), (0.1, 0.0, 0.5), None, 'body'), ((I1, I1, I), (0.0, 1e-15, 0.5), None, 'body'),
    ((I1, I1, I), None, (0.1, 0.0, 0.5), 'body'), ((I1, I1, I), None, (0.0, 1e-14, 0.5), 'body'),
    ((I1, I1, I), (0.0, 0.0, 0.5), (0.0, 0.1, 0.0), 'body'),
    ((0.31, I1, I1 + 0.1), (0.0, 0.0, 0.5), None, 'body'),
    ((I1, I1, I), (0.0, 0.0, 0.5), None, 'world'),
    ((I1, I1, I1), (0.0, 0.0, 0.5), (0.0, 0.0, 0.1), 'world'),
    ((I1, I1, I1), (0.0, 0.0, 0.5), (0.0, 1e-15, 0.1), 'body'),
    ((I1, I1, 0.0), (0.0, 0.0, 0.5), None, 'body')])
def test_what_has_no_closed_form_has_no_drive(inertia, torque, rotor, frame):
    assert drive(scene_of(inertia, torque, rotor, frame)) is None


@pytest.mark.parametrize('inertia', [(I1, I1, I), (I1, I1, I1)])
def test_a_torque_and_a_rotor_off_the_axis_by_rounding_count_as_along_it(inertia):
    tiny = 1e-16
    assert drive(scene_of(inertia, (0.1 * tiny, -0.1 * tiny, 0.5), (0.0, 0.1 * tiny, 0.1)))


@pytest.mark.parametrize(('constraint', 'center', 'effects', 'taken'), [
    ('free', 0.0, 'torque: {value: [0, 0, 0.5]}', True),
    ('free', 0.0, 'gravity: {g: 9.81}, torque: {value: [0, 0, 0.5]}', True),    # it falls besides
    ('free', 0.0, 'gravity: {g: 9.81}', False), ('free', 0.0, 'drag: {angular: 1}', False),
    ('free', 0.0, 'drag: {angular: 1}, torque: {value: [0, 0, 0.5]}', False),
    ('pivot', 0.0, 'torque: {value: [0, 0, 0.5]}', True),
    ('pivot', 0.0, 'gravity: {g: 9.81}, torque: {value: [0, 0, 0.5]}', True),   # no arm
    ('pivot', 0.1, 'gravity: {g: 9.81}, torque: {value: [0, 0, 0.5]}', False),
    ('pivot', 0.1, 'torque: {value: [0, 0, 0.5]}', True),
    ('{hinge: {axis: [0, 0, 1]}}', 0.0, 'torque: {value: [0, 0, 0.5]}', False)])
def test_a_force_is_no_matter_where_the_body_flies_and_is_one_where_it_is_held(
        constraint, center, effects, taken):
    scene = parse_scene(
        f'scene: s\nbody: {{mass: 1, inertia: [0.3, 0.3, 0.5], center_of_mass: [0, 0, {center}]}}'
        f'\nconstraint: {constraint}\neffects: [{effects}]\ninitial: {{}}\n')
    assert absorbs(scene) is taken


@pytest.mark.parametrize(('inertia', 'torque', 'rotor', 'frame'), [
    ((I1, I1, I), (0.0, 0.0, 0.5), None, 'body'), ((I, I1, I1), (-0.4, 0.0, 0.0), None, 'body'),
    ((I1, I, I1), (0.0, 0.5, 0.0), (0.0, -0.11, 0.0), 'body'),
    ((I, I1, I1), None, (0.11, 0.0, 0.0), 'body'),
    ((I1, I1, I1), (0.3, -0.2, 0.4), None, 'body'),
    ((I1, I1, I1), (0.3, -0.2, 0.6), (0.06, -0.04, 0.12), 'body'),
    ((I1, I1, I1), None, (0.06, -0.04, 0.12), 'body'),
    ((I1, I1, I1), (0.3, -0.2, 0.4), None, 'world')])
@pytest.mark.parametrize('omega', [(0.7, -1.1, 0.4), (0.0, 0.0, 0.0)])
def test_a_driven_body_obeys_eulers_equations(inertia, torque, rotor, frame, omega):
    """I omega' = N - omega x (I omega + h), q' = q omega/2, by SciPy, before and after the anchor.

    A free body goes straight on.
    """
    scene = scene_of(inertia, torque, rotor, frame)
    carried, N = np.array(total_pull(scene).carried), np.array(torque or (0.0, 0.0, 0.0))
    q, anchored = np.array([0.1, -0.5, 0.5, 0.7]), np.empty(driven_body.ANCHOR_SIZE)
    start = np.array([1.5, *q, *omega, 1.0, 2.0, 3.0, 0.4, 0.5, -0.6])

    def rates(time, y):
        turn, w = Rotation.from_quat(y[:4]), y[4:]
        acts = turn.inv().apply(N) if frame == 'world' else N
        grown = (acts - np.cross(w, inertia * w + carried)) / inertia
        return [*(0.5 * np.array(multiply(*y[:4], *w, 0.0))), *grown]
    driven_body.anchor(driven_body.parameters(scene), start, anchored)
    for elapsed in (-0.8, 0.0, 2.3):
        out = np.empty(14)
        driven_body.state(anchored, 1.5 + elapsed, out)
        y = solve_ivp(rates, (0.0, elapsed), [*(q / np.linalg.norm(q)), *omega], 'DOP853',
                      rtol=1e-8, atol=1e-9).y[:, -1]
        # measured: 7.3e-9
        assert out[1:8] == pytest.approx(y, abs=3e-7)
        assert out[0] == 1.5 + elapsed
        assert out[8:11] == near(start[8:11] + elapsed * start[11:], rel=1e-15)
        assert out[11:].tolist() == start[11:].tolist()
