# SPDX-License-Identifier: GPL-3.0-or-later
"""Rasters.

Comes in: a file of a grid. Goes out: its heights as points, row by row, without those that say there is none.
"""
