# SPDX-License-Identifier: Apache-2.0
"""check_scenes: its output for scenes and overrides; a wrong formula does not pass."""

import json

import kept
import numpy as np
import pytest
from notices import without_notices
from numba_only import LONG_IN_PYTHON
from soak import IN_SOAK

from rigid_body_sim.scene.scene import load_scene, scene_names
from rigid_body_sim.study import check_scenes
from rigid_body_sim.study.scenes import convex_body, driven_body
from rigid_body_sim.study.scenes.experiment import Experiment
from rigid_body_sim.study.scenes.limits import limit
from rigid_body_sim.study.scenes.quantity import Quantity
from rigid_body_sim.study.scenes.systems import SYSTEMS
from rigid_body_sim.theory import (
    billiard,
    heavy_top,
    kater_pendulum,
    rolling_disk,
    symmetric_top,
)

# all that ship except those whose kernels no other test compiles (ball by dop8, torque, heat, bat)
# and the second of two alike
QUICK = [name for name in SYSTEMS if not name.startswith((
    'billiard', 'driven', 'major', 'baseball', 'falling', 'rolling_', 'euler_disk', 'rattleback',
    'tippe', 'rising', 'routh', 'chaplygin', 'tossed', 'kapitza', 'librating'))]
MARKS = {'sleeping_top': LONG_IN_PYTHON, 'kater_pendulum': pytest.mark.without_numba,
         'kater_pendulum_from_p': pytest.mark.without_numba}
KEPT = 'predicted', 'tolerance', 'unit', 'as_written', 'detail'


def table(*arguments, capsys, status=0):
    """Return the quantities of a run by name, those of the last scene."""
    assert check_scenes.main([*arguments, '--json']) == status
    found = json.loads(capsys.readouterr().out)
    assert found['failed'] == sum(row['verdict'] != 'confirmed' for one in found['scenes']
                                  for row in one['quantities'])
    return {row['quantity']: row for row in found['scenes'][-1]['quantities']}


def test_every_scene_that_ships_is_checked():
    assert set(SYSTEMS) == set(scene_names())


@pytest.mark.parametrize('name', [
    pytest.param(name, marks=MARKS.get(name, ())) for name in QUICK])
def test_scene_is_confirmed_by_both_ways(name, capsys):
    rows = table('--scene', name, capsys=capsys)
    assert len(rows) >= 4
    assert all(set(row['measured']) in ({'exact', 'dop8'}, {'both'}) for row in rows.values())
    # errors of the notes are told apart by far more than the tolerance (Chandler: by 0.3 %, far
    # above its 1e-9)
    for row in rows.values():
        if 'error_as_written' in row:
            assert row['error_as_written'] > 1e3 * row['tolerance']
    kept.check(f'theory_{name}', {quantity: {key: row.get(key) for key in KEPT}
                                  for quantity, row in rows.items()})


@pytest.mark.without_numba
def test_a_changed_scene_without_a_closed_form_is_integrated():
    axial = Experiment(load_scene('driven_body'), 'exact')
    assert axial.variant(driven_body.ASYMMETRIC).method == 'dop8'
    assert axial.variant({'torque.value': [0.0, 0.0, 0.1]}).method == 'exact'


@IN_SOAK
@pytest.mark.parametrize('name', [name for name in SYSTEMS if name not in QUICK])
def test_the_other_scenes_are_confirmed(name, capsys):
    assert len(table('--scene', name, capsys=capsys)) >= 4


def test_a_disk_precesses_with_its_centre_at_rest():
    run = Experiment(load_scene('rolling_disk'), 'dop8')
    A, _, m, R, g = convex_body._numbers(run)
    [way] = convex_body._steady(run, A, m, R, g)
    assert way.passed and way.error < 1e-13    # m; measured 5e-15


def _upright(shape):
    """Return what is found about a disk or hoop that stands upright, [(above, below), ...]."""
    run = Experiment(load_scene('rolling_disk', [f'body.shape={{{shape}: {{radius: 0.5}}}}']),
                     'dop8')
    found = list(convex_body._upright(run, ''))
    return list(zip(found[::2], found[1::2], strict=True))


@LONG_IN_PYTHON
@pytest.mark.parametrize('shape', ['disk', 'hoop'])
def test_a_disk_stays_upright_above_a_speed_or_a_rate_of_spinning_only(shape):
    pairs = _upright(shape)
    assert len(pairs) == 2
    for above, below in pairs:
        assert (above.measured, below.measured) == (0.0, 1.0) == (above.predicted, below.predicted)


