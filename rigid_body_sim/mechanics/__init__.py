# SPDX-License-Identifier: Apache-2.0
"""Newton and Euler on a state: impulses, energy, accelerations and reactions, the ledger.

It may import ``scene`` and what lies below.
"""
