# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of named objects, OMF and geoh5: points, lines, surfaces, boreholes, each read by its own library.

Input: a file, and the name of an object in it. Output: its coordinates, triangles, and values.
"""
