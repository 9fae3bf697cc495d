# SPDX-License-Identifier: Apache-2.0
"""The heavy symmetric top: turning points, mean rates, theta functions, and the motion."""
