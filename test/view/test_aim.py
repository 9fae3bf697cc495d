# SPDX-License-Identifier: Apache-2.0
"""The camera of a page keeps the body in sight as its window takes its size."""

import contextlib
import types

import numpy as np
import pytest

pytest.importorskip('viser')

from rigid_body_sim.view.panel import PRESETS, aim


class Client:
    """Stands for a page in a browser: its camera, and what hears of its changes."""

    def __init__(self, aspect):
        self.heard = []
        self.camera = types.SimpleNamespace(aspect=aspect, position=np.zeros(3),
                                            on_update=self.heard.append)

    atomic = contextlib.nullcontext

    def resize(self, aspect):
        """Give the window another shape."""
        self.camera.aspect = aspect
        self.say()

    def move(self, position):
        """Move the camera as a person or the page does."""
        self.camera.position = np.array(position)
        self.say()

    def say(self):
        for hear in self.heard:
            hear(self.camera)

    @property
    def distance(self):
        """Distance of the camera, relative to that of the preset."""
        return np.linalg.norm(self.camera.position) / np.linalg.norm(PRESETS['3/4'])


def test_the_camera_backs_off_when_the_panel_narrows_the_picture():
    client = Client(0.8)
    aim(client)
    assert client.distance == pytest.approx(1.25)
    client.resize(0.5)
    assert client.distance == pytest.approx(2.0)


def test_a_page_that_puts_its_own_camera_late_is_heard():
    client = Client(0.8)
    aim(client)
    client.move(PRESETS['3/4'])
    client.resize(0.5)
    assert client.distance == pytest.approx(2.0)


def test_a_camera_that_a_person_has_moved_stays():
    client = Client(0.8)
    aim(client)
    client.move((1.0, 2.0, 3.0))
    client.resize(0.5)
    assert client.camera.position.tolist() == [1.0, 2.0, 3.0]
