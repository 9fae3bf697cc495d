# SPDX-License-Identifier: Apache-2.0
"""Numerics with the same bits on every machine.

Everything here is made of + - * /, square roots and fused multiply-adds (fused.py), each of which
IEEE 754 defines to the last bit, in an order that the source fixes. functions.py has the
elementary functions; make_functions.py makes their coefficients.

It may import ``compilation``.
"""
