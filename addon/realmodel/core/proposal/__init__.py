# SPDX-License-Identifier: GPL-3.0-or-later
"""A project from data alone: the order of units, what is cut and what pinches out, and the rest of the file.

logs       the units along holes
order      which unit is older, from superposition
lenses     units that repeat in a hole become bodies
maps       the same from a geological map: age columns, dips, neighbors
rules      which surfaces cut older rock
extent     region, edge length, base, ground
proposal   all of it: propose_project
folder     the project file with its reasons, and the tables
"""

from .proposal import ProposedProject, propose_project

__all__ = ["ProposedProject", "propose_project"]
