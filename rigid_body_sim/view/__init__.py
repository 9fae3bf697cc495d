# SPDX-License-Identifier: Apache-2.0
"""The body in a browser: a scene, a running node or a recording, and the mouse that pushes it.

It may import everything but ``cli``; only node_source.py imports rclpy, for ``view --node``.
"""
