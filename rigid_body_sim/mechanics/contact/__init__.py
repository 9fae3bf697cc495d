# SPDX-License-Identifier: Apache-2.0
"""A convex body on a plane: its surface, the force at the point of contact, impacts.

It may import ``scene`` and what lies below.
"""
