# SPDX-License-Identifier: Apache-2.0
"""The tick thread and what runs in it: deadlines on the machine's clock, sessions, playback, the end.

Nothing here needs ROS: publishers, subscriptions and clocks are handed in by ``node``. It may import
everything below ``node``.
"""
