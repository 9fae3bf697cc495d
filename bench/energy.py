# SPDX-License-Identifier: Apache-2.0
"""Energy over a million steps of a composition: compensated and plain sums.

    .venv/bin/python bench/energy.py [--json] [--steps N]

An asymmetric heavy top runs by split4 with steps of 5e-4 s; the energy is formed at a thousand
states, as a share of the largest of |kinetic| and |potential|. The figures are the largest
residual, the rise of a straight line fitted to it over the run, and the largest residual of L_z,
which gravity conserves too, as a share of |L|. The exit status is 1 if the residual of the
compensated energy exceeds 1e-14 or its line rises by a tenth of that.
"""

import argparse
import json
import sys
import time
import types

import numpy as np

from rigid_body_sim.integrators import METHODS
from rigid_body_sim.integrators.families import composition
from rigid_body_sim.integrators.methods import split4
from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.mechanics.energy import DIAGNOSIS_SIZE, KINETIC, MOMENTUM, POTENTIAL
from rigid_body_sim.mechanics.parameters import parameters
from rigid_body_sim.mechanics.potential import energies
from rigid_body_sim.scene.scene import parse_scene

SCENE = """scene: counted
body: {mass: 1.0, inertia: [0.03, 0.02, 0.01], inertia_about: origin, center_of_mass: [0, 0, 0.1]}
constraint: pivot
effects: [gravity: {g: 9.81}]
initial: {tilt: 0.5, angular_velocity: [0, 0, 60]}"""
STEP, SAMPLES = 5e-4, 1001
ALLOWED, ALLOWED_RISE = 1e-14, 1e-15

PLAIN_DRIFT = """
from {flows} import drift as carried_drift


@compiled
def drift(p, y, c, h):
    y, _ = carried_drift(p, y, c, h)
    return y, (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
"""
PLAIN_KICK = """
from {flows} import kick as carried_kick


@compiled
def kick(p, y, c, h):
    y, lost = carried_kick(p, y, c, h)
    return y, (*lost[:4], 0.0, 0.0, 0.0)
"""


def plain(method):
    """Return the method with plain sums, which drop the rounding errors of a flow.

    The attitude is still brought back to norm 1.
    """
    def step_source(method, bound):
        flows = composition.flows(bound).__name__
        return composition.composed_source(method, PLAIN_DRIFT.format(flows=flows),
                                           PLAIN_KICK.format(flows=flows))

    family = types.SimpleNamespace(**{**vars(composition), 'step_source': step_source})
    return types.SimpleNamespace(
        **{**vars(method), 'NAME': f'plain {method.NAME}', 'FAMILY': family})


def residuals(scene, method, steps):
    """Return the residuals of energy and L_z, shape (2, samples), and CPU seconds of a step."""
    solver = Stepped(scene, method, step=STEP).start(scene.initial.vector)
    solver.state(STEP, np.empty(14))    # the first step compiles
    times, out = np.linspace(0, steps, SAMPLES).round() * STEP, np.empty((SAMPLES, 14))
    begin = time.process_time()
    solver.states(times, out)
    cost = (time.process_time() - begin) / steps
    p, diagnose = parameters(scene), energies(scene).diagnose
    found = np.empty((SAMPLES, DIAGNOSIS_SIZE))
    for vector, row in zip(out, found, strict=True):
        diagnose(p, vector, row)
    kinetic, potential, vertical = found[:, KINETIC], found[:, POTENTIAL], found[:, MOMENTUM + 2]
    energy = kinetic + potential
    scale = max(np.abs(kinetic).max(), np.abs(potential).max())
    size = np.linalg.norm(found[0, MOMENTUM:MOMENTUM + 3])
    return np.array([(energy - energy[0]) / scale, (vertical - vertical[0]) / size]), cost


def main():
    """Measure and print; return the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--json', action='store_true')
    parser.add_argument('--steps', type=int, default=1_000_000)
    options = parser.parse_args()
    scene, table = parse_scene(SCENE), {}
    METHODS['plain split4'] = plain(split4)
    for label, method in (('compensated', 'split4'), ('plain', 'plain split4')):
        (energy, vertical), cost = residuals(scene, method, options.steps)
        rise = float(np.polyfit(np.linspace(0.0, 1.0, SAMPLES), energy, 1)[0])
        table[label] = {'energy': float(np.abs(energy).max()), 'rise': rise,
                        'vertical_momentum': float(np.abs(vertical).max()),
                        'microseconds_per_step': 1e6 * cost}
    good = (table['compensated']['energy'] < ALLOWED
            and abs(table['compensated']['rise']) < ALLOWED_RISE)
    if options.json:
        print(json.dumps({'steps': options.steps, 'split4': table, 'allowed': ALLOWED,
                          'allowed_rise': ALLOWED_RISE, 'good': good}))
    else:
        title = f'{options.steps} steps of split4'
        print(f'{title:30}{"energy":>12}{"its rise":>12}{"L_z":>12}{"us a step":>12}')
        for label, row in table.items():
            print(f'{label:30}{row["energy"]:>12.1e}{row["rise"]:>12.1e}'
                  f'{row["vertical_momentum"]:>12.1e}{row["microseconds_per_step"]:>12.2f}')
    return int(not good)


if __name__ == '__main__':
    sys.exit(main())
