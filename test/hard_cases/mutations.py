# SPDX-License-Identifier: Apache-2.0
"""The mutation check: kernels with one sign or term wrong, and the named test that must fail.

The tree is copied, one line changed there, and the test run on the copy without compiling, so no
cached code can answer for it.
"""

import os
import pathlib
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]

# name: (file of the package, what stands there, what is put there, the test that must fail)
MUTANTS = {
    'free body: discriminant loses its sign': (
        'motions/free_body/anchor.py', 'if gap[0] < 0.0:', 'if gap[0] > 0.0:',
        'test/hard_cases/test_02_inertia.py::test_case[lamina]'),
    'free body: Euler coefficient of the wrong axis': (
        'motions/free_body/anchor.py', '_quotient(to_c * b, c * to_b)',
        '_quotient(to_b * c, b * to_c)',
        'test/hard_cases/test_02_inertia.py::test_case[lamina]'),
    'free body: next flip a half turn late': (
        'motions/free_body/free_body.py',
        'time = course.start + (0.5 * half_turns - course.phase) / rate',
        'time = course.start + (0.5 * half_turns + course.phase) / rate',
        'test/hard_cases/test_01_racket.py::test_case[flips: racket, 0.01 off the middle axis]'),
    'top: own spin added to both phases': (
        'motions/lagrange_top/anchor.py',
        'minus(scaled(means.b, units.rate), scaled(own_spin, 0.5))',
        'plus(scaled(means.b, units.rate), scaled(own_spin, 0.5))',
        'test/hard_cases/test_06_tops.py::test_case[top, loops]'),
    'top: a phase not rescaled below 1e-60': (
        'motions/lagrange_top/means.py',
        'ab, bb, pb = one, scaled(kc, scale), scaled(kc, 1.0 / scale)', 'ab, bb, pb = one, kc, kc',
        'test/hard_cases/test_06_tops.py::'
        'test_a_kick_in_a_plane_stays_in_it_and_follows_the_hyperbolic_sine'),
    'top: exactly upright loses its quaternion': (
        'motions/lagrange_top/anchor.py', 'if gap == 0.0:', 'if gap < 0.0:',
        'test/hard_cases/test_06_tops.py::test_exactly_upright_and_exactly_hanging_for_ever'),
    'pendulum: turning points at the lowest position': (
        'motions/pendulum/pendulum.py',
        '(0.25 + 0.5 * half_turns', '(0.0 + 0.5 * half_turns',
        'test/motions/pendulum/test_pendulum.py::test_turning_points'),
    'ball: friction heats twice': (
        'motions/sliding_sphere.py', '(1.0 - 0.5 * share)', '(1.0 - share)',
        'test/motions/test_sliding_sphere.py::test_energy_lost_is_heat'),
    'ball: path without its curvature': (
        'motions/sliding_sphere.py', 'elapsed * (v0x - 0.5 * lost * ex)', 'elapsed * v0x',
        'test/motions/test_sliding_sphere.py::test_masse_runs_on_a_parabola'),
    'dop8: a digit of a weight': (
        'integrators/marching/dormand_prince.py', '0.05429373411656876', '0.054293734116468765',
        'test/integrators/methods/test_dop8.py::test_order_conditions'),
    'impulse: work without half of its own': (
        'mechanics/impulse.py', 'work = dot(turns, plus(omega, scaled(0.5, d)))',
        'work = dot(turns, omega)',
        'test/simulation/test_simulation.py::test_ledger_balances_under_impulses_and_holds'),
    'dissipation: heats the wrong way': (
        'scene/effects/internal_dissipation.py',
        '* (I3 - I1) * wz * wx,', '* (I1 - I3) * wz * wx,',
        'test/hard_cases/test_08_dissipation.py::test_case[stiff: c dt = 1]'),
    'dissipation: the end state goes on': (
        'scene/effects/internal_dissipation.py', 'ENDED = 2.0 ** -54', 'ENDED = 0.0',
        'test/hard_cases/test_08_dissipation.py::test_case[stiff: c dt = 1e+06]'),
    'contact: friction along the slip': (
        'mechanics/contact/forces.py', 'return ((N * unit[0], N * unit[1], N),',
        'return ((-N * unit[0], -N * unit[1], N),',
        'test/integrators/marching/test_held_by_rolling_friction.py::'
        'test_the_ledger_of_a_ball_that_friction_turned_and_stopped_leaves_round_off'),
    'contact: normal force without the centripetal term': (
        'mechanics/contact/forces.py', 'drawn = cross(omega, swept(c, axes[2], omega))',
        'drawn = cross(omega, moved)',
        'test/mechanics/contact/test_standing.py::'
        'test_a_body_that_slips_is_held_on_the_plane_by_a_force_on_the_cone[0]'),
    'contact: force of rolling without the centripetal term': (
        'mechanics/contact/forces.py', 'net = scaled(-c.mass, at.drawn)',
        'net = scaled(-c.mass, cross(at.omega, at.moved))',
        'test/integrators/marching/test_taylor_on_a_plane.py::'
        'test_the_series_of_a_phase_meet_its_equations_under_friction'
        '[disk-air_film: {viscosity: 0.03}-2]'),
    'contact: moment of its force about the centre of mass turned': (
        'integrators/equations/contact_rates.py', 'torque = plus(contact.push.torque,',
        'torque = minus(contact.push.torque,',
        'test/integrators/marching/test_convex_body.py::'
        'test_dry_rolling_friction_stops_a_ball_where_it_says'),
    'contact: restitution goes on into the plane': (
        'mechanics/contact/laws.py', '(1.0 + restitution) * vz', '(1.0 - restitution) * vz',
        'test/mechanics/contact/test_laws.py::test_an_impact_obeys_newton_and_coulomb[0-0.5-0.7]'),
    'contact: loss of an impact by the velocity before it': (
        'integrators/equations/contact_impacts.py',
        'loss = -0.5 * dot(given, plus(before, after))', 'loss = -0.5 * dot(given, before)',
        'test/integrators/marching/test_convex_body.py::'
        'test_impulse_into_the_plane_is_taken_by_the_plane'),
    'contact: film of air heats by the speed alone': (
        'integrators/equations/contact_rates.py',
        'contact.film * contact.speed * contact.speed', 'contact.film * contact.speed',
        'test/integrators/marching/test_taylor_on_a_plane.py::'
        'test_the_series_of_a_phase_meet_its_equations_under_friction'
        '[disk-air_film: {viscosity: 0.03}-2]'),
    'contact: friction of a spin drives it': (
        'mechanics/contact/patch.py', 'third = -side * size', 'third = side * size',
        'test/mechanics/contact/test_patch.py::'
        'test_a_patch_that_pivots_slips_as_it_is_said_and_goes_on_the_cone[1-1.0]'),
    'contact: slip begins where friction holds': (
        'integrators/marching/contact_succession.py',
        'if mode == ROLLING and row[GRIP] < -HOLDS * mu * row[NORMAL]',
        'if mode == ROLLING and row[GRIP] > HOLDS * mu * row[NORMAL]',
        'test/integrators/marching/test_hard_contacts.py::'
        'test_a_slip_that_turns_round_does_not_roll[0.1-sliding began-dop8]'),
    'contact: weight along a slope turned': (
        'integrators/equations/contact_acting.py',
        'Applied(rotate_back(*c.plane, fx, fy, fz)', 'Applied(rotate(*c.plane, fx, fy, fz)',
        'test/integrators/marching/test_hard_contacts.py::'
        'test_a_slip_that_turns_round_does_not_roll[0.4-rolling began-dop8]'),
}
QUICK = ('dop8: a digit of a weight', 'contact: restitution goes on into the plane')


