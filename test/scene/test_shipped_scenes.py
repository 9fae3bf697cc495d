# SPDX-License-Identifier: Apache-2.0
"""Every system of the notes ships as a scene that loads and starts."""

import numpy as np
import pytest
from near import near

from rigid_body_sim.scene.scene import load_scene, scene_names
from rigid_body_sim.simulation.simulation import Simulation

NOTES = (
    'billiard_center', 'billiard_low', 'billiard_natural_roll', 'billiard_follow',
    'kater_pendulum', 'kater_pendulum_from_p',
    'baseball_bat', 'driven_body', 'free_body', 'symmetric_top', 'chandler_wobble',
    'asymmetric_top', 'tennis_racket',
    'major_axis_relaxation', 'heavy_top', 'steady_precession', 'fast_top', 'sleeping_top',
    'falling_top', 'thin_rod', 'sphere',
    'needle', 'spherical_pendulum')


def test_none_is_missing():
    assert set(NOTES) <= set(scene_names())


@pytest.mark.without_numba
@pytest.mark.parametrize('name', NOTES)
def test_scene(name):
    """A scene has the name of its file, names its section of the notes, runs, and balances."""
    scene = load_scene(name)
    assert scene.name == name
    assert '(notes, ' in scene.about
    simulation = Simulation(scene)
    simulation.advance(50)
    assert np.isfinite(simulation.vector).all()
    # the scene's own tests have the measured errors; this only asks that nothing is lost
    assert abs(simulation.ledger()['energy_residual']) < 1e-12


def test_the_pendulum_hangs_the_same_way_from_both_edges():
    """The pendulum is turned over: its centre of mass is below the edge and the swing the same."""
    for name, below in (('kater_pendulum', 0.4), ('kater_pendulum_from_p', 0.6)):
        scene = load_scene(name)
        height = np.array(scene.body.center_of_mass) - scene.constraint.through
        # R_zz
        turned = (1.0
                  - 2.0 * (scene.initial.orientation[0] ** 2 + scene.initial.orientation[1] ** 2))
        assert height[2] * turned == near(-below * np.cos(0.1), 1e-14)
