# SPDX-License-Identifier: Apache-2.0
"""Work-precision, the hard cases, and every scene compared with theory and with peers.

It may import ``analysis`` and what lies below.
"""
