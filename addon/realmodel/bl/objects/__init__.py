# SPDX-License-Identifier: GPL-3.0-or-later
"""Arrays as objects of Blender, and objects as arrays; work on any mesh object.

Comes in: arrays, or objects. Goes out: meshes, materials, collections and what tags them, shapes, arrays that
are stored in the .blend; for Booleans, objects of objects.
"""
