# SPDX-License-Identifier: GPL-3.0-or-later
"""The shapes of faults and bodies.

Input: meshes, sticks, points or traces with dips. Output: a triangulated surface for each fault and each
body, continued in its own plane where it has to be.
"""
