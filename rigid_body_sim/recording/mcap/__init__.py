# SPDX-License-Identifier: Apache-2.0
"""Additions to the package `mcap`; everything else about the format is left to it.

Here live: chunks composed from arrays of ticks (chunks, writing), a cut file mended in place
(scan, mending), and messages read as columns (walk, reading). These modules import `mcap`, NumPy
and the compression libraries, and nothing else of rigid_body_sim.
"""
