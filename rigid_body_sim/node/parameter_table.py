# SPDX-License-Identifier: Apache-2.0
"""The table of the node's parameters: names, types, defaults, ranges and meanings."""

import array
import dataclasses
import math
import re

from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor
from rclpy.parameter import Parameter

from rigid_body_sim.errors import BadInput, nearest
from rigid_body_sim.messages import robot_description, state_topics
from rigid_body_sim.recording import compression

STATE_TOPICS = tuple(output.name for output in state_topics.EVERY_TICK)
EXTRA_TOPICS = (*(output.name for output in state_topics.ON_REQUEST), robot_description.TOPIC)


@dataclasses.dataclass(frozen=True)
class Entry:
    """One parameter.

    Attributes
    ----------
    name : str
    default : str, bool, float or tuple of str
        Its type is the parameter's type; an integer is accepted for a float.
    about : str
        One line for `ros2 param describe` and the reference page.
    low, high : float
        Least and largest value of a float, both allowed.
    choices : tuple of str
        The words allowed, for a string or for each entry of a list.
    changeable : bool
        Whether ``set_parameters`` may change it while the node runs.
    """

    name: str
    default: object
    about: str
    low: float = -math.inf
    high: float = math.inf
    choices: tuple = ()
    changeable: bool = False

    @property
    def kind(self):
        """The ROS type in words."""
        return {bool: 'bool', str: 'string', float: 'double', tuple: 'string array'}[
            type(self.default)
        ]

    @property
    def limits(self):
        """What is allowed, in words."""
        if self.choices:
            return ', '.join(self.choices)
        return f'{self.low:g} to {self.high:g}' if isinstance(self.default, float) else ''

    def checked(self, value, where=None):
        """Return the value with the parameter's type.

        Raises
        ------
        BadInput
            If the type, the range or a word is wrong.
        """
        where = where or f'parameter {self.name}'
        value = value.tolist() if isinstance(value, array.array) else value
        if isinstance(self.default, float):
            value = number_of(value)
            if isinstance(value, bool) or not isinstance(value, (int, float)):
                raise BadInput(
                    where, f'got {value!r}', f'needs a number from {self.low:g} to {self.high:g}'
                )
            if not self.low <= value <= self.high:
                raise BadInput(
                    where, f'got {value!r}', f'needs a number from {self.low:g} to {self.high:g}'
                )
            return float(value)
        if isinstance(self.default, tuple):
            # an empty list arrives without a type; one word alone is a list of one
            words = (
                [word for word in (value,) if word]
                if value is None or isinstance(value, str)
                else value
            )
            words = words if isinstance(words, (list, tuple)) else [None]
            if not all(isinstance(word, str) for word in words):
                raise BadInput(
                    where,
                    f'got {value!r}',
                    'needs a list of words'
                    + (f', each one of {self.limits}' if self.choices else ''),
                )
            for word in words:
                self._refuse_unknown_word(word, where)
            return tuple(words)
        if not isinstance(value, type(self.default)):
            raise BadInput(
                where,
                f'got {value!r}',
                'needs true or false' if self.kind == 'bool' else 'needs a text',
            )
        if isinstance(value, str):
            self._refuse_unknown_word(value, where)
        return value

    def _refuse_unknown_word(self, word, where):
        if self.choices and word not in self.choices:
            near = nearest(word, self.choices) if len(self.choices) > 3 else None
            raise BadInput(
                where,
                f'got {word!r}',
                f'did you mean {near!r}?' if near else f'needs one of {self.limits}',
            )

    def descriptor(self, fixed):
        """Return the ROS descriptor: type, range, whether it is fixed for good."""
        # a list is declared before it has its value, so rclpy must not treat it as read-only:
        # Settings refuses the change itself
        read_only = fixed and not self.changeable and not isinstance(self.default, tuple)
        descriptor = ParameterDescriptor(
            description=self.about, additional_constraints=self.limits, read_only=read_only
        )
        if isinstance(self.default, float):
            descriptor.floating_point_range = [
                FloatingPointRange(from_value=self.low, to_value=self.high)
            ]
        return descriptor

    def declare(self, node, value, fixed):
        """Declare the parameter with a checked value.

        If `fixed`, those that cannot change while the node runs never change.
        """
        if isinstance(value, tuple):
            # rclpy takes an empty list for one of bytes unless the type is said
            node.declare_parameter(
                self.name,
                Parameter.Type.STRING_ARRAY,
                self.descriptor(fixed),
                ignore_override=True,
            )
            node.set_parameters([Parameter(self.name, Parameter.Type.STRING_ARRAY, list(value))])
        else:
            node.declare_parameter(self.name, value, self.descriptor(fixed), ignore_override=True)


NUMBER = re.compile(r'[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?')


