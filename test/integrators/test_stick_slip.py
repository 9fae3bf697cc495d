# SPDX-License-Identifier: Apache-2.0
"""A body that a slow torque drags over dry friction, against a spring."""

import numpy as np
import pytest

from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation

SCENE = """
scene: stick_slip
body: {mass: 1.0, inertia: [1.4, 1.4, 1.4]}
constraint: {hinge: {axis: [0, 0, 1]}}
effects:
  - torque: {value: [0, 0, '0.8700141743156908*sin(0.666142789247347*t)'], frame: body}
  - spring: {stiffness: 25.7}
  - dry_friction: {torque: 0.2766852323782931}
initial: {angle: 0.21, rate: -1.92}
"""


@pytest.mark.parametrize(('method', 'accuracy', 'apart'), [
    ('gauss16', 1e-8, 3e-11),     # measured: 5.9e-12, without dips.py 1.5e-5
    ('gauss16', 1e-12, 2e-14),    # 1.8e-15, 3.2e-5
    ('dop8', 1e-6, 1e-8)])        # 2.1e-9 either way
def test_no_rest_is_missed_between_two_looks(method, accuracy, apart):
    """The rate of the body dips below zero for less than a quarter of a long step."""
    scene, times = parse_scene(SCENE), np.linspace(0.1, 60.0, 600)
    ends = [Simulation(scene, integrator=one, accuracy=of, horizon=60.0).states(times).orientation
            for one, of in ((method, accuracy), ('dop8', 1e-14))]
    assert np.abs(ends[0] - ends[1]).max() < apart
