# SPDX-License-Identifier: Apache-2.0
"""The same bits on every machine: what is run, the digests of it, the machines that one stands for.

It may import everything up to study/.
"""
