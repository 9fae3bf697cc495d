# SPDX-License-Identifier: Apache-2.0
"""What a scene is: body, constraint, effects and initial conditions, read from YAML and checked.

It may import ``numerics`` and what lies below.
"""
