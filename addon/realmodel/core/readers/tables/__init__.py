# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of text: points, and boreholes with their directions.

Input: a file and its columns. Output: points (N, 3) float64 with the lines that they came from.
"""
