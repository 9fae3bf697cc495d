# SPDX-License-Identifier: Apache-2.0
"""One page per method: what it is, its order, its source, its coefficients."""
