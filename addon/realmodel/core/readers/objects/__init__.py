# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of named objects: points, lines, surfaces, boreholes; OMF and geoh5 by their own libraries.

Input: a file, and the name of an object in it. Output: its coordinates, triangles, and values.
"""
