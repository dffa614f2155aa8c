# SPDX-License-Identifier: GPL-3.0-or-later
"""IFC 4.3 (ISO 16739-1:2024) by IfcOpenShell: a geomodel of closed strata, their boundaries, boreholes.

A block is an IfcGeotechnicalStratum of the IfcGeomodel; each connected part of it is a closed set of
triangles. Where blocks meet, or meet the outside on a surface, an IfcVirtualElement has the triangles that
both have, and an IfcRelConnectsWithRealizingElements says whose boundary it is (an IfcRelSpaceBoundary takes
spaces alone). A borehole is an IfcBorehole of strata.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ...base.atomic import Outputs
from ...base.packages import extra
from ...base.text import Step
from ...cells.model_data import ModelData
from ...results.sections.section_data import rgb_bytes
from .contents import BlockShell, Contents, Hole
from .ifc_entities import Entities

_RADIUS = 0.1  # of boreholes, in meters


def write_ifc(model: ModelData, path: Path, outputs: Outputs, step: Step) -> None:
    """Writes a model."""
    library = extra("ifcopenshell", "writing IFC", "ifc")
    contents = Contents.of(model)
    step(0.1)
    writer = _Writer(Entities(library, model), model, contents)
    writer.write(lambda share: step(0.1 + 0.6 * share))
    with outputs.path(path) as target:
        writer.entities.file.write(str(target), ".ifc")
    step(1.0)


class _Writer:
    """Makes the entities of a model."""

    def __init__(self, entities: Entities, model: ModelData, contents: Contents):
        self.entities, self._model, self._contents = entities, model, contents
        self._triangles = contents.triangles
        self._materials: dict[int, list] = {}  # elements by the number of their property

    def write(self, step: Step) -> None:
        entities, contents = self.entities, self._contents
        site = entities.site
        geomodel = entities.product("IfcGeomodel", "geomodel", self._model.project.name, site)
        strata = {}
        for number, shell in enumerate(contents.blocks):
            strata[shell.number] = self._stratum(shell, geomodel)
            step(0.5 * (number + 1) / len(contents.blocks))
        borders = self._borders(strata, geomodel)
        step(0.9)
        if strata:
            entities.aggregate(geomodel, [*strata.values(), *borders])
        holes = [self._borehole(hole) for hole in contents.holes]
        entities.contain(site, [geomodel, *holes])
        for prop, elements in self._materials.items():
            self._associate(prop, elements)
        step(1.0)

    def _stratum(self, shell: BlockShell, geomodel: Any) -> Any:
        entities, block = self.entities, self._model.blocks[shell.number]
        of_block, corners = self._triangles.around(shell.number)
        cells = self._model.face_cells[self._triangles.face[of_block]]
        second = self._triangles.blocks[of_block, 1] == shell.number
        component = self._model.cell_component[np.where(second, cells[:, 1], cells[:, 0])]
        style = entities.style(shell.part.material, shell.part.color)
        items = [entities.triangles(corners[component == part], True, style) for part in np.unique(component)]
        made = entities.product("IfcGeotechnicalStratum", "stratum", shell.part.name, geomodel)
        made.PredefinedType = "SOLID"
        entities.show(made, "Body", "Tessellation", items)
        self._materials.setdefault(block.property, []).append(made)
        self._describe(made, shell)
        return made

    def _describe(self, made: Any, shell: BlockShell) -> None:
        entities, block = self.entities, self._model.blocks[shell.number]
        color = rgb_bytes(np.array(shell.part.color)).tobytes().hex()
        entities.properties(made, "Pset_GeotechnicalStratumCommon", {"StratumColour": f"#{color}"})
        values = {
            "RockMass": self._model.project.rocks[block.rock].name,
            "Surface": self._model.surface_names[block.surface],
            "Property": block.property,
            "Components": block.components,
        }
        values |= {f"Property{key.capitalize()}": value for key, value in shell.known.items()}
        entities.properties(made, "RealModel_Block", values)
        entities.volume(made, "Qto_VolumetricStratumBaseQuantities", block.volume)

    def _borders(self, strata: dict, geomodel: Any) -> list:
        """What lies between two blocks on one surface, wall or cut, and on surfaces beneath the outside."""
        entities, names = self.entities, self._contents.boundary_names
        triangles = self._triangles
        surface = self._model.face_surface[triangles.face]
        low, high = triangles.blocks.min(axis=1), triangles.blocks.max(axis=1)
        keys = np.column_stack([surface, low, high])[(low >= 0) | (surface >= 0)]
        style = entities.style("boundary", (0.7, 0.7, 0.7))
        borders = []
        for on, a, b in np.unique(keys, axis=0).tolist():
            mask = (surface == on) & (low == a) & (high == b)
            between = [self._contents.block_names[block] for block in (a, b) if block >= 0]
            name = f"{names[on if on >= 0 else len(names) + on]}: {' / '.join(between)}"
            made = entities.product("IfcVirtualElement", f"border {on} {a} {b}", name, geomodel)
            made.PredefinedType = "BOUNDARY"
            entities.show(
                made, "Surface", "Tessellation", [entities.triangles(triangles.corners[mask], False, style)]
            )
            if a >= 0:
                entities.connect(strata[a], strata[b], made, name)
            borders.append(made)
        return borders

    def _borehole(self, hole: Hole) -> Any:
        entities = self.entities
        made = entities.product("IfcBorehole", "borehole", hole.name, entities.site)
        if not hole.blocks:
            return made
        entities.show(made, "Axis", "Curve3D", [entities.line(hole.places)])
        shells = {shell.number: shell for shell in self._contents.blocks}
        depths, strata = hole.depths.tolist(), []
        for number, (first, last) in enumerate(hole.strata):
            block = hole.blocks[first]
            name = self._contents.block_names[block] if block >= 0 else "unknown"
            stratum = entities.product("IfcGeotechnicalStratum", f"{hole.name} {number}", name, made)
            part = shells[block].part if block >= 0 else None
            style = entities.style(*((part.material, part.color) if part else ("unknown", (0.5, 0.5, 0.5))))
            stratum.PredefinedType = "SOLID" if block >= 0 else "NOTDEFINED"
            entities.show(
                stratum,
                "Body",
                "AdvancedSweptSolid",
                [entities.tube(hole.places[first : last + 1], _RADIUS, style)],
            )
            if block >= 0:
                self._materials.setdefault(self._model.blocks[block].property, []).append(stratum)
            limits = {"From": depths[first], "To": depths[last]}
            entities.properties(stratum, "RealModel_Interval", {**limits, "Top": hole.surfaces[first]})
            strata.append(stratum)
        entities.aggregate(made, strata)
        return made

    def _associate(self, prop: int, elements: list) -> None:
        library = self._model.project.library
        entry = library.get(prop) if library else None
        name = next(shell.part.material for shell in self._contents.blocks if shell.part.property == prop)
        self.entities.material(name, entry.rock if entry else None, elements)
