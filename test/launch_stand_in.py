# SPDX-License-Identifier: Apache-2.0
"""A stand-in for the packages launch and launch_ros, which are not on PyPI.

It knows the names, arguments and evaluation that the launch files of this package use, as ROS 2
Jazzy has them (launch 3.4, launch_ros 0.26). An argument that the real class does not take is a
TypeError here too, so a misspelt one fails a test. Nothing is started: :func:`evaluate` returns
the processes that would be.
"""

import contextlib
import pathlib
import sys
import types

import yaml

SHARE = pathlib.Path(__file__).resolve().parent.parent


class Context:
    """The object that launch hands to functions: the values of the arguments."""

    def __init__(self, configurations):
        self.launch_configurations = dict(configurations)
        self.processes, self.arguments, self.handlers, self.events = [], {}, [], []


class Substitution:
    """Something whose text is known when the launch runs."""


class LaunchConfiguration(Substitution):
    def __init__(self, variable_name, *, default=None):
        self.name = variable_name

    def perform(self, context):
        if self.name not in context.launch_configurations:
            raise LookupError(f'launch configuration {self.name!r} does not exist')
        return context.launch_configurations[self.name]


class PathJoinSubstitution(Substitution):
    def __init__(self, substitutions):
        self.parts = substitutions

    def perform(self, context):
        return '/'.join(text(part, context) for part in self.parts)


class FindPackageShare(Substitution):
    def __init__(self, package):
        assert package == 'rigid_body_sim', package

    def perform(self, context):
        return str(SHARE)


class ExecutableInPackage(Substitution):
    def __init__(self, executable, package):
        self.executable, self.package = executable, package

    def perform(self, context):
        return f'{self.package}/{self.executable}'


class IfCondition:
    def __init__(self, predicate_expression):
        self.expression = predicate_expression

    def evaluate(self, context):
        value = text(self.expression, context)
        if value.lower() not in ('true', 'false', '1', '0'):
            raise ValueError(f'invalid condition expression: {value!r}')
        return value.lower() in ('true', '1')


class Action:
    def __init__(self, *, condition=None):
        self.condition = condition

    def visit(self, context):
        if self.condition is None or self.condition.evaluate(context):
            for entity in self.execute(context) or ():
                entity.visit(context)

    def execute(self, context):
        raise NotImplementedError


class DeclareLaunchArgument(Action):
    def __init__(
            self, name, *, default_value=None, description=None, choices=None, condition=None):
        super().__init__(condition=condition)
        self.name, self.default, self.description = name, default_value, description
        self.choices = choices
        assert description, f'the argument {name} has no description'
        assert choices is None or default_value is None or default_value in choices, name

    def execute(self, context):
        given = context.launch_configurations
        if self.name not in given:
            if self.default is None:
                raise RuntimeError(f'Required launch argument "{self.name}" was not provided')
            given[self.name] = text(self.default, context)
        context.arguments[self.name] = self
        if self.choices is not None and given[self.name] not in self.choices:
            raise RuntimeError(f'Argument "{self.name}" provided value "{given[self.name]}" is '
                               f'not valid. Valid options are: {self.choices}')


class OpaqueFunction(Action):
    def __init__(self, *, function, args=None, kwargs=None, condition=None):
        super().__init__(condition=condition)
        self.function = function

    def execute(self, context):
        return self.function(context)


class GroupAction(Action):
    def __init__(self, actions, *, scoped=True, forwarding=True, launch_configurations=None,
                 condition=None):
        super().__init__(condition=condition)
        self.actions = actions

    def execute(self, context):
        before = dict(context.launch_configurations)
        for action in self.actions:
            action.visit(context)
        context.launch_configurations = before


class ExecuteProcess(Action):
    def __init__(self, *, cmd, name=None, output=None, condition=None):
        super().__init__(condition=condition)
        self.command = cmd

    def execute(self, context):
        context.processes.append(
            {'command': [text(part, context) for part in self.command]})


class Node(Action):
    def __init__(self, *, executable, package=None, name=None, namespace=None, parameters=None,
                 arguments=None, output=None, emulate_tty=False, condition=None):
        super().__init__(condition=condition)
        self.settings = {'package': package, 'executable': executable, 'name': name}
        self.namespace, self.parameters = namespace, parameters or ()
        self.arguments = arguments or ()

    def execute(self, context):
        given, files = {}, []
        for parameters in self.parameters:
            if isinstance(parameters, dict):
                given |= {name: value_of(value, context) for name, value in parameters.items()}
            else:
                files.append(text(parameters, context))
        context.processes.append({
            **self.settings, 'kind': type(self).__name__, 'files': files, 'given': given,
            'namespace': text(self.namespace or '', context),
            'arguments': [text(one, context) for one in self.arguments]})


class LifecycleNode(Node):
    def __init__(self, *, name, namespace, autostart=False, **settings):
        super().__init__(name=name, namespace=namespace, **settings)


