# SPDX-License-Identifier: Apache-2.0
"""The ROS 2 nodes: what needs rclpy, and nothing else.

Parameters, publishers, subscriptions, services, and the executor that serves them. It may import
every room but ``view`` and ``cli``.
"""
