# SPDX-License-Identifier: Apache-2.0
"""Parameter overrides: the last one of a name wins, whatever its type and wherever it stands."""

import pathlib

import pytest
import rclpy
import yaml
from rclpy.logging import LoggingSeverity, set_logger_level
from rclpy.parameter import Parameter

from rigid_body_sim.errors import BadInput
from rigid_body_sim.node import overrides, process
from rigid_body_sim.node.parameters import Settings
from rigid_body_sim.realtime.shutdown import Stop


@pytest.fixture
def start(tmp_path, ros_domain):
    """Return a function that starts a node as a command line says, and returns its Settings.

    A source is a rule for -p, or a dict that becomes a file of parameters.
    """
    started = []

    def start(*sources, extra=(), name='sim_node'):
        arguments = ['--ros-args', *extra]
        for place, source in enumerate(sources):
            if isinstance(source, str):
                arguments += ['-p', source]
                continue
            path = tmp_path / f'{place}.yaml'
            path.write_text(yaml.safe_dump(source))
            arguments += ['--params-file', str(path)]
        context = rclpy.Context()
        with overrides.settled(arguments) as (settled, shared):
            rclpy.init(args=['', *settled], context=context, domain_id=ros_domain.id)
        node = rclpy.create_node(name, context=context, enable_rosout=False,
                                 start_parameter_services=False)
        started.append((node, context))
        node.warned = []
        node.get_logger = lambda: type('Log', (), {'warning': node.warned.append})
        return node, Settings(node, shared=shared)
    yield start
    for node, context in started:
        node.destroy_node()
        context.try_shutdown()


def file(**values):
    return {'/**': {'ros__parameters': values}}


def named(**values):
    return {'/sim_node': {'ros__parameters': values}}


@pytest.mark.parametrize(('sources', 'rate'), [
    ([file(rate=500), 'rate:=200.5'], 200.5),
    ([file(rate=500.5), 'rate:=200'], 200.0),
    (['rate:=200.5', file(rate=500)], 500.0),
    (['rate:=5', 'rate:=7.5', 'rate:=9'], 9.0),
    ([named(rate=500), 'rate:=200.5'], 200.5),
    ([named(rate=500), 'rate:=200'], 200.0),
    ([file(rate='abc'), 'rate:=200'], 200.0),
    ([file(rate=True), named(rate=30.5), file(rate=40)], 40.0),
    ([named(rate=500), {**file(rate=40), **named(accuracy=1e-9)}], 40.0),
    ([{**file(rate=1.5), **named(rate=2)}], 2.0),
    (['sim_node:rate:=5.5', 'rate:=6'], 6.0),
    (['rate:=6', 'sim_node:rate:=5.5', 'other:rate:=9'], 5.5),
    ([file(rate=8), {'/*': {'ros__parameters': {'rate': 9.5}}}], 9.5),
    ([file(rate='1e3')], 1000.0),
])
def test_the_last_value_wins(start, sources, rate):
    assert start(*sources)[1].rate == rate


@pytest.mark.parametrize(('sources', 'line'), [
    ([file(rate=1000.0), 'rate:=abc'], "parameter rate: got 'abc'; needs a number"),
    ([file(rate=1000.0), file(rate='abc')], "parameter rate: got 'abc'; needs a number"),
    ([file(scene='sphere'), 'scene:=3'], 'parameter scene: got 3; needs a text'),
    ([file(record=True), 'record:=5.5'], 'parameter record: got 5.5; needs true or false'),
    ([file(publish=['odom']), 'publish:=[1, 2]'],
     r'parameter publish: got \[1, 2\]; needs a list'),
])
def test_a_last_value_of_a_wrong_type_is_refused(start, sources, line):
    with pytest.raises(BadInput, match=line):
        start(*sources)


def test_nested_and_dotted_names_are_one(start):
    _, settings = start(file(recording={'name': 'first', 'split_bytes': 5}),
                        file(**{'recording.name': 'second'}), 'recording.split_bytes:=7.5')
    assert settings['recording.name'] == 'second'
    assert settings['recording.split_bytes'] == 7.5


