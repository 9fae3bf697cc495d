# SPDX-License-Identifier: Apache-2.0
"""A body that a slow torque drags over dry friction, against a spring."""

import numpy as np
import pytest
from soak import IN_SOAK

from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation

SCENE = """
scene: stick_slip
parameters: {since: SINCE}
body: {mass: 1.0, inertia: [1.4, 1.4, 1.4]}
constraint: {hinge: {axis: [0, 0, 1]}}
effects:
  - torque: {value: [0, 0, '0.8700141743156908*sin(0.666142789247347*(t + since))'], frame: body}
  - spring: {stiffness: 25.7}
  - dry_friction: {torque: 0.2766852323782931}
initial: START
"""
WHOLE = '0.0', '{angle: 0.21, rate: -1.92}', 60.0
LATE = '42.2', '{angle: 0.020595, rate: -0.032421}', 3.2
"""Since when the torque acts, s; the start; for how long the body is followed, s. In the late
part, where the body is about to stick, steps of plain Python are cheaper than to compile them."""


@pytest.mark.parametrize(('method', 'accuracy', 'apart', 'part'), [
    # measured: 4.8e-12, without dips.py 1.2e-5
    pytest.param('gauss16', 1e-8, 3e-11, LATE, marks=pytest.mark.without_numba),
    pytest.param('gauss16', 1e-8, 3e-11, WHOLE, marks=IN_SOAK),     # 5.9e-12, 1.5e-5
    pytest.param('gauss16', 1e-12, 2e-14, WHOLE, marks=IN_SOAK),    # 1.8e-15, 3.2e-5
    pytest.param('dop8', 1e-6, 1e-8, WHOLE, marks=IN_SOAK)])        # 2.1e-9 either way
def test_no_rest_is_missed_between_two_looks(method, accuracy, apart, part):
    """The rate of the body dips below zero for less than a quarter of a long step."""
    since, start, end = part
    scene = parse_scene(SCENE.replace('SINCE', since).replace('START', start))
    times = np.linspace(0.1, end, round(10.0 * end))
    ends = [Simulation(scene, integrator=one, accuracy=of, horizon=end).states(times).orientation
            for one, of in ((method, accuracy), ('dop8', 1e-14))]
    assert np.abs(ends[0] - ends[1]).max() < apart
