# SPDX-License-Identifier: Apache-2.0
"""What a recording says about its run; the node and `simulate` write the same.

It is enough to understand the recording and to run it again. ``about`` goes into metadata.yaml
(custom_data), into a metadata record of each file and into the journal (entry ``begin``); the
entry ``state`` stands at the start of each file and after each gap. All texts are plain or JSON.
"""

import functools
import json
import pathlib
import platform
import sys
import xml.etree.ElementTree

import numpy

from rigid_body_sim.choice.forecast import Forecast
from rigid_body_sim.compilation import environment
from rigid_body_sim.messages import cdr
from rigid_body_sim.simulation import arithmetic

STATUS_TYPE, STRING_TYPE = 'diagnostic_msgs/msg/DiagnosticStatus', 'std_msgs/msg/String'
OK, WARN, ERROR = 0, 1, 2
UNPACED = ('simulate', 'view')
"""Commands whose recordings have the stamps as publish times."""
SIMULATION_PARAMETERS = {'scene', 'scene_overrides', 'integrator', 'accuracy', 'step', 'rate'}
"""Parameters whose change makes a new Simulation, which continues the one before."""


@functools.cache
def version():
    """Return the package's version as package.xml has it; '' without that file.

    It is in the source tree or in the installed share folder.
    """
    for parent in pathlib.Path(__file__).resolve().parents:
        for path in (parent / 'package.xml', parent / 'share' / 'rigid_body_sim' / 'package.xml'):
            if path.is_file():
                root = xml.etree.ElementTree.parse(path).getroot()
                if root.findtext('name') == 'rigid_body_sim':
                    return root.findtext('version')
    return ''


def machine():
    """Return what a run was made on, as a dict of texts: processor, system, versions.

    States do not depend on it (see simulation/arithmetic.py), except by a method of SciPy's.
    """
    numba = environment.numba if environment.HAVE_NUMBA else None
    return {'processor': environment.processor(), 'system': platform.platform(),
            'libc': ' '.join(platform.libc_ver()), 'python': sys.version,
            'numpy': numpy.__version__, 'numba': numba.__version__ if numba else 'no',
            'sources': environment.sources_key()}


def about(made_by, simulation, parameters):
    """Return what a recording says about its run.

    Parameters
    ----------
    made_by : str
        The command: ``sim_node``, ``simulate``.
    simulation : Simulation
    parameters : dict
        All settings of the subcommand, defaults included.

    Returns
    -------
    dict of str to str
        ``made_by``, ``version``, ``scene`` (YAML as it runs), and JSON: ``simulation`` (what it
        was asked for, and the method it chose), ``parameters``, ``machine``. ``arithmetic`` is
        the promise: a program of that version of the arithmetic makes the same bits of it on
        every machine.
    """
    return {'made_by': made_by, 'version': version(), 'scene': simulation.scene.text,
            'simulation': json.dumps(run_of(simulation)),
            'parameters': json.dumps(parameters), 'machine': json.dumps(machine()),
            'arithmetic': arithmetic.version()}


def run_of(simulation):
    """Return what a Simulation was asked for and what it chose, as a dict.

    With the scene it is enough to make the Simulation again.
    """
    return {'integrator': simulation.integrator, 'accuracy': simulation.accuracy,
            'step': simulation.choice.step, 'rate': simulation.rate,
            **method_of(simulation.choice)}


def method_of(choice):
    """Return a Choice as a dict; `settled` of choice.choose takes it back."""
    told = choice.settled.forecast if choice.settled else Forecast(None, None)    # no trial here
    return {'method': choice.method, 'horizon': choice.horizon, 'tolerance': choice.tolerance,
            'expected_error': told.error, 'met_until': told.met_until}


def state_entry(tick, stamp, simulation):
    """Return the values of the journal's entry ``state``.

    These are the full state at a tick, its stamp (ns; the log time is another if the recording is
    played and recorded again), the wrench that is held, and the run as it is now.
    """
    wrench = simulation.wrench
    return {'tick': tick, 'stamp': stamp, 'vector': simulation.vector.tolist(),
            'energy': simulation.energy,
            'angular_momentum_squared': simulation.angular_momentum_squared,
            'wrench': {'force': wrench.force, 'torque': wrench.torque, 'frame': wrench.frame},
            'scene': simulation.scene.text, 'simulation': run_of(simulation)}


def scene_message(scene):
    """Return the bytes of the latched message ``scene``."""
    return cdr.encode(STRING_TYPE, {'data': scene.text})


def event_message(source, level, name, message, values):
    """Return the bytes of a message on ``events``.

    `values` maps names to texts or numbers, which keep all their digits.
    """
    texts = [{'key': key, 'value': repr(float(value)) if isinstance(value, float) else str(value)}
             for key, value in values.items()]
    return cdr.encode(STATUS_TYPE, {'level': level, 'name': name, 'message': message,
                                    'hardware_id': source, 'values': texts})


def event_text(event):
    """Return (message, values) of what a Simulation noted."""
    values = {'tick': event.tick, 'time': event.time, **event.values}
    return f'{event.name} at t = {event.time:.9g} s', values