def test_words_stay_words(start):
    _, settings = start(file(scene='sphere', integrator='dop8', accuracy=1e-9, publish=[]),
                        'recording.name:="5"', "frame_prefix:='true'")
    assert (settings['recording.name'], settings.frame_prefix) == ('5', 'true')
    assert (settings.accuracy, settings.publish) == (1e-9, ())


def test_the_name_of_the_node_may_change(start):
    extra = ['-r', '__node:=ball', '-r', '__ns:=/left']
    mine = {'left': {'ball': {'ros__parameters': {'rate': 50}}}}
    assert start(mine, extra=extra)[1].rate == 50.0
    assert start(mine, 'rate:=60.5', extra=extra)[1].rate == 60.5


def test_a_shared_file_may_hold_parameters_of_other_nodes(start):
    node, settings = start({**file(controller_frequency=20.0, costmap={'width': 3}, rate=250),
                            '/other_node': {'ros__parameters': {'ratee': 5}}},
                           {'/*/*': {'ros__parameters': {'whatever': [1, 2]}}})
    assert settings.rate == 250.0
    assert [line.split(';')[0] for line in node.warned] == [
        f'parameter {name}: there is none of that name' for name in
        ('controller_frequency', 'costmap.width')]


@pytest.mark.parametrize('source', ['ratee:=5', named(ratee=5), 'sim_node:ratee:=5',
                                    {'/**/sim_node': {'ros__parameters': {'ratee': 5}}}])
def test_an_unknown_parameter_for_this_node_is_refused(start, source):
    known_to_others = file(ratee=4)
    with pytest.raises(BadInput, match='ratee: there is none of that name; did you mean rate'):
        start(known_to_others, source)


def test_the_node_takes_its_own_dump(start):
    """What ``ros2 param dump`` writes: all parameters, nested, by the YAML of Python."""
    node, settings = start('rate:=250', 'accuracy:=1e-9', 'scene_overrides:=[body.mass=2.0]')
    dump = {}
    for name, parameter in node.get_parameters_by_prefix('').items():
        *groups, last = name.split('.')
        into = dump
        for group in groups:
            into = into.setdefault(group, {})
        into[last] = parameter.value
    assert 'start_type_description_service' in dump and 'use_sim_time' in dump
    _, again = start(named(**dump))
    assert again.values == settings.values


@pytest.mark.parametrize('arguments', [
    [], ['--ros-args'], ['--ros-args', '-p'], ['--ros-args', '-p', 'rate'],
    ['--ros-args', '-p', 'rate:='], ['--ros-args', '-p', 'rate:=[1'], ['-p', 'rate:=5'],
    ['--ros-args', '-p', ':=5'], ['--ros-args', '-p', 'rate:=--- 1\n--- 2'],
    ['--ros-args', '--params-file', '/nowhere.yaml'], ['--ros-args', '--', '-p', 'rate:=5'],
    ['--ros-args', '-r', '__ns:=/left', '--log-level', 'warn']])
def test_what_is_not_understood_is_left_to_rcl(arguments):
    with overrides.settled(arguments) as (settled, shared):
        assert (settled, shared) == (arguments, frozenset())


SHARED = """
/**: {ros__parameters: {rate: 7, recording: {name: 1e3, split_bytes: 1e6}}}
left/: {n: {ros__parameters: {step: 1}}}
---
ros__parameters: {rate: 8}
"""
EVERY = {'rate': 8, 'recording.name': '1e3', 'recording.split_bytes': '1e6'}


