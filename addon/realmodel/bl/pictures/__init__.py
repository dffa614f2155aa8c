# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures: camera, light and sky, animations, what a viewport shows.

Comes in: a scene with a built model. Goes out: image files and a .blend.
"""
