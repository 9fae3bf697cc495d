# SPDX-License-Identifier: Apache-2.0
"""The free rotation by theta functions, and the free flight."""
