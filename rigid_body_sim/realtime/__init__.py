# SPDX-License-Identifier: Apache-2.0
"""The tick thread: deadlines, sessions, playback, and the end of a process.

Nothing here needs ROS: publishers, subscriptions and clocks are handed in by ``node``. It may
import everything below ``node``.
"""
