# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender as the host of the add-on: its versions, and what runs in it beside its main loop.

Input: functions to call later, arrays of a mesh. Output: threads, timers and draw handlers, caches that
are cleared with the file, nodes, messages.
"""
