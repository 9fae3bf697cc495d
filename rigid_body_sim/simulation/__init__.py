# SPDX-License-Identifier: Apache-2.0
"""A scene in motion: ticks, states at any time, commands and their admission, events, ensembles.

It may import ``choice`` and what lies below.
"""
