# SPDX-License-Identifier: Apache-2.0
"""Services that fail answer all the same, each by one wrapper; without ROS."""

import types

from rigid_body_sim.node.answering import Answered, Answering


class Bare:
    """Stands for rclpy's Node: it makes one service itself, by no function of its own."""

    def __init__(self):
        self.lines = []
        self.services = [types.SimpleNamespace(service_name='change_state', callback=refuse)]

    def create_service(self, srv_type, srv_name, callback):
        self.services.append(types.SimpleNamespace(service_name=srv_name, callback=callback))

    def get_logger(self):
        return types.SimpleNamespace(warning=self.lines.append)


class Node(Answering, Bare):
    """A node that answers."""


def refuse(request, response):
    raise ValueError('no such\nstate')


def test_a_service_that_fails_answers_and_says_why_once():
    node = Node()
    node.create_service(None, 'reset', refuse)
    node.answer_all()
    node.answer_all()
    for service in node.services:
        assert service.callback('what is asked', 'by default') == 'by default'
        assert not isinstance(service.callback._callback, Answered)
    assert node.lines == [
        f'{name}: the request does not fit: ValueError: no such state'
        for name in ('change_state', 'reset')]
