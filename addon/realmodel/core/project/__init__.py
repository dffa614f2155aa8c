# SPDX-License-Identifier: GPL-3.0-or-later
"""The project: rock masses with their surfaces, faults and bodies, the library, and the project file.

Input: a project file, or arrays and paths from a caller. Output: a `Project` whose entries are checked,
its files not yet read.
"""
