# SPDX-License-Identifier: Apache-2.0
"""Random scenes, a truth for each that shares no formula with the package, and a judge.

``draw`` makes scenes, ``truth`` and ``ball`` follow them with 64-bit mantissas by the ``laws``,
``kinks`` finds where a scene is not smooth, ``judge`` compares. ``wide`` has their vectors. Convex
bodies on a plane have their own: ``plane_draw``, ``plane_truth`` by ``plane_laws`` and
``collocation``, ``plane_judge``.
"""
