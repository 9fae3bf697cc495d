# SPDX-License-Identifier: Apache-2.0
"""Which method runs a scene: the exact one, or the cheapest one measured to be accurate enough.

It may import ``integrators`` and what lies below.
"""
