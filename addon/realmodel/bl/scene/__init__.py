# SPDX-License-Identifier: GPL-3.0-or-later
"""The build of a scene: its model, made in a thread and put into the scene.

Input: a scene with its settings. Output: surfaces, blocks and data as objects, the tables of the
panel, the problem of a build that failed, files of objects.
"""
