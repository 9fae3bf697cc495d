# SPDX-License-Identifier: Apache-2.0
"""ROS 2 messages without ROS: definitions as data, CDR encoding, the topics of a simulation.

The same bytes go to the wire and into recordings. It may import ``simulation`` and what lies
below.
"""
