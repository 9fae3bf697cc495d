# SPDX-License-Identifier: Apache-2.0
"""The same bits on every machine: the cases that are run, their digests, emulated machines.

It may import everything up to study/.
"""
