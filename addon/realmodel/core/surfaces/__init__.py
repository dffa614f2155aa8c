# SPDX-License-Identifier: GPL-3.0-or-later
"""The surfaces of rock masses: read, meshed and interpolated, with warnings about points that cannot be
right.

Input: a `Project`. Output: a `RockInput` for each rock mass, with the triangles of its surfaces on the
planar mesh of its region; or the parts of its surfaces that a tile needs.
"""
