# SPDX-License-Identifier: GPL-3.0-or-later
"""Long work beside the build, each in a thread while the window goes on.

Input: a built model or a mesh object, read on the main thread. Output: ensembles, meshes for simulation,
files, what a planned hole meets, beds in a mesh.
"""
