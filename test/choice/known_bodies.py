# SPDX-License-Identifier: Apache-2.0
"""Bodies whose runs are known, for tests of trials and of what they foretell."""

import math

from scipy.spatial.transform import Rotation

from rigid_body_sim.errors import NotConverged
from rigid_body_sim.scene.scene import parse_scene

SLOW = """
scene: struck
body: {mass: 1.0, inertia: [1.0, 2.0, 3.0]}
constraint: free
effects: [EFFECTS]
initial: {angular_velocity: [0.3, 0.2, 0.1]}
"""
TORQUE = 'torque: {value: [0.01, 0.02, 0.01], frame: world}'


class Coasting:
    """A body that turns at its rate about z from its start; `most` is the latest time it knows."""

    def __init__(self, most=math.inf, error=NotConverged):
        self.most, self.error, self.starts = most, error, []

    def start(self, vector):
        self.starts.append(vector.copy())
        started = Coasting(self.most, self.error)
        started.vector = vector.copy()
        return started

    def state(self, time, out):
        if time > self.most:
            raise self.error('no further')
        out[:] = self.vector
        turn = Rotation.from_rotvec((time - self.vector[0]) * self.vector[5:8])
        out[0], out[1:5] = time, (Rotation.from_quat(self.vector[1:5]) * turn).as_quat()

    def states(self, times, out):
        for time, row in zip(times, out, strict=True):
            self.state(time, row)

    def allowance(self, until):
        return None


def coasting_scene(*strikes, effects=(), inertia='[4, 4, 4]'):
    """Return the scene of a body that coasts, with strikes (time, impulse) and other effects."""
    struck = [f'strike: {{impulse: [{impulse}, 0, 0], point: [0, 1, 0], time: {time}, '
              'frame: body}'
              for time, impulse in strikes]
    return parse_scene(f'scene: s\nbody: {{mass: 2, inertia: {inertia}}}\nconstraint: free\n'
                       f'effects: [{", ".join([*struck, *effects])}]\n'
                       'initial: {angular_velocity: [0, 0, 3]}\n')
