# SPDX-License-Identifier: Apache-2.0
"""What accuracy costs, the hard cases, and every scene measured against theory and peers.

It may import ``analysis`` and what lies below.
"""
