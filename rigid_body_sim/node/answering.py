# SPDX-License-Identifier: Apache-2.0
"""Answers to failing requests, so that the node goes on.

An exception in the callback of a service propagates out of rclpy's executor and would end the
process: anybody could stop the simulation by an unsuitable request, such as a lifecycle transition
from another state. Here the default response is sent instead, which says `success: false` for each
service with such a field, and a line in the log says why.
"""

import functools


class Answering:
    """A base class, to be listed before rclpy's, whose services answer every request."""

    def create_service(self, srv_type, srv_name, callback, **options):
        """Create a service as rclpy.node.Node does."""
        return super().create_service(srv_type, srv_name, self._answered(callback, srv_name),
                                      **options)

    def answer_all(self):
        """Make the services that rclpy created itself answer too."""
        for service in self.services:
            service.callback = self._answered(service.callback, service.service_name)

    def _answered(self, callback, name):
        @functools.wraps(callback)
        def answer(request, response):
            try:
                return callback(request, response)
            except Exception as error:
                why = ' '.join(str(error).split())[:200]
                self.get_logger().warning(
                    f'{name}: the request does not fit: {type(error).__name__}: {why}')
                return response
        return answer
