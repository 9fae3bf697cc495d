# SPDX-License-Identifier: Apache-2.0
"""Families of methods: each binds a page of methods/ to the equations of a scene."""
