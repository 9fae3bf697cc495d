# SPDX-License-Identifier: Apache-2.0
"""From a recording to figures, numbers and a report, and recorded runs simulated again.

It may import ``theory``, ``recording`` and what lies below.
"""
