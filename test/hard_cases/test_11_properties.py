# SPDX-License-Identifier: Apache-2.0
"""Group 11, properties of any scene: finite, a unit quaternion, errors as conditioning allows.

A failure shrinks to a scene, which is printed and kept as a file that `simulate --scene` runs.
"""

import json
import os
import subprocess
import sys

import pytest
import yaml
from hard_cases.conditioning import Allowed, anchored_anew
from hard_cases.random_scenes import commands, run, scenes, stepped_scenes
from hypothesis import HealthCheck, Phase, example, given, settings
from hypothesis import strategies as st
from numba_only import LONG_IN_PYTHON
from soak import SOAK

from rigid_body_sim.cli import simulate
from rigid_body_sim.compilation.jit import HAVE_NUMBA
from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.scene import load_scene, parse_scene
from rigid_body_sim.simulation.simulation import Simulation

CHECKS = settings(deadline=None, derandomize=True, phases=(Phase.generate, Phase.shrink),
                  database=None, suppress_health_check=list(HealthCheck))


def keep(place, scene, acts, check):
    """Run a check; where it fails, leave the scene in a file."""
    try:
        check()
    except AssertionError:
        place.write_text(yaml.safe_dump(scene))
        print(f'{place}, after {acts}:\n{place.read_text()}')
        raise


def hold_for_all(place, drawn, acts, count, allow=Allowed.check):
    @settings(CHECKS, max_examples=count)
    @given(scene=drawn, acts=acts)
    def holds(scene, acts):
        found = run(scene, acts)
        if found is not None:
            keep(place, scene, acts, lambda: allow(found[1], found[0]))

    holds()


def test_any_scene_in_closed_form_under_any_commands(tmp_path):
    # measured: 2.0 ulp of energy, 2.8 of momentum, of 8
    hold_for_all(tmp_path / 'failing.yaml', scenes(), commands(), 40_000 if SOAK else 50)


def test_any_scene_that_is_stepped_under_any_commands(tmp_path):
    """A few run in a process that does not compile; `make soak` has more kinds of scenes."""
    if HAVE_NUMBA and not SOAK:
        this = f'{__file__}::{test_any_scene_that_is_stepped_under_any_commands.__name__}'
        done = subprocess.run(
            [sys.executable, '-m', 'pytest', '-q', '-p', 'no:cacheprovider', this],
            capture_output=True, text=True, timeout=200,
            env=os.environ | {'NUMBA_DISABLE_JIT': '1'})
        assert done.returncode == 0, done.stdout
        return
    acts = commands(('impulse', 'advance', 'reset', *(['hold'] if SOAK else [])),
                    st.sampled_from([1e-12, 1e-3, 1.0, 10.0]))
    hold_for_all(
        tmp_path / 'failing.yaml', stepped_scenes(every_effect=SOAK), acts, 2000 if SOAK else 5)


def back_at_its_unstable_place(constraint, body, initial, effects=()):
    """Return a scene that comes back to an unstable place before it ends."""
    return {'scene': 'drawn', 'constraint': constraint, 'effects': [*effects],
            'initial': initial, 'body': {'mass': 1.0, **body}}


@settings(CHECKS, max_examples=20_000 if SOAK else 100)
@given(scene=scenes(), times=st.tuples(st.floats(0.0, 1.0), st.floats(1e-3, 1e3)))
@example(scene=back_at_its_unstable_place(
    'pivot', {'inertia': [0.5, 0.5, 5e-13], 'inertia_about': 'origin',
              'center_of_mass': [0.0, 0.0, -0.01]},
    {'orientation': [0.0, 1.0, 0.0, 0.0], 'angular_velocity': [0.0, 1e-12, 0.0]},
    [{'gravity': {'g': 11.0}}]), times=(0.25, 182.0))
@example(scene=back_at_its_unstable_place(
    'free', {'inertia': [0.125, 1.0, 0.875]},
    {'angular_velocity': [0.0, 9.899437689791357e-10, 1.0]}), times=(0.5625, 132.0))
def test_anchored_anew_on_the_way_it_ends_where_an_ulp_would_bring_it(scene, times):
    """The bound follows from conditioning: what 8 ulp of the state between do to the motion."""
    try:
        simulation = Simulation(parse_scene(json.dumps(scene)))
    except BadInput:
        return
    share, last = times
    error, bound = anchored_anew(simulation, simulation.vector.copy(), share * last, last)
    assert error <= bound


@LONG_IN_PYTHON
def test_a_failure_leaves_a_scene_file_that_the_command_runs(tmp_path, capsys):
    """A check that free bodies fail leaves the smallest one as a file, and `simulate` runs it."""
    def not_free(_, simulation):
        assert simulation.scene.constraint.kind != 'free'
    place = tmp_path / 'failing.yaml'
    with pytest.raises(AssertionError):
        hold_for_all(place, scenes(), commands(), 20, not_free)
    assert load_scene(place).constraint.kind == 'free'
    capsys.readouterr()
    assert simulate.main(['--scene', str(place), '--duration', '0.1', '--json', '--output',
                          str(tmp_path / 'run')]) == 0
    assert json.loads(capsys.readouterr().out)['state']['time'] == 0.1
