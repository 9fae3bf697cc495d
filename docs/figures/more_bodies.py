# SPDX-License-Identifier: Apache-2.0
"""The package of docs/extending, for the figures of its pages."""

import contextlib
import functools
import importlib
import pathlib
import re
import sys
import tempfile
from unittest import mock

import numpy as np

from figures.style import LINES, label, panels
from rigid_body_sim.integrators import METHODS
from rigid_body_sim.motions import MOTIONS
from rigid_body_sim.scene.constraints import CONSTRAINTS
from rigid_body_sim.scene.effects import EFFECTS
from rigid_body_sim.scene.scene import load_scene, parse_scene
from rigid_body_sim.simulation.simulation import Simulation

PAGES = sorted((pathlib.Path(__file__).resolve().parent.parent / 'extending').glob('*.md'))
FILES = dict(re.findall(r'^```\w+\n# (more_bodies/\S+)\n(.*?)^```$',
                        '\n'.join(page.read_text() for page in PAGES),
                        re.MULTILINE | re.DOTALL))
BOOKED = 'kinetic', 'potential', 'dissipated'
FREE = """scene: free
body: {{mass: 0.2, inertia: [0.002, 0.003, 0.0015]}}
constraint: free
effects: [{effect}]
initial: {{angular_velocity: [1.0, 2.0, 10.0]}}
"""


@functools.cache
def _written():
    """Write the package to a folder that is removed with this process; return the folder."""
    folder = tempfile.TemporaryDirectory()
    for name, text in {'more_bodies/__init__.py': '', **FILES}.items():
        path = pathlib.Path(folder.name) / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
    sys.path.insert(0, folder.name)
    importlib.invalidate_caches()
    return folder


@contextlib.contextmanager
def installed():
    """Let the package have its lines in the tables; yield the folder of its files."""
    folder = pathlib.Path(_written().name) / 'more_bodies'

    def of(name):
        return importlib.import_module(f'more_bodies.{name}')
    with (mock.patch.dict(EFFECTS, {'compass': of('compass').Compass,
                                    'paddle': of('paddle').Paddle}),
          mock.patch.dict(CONSTRAINTS, {'ball_joint': of('ball_joint').BallJoint}),
          mock.patch.dict(METHODS, {'ralston3': of('ralston3')}),
          mock.patch('rigid_body_sim.motions.MOTIONS',
                     ('more_bodies.slowing_sphere', *MOTIONS))):
        yield folder


def free(effect):
    """Return the scene of a free body under an effect, given as in a scene file."""
    return parse_scene(FREE.format(effect=effect))


def energies(scene, seconds):
    """Return a figure of the energies of a scene over time, and of what the ledger books."""
    simulation, rows = Simulation(scene, accuracy=1e-9, rate=200.0), []
    for _ in range(round(200.0 * seconds)):
        simulation.advance(1)
        ledger = simulation.ledger()
        rows.append([simulation.time, *(ledger[name] for name in BOOKED)])
    time, kinetic, potential, heat = np.array(rows).T
    figure, [axes] = panels()
    shown = (('kinetic', kinetic), ('potential', potential), ('heat', heat))
    for line, (name, values) in zip(LINES, shown, strict=False):
        if values.any():
            axes.plot(time, values, label=name, **line)
    axes.plot(time, kinetic + potential + heat, label='sum', **LINES[3])
    label(axes, 'time (s)', 'energy (J)', loc='center left', bbox_to_anchor=(1.0, 0.5))
    return figure


def needle(folder):
    """Return the scene of the page about scenes."""
    return load_scene(folder / 'compass_needle.yaml')
