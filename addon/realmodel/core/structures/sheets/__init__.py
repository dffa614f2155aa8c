# SPDX-License-Identifier: GPL-3.0-or-later
"""The sheets of surfaces in compartments.

Input: a `RockInput` with points or triangles, and the faults that displace it. Output: for each surface
and each compartment one triangulated sheet, continued beyond the faults that cut it.
"""
