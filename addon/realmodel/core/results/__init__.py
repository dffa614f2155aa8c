# SPDX-License-Identifier: GPL-3.0-or-later
"""What is found in a model without changing it: sections, maps, contours, volumes, boreholes, residuals.

Input: `ModelData`, or triangulated surfaces. Output: polygons, lines, numbers and drawings, not yet in
files.
"""
