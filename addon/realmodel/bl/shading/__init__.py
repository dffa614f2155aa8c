# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks of rock: materials, weathering, worn edges, what is scattered on ledges.

Input: blocks in a scene, the looks of their library. Output: node trees, modifiers, an asset library.
"""