def number_of(value):
    """Return the number in a text; return anything else unchanged.

    The YAML of ``ros2 param set`` and of launch files takes ``1e-9`` for a text.
    """
    return float(value) if isinstance(value, str) and NUMBER.fullmatch(value) else value


TABLE = (
    Entry(
        'scene',
        'tennis_racket',
        'name of a scene that ships, or path of a scene file',
        changeable=True,
    ),
    Entry('scene_overrides', (), 'changes of the scene, each key.path=value', changeable=True),
    Entry('rate', 1000.0, 'ticks per second of simulated time (Hz)', 1e-3, 1e5, changeable=True),
    Entry(
        'integrator',
        'auto',
        'method; auto: the exact one if there is one, else the cheapest that meets accuracy',
        changeable=True,
    ),
    Entry(
        'accuracy',
        1e-12,
        'error of the attitude asked for, over duration or 100 s (rad)',
        1e-15,
        1e-1,
        changeable=True,
    ),
    Entry(
        'step',
        0.0,
        'fixed step of the method (s); 0: steps that meet accuracy',
        0.0,
        1e3,
        changeable=True,
    ),
    Entry(
        'real_time_factor',
        1.0,
        'simulated seconds per second; 0: as fast as it goes',
        0.0,
        1e6,
        changeable=True,
    ),
    Entry(
        'duration', 0.0, 'simulated seconds after which the node ends (s); 0: endless', 0.0, 1e9
    ),
    Entry(
        'overrun',
        'slip',
        'when it cannot keep up: slip (simulated time falls behind) or skip_publish (messages '
        'are left out first)',
        choices=('slip', 'skip_publish'),
        changeable=True,
    ),
    Entry(
        'publish',
        (),
        f'topics beside {", ".join(STATE_TOPICS)}',
        choices=STATE_TOPICS + EXTRA_TOPICS,
    ),
    Entry(
        'display_rate',
        state_topics.DISPLAY_RATE,
        'how often marker and tf are published (Hz of simulated time), at most at every tick',
        1e-3,
        1e5,
    ),
    Entry(
        'stamp_origin',
        'clock',
        'stamp of tick 0: the node clock at start, or zero',
        choices=('clock', 'zero'),
    ),
    Entry('frame_prefix', 'auto', 'put before both frame names; auto: the namespace of the node'),
    Entry('world_frame', 'world', 'name of the fixed frame'),
    Entry('body_frame', 'body', 'name of the frame that moves with the body'),
    Entry(
        'command_timeout',
        0.0,
        'a held wrench ends this long after its last message (s); 0: it is held until replaced',
        0.0,
        1e6,
        changeable=True,
    ),
    Entry('record', True, 'record to MCAP'),
    Entry(
        'recording.directory',
        'recordings',
        'folder in which each run makes a recording of its own',
    ),
    Entry('recording.name', '', 'name of the recording; empty: node, scene, date and time'),
    Entry(
        'recording.compression',
        'auto',
        'compression of chunks; auto: zstd',
        choices=('auto', *compression.NAMES),
    ),
    Entry(
        'recording.split_bytes',
        0.0,
        'a new file begins after so many bytes; 0: after 4 GB',
        0.0,
        4e9,
    ),
    Entry(
        'recording.split_seconds',
        0.0,
        'a new file begins after so much time of stamps (s); 0: never',
        0.0,
        1e9,
    ),
    Entry(
        'diagnostics.energy_residual_warn',
        1e-11,
        'WARN above this relative energy residual',
        0.0,
        1e9,
        changeable=True,
    ),
    Entry(
        'diagnostics.energy_residual_error',
        1e-6,
        'ERROR above this relative energy residual',
        0.0,
        1e9,
        changeable=True,
    ),
    Entry(
        'diagnostics.momentum_residual_warn',
        1e-11,
        'WARN above this relative angular momentum residual',
        0.0,
        1e9,
        changeable=True,
    ),
    Entry(
        'diagnostics.momentum_residual_error',
        1e-6,
        'ERROR above this relative angular momentum residual',
        0.0,
        1e9,
        changeable=True,
    ),
    Entry(
        'diagnostics.prediction_warn',
        1e-6,
        'WARN above this relative difference of a measured interval from theory',
        0.0,
        1e9,
        changeable=True,
    ),
    Entry(
        'diagnostics.prediction_error',
        1e-2,
        'ERROR above this relative difference of a measured interval from theory',
        0.0,
        1e9,
        changeable=True,
    ),
    Entry(
        'diagnostics.lateness_warn',
        0.002,
        'WARN above this lateness of ticks, p99 of the last second (s)',
        0.0,
        1e9,
        changeable=True,
    ),
    Entry(
        'diagnostics.lateness_error',
        0.1,
        'ERROR above this lateness of ticks, p99 of the last second (s)',
        0.0,
        1e9,
        changeable=True,
    ),
)
ENTRIES = {entry.name: entry for entry in TABLE}
