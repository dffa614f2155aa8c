# SPDX-License-Identifier: GPL-3.0-or-later
"""What divides a region into triangles: one registry (docs/dev/extending.md)."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Mesher:
    """label and tip: in the panel."""

    label: str
    tip: str


DEFAULT_MESHER = "delaunay"

MESHERS: dict[str, Mesher] = {
    "delaunay": Mesher("Delaunay", "Triangles as equal as refinement of a Delaunay triangulation makes them"),
    "frontal": Mesher(
        "Frontal", "Triangles laid from the border inwards: close to equilateral nearly everywhere"
    ),
    "grid": Mesher("Grid", "The nodes of a regular grid, and where its lines meet the outline"),
}
