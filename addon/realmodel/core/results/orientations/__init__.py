# SPDX-License-Identifier: GPL-3.0-or-later
"""Orientations of bedding on the sphere: their means, and stereonets of them.

Input: the dips of a project. Output: numbers, and a drawing.
"""
