# SPDX-License-Identifier: Apache-2.0
"""An experiment: a scene that moves by one method, and the instruments that read the motion."""

import numpy as np
from scipy.optimize import brentq

from rigid_body_sim.choice.choose import methods_for
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation

SMOOTH = 'dop8'
ACCURACY = 1e-13    # rad in 100 s, far below the tolerances
NODES = 17          # number of nodes of the interpolation that is differentiated


class Experiment:
    """One run of a scene.

    Parameters
    ----------
    scene : scenes.Scene
    method : str
        ``exact``, or a smooth method that integrates the full equations of motion.
    accuracy : float
        Accuracy asked of a smooth method, rad in 100 s.
    """

    def __init__(self, scene, method, accuracy=ACCURACY):
        self.scene, self.method = scene, method
        self.simulation = Simulation(scene, method, accuracy)
        self._accuracy = accuracy

    def variant(self, changes, texts=()):
        """Return the same experiment with changes to the scene, {key.path: numbers or text}.

        A changed scene that the method cannot run is integrated by the smooth method.
        """
        overrides = [f'{key}={np.asarray(value).tolist()}' for key, value in changes.items()]
        overrides += [f'{key}={text}' for key, text in dict(texts).items()]
        scene = parse_scene(self.scene.text, overrides, self.scene.name)
        method = self.method if self.method in methods_for(scene) else SMOOTH
        return Experiment(scene, method, self._accuracy)

    def states(self, times):
        """Return the States at times (s)."""
        return self.simulation.states(times)

    def at(self, time):
        """Return the State at a time (s)."""
        return self.states([time])[0]

    def read(self, value, times):
        """Return the readings of an instrument, `value(states)`, shape (n,) or (n, ...)."""
        return np.asarray(value(self.states(np.atleast_1d(times))))

    def crossings(self, value, begin, end, samples, rising=None):
        """Return the times (s) at which a reading passes through zero, found to round-off.

        Parameters
        ----------
        value : callable
            Takes States and returns the readings.
        begin, end : float
            Span of times that is searched, s.
        samples : int
            Number of intervals of the search, enough that no two crossings share one.
        rising : bool, optional
            Sense of the crossings; both by default.
        """
        times = np.linspace(begin, end, samples + 1)
        readings = self.read(value, times)
        above = readings > 0.0
        places = [k
                  for k in np.flatnonzero(above[1:] != above[:-1])
                  if rising is None or above[k + 1] == rising]
        return np.array([brentq(lambda time: self.read(value, time)[0], times[k], times[k + 1],
                                xtol=1e-300, rtol=8.9e-16)
                         for k in places])

    def derivative(self, value, time, width, order=1):
        """Return the time derivative of a reading.

        The reading is interpolated by a polynomial at Chebyshev points within `width` (s) of the
        time.
        """
        points = np.cos(np.pi * (np.arange(NODES) + 0.5) / NODES)
        readings = self.read(value, time + width * points)
        fit = np.polynomial.chebyshev.chebfit(points, readings, NODES - 1)
        slope = np.polynomial.chebyshev.chebder(fit, order)
        return np.polynomial.chebyshev.chebval(0.0, slope) / width**order