@LONG_IN_PYTHON
@pytest.mark.parametrize(('wrong', 'passed'), [
    (lambda A, m, R, g: np.sqrt(m * g * R / A), (True, False)),
    (lambda A, m, R, g: np.sqrt(2.0 * g / (3.0 * R)), (False, True))],
    ids=['about the centre', 'of the hoop'])
def test_a_wrong_rate_of_spinning_is_not_confirmed(monkeypatch, wrong, passed):
    monkeypatch.setattr(rolling_disk, 'rate_of_upright_stability', wrong)
    _, (above, below) = _upright('disk')
    assert (above.passed, below.passed) == passed


def test_inertia_by_quadrature_and_by_a_blow(capsys):
    rows = table('--scene', 'inertia_tensors', capsys=capsys)
    assert len(rows) == 11
    assert all(set(row['measured']) == {'quadrature', 'blow'} for row in rows.values())


@pytest.mark.parametrize(
    ('module', 'function', 'wrong', 'scene', 'quantity'),
    [(symmetric_top, 'precession_rate', symmetric_top.precession_rate_as_written, 'symmetric_top',
      'Omega of omega round e3 in the body'),
     pytest.param(
         kater_pendulum, 'moment_about_suspension',
         kater_pendulum.moment_about_suspension_as_written, 'kater_pendulum',
         'I_Q = M g l/Omega^2', marks=pytest.mark.without_numba),
     (heavy_top, 'curvature', heavy_top.curvature_at_equilibrium, 'heavy_top',
      "V_eff'' off equilibrium, at 0.5219 rad"),
     pytest.param(
         kater_pendulum, 'frequency_from_q', lambda g, length, a: np.sqrt(g / (length**2 + a**2)),
         'kater_pendulum', "g = l' Omega^2, over the formula, in the limit",
         marks=pytest.mark.without_numba)])
def test_a_wrong_formula_is_not_confirmed(
        monkeypatch, capsys, module, function, wrong, scene, quantity):
    monkeypatch.setattr(module, function, wrong)
    rows = table('--scene', scene, capsys=capsys, status=1)
    assert rows[quantity]['verdict'] == 'NOT CONFIRMED'


@pytest.mark.parametrize(('scene', 'assignments'), [
    ('heavy_top', ['initial.spin=35', 'initial.tilt=1.2']),
    ('heavy_top', ['initial.spin=-80', 'initial.tilt=2.5', 'gravity.g=3']),
    ('kater_pendulum', ['constraint.hinge.distance=0.2', 'initial.angle=1.5']),
    ('symmetric_top', ['body.inertia=[1, 1, 0.6]']),
    ('tennis_racket', ['body.inertia=[2, 1, 2.5]', 'initial.angular_velocity=[-3, 0.01, 0.02]']),
    ('steady_precession', ['initial.tilt=1.0', 'initial.spin=80']),
    ('heavy_top', ['initial.spin=10']), ('fast_top', ['initial.tilt=1.0']),
    pytest.param('sleeping_top', ['initial.angular_velocity=[1e-6, 0, 60]'], marks=LONG_IN_PYTHON),
])
def test_other_values_are_confirmed_too(scene, assignments, capsys):
    table(
        '--scene', scene, *(word for one in assignments for word in ('--set', one)), capsys=capsys)


def test_own_file_is_checked_by_the_name_in_it(tmp_path, capsys):
    path = tmp_path / 'mine.yaml'
    path.write_text(load_scene('heavy_top', ['initial.tilt=0.8']).text)
    assert "beta'' at 3 times" in table('--scene', str(path), capsys=capsys)


