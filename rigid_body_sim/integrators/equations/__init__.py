# SPDX-License-Identifier: Apache-2.0
"""Right-hand sides of the equations of motion, and the flows that compositions are made of."""
