#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fit the inertia and the start of a body to a recorded attitude.

The attitude of a free body determines its moments up to a common factor, so the ratios I2/I1 and
I3/I1 and the three rates are sought. Each step of the search needs the residual at six points that
lie close together: one ensemble. The covariance of the fit says how well the noise lets
them be known, and the fit is compared with it.
"""

import argparse

import numpy as np
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from rigid_body_sim import ensemble, parse_scene

SCENE = """
scene: recorded
body: {mass: 1.0, inertia: [1.0, 1.4, 2.1]}
constraint: free
effects: []
initial: {angular_velocity: [0.4, 1.5, 0.7]}
"""
TRUE = np.array([1.4, 2.1, 0.4, 1.5, 0.7])
GUESS = np.array([1.3, 1.9, 0.5, 1.4, 0.8])
NAMES = ('I2/I1', 'I3/I1', 'w1 (rad/s)', 'w2 (rad/s)', 'w3 (rad/s)')
STEP = 1e-6    # step of the central differences; their error is its square


def attitudes(scene, points, times):
    """Return the orientations, shape (points, times, 4), of bodies with some parameters."""
    overrides = {'body.inertia': [[1.0, *point[:2]] for point in points],
                 'initial.angular_velocity': [list(point[2:]) for point in points]}
    return ensemble(scene, times=times, overrides=overrides).orientation


def errors(recorded, orientations):
    """Return the rotation vectors from the recorded attitudes to others, rad, flat."""
    return (recorded.inv() * Rotation.from_quat(orientations)).as_rotvec().ravel()


def fit(scene, times, recorded, guess=GUESS):
    """Return scipy's result of the fit to recorded attitudes (a Rotation)."""
    def residual(point):
        return errors(recorded, attitudes(scene, [point], times)[0])

    def jacobian(point):
        steps = STEP * np.eye(len(point))
        found = attitudes(scene, [*(point + steps), *(point - steps)], times)
        ahead, behind = found[:len(point)], found[len(point):]
        return np.array([(errors(recorded, a) - errors(recorded, b)) / (2.0 * STEP)
                         for a, b in zip(ahead, behind, strict=True)]).T
    return least_squares(residual, guess, jacobian, xtol=1e-15, ftol=1e-15, gtol=1e-15)


def record(scene, times, noise, seed=1):
    """Return the attitudes that a noisy instrument records (noise in rad), as a Rotation."""
    exact = Rotation.from_quat(attitudes(scene, [TRUE], times)[0])
    turns = noise * np.random.default_rng(seed).standard_normal((len(times), 3))
    return exact * Rotation.from_rotvec(turns)


def main():
    """Record, fit, compare."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--noise', type=float, default=1e-3, help='noise, rad (1e-3)')
    parser.add_argument('--seconds', type=float, default=20.0, help='duration (20)')
    options = parser.parse_args()
    scene = parse_scene(SCENE)
    times = np.linspace(0.0, options.seconds, 400)
    found = fit(scene, times, record(scene, times, options.noise))
    deviation = options.noise * np.sqrt(np.diag(np.linalg.inv(found.jac.T @ found.jac)))
    print(f'{found.nfev} evaluations; condition of the Jacobian '
          f'{np.linalg.cond(found.jac):.3g}; residual {np.std(found.fun):.3g} rad')
    for name, value, true, sigma in zip(NAMES, found.x, TRUE, deviation, strict=True):
        print(f'  {name:11} {value:.12f}, true {true}, off by {value - true:9.2e}: '
              f'{abs(value - true) / sigma if sigma else 0.0:.2f} standard deviations')


if __name__ == '__main__':
    main()
