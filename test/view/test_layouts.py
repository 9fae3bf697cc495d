# SPDX-License-Identifier: Apache-2.0
"""The layouts for RViz, PlotJuggler and Foxglove ask for topics and fields that the node has."""

import json
import pathlib
import re
from xml.etree import ElementTree

import pytest
import yaml

from rigid_body_sim.messages.state_topics import OUTPUTS

CONFIG = pathlib.Path(__file__).resolve().parents[2] / 'config'
TOPICS = {*OUTPUTS, 'diagnostics', 'events', 'scene', 'cmd_wrench', 'cmd_impulse'}
DISPLAYS = {'Marker': 'visualization_msgs/msg/Marker', 'Pose': 'geometry_msgs/msg/PoseStamped',
            'Odometry': 'nav_msgs/msg/Odometry', 'Wrench': 'geometry_msgs/msg/WrenchStamped'}
"""Message type of each display of rviz_default_plugins, as its documentation says."""


@pytest.mark.parametrize(('name', 'pattern'), [
    ('rigid_body_sim.rviz', r'Value: (\w+), Depth'), ('plotjuggler.xml', r'curve name="/(\w+)'),
    ('foxglove.json', r'"/(\w+)')])
def test_every_topic_of_a_layout_is_one_of_the_node(name, pattern):
    found = set(re.findall(pattern, (CONFIG / name).read_text()))
    assert found <= TOPICS and {'pose'} <= found


def fields():
    """Yield (layout, path of a field) of every curve, as /topic/field/..."""
    tree = ElementTree.parse(CONFIG / 'plotjuggler.xml')
    for curve in tree.iter('curve'):
        yield 'plotjuggler', curve.get('name')
    layout = json.loads((CONFIG / 'foxglove.json').read_text())
    for panel in layout['configById'].values():
        for path in panel.get('paths', ()):
            yield 'foxglove', path['value'].replace('.', '/')


@pytest.mark.parametrize(('layout', 'path'), list(fields()))
def test_every_curve_is_a_number_of_a_message(layout, path):
    _, topic, *names = path.split('/')
    package, _, kind = OUTPUTS[topic].type.split('/')
    message = getattr(pytest.importorskip(f'{package}.msg'), kind)()
    for name in names:
        message = getattr(message, name)
    assert isinstance(message, float)


def test_every_display_of_rviz_takes_the_type_of_its_topic():
    layout = yaml.safe_load((CONFIG / 'rigid_body_sim.rviz').read_text())
    shown = [one for one in layout['Visualization Manager']['Displays'] if 'Topic' in one]
    assert {one['Topic']['Value'] for one in shown} == {'marker', 'pose', 'odom', 'reaction'}
    for one in shown:
        package, _, kind = one['Class'].partition('/')
        assert package == 'rviz_default_plugins'
        assert DISPLAYS[kind] == OUTPUTS[one['Topic']['Value']].type


def test_every_panel_of_the_foxglove_layout_has_its_settings():
    layout = json.loads((CONFIG / 'foxglove.json').read_text())
    panels = set(re.findall(r'"(?:first|second)": "([^"]+)"', json.dumps(layout['layout'])))
    assert panels == set(layout['configById'])
