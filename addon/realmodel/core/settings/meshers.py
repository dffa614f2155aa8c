# SPDX-License-Identifier: GPL-3.0-or-later
"""The meshers of regions: one registry (docs/dev/extending.md)."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Mesher:
    """label and tip: in the panel."""

    label: str
    tip: str


DEFAULT_MESHER = "delaunay"

MESHERS: dict[str, Mesher] = {
    "delaunay": Mesher("Delaunay", "Delaunay refinement: no angle below 25 degrees"),
    "frontal": Mesher("Frontal", "Advancing front: nearly equilateral triangles, slower"),
    "grid": Mesher("Grid", "Nodes of a regular grid, fitted to the outline"),
}
