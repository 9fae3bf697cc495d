# SPDX-License-Identifier: Apache-2.0
"""Scenes: body, constraint, effects and initial conditions, read from YAML and checked.

It may import ``numerics`` and what lies below.
"""
