# SPDX-License-Identifier: Apache-2.0
"""The launch files start the right processes with the right parameters."""

import pathlib
import re

import pytest
import yaml
from launch_stand_in import evaluate, load

ROOT = pathlib.Path(__file__).resolve().parent.parent
LAUNCH = ROOT / 'launch'
SIM, MANAGED, TWO = (LAUNCH / f'{name}.launch.py' for name in ('sim', 'lifecycle', 'two_bodies'))
DEFAULTS = str(ROOT / 'config' / 'sim_node.yaml')
ARGUMENTS = ['scene', 'rate', 'namespace', 'use_sim_time', 'params_file', 'lifecycle', 'record',
             'rviz', 'view']


def test_without_arguments_the_node_runs_with_the_parameter_file_alone():
    context = evaluate(SIM)
    assert list(context.arguments) == ARGUMENTS
    [node] = context.processes
    assert (node['package'], node['executable'], node['name'], node['namespace']) == \
        ('rigid_body_sim', 'sim_node', 'sim_node', '')
    assert (node['files'], node['given']) == ([DEFAULTS], {})


def test_arguments_become_parameters_of_their_type():
    [node] = evaluate(SIM, scene='heavy_top', rate='500', record='false', use_sim_time='true',
                      namespace='left', params_file='mine.yaml').processes
    assert node['given'] == {'scene': 'heavy_top', 'rate': 500, 'record': False,
                             'use_sim_time': True}
    assert (node['files'], node['namespace']) == (['mine.yaml'], 'left')


def test_a_scene_that_looks_like_a_number_stays_a_word():
    [node] = evaluate(SIM, scene='1e3').processes
    assert node['given'] == {'scene': '1e3'}


def test_the_node_takes_what_launch_gives():
    parameters = pytest.importorskip('rigid_body_sim.node.parameters', reason='no ROS here')
    [node, _] = evaluate(SIM, scene='heavy_top', rate='500', record='true', rviz='true').processes
    for name, value in node['given'].items():
        parameters.ENTRIES[name].checked(value)
    assert set(yaml.safe_load(pathlib.Path(DEFAULTS).read_text())['/**']) == {'ros__parameters'}


def test_rviz_opens_with_what_it_shows():
    node, rviz = evaluate(SIM, rviz='true', namespace='left').processes
    assert node['given'] == {'publish': ['marker', 'odom']}
    assert (rviz['package'], rviz['executable'], rviz['namespace']) == ('rviz2', 'rviz2', 'left')
    file = ROOT / 'config' / 'rigid_body_sim.rviz'
    assert rviz['arguments'] == ['-d', str(file), '-f', 'left/world']
    # relative names, which the namespace completes
    assert re.findall(r'Value: (/?)(marker|pose|odom|reaction),', file.read_text()) == [
        ('', 'marker'), ('', 'pose'), ('', 'odom'), ('', 'reaction')]
    _, alone = evaluate(SIM, rviz='true').processes
    assert (alone['namespace'], alone['arguments']) == ('', ['-d', str(file)])


@pytest.mark.parametrize(('arguments', 'name'), [
    ({}, '/sim_node'), ({'namespace': 'left'}, '/left/sim_node'),
    ({'namespace': '/left/', 'lifecycle': 'true'}, '/left/lifecycle_sim_node')])
def test_the_view_shows_the_node_of_this_launch(arguments, name):
    view = evaluate(SIM, view='true', **arguments).processes[-1]
    assert view['command'] == ['rigid_body_sim/view', '--node', name]


def test_lifecycle_starts_the_managed_node():
    [node] = evaluate(SIM, lifecycle='true', scene='heavy_top').processes
    assert (node['kind'], node['executable']) == ('LifecycleNode', 'lifecycle_sim_node')
    assert node['given'] == {'scene': 'heavy_top'}


@pytest.mark.parametrize(('name', 'value'), [
    ('rviz', 'yes'), ('view', 'True'), ('lifecycle', '1'), ('record', 'maybe'),
    ('use_sim_time', 'on')])
def test_bad_values_are_refused_in_one_line(name, value):
    with pytest.raises(RuntimeError) as refused:
        evaluate(SIM, **{name: value})
    assert f'"{name}"' in str(refused.value) and 'true' in str(refused.value)
    assert '\n' not in str(refused.value)


def test_the_managed_node_is_configured_and_then_activated():
    transition = pytest.importorskip('lifecycle_msgs.msg').Transition
    context = evaluate(MANAGED, scene='heavy_top', rate='200', namespace='left')
    [node] = context.processes
    assert (node['kind'], node['executable'], node['namespace']) == \
        ('LifecycleNode', 'lifecycle_sim_node', 'left')
    assert (node['files'], node['given']) == ([DEFAULTS], {'scene': 'heavy_top', 'rate': 200})
    [configure], [handler] = context.events, context.handlers
    assert configure.transition == transition.TRANSITION_CONFIGURE
    assert (handler.start, handler.goal) == ('configuring', 'inactive')
    assert configure.matches(handler.node)
    [activate] = handler.entities
    assert activate.event.transition == transition.TRANSITION_ACTIVATE
    assert activate.event.matches(handler.node)


def test_two_bodies_have_a_namespace_each():
    left, right = evaluate(TWO, rate='250', right='symmetric_top').processes
    assert (left['namespace'], left['given']) == ('left', {'scene': 'tennis_racket', 'rate': 250})
    assert (right['namespace'], right['given']) == ('right', {'scene': 'symmetric_top',
                                                              'rate': 250})


def test_the_stand_in_refuses_what_launch_does_not_know(tmp_path):
    text = SIM.read_text()
    for old, new in (("executable='sim_node'", "executible='sim_node'"),
                     ('default_value=', 'default='),
                     ('OpaqueFunction(function', 'Opaque(function'),
                     ("LaunchConfiguration('rviz')", "LaunchConfiguration('rwiz')")):
        assert old in text
        wrong = tmp_path / 'wrong.launch.py'
        wrong.write_text(text.replace(old, new))
        with pytest.raises((TypeError, NameError, LookupError)):
            evaluate(wrong)


@pytest.mark.parametrize('path', sorted(LAUNCH.glob('*.launch.py')), ids=lambda path: path.stem)
def test_the_files_load_with_the_real_packages(path):
    pytest.importorskip('launch_ros', reason='launch is not on PyPI: run on a ROS install')
    shown = {argument.name: argument for argument in load(path).get_launch_arguments()}
    assert all(argument.description for argument in shown.values())
    if path == SIM:
        assert list(shown) == ARGUMENTS
