# SPDX-License-Identifier: Apache-2.0
"""The tick thread and what runs in it: deadlines, sessions, playback, how a process ends.

Nothing here needs ROS: publishers, subscriptions and clocks are handed in by ``node``. It may
import everything below ``node``.
"""
