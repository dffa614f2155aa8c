# SPDX-License-Identifier: GPL-3.0-or-later
"""The only place where arrays meet bpy.

scene           a model as collections, objects and custom properties of a scene
stored_project  the project inside the .blend, from which the model can be built again
meshes          arrays to meshes and back
materials       one for each property of the library
origin          what keeps UTM coordinates exact in float32
batch           scene, .blend file and picture without a window, for build_model.py
picture, arrangement, cutaway   the rendered picture and how the model is opened in it
versions        every difference between Blender versions
"""
