# SPDX-License-Identifier: Apache-2.0
"""What the lecture notes predict, one file a section, and which prediction fits a scene (prediction.py).

The formulas share nothing with the simulation that they are held against. It may import ``numerics``,
``scene`` and what lies below.
"""
