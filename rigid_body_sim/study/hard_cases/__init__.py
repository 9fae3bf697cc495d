# SPDX-License-Identifier: Apache-2.0
"""Hard cases, on which general simulators lose energy, blow up, refuse or lie.

The command and test/hard_cases share one table of them.
"""