def killed(name, folder):
    """Return whether the named test fails on a mutant below a folder.

    The test must pass on the original.
    """
    file, found, put, test = MUTANTS[name]
    copy = pathlib.Path(folder) / 'tree'
    for part in ('rigid_body_sim', 'test', 'config'):
        shutil.copytree(ROOT / part, copy / part, ignore=shutil.ignore_patterns('__pycache__'))
    for part in ('pyproject.toml', 'package.xml'):
        shutil.copy(ROOT / part, copy / part)
    path = copy / 'rigid_body_sim' / file
    text = path.read_text()
    if text.count(found) < 1:
        raise LookupError(f'{file} no longer holds {found!r}: the mutant {name!r} needs another '
                          'line')
    environment = {key: value for key, value in os.environ.items() if not key.startswith('PYTEST')}
    environment |= {
        'NUMBA_DISABLE_JIT': '1', 'PYTHONPATH': str(copy), 'PYTHONDONTWRITEBYTECODE': '1'}
    path.write_text(text.replace(found, put))
    try:
        done = subprocess.run(
            [sys.executable, '-m', 'pytest', '-q', '-x', '-p', 'no:cacheprovider', test], cwd=copy,
            env=environment, capture_output=True, text=True, timeout=300)
    except subprocess.TimeoutExpired:
        return True     # it went on for ever: no test would let that pass
    if done.returncode not in (0, 1):
        raise LookupError(f'{test} did not run: {done.stdout[-500:]}{done.stderr[-500:]}')
    return done.returncode == 1
