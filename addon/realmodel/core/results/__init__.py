# SPDX-License-Identifier: GPL-3.0-or-later
"""What is found in a model without changing it: sections, maps, contours, volumes, boreholes, residuals.

Comes in: `ModelData`, or triangulated surfaces. Goes out: polygons, lines, numbers and drawings, not yet in
files.
"""