@pytest.mark.parametrize(('arguments', 'rest', 'merged', 'shared'), [
    (['-p', 'rate:=5'], ['--ros-args'], {'/**': {'rate': 5}}, set()),
    (['-r', 'x:=y', '--param', 'n:step:=1', '-p', '/m:step:=2', '--', '-p', 'a:=b'],
     ['--ros-args', '-r', 'x:=y', '--', '-p', 'a:=b'], {'/n': {'step': 1}, '/m': {'step': 2}},
     set()),
    (['--params-file', 'FILE', '-p', 'rate:=9'], ['--ros-args'],
     {'/**': EVERY | {'rate': 9}, '/left/n': {'step': 1}},
     {'recording.name', 'recording.split_bytes'}),
    (['-p', 'rate:=9', '--params-file', 'FILE'], ['--ros-args'],
     {'/**': EVERY, '/left/n': {'step': 1}}, set(EVERY))])
def test_arguments_become_one_file_in_their_order(tmp_path, arguments, rest, merged, shared):
    path = tmp_path / 'shared.yaml'
    path.write_text(SHARED)
    arguments = ['a', '--ros-args', *(str(path) if one == 'FILE' else one for one in arguments)]
    with overrides.settled(arguments) as (settled, of_any):
        text = pathlib.Path(settled[-1]).read_text(encoding='utf-8')
        assert settled[:-1] == ['a', *rest, '--ros-args', '--params-file']
    assert yaml.safe_load(text) == {
        node: {'ros__parameters': values} for node, values in merged.items()}
    assert of_any == shared
    # to rcl 1e3 is a number, unless the parameter is a text
    assert text.count("'1e3'") == text.count('1e3') and "'1e6'" not in text


@pytest.mark.parametrize('text', ['', '- 1', 'a: [', 'a: {ros__parameters: 3}', '3', '[a]: 1'])
def test_a_file_that_is_not_understood_is_left_to_rcl(tmp_path, text):
    path = tmp_path / 'wrong.yaml'
    path.write_text(text)
    arguments = ['--ros-args', '--params-file', str(path), '-p', 'rate:=5']
    with overrides.settled(arguments) as (settled, _):
        assert settled == arguments


def test_a_number_that_arrives_as_a_text_is_one(start):
    node, settings = start()
    for text, value in (('1e-9', 1e-9), ('1E-6', 1e-6), ('2.5e-4', 2.5e-4), ('.1e-6', 1e-7)):
        assert node.set_parameters([Parameter('accuracy', value=text)])[0].successful
        assert settings.accuracy == node.get_parameter('accuracy').value == value
    for text in ('1e5', 'nan', 'inf', '', '1e', 'e5', '0x1', '1_0', ' 1'):
        assert not node.set_parameters([Parameter('accuracy', value=text)])[0].successful
    assert settings.accuracy == 1e-7


def test_the_clock_cannot_change_while_the_node_runs(start):
    node, settings = start()
    [result] = node.set_parameters([Parameter('use_sim_time', value=True)])
    assert not result.successful
    assert result.reason == ('parameter use_sim_time: it cannot change while the node runs; '
                             'give it at the start')
    assert settings.use_sim_time is False
    # ros2 param load sends what it is already
    assert node.set_parameters([Parameter('use_sim_time', value=False)])[0].successful
    settings.running = False
    assert node.set_parameters([Parameter('use_sim_time', value=True)])[0].successful
    assert settings.use_sim_time is True


def test_the_last_document_of_a_file_wins_and_a_later_rule_after_it(start, tmp_path):
    path = tmp_path / 'two.yaml'
    path.write_text('\n---\n'.join(yaml.safe_dump(file(rate=rate)) for rate in (30, 40)))
    given = ['--params-file', str(path)]
    assert start(extra=given)[1].rate == 40.0
    assert start('rate:=200.5', extra=given)[1].rate == 200.5
    assert start({**file(rate=1.5)}, 'accuracy:=1e-9', extra=given)[1].rate == 1.5


@pytest.mark.parametrize('name', ['1e3', '12e5', 'y', 'N', '.5e3', 'inf'])
def test_a_text_that_its_dump_does_not_quote_stays_a_text(start, name):
    """PyYAML leaves out the quotes of what rcl takes for a number or a truth value."""
    assert f'{name}\n' == yaml.safe_dump({'x': name}).removeprefix('x: ')
    _, settings = start(named(world_frame=name, recording={'name': name}), f'body_frame:={name}')
    assert [settings[key] for key in ('world_frame', 'recording.name', 'body_frame')] == [name] * 3


