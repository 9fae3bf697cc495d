# SPDX-License-Identifier: Apache-2.0
"""Recordings: written by a process of their own, read as arrays, mended, exported.

What the package `mcap` does not do is in mcap/. This folder imports messages and below.
"""
