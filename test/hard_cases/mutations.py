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
        'integrators/marching/dormand_prince.py', '0.054293734116568765', '0.054293734116468765',
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
}
QUICK = ('dop8: a digit of a weight',)


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
