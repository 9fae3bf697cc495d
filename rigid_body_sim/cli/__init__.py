# SPDX-License-Identifier: Apache-2.0
"""The shell: the table of subcommands, completion, and subcommands without a room of their own.

It may import every other folder, and no folder imports it.
"""
