# SPDX-License-Identifier: Apache-2.0
"""Expressions of a scene file: reader, tree, derivatives, and source for kernels."""