class ParameterValue:
    def __init__(self, value, *, value_type=None):
        self.value, self.type = value, value_type


class EmitEvent(Action):
    def __init__(self, *, event, condition=None):
        super().__init__(condition=condition)
        self.event = event

    def execute(self, context):
        context.events.append(self.event)


class RegisterEventHandler(Action):
    def __init__(self, event_handler, *, condition=None):
        super().__init__(condition=condition)
        self.handler = event_handler

    def execute(self, context):
        context.handlers.append(self.handler)


class OnStateTransition:
    def __init__(self, *, entities, target_lifecycle_node=None, transition=None, start_state=None,
                 goal_state=None):
        self.entities, self.node = entities, target_lifecycle_node
        self.start, self.goal = start_state, goal_state


class ChangeState:
    def __init__(self, *, lifecycle_node_matcher, transition_id):
        self.matches, self.transition = lifecycle_node_matcher, transition_id


class PythonLaunchDescriptionSource:
    def __init__(self, launch_file_path):
        self.path = launch_file_path


class IncludeLaunchDescription(Action):
    def __init__(self, launch_description_source, *, launch_arguments=None, condition=None):
        super().__init__(condition=condition)
        self.source, self.arguments = launch_description_source, dict(launch_arguments or {})

    def execute(self, context):
        path = pathlib.Path(text(self.source.path, context))
        given = {name: text(value, context) for name, value in self.arguments.items()}
        context.launch_configurations |= given
        included = load(path)
        known = {entity.name for entity in included.entities
                 if isinstance(entity, DeclareLaunchArgument)}
        assert set(given) <= known, f'{path.name} has no argument {set(given) - known}'
        included.visit(context)


class LaunchDescription:
    def __init__(self, initial_entities=None):
        self.entities = list(initial_entities or ())

    def visit(self, context):
        for entity in self.entities:
            entity.visit(context)


def text(value, context):
    """Return the text of a value: a word, a substitution, or a list of those."""
    if isinstance(value, str):
        return value
    if isinstance(value, (list, tuple)):
        return ''.join(text(part, context) for part in value)
    return value.perform(context)


def value_of(value, context):
    """Return the value of a parameter: text is read as YAML unless a type is given."""
    kind = value.type if isinstance(value, ParameterValue) else None
    raw = text(value.value if isinstance(value, ParameterValue) else value, context)
    return kind(raw) if kind else yaml.safe_load(raw)


def matches_action(action):
    """Return whether another action is this one."""
    return lambda other: other is action


MODULES = {
    'launch': {'LaunchDescription': LaunchDescription},
    'launch.actions': {one.__name__: one for one in (
        DeclareLaunchArgument, EmitEvent, ExecuteProcess, GroupAction, IncludeLaunchDescription,
        OpaqueFunction, RegisterEventHandler)},
    'launch.conditions': {'IfCondition': IfCondition},
    'launch.events': {'matches_action': matches_action},
    'launch.launch_description_sources': {
        'PythonLaunchDescriptionSource': PythonLaunchDescriptionSource},
    'launch.substitutions': {'LaunchConfiguration': LaunchConfiguration,
                             'PathJoinSubstitution': PathJoinSubstitution},
    'launch_ros': {},
    'launch_ros.actions': {'LifecycleNode': LifecycleNode, 'Node': Node},
    'launch_ros.event_handlers': {'OnStateTransition': OnStateTransition},
    'launch_ros.events': {},
    'launch_ros.events.lifecycle': {'ChangeState': ChangeState},
    'launch_ros.parameter_descriptions': {'ParameterValue': ParameterValue},
    'launch_ros.substitutions': {'ExecutableInPackage': ExecutableInPackage,
                                 'FindPackageShare': FindPackageShare},
}


@contextlib.contextmanager
def installed():
    """Let imports of launch and launch_ros find the stand-in, also where the real ones exist."""
    before = {name: module for name, module in sys.modules.items()
              if name.partition('.')[0] in ('launch', 'launch_ros')}
    for name in before:
        del sys.modules[name]
    for name, contents in MODULES.items():
        module = types.ModuleType(name)
        vars(module).update(contents)
        module.__path__ = []
        sys.modules[name] = module
    try:
        yield
    finally:
        for name in MODULES:
            del sys.modules[name]
        sys.modules.update(before)


def load(path):
    """Return the LaunchDescription of a launch file."""
    names = {'__file__': str(path)}
    exec(compile(path.read_text(), path, 'exec'), names)
    return names['generate_launch_description']()


def evaluate(path, **arguments):
    """Return the Context after a launch file was run with arguments ``name=value``."""
    context = Context(arguments)
    with installed():
        description = load(path)
        known = {entity.name for entity in description.entities
                 if isinstance(entity, DeclareLaunchArgument)}
        assert set(arguments) <= known, f'no argument {set(arguments) - known}'
        description.visit(context)
    return context
