# SPDX-License-Identifier: Apache-2.0
"""Answers to failing requests, so that the node goes on.

An exception in the callback of a service propagates out of rclpy's executor and would end the
process: anybody could stop the simulation by an unsuitable request, such as a lifecycle transition
from another state. Here the default response is sent instead, which says `success: false` for each
service with such a field, and a line in the log says why.
"""


class Answered:
    """The callback of a service: that of a node, or the default response where it fails.

    Parameters
    ----------
    node : rclpy.node.Node
        Its log says why.
    name : str
        The service's.
    callback : callable (request, response) -> response
    """

    def __init__(self, node, name, callback):
        self._node, self._name, self._callback = node, name, callback

    def __call__(self, request, response):
        """Return the response."""
        try:
            return self._callback(request, response)
        except Exception as error:
            why = ' '.join(str(error).split())[:200]
            self._node.get_logger().warning(
                f'{self._name}: the request does not fit: {type(error).__name__}: {why}')
            return response


class Answering:
    """A base class, to be listed before rclpy's, whose services answer every request."""

    def create_service(self, srv_type, srv_name, callback, **options):
        """Create a service as rclpy.node.Node does."""
        return super().create_service(srv_type, srv_name, Answered(self, srv_name, callback),
                                      **options)

    def answer_all(self):
        """Make those services answer, too, that rclpy makes without `create_service`."""
        for service in self.services:
            if not isinstance(service.callback, Answered):
                service.callback = Answered(self, service.service_name, service.callback)
