# SPDX-License-Identifier: Apache-2.0
"""Arguments of the command `view` that cannot be met end it with one line."""

import time

import pytest

pytest.importorskip('viser')

from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.view.access import Access
from rigid_body_sim.view.live import Live
from rigid_body_sim.view.page import LAST_PORT, serve

PATIENCE = 200.0


@pytest.mark.parametrize(('host', 'port', 'said'), [
    (r'203\.0\.113\.7', 0, '--host'), ('999.1.1.1', 0, '--host'), ('a' * 300, 0, '--host'),
    ('127.0.0.1', LAST_PORT + 1, '--port'), ('127.0.0.1', -1, '--port')])
def test_an_address_that_cannot_be_listened_on_is_one_line(host, port, said):
    """The server once tried one port after the other for ever."""
    with pytest.raises(BadInput, match=f'^{said}: .*{port if said == "--port" else host}'):
        serve(Access(host.replace('\\', '')), port)


def poll_until(live, deadline):
    """Poll a Live until a time of the clock."""
    while time.monotonic() < deadline:
        live.wait(1.0)
        live.poll()


def test_settings_that_cannot_run_the_first_scene_end_the_page():
    """The page once stayed open, and empty."""
    live = Live(load_scene('rattleback').text, {'rate': 1000.0, 'integrator': 'exact'})
    deadline = time.monotonic() + PATIENCE
    try:
        with pytest.raises(BadInput, match="'exact' cannot run the scene rattleback"):
            poll_until(live, deadline)
    finally:
        live.close()


@pytest.mark.parametrize('name', ['bad name', '', '/', '//sim', 'sim-node', '7up'])
def test_a_name_that_no_node_has_is_one_line(name):
    pytest.importorskip('rclpy')
    from rigid_body_sim.view.node_source import NodeSource
    with pytest.raises(BadInput, match=r'^--node: got'):
        NodeSource(name)
