# SPDX-License-Identifier: Apache-2.0
"""The parameters of the node: one table declares, checks, changes and documents them.

rclpy ignores overrides of unknown names, refuses an integer where a double is meant, and would let
a deleted parameter go. So the overrides are read here, checked by the same rules that hold later
for ``set_parameters``, and declared already converted. docs/reference/parameters.md shows the
table; ``python -m rigid_body_sim.node.parameters`` prints config/sim_node.yaml.
"""

import array
import dataclasses
import math
import re
import textwrap

import yaml
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor, SetParametersResult
from rclpy.exceptions import ParameterNotDeclaredException
from rclpy.parameter import Parameter

from rigid_body_sim.errors import BadInput, NotConverged, nearest
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
        # a list is declared before it has its value, so rclpy must not hold it fixed: Settings
        # refuses the change itself
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
    """Return the number that a text writes; whatever else it is stays as it is.

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
        'method; auto: the exact one if there is, else the cheapest that meets accuracy',
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
        'of chunks; auto: zstd',
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
SIM_TIME = 'use_sim_time'
# declared by rclpy itself for each topic when its publisher or subscription is made
FOREIGN_PREFIX = 'qos_overrides.'


class Settings:
    """The checked values of all parameters of a node, kept up to date by ``set_parameters``.

    Parameters
    ----------
    node : rclpy.node.Node
        Its overrides are read and its parameters declared.
    running : bool
        Whether the node runs from the start to the end; a managed node sets :attr:`running`
        itself.
    shared : set of str
        Names of overrides that may be meant for other nodes (overrides.settled): of those that
        are unknown the log tells, and the node goes on.

    Attributes
    ----------
    running : bool
        Whether parameters that are fixed while the node runs are fixed now.

    Raises
    ------
    BadInput
        For an override that is unknown or wrong.
    """

    def __init__(self, node, running=True, shared=frozenset()):
        self.running = running
        self.recordings = set()
        """Paths of the recordings that the node made."""
        # those that rclpy declares for each node
        self._foreign = tuple(node.get_parameters_by_prefix(''))
        with node.handle:
            self._overrides = node.handle.get_parameters(Parameter)
        self._node = node
        self.on_change(lambda changes: None, lambda changes: None)
        for name, override in self._overrides.items():
            try:
                self._refuse_unknown(name, [*ENTRIES, *self._foreign])
            except BadInput as refusal:
                if name not in shared:
                    raise
                near = f', {refusal.remedy}' if refusal.remedy.startswith('did') else ''
                node.get_logger().warning(
                    f'{refusal.where}: {refusal.problem}{near}; '
                    'it stands in a section for several nodes and is left to the others'
                )
            if name == SIM_TIME and not isinstance(override.value, bool):
                raise BadInput(
                    f'parameter {SIM_TIME}', f'got {override.value!r}', 'needs true or false'
                )
        self.values = {}
        for entry in TABLE:
            given = (
                self._overrides[entry.name].value
                if entry.name in self._overrides
                else entry.default
            )
            self.values[entry.name] = value = entry.checked(given)
            entry.declare(node, value, running)
        node.add_pre_set_parameters_callback(self._with_types)
        node.add_on_set_parameters_callback(self._check_change)
        node.add_post_set_parameters_callback(self._apply_change)

    def __getitem__(self, name):
        return self.values[name]

    def __getattr__(self, name):
        try:
            return self.__dict__['values'][name]
        except KeyError:
            raise AttributeError(name) from None

    @property
    def use_sim_time(self):
        """Whether the node follows /clock."""
        return self._node.get_parameter(SIM_TIME).value

    def refuse_unknown_qos(self):
        """Refuse qos_overrides of unknown topics or policies.

        Call it when all publishers and subscriptions are made.
        """
        declared = list(self._node.get_parameters_by_prefix(''))
        for name in self._overrides:
            if name.startswith(FOREIGN_PREFIX):
                self._refuse_unknown(name, declared, ())

    def on_change(self, before, after):
        """Set what a change does from now on.

        Parameters
        ----------
        before : callable
            Called with a dict of the changed values, before they hold; it raises BadInput to
            refuse them all.
        after : callable
            Called with the same dict once they hold.
        """
        self._before_change, self._after_change = before, after

    @staticmethod
    def _refuse_unknown(name, known, prefixes=(FOREIGN_PREFIX,)):
        if name not in known and not name.startswith(prefixes):
            raise BadInput(
                f'parameter {name}', 'there is none of that name', _nearest(name, known)
            )

    def _with_types(self, parameters):
        """Return the parameters with the types of the table: doubles, and lists of words."""
        typed = []
        for parameter in parameters:
            if not self._node.has_parameter(parameter.name):
                # rclpy would leave out the name
                raise ParameterNotDeclaredException(
                    f'{parameter.name}; {_nearest(parameter.name, ENTRIES)}'
                )
            default = getattr(ENTRIES.get(parameter.name), 'default', None)
            number = number_of(parameter.value)
            if isinstance(default, float) and type(number) in (int, float):
                parameter = Parameter(parameter.name, Parameter.Type.DOUBLE, float(number))
            elif isinstance(default, tuple) and (
                parameter.value in (None, []) or isinstance(parameter.value, str)
            ):
                parameter = Parameter(
                    parameter.name,
                    Parameter.Type.STRING_ARRAY,
                    [parameter.value] if parameter.value else [],
                )
            typed.append(parameter)
        return typed

    def _check_change(self, parameters):
        try:
            changes = self._changes(parameters)
            self._before_change(changes)
        except (BadInput, NotConverged) as refusal:
            return SetParametersResult(successful=False, reason=str(refusal))
        return SetParametersResult(successful=True)

    def _apply_change(self, parameters):
        changes = self._changes(parameters)
        self.values.update(changes)
        self._after_change(changes)

    def _changes(self, parameters):
        """Return the checked changes by name."""
        changes = {}
        for parameter in parameters:
            entry = ENTRIES.get(parameter.name)
            if parameter.type_ == Parameter.Type.NOT_SET:
                raise BadInput(
                    f'parameter {parameter.name}', 'it cannot be deleted', 'set it to a value'
                )
            same_time = parameter.name != SIM_TIME or parameter.value == self.use_sim_time
            changeable = same_time if entry is None else entry.changeable
            if self.running and not changeable:
                raise BadInput(
                    f'parameter {parameter.name}',
                    'it cannot change while the node runs',
                    'give it at the start',
                )
            if entry is not None:
                changes[entry.name] = entry.checked(parameter.value)
        return changes


def _nearest(name, known):
    """Return what to say of an unknown name."""
    near = nearest(name, known)
    return f'did you mean {near}?' if near else f'the parameters are {", ".join(ENTRIES)}'


def table():
    """Return the table of the parameters in Markdown, for docs/make_reference.py."""
    rows = [
        '| parameter | type | default | range | while running | meaning |',
        '|---|---|---|---|---|---|',
    ]
    for entry in TABLE:
        default = (
            str(list(entry.default))
            if isinstance(entry.default, tuple)
            else str(entry.default).lower()
            if entry.kind == 'bool'
            else f'{entry.default}' or "''"
        )
        rows.append(
            f'| {entry.name} | {entry.kind} | {default} | {entry.limits} '
            f'| {"yes" if entry.changeable else "no"} | {entry.about} |'
        )
    return '\n'.join(rows)


def parameter_file():
    """Return config/sim_node.yaml: every parameter with its default, its meaning and range."""
    lines = ['# SPDX-License-Identifier: Apache-2.0',
             '# Made by: python -m rigid_body_sim.node.parameters > config/sim_node.yaml',
             '# The parameters of sim_node with their defaults.',
             '# Copy the file, keep the lines that you change, and run one of',
             '#   ros2 run rigid_body_sim sim_node --ros-args --params-file FILE',
             '#   ros2 launch rigid_body_sim sim.launch.py params_file:=FILE',
             '/**:', '  ros__parameters:']
    group = ''
    for entry in TABLE:
        before, _, name = entry.name.rpartition('.')
        if before and before != group:
            lines.append(f'    {before}:')
        group, indent = before, ' ' * (6 if before else 4)
        about = f'{entry.about} [{entry.limits}]' if entry.limits else entry.about
        lines += textwrap.wrap(about, 97, initial_indent=f'{indent}# ',
                               subsequent_indent=f'{indent}#   ', break_long_words=False)
        lines.append(f'{indent}{name}: {_as_yaml(entry.default)}')
    return '\n'.join(lines)


def _as_yaml(value):
    """Return a default as YAML 1.1 reads it: a float needs a point and a signed exponent."""
    return yaml.safe_dump(list(value) if isinstance(value, tuple) else value,
                          default_flow_style=True).removesuffix('\n').removesuffix('\n...')


if __name__ == '__main__':
    print(parameter_file())
