# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks of rock: materials, weathering, worn edges, what is scattered on ledges.

Comes in: blocks in a scene, the looks of their library. Goes out: node trees, modifiers, an asset library.
"""
