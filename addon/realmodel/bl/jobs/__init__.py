# SPDX-License-Identifier: GPL-3.0-or-later
"""Long work beside the build, each in a thread while the window goes on.

Comes in: a built model or a mesh object, read on the main thread. Goes out: ensembles, meshes for simulation,
files, what a planned hole meets, beds in a mesh.
"""
