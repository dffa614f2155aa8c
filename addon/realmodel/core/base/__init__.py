# SPDX-License-Identifier: GPL-3.0-or-later
"""What every later step uses: errors, warnings, threads, arrays in files, output files, text, TOML, vectors.

Input: text, arrays and functions of any step. Output: the same, checked or calculated, with the same
bytes on every system. Nothing here knows what rock is.
"""
