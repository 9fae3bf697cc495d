# SPDX-License-Identifier: Apache-2.0
"""The physical pendulum: its anchor, and the motion."""
