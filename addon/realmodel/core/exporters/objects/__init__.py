# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of named objects for programs around models of the ground: OMF, geoh5, IFC, RESQML, each by its own
library, which is an extra of the package.

Input: a model. Output: a file of its blocks, surfaces and boreholes.
"""
