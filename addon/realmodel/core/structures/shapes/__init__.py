# SPDX-License-Identifier: GPL-3.0-or-later
"""The shapes of faults and bodies.

Comes in: meshes, sticks, points or traces with dips. Goes out: a triangulated surface for each fault and each
body, continued in its own plane where it has to be.
"""
