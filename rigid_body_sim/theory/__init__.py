# SPDX-License-Identifier: Apache-2.0
"""What the lecture notes predict, one file a section; prediction.py finds what fits a scene.

The formulas share nothing with the simulation that they are held against. It may import
``numerics``, ``scene`` and what lies below.
"""
