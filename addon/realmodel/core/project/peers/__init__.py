# SPDX-License-Identifier: GPL-3.0-or-later
"""Projects from the tables and calls of other modeling programs.

Input: their tables of points and orientations, files or data frames, and their groups of surfaces. Output: a
`Project`.
"""
