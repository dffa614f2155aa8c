# SPDX-License-Identifier: GPL-3.0-or-later
"""Outlines, lines and points in plan.

Comes in: a file of shapes and which of it counts. Goes out: `Shapes`, or points with heights.
"""
