# SPDX-License-Identifier: Apache-2.0
"""The parameters of the node: the table declares, checks, changes and documents them.

rclpy ignores overrides of unknown names, refuses an integer for a double, and lets parameters be
deleted. So the overrides are read here, checked by the same rules that hold later for
``set_parameters``, and declared already converted. docs/reference/parameters.md shows the table;
``python -m rigid_body_sim.node.parameters`` prints config/sim_node.yaml.
"""

import textwrap

import yaml
from rcl_interfaces.msg import SetParametersResult
from rclpy.exceptions import ParameterNotDeclaredException
from rclpy.parameter import Parameter

from rigid_body_sim.errors import BadInput, NotConverged, nearest
from rigid_body_sim.node.parameter_table import ENTRIES, TABLE, number_of

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
        Names of overrides that may be meant for other nodes (overrides.settled): unknown ones are
        logged, and the node goes on.

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
        self._node, self._shared = node, shared
        self.on_change(lambda changes: None, lambda changes: None)
        for name, override in self._overrides.items():
            self._refuse_unless_shared(name, [*ENTRIES, *self._foreign])
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
                self._refuse_unless_shared(name, declared, ())

    def on_change(self, before, after):
        """Register the functions that a change calls.

        Parameters
        ----------
        before : callable
            Called with a dict of the changed values, before they hold; it raises BadInput to
            refuse them all.
        after : callable
            Called with the same dict once they hold.
        """
        self._before_change, self._after_change = before, after

    def _refuse_unless_shared(self, name, known, prefixes=(FOREIGN_PREFIX,)):
        if name in known or name.startswith(prefixes):
            return
        refusal = BadInput(
            f'parameter {name}', 'there is none of that name', _nearest(name, known)
        )
        if name not in self._shared:
            raise refusal
        near = f', {refusal.remedy}' if refusal.remedy.startswith('did') else ''
        self._node.get_logger().warning(
            f'{refusal.where}: {refusal.problem}{near}; '
            'it stands in a section for several nodes and is left to the others'
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
        """Return the checked changes by name, without what is fixed and stays as it is."""
        changes = {}
        for parameter in parameters:
            entry = ENTRIES.get(parameter.name)
            if parameter.type_ == Parameter.Type.NOT_SET:
                raise BadInput(
                    f'parameter {parameter.name}', 'it cannot be deleted', 'set it to a value'
                )
            value = parameter.value if entry is None else entry.checked(parameter.value)
            fixed = parameter.name == SIM_TIME if entry is None else not entry.changeable
            if self.running and fixed:
                present = self.use_sim_time if entry is None else self.values[entry.name]
                if value != present:
                    raise BadInput(
                        f'parameter {parameter.name}',
                        'it cannot change while the node runs',
                        'give it at the start',
                    )
            elif entry is not None:
                changes[entry.name] = value
        return changes


def _nearest(name, known):
    """Return the error text for an unknown name."""
    near = nearest(name, known)
    return f'did you mean {near}?' if near else f'the parameters are {", ".join(ENTRIES)}'


def table():
    """Return the table of the parameters in Markdown, for docs/make_reference.py."""
    rows = [
        '| parameter | default | while running | meaning; type and range |',
        '|---|---|---|---|',
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
            f'| {entry.name} | {default} | {"changes" if entry.changeable else "fixed"} '
            f'| {entry.about}; {entry.kind}{", " if entry.limits else ""}{entry.limits} |'
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
