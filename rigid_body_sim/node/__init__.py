# SPDX-License-Identifier: Apache-2.0
"""The ROS 2 nodes: all code that needs rclpy.

Parameters, publishers, subscriptions, services, and the executor that serves them. It may import
every room but ``view`` and ``cli``.
"""
