# SPDX-License-Identifier: Apache-2.0
"""Loops over steps, step control, dense output, and what a march keeps of its way."""
