# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of named objects, OMF and geoh5: points, lines, surfaces, boreholes, each read by its own library.

Comes in: a file, and the name of an object in it. Goes out: its coordinates, triangles, and values.
"""
