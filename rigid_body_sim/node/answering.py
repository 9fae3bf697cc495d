# SPDX-License-Identifier: Apache-2.0
"""Requests that fail are answered, and the node goes on.

An exception in the callback of a service leaves rclpy's executor, which would end the process:
anybody could stop the simulation by a request that does not fit, such as a lifecycle transition
from another state. Here the response goes out as it was made, which says `success: false` for
each service with such a field, and a line in the log says why.
"""

import functools


class Answering:
    """What a node class inherits, before rclpy's, so that its services answer every request."""

    def create_service(self, srv_type, srv_name, callback, **options):
        """Create a service as rclpy.node.Node does."""
        return super().create_service(srv_type, srv_name, self._answered(callback, srv_name),
                                      **options)

    def answer_all(self):
        """Have the services that rclpy made by itself answer too."""
        for service in self.services:
            if not hasattr(service.callback, 'answers'):
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
        answer.answers = True
        return answer
