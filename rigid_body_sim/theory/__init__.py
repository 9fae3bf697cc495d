# SPDX-License-Identifier: Apache-2.0
"""Predictions of the lecture notes, one file per section; prediction.py finds those of a scene.

The formulas share nothing with the simulation that they are compared with. It may import
``numerics``, ``scene`` and what lies below.
"""
