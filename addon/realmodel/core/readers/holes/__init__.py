# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that hold all tables of boreholes: AGS, DIGGS, LAS, well tops.

Input: a file. Output: its tables of collars, surveys, intervals and picks, as texts with their lines.
"""
