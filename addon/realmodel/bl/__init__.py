# SPDX-License-Identifier: GPL-3.0-or-later
"""The only place where arrays meet bpy.

scene           names and tags of a model's collections and objects
built_scene     a built model as collections and objects of a scene with its settings
project_settings  from the settings to a project, and back
meshes          arrays to meshes and back
materials       one for each property of the library
origin          what keeps UTM coordinates exact in float32
batch           scene, .blend file and picture without a window, for build_model.py
picture         camera and sun; the picture of build_model.py
versions        every difference between Blender versions
"""
