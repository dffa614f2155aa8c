# SPDX-License-Identifier: GPL-3.0-or-later
"""Heights that data allow, drawn at random.

Input: points, dips and bounds of a surface or of a series of sheets, and a seed. Output: the heights of
one realization.
"""
