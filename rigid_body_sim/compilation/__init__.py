# SPDX-License-Identifier: Apache-2.0
"""Compilation of kernels: numba or plain Python, the cache, templates, vector lanes, threads.

It may import ``errors`` only.
"""
