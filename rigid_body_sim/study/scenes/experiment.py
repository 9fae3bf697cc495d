"""An experiment: a scene set in motion by one method, and the instruments that read the motion."""

import numpy as np
from scipy.optimize import brentq

from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation

ACCURACY = 1e-13    # rad in 100 s, far below the tolerances
NODES = 17          # of the interpolation that differentiates


class Experiment:
    """One run of a scene.

    Parameters
    ----------
    scene : scenes.Scene
    method : str
        ``exact``, or a smooth method that integrates the full equations of motion.
    accuracy : float
        Asked of a smooth method, rad in 100 s.
    """

    def __init__(self, scene, method, accuracy=ACCURACY):
        self.scene, self.method = scene, method
        self.simulation = Simulation(scene, method, accuracy)
        self._accuracy = accuracy

    def variant(self, changes):
        """Return the same experiment with changes of the scene, {key.path: numbers}."""
        overrides = [f'{key}={np.asarray(value).tolist()}' for key, value in changes.items()]
        return Experiment(
            parse_scene(self.scene.text, overrides, self.scene.name), self.method, self._accuracy
        )

    def states(self, times):
        """Return the States at times (s)."""
        return self.simulation.states(times)

    def at(self, time):
        """Return the State at a time (s)."""
        return self.states([time])[0]

    def read(self, value, times):
        """Return what an instrument, `value(states)`, reads at times; shape (n,) or (n, ...)."""
        return np.asarray(value(self.states(np.atleast_1d(times))))

    def crossings(self, value, begin, end, samples, rising=None):
        """Return the times (s) at which a reading goes through zero, refined to rounding by root finding.

        `samples`: how often it is looked at in between, enough that no two crossings lie closer.
        rising: True or False for one direction.
        """
        times = np.linspace(begin, end, samples + 1)
        readings = self.read(value, times)
        above = readings > 0.0
        places = [
            k
            for k in np.flatnonzero(above[1:] != above[:-1])
            if rising is None or above[k + 1] == rising
        ]
        return np.array(
            [
                brentq(
                    lambda time: self.read(value, time)[0],
                    times[k],
                    times[k + 1],
                    xtol=1e-300,
                    rtol=8.9e-16,
                )
                for k in places
            ]
        )

    def derivative(self, value, time, width, order=1):
        """Return the time derivative of a reading, from polynomial interpolation at Chebyshev points within `width` (s) of a time."""
        points = np.cos(np.pi * (np.arange(NODES) + 0.5) / NODES)
        readings = self.read(value, time + width * points)
        fit = np.polynomial.chebyshev.chebfit(points, readings, NODES - 1)
        slope = np.polynomial.chebyshev.chebder(fit, order)
        return np.polynomial.chebyshev.chebval(0.0, slope) / width**order
