# SPDX-License-Identifier: GPL-3.0-or-later
"""Input: boreholes, a geological map, the ground, dips. Output: a `ProposedProject` that builds at once, with
the reasons of all choices, and its folder.

logs       the units along holes
order      which unit is older, from superposition
lenses     units that repeat in a hole become bodies
maps       the same from a geological map: ages, dips, borders
rules      which surfaces cut older rock
methods    which surfaces are interpolated together
extent     region, edge length, base
colors     a library by the names of rocks
choices    what was chosen, and why
folder     the project file with its reasons, and the tables
proposal   all of it: propose_project
"""

from .proposal import ProposedProject, propose_project

__all__ = ["ProposedProject", "propose_project"]
