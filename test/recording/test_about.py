# SPDX-License-Identifier: Apache-2.0
"""What a recording says of the package and of its events."""

import pathlib
import re
import types
import xml.etree.ElementTree

import pytest

from rigid_body_sim.messages import cdr
from rigid_body_sim.messages.definitions import definition, schema
from rigid_body_sim.recording import about

PACKAGE = '<package><name>{}</name><version>{}</version></package>'


def test_the_version_is_that_of_package_xml():
    root = xml.etree.ElementTree.parse(
        pathlib.Path(__file__).resolve().parents[2] / 'package.xml').getroot()
    assert about.version() == root.findtext('version')


@pytest.mark.parametrize('place', ['package.xml', 'share/rigid_body_sim/package.xml'])
def test_package_xml_of_another_package_is_passed_by(tmp_path, monkeypatch, place):
    """As where the package was installed into the tree of another one."""
    (tmp_path / 'lib').mkdir()
    (tmp_path / 'lib' / 'package.xml').write_text(PACKAGE.format('other', '1.2'))
    monkeypatch.setattr(about, '__file__', str(tmp_path / 'lib' / 'about.py'))
    assert about.version.__wrapped__() == ''
    (tmp_path / place).parent.mkdir(parents=True, exist_ok=True)
    (tmp_path / place).write_text(PACKAGE.format('rigid_body_sim', '9.8'))
    assert about.version.__wrapped__() == '9.8'


def test_levels_are_those_of_the_message():
    text = definition(about.STATUS_TYPE).text
    for name in ('OK', 'WARN', 'ERROR'):
        assert getattr(about, name) == int(re.search(rf'byte {name}\s*=\s*(\d+)', text)[1])


def test_an_event_keeps_all_digits_of_its_numbers():
    event = types.SimpleNamespace(name='flip', tick=3, time=0.1 + 0.2, values={'side': 'up'})
    message, values = about.event_text(event)
    assert message == 'flip at t = 0.3 s'
    found = cdr.decode(schema(about.STATUS_TYPE), about.STATUS_TYPE, about.event_message(
        'simulate', about.WARN, 'flip', message, values))
    assert (found['name'], found['message'], found['hardware_id']) == ('flip', message, 'simulate')
    assert {value['key']: value['value'] for value in found['values']} == {
        'tick': '3', 'time': '0.30000000000000004', 'side': 'up'}
    assert found['level'] in (1, b'\x01')
