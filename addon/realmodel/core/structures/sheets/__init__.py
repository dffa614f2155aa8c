# SPDX-License-Identifier: GPL-3.0-or-later
"""The sheets of surfaces in compartments.

Comes in: a `RockInput` with points or triangles, and the faults that displace it. Goes out: for each surface
and each compartment one triangulated sheet, continued beyond the faults that cut it.
"""
