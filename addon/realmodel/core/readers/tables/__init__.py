# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of text: points, and boreholes with their directions.

Comes in: a file and its columns. Goes out: points (N, 3) float64 with the lines that they came from.
"""