@pytest.mark.without_numba
@pytest.mark.parametrize(('arguments', 'line'), [
    (['--scene', 'heavy_topp'], "scene: no scene 'heavy_topp'; did you mean heavy_top?"),
    (['--set', 'initial.spin=3'], "--set: got 'initial.spin=3'; name the scene it changes"),
    (['--scene', 'heavy_top', '--set', 'scene=other'],
     'other: no formula of the notes applies to it'),
    (['--scene', 'kater_pendulum', '--set', 'constraint.hinge.distance=0'],
     'kater_pendulum.yaml: constraint.hinge.distance: got 0'),
    (['--scene', 'kater_pendulum', '--set', 'constraint.hinge.through=[0, 0, -0.4]'],
     'kater_pendulum: the suspension distance l is 0.0 m'),
    (['--scene', 'kater_pendulum', '--set', 'initial.rate=30'],
     'kater_pendulum: the pendulum does not swing to and fro'),
    (['--scene', 'symmetric_top', '--set', 'body.inertia=[1, 2, 2.5]'],
     'symmetric_top: moments [1.0, 2.0, 2.5]'),
    (['--scene', 'heavy_top', '--set', 'gravity.g=0'], 'heavy_top: moments'),
    (['--scene', 'steady_precession', '--set', 'initial.spin=3'],
     'steady_precession: tilt 0.5 rad, spin 3 rad/s'),
    (['--scene', 'kater_pendulum', '--set', 'effects=[]'],
     'kater_pendulum: the effects here: none; the formulas'),
    (['--scene', 'heavy_top', '--set', 'initial.tilt=0'], 'heavy_top: tilt 0 rad'),
    (['--scene', 'sphere', '--set', 'initial.angular_velocity=[0, 0, 0]'], 'sphere: omega'),
    (['--scene', 'sleeping_top', '--set', 'initial.tilt=0.3'],
     'sleeping_top: it starts at a tilt of'),
])
def test_what_cannot_be_checked_gets_one_line(arguments, line, capsys):
    assert check_scenes.main(arguments) == 2
    said = without_notices(capsys.readouterr().err).splitlines()
    assert len(said) == 1
    assert said[0].startswith(line)


def test_what_people_read(capsys):
    assert check_scenes.main(['--scene', 'symmetric_top']) == 0
    said = capsys.readouterr().out
    assert 'uncorrected, the notes give 0.461538461538462: off by 2.3e-01' in said
    assert said.splitlines()[-1].startswith('7 quantities of 1 systems: 7 confirmed, 0 not')


def test_quantity_judges():
    assert Quantity('', 2.0, 2.0 + 1e-9, 1e-9).passed
    assert not Quantity('', 2.0, 2.0 + 1e-8, 1e-9).passed
    assert not Quantity('', 2.0, float('nan'), 1e-9).passed
    assert not Quantity('', float('nan'), float('nan'), 1e-9).passed
    assert not Quantity('', [1.0, 2.0], [1.0, 2.1], 1e-3).passed
    assert Quantity('', 2.0, 1.0, 0.0, bound=True).passed
    assert not Quantity('', 2.0, 2.1, 1e-2, bound=True).passed
    assert Quantity('', 0.0, 1e-10, 1e-9, absolute=True).passed
    assert not Quantity('', 0.0, 1e-10, 1e-9).passed    # relative to nothing: only nothing passes
    assert Quantity('', 2.0, 2.0, 1e-9, as_written=3.0).error_as_written == 0.5


def test_limit_finds_order_and_what_is_left():
    values = (0.4, 0.2, 0.1)
    order, left = limit('', '', values, [1.0 + 0.3 * value**2 for value in values], 2, 1e-6, 1e-12)
    assert order.passed
    assert left.passed
    order, left = limit('', '', values, [1.01 + 0.3 * value**2 for value in values], 2, 0.1, 1e-3)
    assert not order.passed
    assert not left.passed


def test_billiard_height_decides_the_formula():
    """The notes' time above 2a/5 is seven times too long, as the check finds it."""
    a, h = 0.03, 0.02
    right = billiard.onset_of_rolling(1.5, h, a, 0.2, 9.81)
    assert billiard.onset_of_rolling_above_as_written(1.5, h, a, 0.2, 9.81) == pytest.approx(
        7.0 * right)


@IN_SOAK
def test_two_processes_share_several_scenes(capsys):
    """Held bodies run in one process and the others in another.

    The tables come in the order asked, and errors read as from one process.
    """
    assert check_scenes.main(['--scene', 'heavy_top', '--scene', 'symmetric_top', '--json']) == 0
    found = json.loads(capsys.readouterr().out)
    assert [table['scene'] for table in found['scenes']] == ['heavy_top', 'symmetric_top']
    assert found['quantities'] == sum(len(table['quantities']) for table in found['scenes']) > 20
    assert check_scenes.main([
        '--scene', 'heavy_top', '--scene', 'symmetric_top', '--set', 'initial.spin=50']) == 2
    assert capsys.readouterr().err.startswith(
        'symmetric_top: moments [1.0, 1.0, 1.3], omega [0.0, 0.0, 50.0]; needs I1 = I2')
