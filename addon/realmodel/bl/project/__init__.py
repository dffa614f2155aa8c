# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of a scene as a project of the core, and back.

Input: `scene.realmodel` with the objects it refers to, or a `Project`. Output: the other of the two, and
what the panel asks of settings: names, units, choices, sizes.
"""
