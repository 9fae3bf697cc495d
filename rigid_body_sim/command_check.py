"""What is no command, and what a body cannot take: tried on a copy of the present state before a command acts."""

import math

import numpy as np

from rigid_body_sim import mechanics
from rigid_body_sim.errors import BadInput
from rigid_body_sim.state import ANGULAR_VELOCITY, STATE_SIZE

LARGEST_WORK = 1e250
"""Work (J) of one command: the energies of all that a tick takes stay far below what a double holds."""
LARGEST_TURN = 1e7
"""Angle (rad) through which a held wrench may turn the body within a tick: beyond, a tick would take minutes."""


class CommandCheck:
    """Refuses what is no command, and commands that a body cannot take.

    Parameters
    ----------
    scene : Scene
    parameters : array
        Of the scene (mechanics.parameters).
    rate : float
        Ticks per second: a wrench is tried as what it gives in a tick, an impulse as it is.
    """

    def __init__(self, scene, parameters, rate):
        self._scene, self._parameters, self._rate = scene, parameters, rate
        # thousands of commands a second are checked: the arrays are made once
        self._after, self._exchange = np.empty(STATE_SIZE), np.empty(mechanics.EXCHANGE_SIZE)
        self._force, self._torque = np.empty(3), np.empty(3)

    def well_formed(self, force, torque, frame, what):
        """Return a force and a torque as tuples of floats; BadInput if they or the frame are none, or the scene refuses commands."""
        if not self._scene.accepts_commands:
            raise BadInput(what, f'the scene {self._scene.name} refuses commands', 'its key `commands` says so; set commands: accept')
        force, torque = tuple(map(float, force)), tuple(map(float, torque))
        if (len(force), len(torque)) != (3, 3) or not all(map(math.isfinite, force + torque)):
            raise BadInput(what, f'got force {list(force)}, torque {list(torque)}', 'three finite numbers each')
        if frame not in ('world', 'body'):
            raise BadInput(what, f'got frame {frame!r}', "'world' or 'body'")
        return force, torque

    def bearable(self, state, force, torque, what):
        """Raise BadInput if a force (N or N s) and a torque (N m or N m s), world axes, cannot act on a state; `what`: impulse or wrench."""
        self._after[:], self._force[:], self._torque[:] = state, force, torque
        if what == 'wrench':
            self._force /= self._rate
            self._torque /= self._rate
        if not mechanics.apply_impulse(self._parameters, self._after, self._force, self._torque, self._exchange):
            raise BadInput(what, f'torque {list(torque)} (world axes) about an axis of zero moment',
                           'leave that component 0: an axis without moment takes no angular momentum')
        work = self._exchange.item(mechanics.WORK)
        if not abs(work) <= LARGEST_WORK:
            raise BadInput(what, f'force {list(force)}, torque {list(torque)} would do a work of {work!r} J',
                           f'at most {LARGEST_WORK:g} J: energies are doubles')
        if what == 'wrench' and (any(force) or any(torque)):
            turn = float(np.abs(self._after[ANGULAR_VELOCITY]).max()) / self._rate
            if turn > LARGEST_TURN:
                raise BadInput(what, f'torque {list(torque)} would turn the body by {turn:.3g} rad within a tick',
                               f'at most {LARGEST_TURN:g} rad: hold less, or give it as an impulse')
