# SPDX-License-Identifier: Apache-2.0
"""The errors that conditioning allows a state and a residual, given roundings on the way."""

import math

import numpy as np

from rigid_body_sim.integrators.methods import dop8
from rigid_body_sim.mechanics.bounds import swing_rate
from rigid_body_sim.mechanics.parameters import moment_about_hinge
from rigid_body_sim.mechanics.quadrature import MOST, RADIANS
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.numerics.rotations import angle_between
from rigid_body_sim.scene.state import ANGULAR_VELOCITY, ORIENTATION, VELOCITY

EPSILON = float(np.finfo(float).eps)
SMALLEST = 5e-324       # energies of 1e-320 J are whole multiples of this
WEIGHTS = sum(map(abs, dop8.B.values()))
"""12.9: an ulp of each stage in a sum of the work by dop8, which makes stepped ledgers."""
FEW = 8.0
"""Ulp of each number of a state. Measured over 5500 scenes: 2.0 (energy), 2.8 (momentum)."""


class Allowed:
    """The sum of what an ulp does to states at which a motion is anchored or looked at.

    An ulp of omega (of its largest size, as closed forms round it) changes the energy by
    I_k |omega_k| |omega| a component, the momentum by |I| |omega|; an ulp of the attitude lifts
    the weight M g by the arm; one of v changes M v^2. Nothing of it grows with time, but for the
    angular impulse of the weight, which is a sum over the time. For a needle the terms are
    sqrt(I_max/I_min) times the energy: that is its conditioning. A method that steps adds the
    accuracy it was asked for, in proportion to the time. The ledger sees the power of drag at
    times rounded to the clock's ulp, in which a decay of 1e-12 s is not smooth: that power times
    an ulp of the time is uncertain.

    Attributes
    ----------
    energy, momentum : float
        J, kg m^2/s.
    """

    def __init__(self, simulation):
        scene = simulation.scene
        body, kind, gravity = scene.body, scene.constraint.kind, scene.effect('gravity')
        self._moments = np.array((body.about_origin if kind == 'pivot'
                                  else body.about_center).moments)
        if kind == 'hinge':
            self._moments = np.full(3, moment_about_hinge(body, scene.constraint))
        self._mass = body.mass if kind in ('free', 'table') else 0.0
        self._weight = (body.mass * gravity.g * float(np.linalg.norm(body.center_of_mass))
                        if gravity else 0.0)
        self._swing = swing_rate(scene)
        choice = simulation.choice
        # 1/s
        self._loss = 0.0 if choice.method == 'exact' else choice.accuracy / choice.horizon
        self._quadrature = 1.0 if choice.method == 'exact' else WEIGHTS
        self._drag = scene.effect('drag')
        self.restart(simulation)

    def restart(self, simulation):
        """Begin anew at the present state, as the ledger does at a reset."""
        self.energy, self.momentum = FEW * SMALLEST, FEW * SMALLEST
        self._time, self._least, self._power = simulation.time, 0.0, 0.0
        self.look(simulation)
        ledger = simulation.ledger()
        self._least = max(ledger['kinetic'], abs(ledger['potential']))
        self._start = ledger['angular_momentum_squared'] ** 0.5

    def look(self, simulation):
        """Add what the present state may have lost."""
        omega, v = np.abs(simulation.vector[ANGULAR_VELOCITY]), simulation.vector[11:14]
        passed = simulation.time - self._time
        size = hypot3(*omega.tolist()) + self._swing    # of 1e-163 the squares are 0
        ulp = FEW * (EPSILON + self._loss * passed)
        self.energy += ulp * (float(self._moments @ omega) * size + self._mass * float(v @ v)
                              + self._weight + self._quadrature * abs(simulation.ledger()['work']))
        self.energy += self._power * math.ulp(simulation.time)    # measured: 0.06 ulp
        if self._drag:
            self._power = self._drag.linear * float(v @ v) + self._drag.angular * size * size
        # the ledger's quadrature of the weight's torque has a limited number of panels: beyond, it
        # no longer follows the turning
        resolved = size * passed <= RADIANS * MOST
        self.momentum += (ulp * float(np.linalg.norm(self._moments)) * size
                          + (ulp if resolved else 1.0) * self._weight * passed)
        self._time = simulation.time

    def check(self, simulation):
        """Assert finite numbers, a unit quaternion, and residuals within what is allowed."""
        vector, ledger = simulation.vector, simulation.ledger()
        assert np.isfinite(vector).all()
        assert np.isfinite(list(ledger.values())).all()
        q = vector[ORIENTATION]
        assert abs(q @ q - 1.0) <= 5.0 * EPSILON        # measured 3
        scale = max(self._least, ledger['kinetic'], abs(ledger['potential']), abs(ledger['work']))
        assert abs(ledger['energy_residual']) * scale <= self.energy
        assert (ledger['momentum_residual'] * max(
            self._start, ledger['angular_momentum_squared'] ** 0.5) <= self.momentum)


NONLINEAR = 0.05
"""rad. A larger change does not depend linearly on ulps: no sample of them bounds it."""
SIZES = FEW * 2.0 ** -np.arange(0.0, 25.0, 4.0)
"""Shifts in ulps of the whole vector, down to the ulp of a component that is 2^-24 of it."""
LOOKS = 25
"""Times between the anchor and the end at which shifted motions are compared."""


def anchored_anew(simulation, vector, first, last):
    """Return (error, bound): what a second anchor does to the end, and what ulps of it can do.

    The error is the angle (rad) at `last` (s) between the motion from 0 s and the same motion
    anchored anew at `first` (s). The bound shifts each component of the anchor's q, omega and v by
    ulps of many sizes and takes how far that moves the body, anywhere between the anchor and the
    end: near a separatrix or an unstable axis ulps grow by e^(lambda T). A body that comes back to
    its unstable place misses it by 1e-12 or 1e-9 rad, as ulps decide, and leaves at quite
    different times. At the end it may have come back again, so that unrelated motions look alike
    there: a few shifts, compared at the end alone, bound nothing. So, where a shift moves the body
    by more than `NONLINEAR` on the way, the bound is half a turn. The floor of a closed form is
    added to the bound: 4 ulp of the whole angle turned, even if nearly all of it lies before the
    anchor.
    """
    motion, wrench = simulation.choice.solver, simulation.wrench
    times = np.linspace(last, first, LOOKS, endpoint=False)

    def attitudes(start):
        solver, out = motion(start, wrench), np.empty(14)
        for time in times:
            solver.state(time, out)
            yield out[ORIENTATION].tolist()

    whole, middle = np.empty(14), np.empty(14)
    solver = motion(vector, wrench)
    solver.state(last, whole)
    solver.state(first, middle)
    again = list(attitudes(middle.copy()))
    error = angle_between(*again[0], *whole[ORIENTATION])
    fastest = max(float(np.linalg.norm(state[ANGULAR_VELOCITY]))
                  for state in (vector, middle, whole))
    moved, floor = 2e-15, 4.0 * EPSILON * fastest * last
    for part in (ORIENTATION, ANGULAR_VELOCITY, VELOCITY):
        length = float(np.linalg.norm(middle[part]))
        for k in range(part.start, part.stop):
            for ulps in (*SIZES, *-SIZES):
                shifted = middle.copy()
                shifted[k] += ulps * EPSILON * length
                shifted[ORIENTATION] /= np.linalg.norm(shifted[ORIENTATION])
                for one, other in zip(again, attitudes(shifted)):
                    moved = max(moved, angle_between(*one, *other))
                if moved > NONLINEAR:
                    return error, np.pi
    return error, moved + floor
