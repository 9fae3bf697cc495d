# SPDX-License-Identifier: Apache-2.0
"""The session of a node runs a scene of every effect: ticks, commands, a reset, a balance.

A node runs exactly this before its clock starts; what is left is the wire, which knows no effect.
"""

import pytest
from scene import effect_cases
from soak import IN_SOAK

from rigid_body_sim.messages.state_topics import Frames, chosen, scene_messages
from rigid_body_sim.node.rehearsal import rehearse
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation


@pytest.mark.without_numba
@IN_SOAK
def test_a_session_runs_a_scene_of_every_effect():
    for name, number in effect_cases.ALL:
        if number:
            continue
        scene = parse_scene(effect_cases.text(name, number))
        held = scene.constraint.holds_a_point
        wanted = ('odom', 'imu', 'reaction') if held else ('odom', 'imu')
        simulation = Simulation(scene, 'dop8', accuracy=1e-6, rate=1000.0)
        rehearse(simulation, scene_messages(chosen(wanted), scene, Frames()))
