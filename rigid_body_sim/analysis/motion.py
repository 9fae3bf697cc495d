# SPDX-License-Identifier: Apache-2.0
"""Quantities that follow from attitude and angular velocity together, tick by tick.

These are omega in world axes, Euler angles, conserved momenta, and slip.
"""

import warnings

import numpy as np
from scipy.spatial.transform import Rotation

from rigid_body_sim.analysis.collectors import Curve, Head, Samples
from rigid_body_sim.analysis.drift import Residual
from rigid_body_sim.scene.constraints.protocol import Mechanism

SAMPLES, HEAD = 8192, 65536
MOST_PHASES = 1000
ROLLS = 1e-9
"""A contact slower than this share of the ball's speed and rim speed does not slip.

Differences of positions tell no more.
"""


class Motion:
    """Takes the ticks of which both pose and angular velocity were recorded.

    Parameters
    ----------
    source : source.Source

    Attributes
    ----------
    angular_velocity_world : Curve
        rad/s.
    euler : Curve
        z-y-z angles alpha, beta, gamma, rad.
    momentum : Residual or None
        Residual of the angular momentum that the scene conserves, see `conserved`.
    slip : Curve or None
        Speed of the point of contact of a sphere on the table, m/s; from differences of
        neighbouring positions.
    phases : list of (str, float)
        Of a sphere on the table, at most MOST_PHASES: ``slip`` or ``roll``, and when it begins
        (s).
    until : float
        Time of the last tick, s.
    samples, head : collectors
        Times (s), quaternions, angular velocities, positions: over the whole recording, and of the
        first ticks without a hole.
    """

    def __init__(self, source):
        self._scene = scene = source.scene
        self._rate = source.history.segments[0].rate
        self.angular_velocity_world, self.euler = Curve(source.ticks), Curve(source.ticks)
        self.conserved = conserved(scene)
        self.momentum = None
        if self.conserved:
            self.momentum = Residual(
                source.history,
                self.conserved.kept,
                self.conserved.scale,
                source.ticks,
                self.conserved.size,
            )
        on_table = scene is not None and scene.constraint.mechanism is Mechanism.TABLE
        self.slip = Curve(source.ticks) if on_table else None
        self.phases, self.until = [], 0.0
        self.samples, self.head = Samples(source.ticks, SAMPLES), Head(HEAD)

    def add(self, stamps, times, orientation, angular_velocity, position):
        """Take n ticks.

        Parameters
        ----------
        stamps, times : array (n,)
            ns, and s from the start.
        orientation : array (n, 4)
        angular_velocity : array (n, 3)
            rad/s, body axes.
        position : array (n, 3)
            m.
        """
        attitude = Rotation.from_quat(orientation)
        world = attitude.apply(angular_velocity)
        self.angular_velocity_world.add(times, world)
        with warnings.catch_warnings():
            # upright, alpha and gamma are not unique: any pair that fits will do
            warnings.simplefilter('ignore')
            self.euler.add(times, attitude.as_euler('ZYZ'))
        if self.momentum:
            self.momentum.add(stamps, times, self.conserved.of(attitude, angular_velocity))
        if self.slip:
            self._add_slip(times, world, position)
        self.until = float(times[-1])
        self.samples.add(times, orientation, angular_velocity, position)
        self.head.add(times, orientation, angular_velocity, position)

    def _add_slip(self, times, world, position):
        """Slip velocity of the contact: v + omega x (-a e_z)."""
        steps = times[2:] - times[:-2]
        whole = steps < 2.5 / self._rate if self._rate else steps > 0.0
        if whole.any():
            v = (position[2:] - position[:-2])[whole] / steps[whole, None]
            omega, a = world[1:-1][whole], self._scene.body.radius
            at, slip = times[1:-1][whole], np.hypot(
                v[:, 0] - a * omega[:, 1], v[:, 1] + a * omega[:, 0]
            )
            self.slip.add(at, slip)
            self._add_phases(
                at,
                slip
                > ROLLS * (np.hypot(v[:, 0], v[:, 1]) + a * np.hypot(omega[:, 0], omega[:, 1])),
            )

    def _add_phases(self, times, slips):
        last = self.phases[-1][0] == 'slip' if self.phases else not slips[0]
        for k in np.flatnonzero(np.diff(slips, prepend=last))[
            : MOST_PHASES - len(self.phases)
        ].tolist():
            self.phases.append(
                ('slip' if slips[k] else 'roll', float(times[k]) if self.phases else 0.0)
            )


class Conserved:
    """An angular momentum that a scene conserves.

    It has a `name`, a number of components (`size`), |L| at the start (`scale`), and says where it
    is `kept`.
    """

    def __init__(self, name, scene, inertia, kept):
        self.name, self._inertia, self._vertical = name, inertia.matrix, name == 'L_z'
        self.size = 1 if self._vertical else 3
        self.scale = float(np.linalg.norm(self._inertia @ scene.initial.angular_velocity))
        self.kept = (
            lambda segment: segment.scene is not None
            and segment.scene.text == scene.text
            and kept(segment)
        )

    def of(self, attitude, angular_velocity):
        """Return the momentum, (n,) or (n, 3), of attitudes and angular velocities (body)."""
        momentum = attitude.apply(angular_velocity @ self._inertia)
        return momentum[:, 2] if self._vertical else momentum


def conserved(scene):
    """Return the Conserved of a scene, or None if there is none.

    It is L of a free body, L or its vertical part about a fixed point under nothing but weight.
    """
    if scene is None or scene.constraint.mechanism not in (Mechanism.FREE, Mechanism.POINT):
        return None

    if scene.constraint.mechanism is Mechanism.FREE:
        return Conserved(
            'L', scene, scene.body.about_center, lambda segment: segment.keeps_momentum
        )
    if scene.weight is None:
        return None
    return Conserved(
        'L_z' if scene.weight else 'L',
        scene,
        scene.constraint.inertia(scene.body),
        lambda segment: segment.keeps_energy,
    )
