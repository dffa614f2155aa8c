# SPDX-License-Identifier: GPL-3.0-or-later
"""The cells: the surfaces of all rock masses intersected, with the properties of the cells.

Input: `RockInput`s and `Structures`. Output: a `CellComplex` with its blocks and warnings, and with its
input: `ModelData`.
"""
