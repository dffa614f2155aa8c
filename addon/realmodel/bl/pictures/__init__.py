# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures: camera, light and sky, animations, what a viewport shows.

Input: a scene with a built model. Output: image files and a .blend.
"""
