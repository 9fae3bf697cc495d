# SPDX-License-Identifier: Apache-2.0
"""Once the clock of a node runs, nothing is compiled, loaded or imported for the first time.

How late a tick is depends on the machine; what it does for the first time does not. So these
tests look at the latter: see cold_starts.py.
"""

import json
import os
import pathlib
import subprocess
import sys

import pytest
from soak import IN_SOAK, SOAK

from rigid_body_sim.compilation.jit import HAVE_NUMBA

DRIVER = pathlib.Path(__file__).with_name('cold_starts.py')
CASES = [
    ['scene:=tennis_racket', 'record:=false'],
    ['scene:=tennis_racket', 'publish:=[odom, imu, marker, clock]',
     'recording.directory:={folder}'],
    ['scene:=tennis_racket', 'rate:=4000', 'record:=false'],
    ['scene:=free_body', 'integrator:=dop8', 'record:=false'],
    ['scene:=sphere', 'publish:=[imu]', 'record:=false'],
    ['scene:=heavy_top', 'publish:=[reaction, imu]', 'record:=false'],
    ['scene:=kater_pendulum', 'publish:=[reaction, joint_states]', 'record:=false'],
    # a strike and a change of torque that the rehearsal does not reach
    ['scene:=billiard_center', 'scene_overrides:=[strike.time=0.11]', 'record:=false'],
    ['scene:=driven_body', 'record:=false',
     'scene_overrides:=["torque={times: [0.0, 0.11], '
     'values: [[0.0, 0.0, 0.1], [0.0, 0.1, 0.0]]}"]'],
    # a coin meets the plane after 0.13 s: the rehearsal does not reach it
    ['scene:=tossed_coin', 'record:=false',
     'scene_overrides:=[initial.position.2=0.09, initial.velocity.2=-0.5]'],
    ['scene:=thin_rod', 'rate:=100', 'record:=false'],
]
FEW = [CASES[k] for k in (1, 9)]
"""What `make test` starts: a closed form with a recorder and further topics, and a coin that meets
the plane late."""
COMPILED_IN = 0.05
"""No kernel is compiled in less processor time than this, and no tick here takes as much (s)."""


def cold_starts(domain, folder, cases, timeout, **environment):
    """Start the nodes in fresh processes; return what cold_starts.py tells of each."""
    words = [json.dumps([word.replace('{folder}', str(folder)) for word in case])
             for case in cases]
    environment = {**domain.environment,
                   'PYTHONPATH': os.pathsep.join([os.getcwd(), os.environ.get('PYTHONPATH', '')]),
                   **environment}
    done = domain.run(DRIVER, *words, timeout=timeout, env=environment)
    assert done.returncode == 0, done.stderr
    return [json.loads(line) for line in done.stdout.splitlines() if line.startswith('{')]


@pytest.mark.skipif(not HAVE_NUMBA, reason='nothing is compiled: numba is not installed')
def test_cold_starts_do_nothing_for_the_first_time_once_the_clock_runs(
        ros_domain, tmp_path, compiled_kernels):
    cases = CASES if SOAK else FEW
    found = cold_starts(ros_domain, tmp_path, cases, 280)
    assert len(found) == len(cases)
    assert {start['arguments'][0]: start['first_times']
            for start in found if start['first_times']} == {}
    assert {start['arguments'][0]: start['dearest_tick']
            for start in found if start['dearest_tick'] > COMPILED_IN} == {}
    assert min(start['ticks'] for start in found) > 100


@IN_SOAK
@pytest.mark.skipif(not HAVE_NUMBA, reason='nothing is compiled: numba is not installed')
@pytest.mark.parametrize('case', CASES, ids=lambda case: ' '.join(case)[:60])
def test_cold_start_with_an_empty_cache(ros_domain, tmp_path, case):
    [found] = cold_starts(
        ros_domain, tmp_path, [case], 280, XDG_CACHE_HOME=str(tmp_path / 'cache'))
    assert any((tmp_path / 'cache').rglob('*.nbc'))
    assert found['first_times'] == []
    assert found['dearest_tick'] < COMPILED_IN


def test_a_node_starts_without_what_few_scenes_need():
    """SciPy's modules take a third of what the others take to import, matplotlib as much."""
    code = ('import sys, rigid_body_sim.node.simulation_node\n'
            "print(*{'.'.join(name.split('.')[:2]) for name in sys.modules})")
    done = subprocess.run([sys.executable, '-c', code], capture_output=True, text=True, check=True,
                          timeout=120, env=os.environ | {'PYTHONPATH': os.getcwd()})
    assert set(done.stdout.split()) & {
        'scipy.integrate', 'scipy.optimize', 'scipy.sparse', 'scipy.spatial', 'scipy.special',
        'matplotlib', 'plotly', 'viser', 'xarray', 'sympy', 'pytest'} == set()