def test_a_shared_file_may_hold_the_qos_of_other_nodes(start):
    scan = {'/scan': {'subscription': {'depth': 3}}}
    node, settings = start(file(qos_overrides=scan))
    settings.refuse_unknown_qos()
    assert [line.split(';')[0] for line in node.warned] == [
        'parameter qos_overrides./scan.subscription.depth: there is none of that name']
    _, settings = start(named(qos_overrides=scan))
    with pytest.raises(BadInput, match=r'scan\.subscription\.depth: there is none'):
        settings.refuse_unknown_qos()


def test_what_rcl_refuses_is_told_by_the_name_of_the_file_that_the_user_gave(tmp_path, capfd):
    path = tmp_path / 'mine.yaml'
    path.write_text('/**: {ros__parameters: {rate: [1, 2.5]}}')
    try:
        assert process.run(None, ['--ros-args', '--params-file', str(path)], Stop()) == 2
    finally:
        set_logger_level('rcl', LoggingSeverity.UNSET)
    told = capfd.readouterr().err
    assert str(path) in told and told.count('\n') == 1


def test_what_is_fixed_may_be_set_to_what_it_is(start):
    """``ros2 param load`` of a dump sets everything, one by one."""
    node, _ = start('publish:=[odom, imu]')
    for value, successful in (['odom', 'imu'], True), (['odom'], False):
        [result] = node.set_parameters([Parameter('publish', value=value)])
        assert result.successful == successful


@pytest.mark.parametrize(('pattern', 'covered', 'others'), [
    ('/**', ['/**', '/a', '/a/b', '/*', '/**/b'], []),
    ('/*', ['/a', '/*'], ['/a/b', '/*/b']), ('/a/*', ['/a/b'], ['/a', '/a/b/c', '/b/b']),
    ('/**/b', ['/b', '/a/b', '/x/y/b'], ['/a', '/b/a', '/ab']),
    ('/a.b', ['/a.b'], ['/a+b', '/axb', '/a.b/c']), ('/a', ['/a'], ['/**', '/*', '/ab'])])
def test_a_pattern_covers_the_nodes_that_it_stands_for(pattern, covered, others):
    assert [name for name in (*covered, *others) if overrides._covers(pattern, name)] == covered


@pytest.mark.parametrize(('sections', 'merged', 'shared'), [
    ([(True, {'/**': {'a': 1, 'b': 2}}), (False, {'/**': {'a': 3}})],
     {'/**': {'a': 3, 'b': 2}}, {'b'}),
    # what a name of a node says goes with a later pattern, and not with an earlier one
    ([(True, {'/n': {'a': 1}}), (True, {'/**': {'a': 3}})], {'/n': {}, '/**': {'a': 3}}, {'a'}),
    ([(True, {'/**': {'a': 3}}), (True, {'/n': {'a': 1}})],
     {'/**': {'a': 3}, '/n': {'a': 1}}, set()),
    ([(True, {'/n': {'a': 1}, '/**': {'a': 3}})], {'/n': {'a': 1}, '/**': {'a': 3}}, set()),
    ([(True, {'/**/n': {'a': 1}}), (True, {'/x/*': {'b': 1}})],
     {'/**/n': {'a': 1}, '/x/*': {'b': 1}}, {'b'})])
def test_sections_are_merged_in_their_order(sections, merged, shared):
    """Shared is what only sections of a file for several nodes have."""
    assert overrides._merged(sections) == (merged, shared)


def test_what_is_said_of_an_error_is_one_line_of_300_characters():
    assert process._one_line(ValueError('a\n  b\tc')) == 'a b c'
    assert process._one_line(ValueError('x' * 400)) == 'x' * 300
