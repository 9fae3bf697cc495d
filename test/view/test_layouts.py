# SPDX-License-Identifier: Apache-2.0
"""The layouts for RViz, PlotJuggler and Foxglove ask for topics that the node has."""

import json
import pathlib
import re

import pytest

from rigid_body_sim.messages.state_topics import OUTPUTS

CONFIG = pathlib.Path(__file__).resolve().parents[2] / 'config'
TOPICS = {*OUTPUTS, 'diagnostics', 'events', 'scene', 'cmd_wrench', 'cmd_impulse'}


@pytest.mark.parametrize(('name', 'pattern'), [
    ('rigid_body_sim.rviz', r'Value: (\w+), Depth'), ('plotjuggler.xml', r'curve name="/(\w+)'),
    ('foxglove.json', r'"/(\w+)')])
def test_every_topic_of_a_layout_is_one_of_the_node(name, pattern):
    found = set(re.findall(pattern, (CONFIG / name).read_text()))
    assert found <= TOPICS and {'pose'} <= found


def test_every_panel_of_the_foxglove_layout_has_its_settings():
    layout = json.loads((CONFIG / 'foxglove.json').read_text())
    panels = set(re.findall(r'"(?:first|second)": "([^"]+)"', json.dumps(layout['layout'])))
    assert panels == set(layout['configById'])
