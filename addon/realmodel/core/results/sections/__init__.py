# SPDX-License-Identifier: GPL-3.0-or-later
"""What planes and fences meet in a model: polygons of blocks, traces of faults, holes near by; and how they
are drawn.

Input: `ModelData`, and polygons that the native module has cut. Output: `SectionData`, its `Drawing`.
"""
