# SPDX-License-Identifier: Apache-2.0
"""Every kind of smooth scene against 34 digits (test/data/make_smooth.py), at round-off."""

import json
import pathlib

import numpy as np
import pytest
from data import smooth_cases
from integrators import plain_python
from soak import SOAK

from rigid_body_sim.mechanics.parameters import moment_about_hinge
from rigid_body_sim.numerics.rotations import angle_between

TEST = pathlib.Path(__file__).resolve().parent.parent
REFERENCE = json.loads((TEST / 'data' / 'smooth.json').read_text())
ULP = np.finfo(float).eps


BY_SERIES = ('asymmetric_heavy_top', 'skew_heavy_top', 'driven_body', 'driven_from_rest',
             'driven_in_pieces', 'damped_top', 'thrown_with_drag')
IN_TEST = {
    'dop8': ('asymmetric_heavy_top', 'driven_body', 'driven_from_rest', 'thrown_with_drag',
             'held_free_body', 'held_from_rest', 'held_top_body', 'held_fast_body',
             'held_hinge_body'),
    'gauss16': ('skew_heavy_top', 'driven_in_pieces', 'damped_top', 'major_axis_relaxation',
                'held_free_body_world', 'held_top', 'held_thin_rod', 'held_hinge'),
    'taylor': ('driven_in_pieces', 'thrown_with_drag')}
"""What `make test` runs: every scene but the dearest, and by each method one of each kind."""


@pytest.fixture(scope='module', params=['dop8', 'gauss16', 'taylor'])
def solved(request, plain):
    # under a held wrench it is dop8
    names = BY_SERIES if request.param == 'taylor' else smooth_cases.CASES
    return plain('integrators/plain_python.py', request.param, 'accuracy', '1e-14',
                 *(names if SOAK else IN_TEST[request.param]))


def check(name, states):
    """Compare with the reference.

    Bound: an ulp on omega turns the body by an ulp of all the angle it went through, an ulp on a
    wrench that is held about a hinge by an ulp of what it turns the body, 4 ulp are for input and
    output. Measured: at most 0.79 of it for the attitude (held_hinge), 0.58 for omega
    (held_hinge), 0.67 for the books (driven_from_rest), 0.29 for the rest.
    """
    speed = np.linalg.norm(plain_python.parse_scene(smooth_cases.text(
        name)).initial.angular_velocity)
    for time, expected in REFERENCE[name].items():
        state, exact = (
            np.array(states[time]['state']), np.array([float(x) for x in expected['state']]))
        entries, books = (np.array(states[time]['entries']),
                          np.array([float(x) for x in expected['entries']]))
        speed = max(speed, np.linalg.norm(exact[4:7]))
        floor = ULP * (4.0 + speed * float(time) + 0.5 * pushed(name) * float(time) ** 2)
        assert state[:4] @ exact[:4] > 0.0, 'the sign of q is continuous'
        assert angle_between(*state[:4], *exact[:4]) < floor
        assert np.linalg.norm(state[4:7] - exact[4:7]) <= floor * speed
        for part in (slice(7, 10), slice(10, 13)):
            assert (np.abs(state[part] - exact[part]).max()
                    <= floor * (1.0 + np.abs(exact[part]).max()))
        assert np.abs(entries - books).max() <= floor * max(np.abs(books).max(), ULP)


def pushed(name):
    """Return the angular acceleration (rad/s^2) that a held wrench can give a hinged body."""
    scene, wrench = plain_python.parse_scene(smooth_cases.text(name)), smooth_cases.CASES[name][4]
    if scene.constraint.kind != 'hinge' or wrench is None:
        return 0.0
    force, couple, _ = wrench
    arm = np.linalg.norm(np.subtract(scene.body.center_of_mass, scene.constraint.through))
    return ((arm * np.linalg.norm(force) + np.linalg.norm(couple))
            / moment_about_hinge(scene.body, scene.constraint))


@pytest.mark.parametrize('name', smooth_cases.CASES)
def test_state_and_ledger_are_at_the_floor(name, solved):
    if name in solved:
        check(name, solved[name])


@pytest.mark.parametrize('method', ['dop8', 'gauss16', 'taylor'])
def test_compiled_is_as_good_as_plain_python(method):
    check(
        'asymmetric_heavy_top', plain_python.solve('asymmetric_heavy_top', method, accuracy=1e-14))
