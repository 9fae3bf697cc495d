# SPDX-License-Identifier: Apache-2.0
"""Orekit as a peer: what it is not asked, and that its conventions are understood."""

import pytest
from near import near

pytest.importorskip('numba')    # the numbers of peers have compiled equations beside them

from rigid_body_sim.numerics.rotations import angle_between
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation
from rigid_body_sim.study.precision import suite
from rigid_body_sim.study.precision.peers import orekit_engine
from rigid_body_sim.study.precision.runner import RefusedError


@pytest.mark.parametrize('name', ['heavy_symmetric_top', 'driven_body', 'damped_body',
                                  'ball_slip_to_roll', 'separatrix_pendulum'])
def test_it_is_asked_for_free_rotations_only(name):
    with pytest.raises(RefusedError, match='anything but a free rotation'):
        list(orekit_engine.runners(suite.problem(name), None))


def test_it_turns_a_skew_body_as_we_do():
    """Neither the body nor its start is along the axes; measured: 1.5e-14 rad, 4e-15 of omega."""
    pytest.importorskip('orekit_jpype')
    scene = parse_scene(
        'scene: skew\nbody: {mass: 1.0, inertia: [[1.3, 0.1, -0.2], [0.1, 2.1, 0.3], '
        '[-0.2, 0.3, 2.9]]}\nconstraint: free\neffects: []\n'
        'initial: {orientation: [0.1, -0.5, 0.3, 0.8], angular_velocity: [0.9, -1.1, 0.7]}\n')
    [runner] = orekit_engine.runners(suite.Problem('skew', '', 10.0, scene), None)
    run = runner.make(None)
    run.start()
    run.to(10.0)
    *q, w1, w2, w3 = run.state()
    there = Simulation(scene).states([10.0])[0]
    assert angle_between(*q, *there.orientation) < 1e-12
    assert [w1, w2, w3] == near(there.angular_velocity.tolist(), rel=1e-12)
