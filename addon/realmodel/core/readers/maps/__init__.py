# SPDX-License-Identifier: GPL-3.0-or-later
"""Outlines, lines and points in plan.

Input: a file of shapes and which of it counts. Output: `Shapes`, or points with heights.
"""
