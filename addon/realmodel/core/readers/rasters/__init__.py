# SPDX-License-Identifier: GPL-3.0-or-later
"""Rasters.

Input: a file of a grid. Output: its heights as points, row by row, without those that say there is none.
"""
