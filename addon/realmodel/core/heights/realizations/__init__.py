# SPDX-License-Identifier: GPL-3.0-or-later
"""Heights that data allow, drawn at random.

Comes in: points, dips and bounds of a surface or of a series of sheets, and a seed. Goes out: the heights of
one realization.
"""
