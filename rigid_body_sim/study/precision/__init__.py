# SPDX-License-Identifier: Apache-2.0
"""Work-precision: error against CPU time of every method, and of peers.

Errors are measured against high-precision references.
"""
