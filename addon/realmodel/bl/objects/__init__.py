# SPDX-License-Identifier: GPL-3.0-or-later
"""Arrays as objects of Blender, and objects as arrays; work on any mesh object.

Input: arrays, or objects. Output: meshes, materials, collections and what tags them, shapes, arrays that
are stored in the .blend; for Booleans, objects of objects.
"""
