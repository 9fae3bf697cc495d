# SPDX-License-Identifier: Apache-2.0
"""One page a method: what it is, its order, its source, its coefficients."""
