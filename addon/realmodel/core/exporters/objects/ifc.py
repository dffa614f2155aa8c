# SPDX-License-Identifier: GPL-3.0-or-later
"""IFC 4.3 (ISO 16739-1:2024) by IfcOpenShell: a geomodel of closed strata, their boundaries, boreholes.

A block is an IfcGeotechnicalStratum of the IfcGeomodel; each connected component of it is a closed set of
triangles. Where blocks meet, or meet the outside on a surface, an IfcVirtualElement has the triangles that
both have, and an IfcRelConnectsWithRealizingElements connects the two blocks (an IfcRelSpaceBoundary takes
spaces alone). A borehole is an IfcBorehole of strata.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ...base.atomic import Outputs
from ...base.packages import extra
from ...base.text import Step
from ...base.units import METERS, UNIT_NAMES
from ...cells.model_data import ModelData
from ...results.sections.section_data import rgb_bytes
from ..shapes.manifold import separated
from .object_contents import BlockShell, Contents, Hole, stable_uuid

SCHEMA = "IFC4X3_ADD2"
_LONG_AGO = "1970-01-01T00:00:00"  # the date of writing: the same model has the same bytes
_PREFIXES = {"m": None, "mm": "MILLI", "cm": "CENTI", "km": "KILO"}
_KINDS = (("LENGTHUNIT", "METRE", 1), ("AREAUNIT", "SQUARE_METRE", 2), ("VOLUMEUNIT", "CUBIC_METRE", 3))


class Entities:
    """Makes entities of a file. Coordinates are written less the model's origin, so that programs with short
    numbers show them: a place in plan, in whole units, which the site has, or the map conversion."""

    def __init__(self, library: Any, model: ModelData):
        self.file = library.file(schema=SCHEMA)
        self._library, self._model, self._name = library, model, model.project.name
        self._styles: dict[tuple, Any] = {}
        self._header()
        self._origin = np.zeros(3)
        if len(model.vertices):
            self._origin[:2] = np.floor(model.vertices[:, :2].min(axis=0))
        self._vertices = model.vertices - self._origin
        make = self.file.create_entity
        self._axes = make("IfcAxis2Placement3D", make("IfcCartesianPoint", (0.0, 0.0, 0.0)))
        context = make("IfcGeometricRepresentationContext", None, "Model", 3, 1e-6, self._axes, None)
        self._contexts = {
            name: make(
                "IfcGeometricRepresentationSubContext",
                ContextIdentifier=name,
                ContextType="Model",
                ParentContext=context,
                TargetView="GRAPH_VIEW" if name == "Axis" else "MODEL_VIEW",
            )
            for name in ("Body", "Surface", "Axis")
        }
        project = make(
            "IfcProject",
            self._guid("project"),
            Name=self._name,
            RepresentationContexts=[context],
            UnitsInContext=make("IfcUnitAssignment", self._units(model.project.units)),
        )
        placement = self._place_site(context)
        self.site = make(
            "IfcSite",
            self._guid("site"),
            Name=self._name,
            ObjectPlacement=make("IfcLocalPlacement", None, placement),
        )
        self.aggregate(project, [self.site])

    def _header(self) -> None:
        header = self.file.header
        header.file_description.description = ("ViewDefinition [ReferenceView_V1.2]",)
        header.file_name.name = f"{self._name}.ifc"
        header.file_name.time_stamp = _LONG_AGO
        header.file_name.author = ("",)
        header.file_name.organization = ("",)
        header.file_name.preprocessor_version = f"IfcOpenShell {self._library.version}"
        header.file_name.originating_system = "RealModel"
        header.file_name.authorization = ""

    def _guid(self, *words: str) -> str:
        return self._library.guid.compress(stable_uuid("ifc", self._name, *words).hex)

    def _units(self, unit: str) -> list:
        """The model's unit of lengths, and its square and cube; radians."""
        make, units = self.file.create_entity, []
        for kind, name, power in _KINDS:
            if unit in _PREFIXES:
                units.append(make("IfcSIUnit", None, kind, _PREFIXES[unit], name))
                continue
            exponents = make("IfcDimensionalExponents", power, 0, 0, 0, 0, 0, 0)
            factor = make(
                "IfcMeasureWithUnit",
                make("IfcRatioMeasure", float(METERS[unit] ** power)),
                make("IfcSIUnit", None, kind, None, name),
            )
            words = ("", "square ", "cubic ")[power - 1] + UNIT_NAMES[unit].lower()
            units.append(make("IfcConversionBasedUnit", exponents, kind, words, factor))
        return [*units, make("IfcSIUnit", None, "PLANEANGLEUNIT", None, "RADIAN")]

    def _place_site(self, context: Any) -> Any:
        """Where the site is: at the origin of a map conversion, where the project names its system, or else
        at the model's origin."""
        make, crs = self.file.create_entity, self._model.project.crs
        east, north, _ = self._origin.tolist()
        if crs is None:
            return make("IfcAxis2Placement3D", make("IfcCartesianPoint", (east, north, 0.0)))
        system = make("IfcProjectedCRS", Name=crs, MapUnit=self.file.by_type("IfcUnitAssignment")[0].Units[0])
        make("IfcMapConversion", context, system, east, north, 0.0, 1.0, 0.0, 1.0)
        return self._axes

    def product(self, kind: str, word: str, name: str, parent: Any) -> Any:
        """An element whose placement is that of another. word: no other element of this name has it."""
        return self.file.create_entity(
            kind,
            self._guid(kind, word, name),
            Name=name,
            ObjectPlacement=self.file.create_entity("IfcLocalPlacement", parent.ObjectPlacement, self._axes),
        )

    def show(self, element: Any, context: str, kind: str, items: Sequence) -> None:
        """Gives an element its shape."""
        make = self.file.create_entity
        shape = make("IfcShapeRepresentation", self._contexts[context], context, kind, items)
        element.Representation = make("IfcProductDefinitionShape", None, None, [shape])

    def triangles(self, corners: np.ndarray, is_closed: bool, style: Any) -> Any:
        """Triangles (T, 3) of vertices of the model; closed ones become a manifold."""
        make = self.file.create_entity
        if is_closed:
            used, numbers = separated(self._vertices, corners)
        else:
            used, numbers = np.unique(corners, return_inverse=True)
        points = make("IfcCartesianPointList3D", self._vertices[used].tolist())
        face_set = make(
            "IfcTriangulatedFaceSet",
            Coordinates=points,
            Closed=is_closed,
            CoordIndex=(numbers.reshape(-1, 3) + 1).tolist(),
        )
        make("IfcStyledItem", face_set, [style])
        return face_set

    def line(self, places: np.ndarray) -> Any:
        """A line through places (N, 3) in model coordinates."""
        make = self.file.create_entity
        points = make("IfcCartesianPointList3D", (places - self._origin).tolist())
        return make("IfcIndexedPolyCurve", points, SelfIntersect=False)

    def tube(self, places: np.ndarray, radius: float, style: Any) -> Any:
        """A round rod along places. radius: in meters."""
        scaled = radius / float(METERS[self._model.project.units])
        solid = self.file.create_entity("IfcSweptDiskSolid", self.line(places), scaled)
        self.file.create_entity("IfcStyledItem", solid, [style])
        return solid

    def style(self, name: str, color: Iterable[float]) -> Any:
        """The surface style of a color, sRGB from 0 to 1."""
        make, key = self.file.create_entity, (name, *color)
        if key not in self._styles:
            shading = make("IfcSurfaceStyleShading", make("IfcColourRgb", None, *key[1:]), 0.0)
            self._styles[key] = make("IfcSurfaceStyle", name, "BOTH", [shading])
        return self._styles[key]

    def aggregate(self, whole: Any, parts: Sequence) -> None:
        """Says that a thing consists of others."""
        self.file.create_entity(
            "IfcRelAggregates",
            self._guid("aggregates", whole.GlobalId),
            RelatingObject=whole,
            RelatedObjects=parts,
        )

    def contain(self, site: Any, elements: Sequence) -> None:
        """Says that elements are in the site."""
        self.file.create_entity(
            "IfcRelContainedInSpatialStructure",
            self._guid("contains", site.GlobalId),
            RelatedElements=elements,
            RelatingStructure=site,
        )

    def connect(self, one: Any, other: Any, border: Any, name: str) -> None:
        """Says that two elements meet in a third one."""
        self.file.create_entity(
            "IfcRelConnectsWithRealizingElements",
            self._guid("connects", border.GlobalId),
            Name=name,
            RelatingElement=one,
            RelatedElement=other,
            RealizingElements=[border],
            ConnectionType="shared boundary",
        )

    def material(self, name: str, category: str | None, elements: Sequence) -> None:
        """What elements are made of."""
        made = self.file.create_entity("IfcMaterial", name, Category=category)
        self.file.create_entity(
            "IfcRelAssociatesMaterial",
            self._guid("material", name),
            RelatedObjects=elements,
            RelatingMaterial=made,
        )

    def properties(self, element: Any, name: str, values: dict) -> None:
        """A set of properties: texts as labels, numbers as they are; those that are None are left out."""
        make = self.file.create_entity
        kinds = {str: "IfcLabel", int: "IfcInteger", float: "IfcReal"}
        entries = [
            make("IfcPropertySingleValue", key, None, make(kinds[type(value)], value))
            for key, value in values.items()
            if value is not None
        ]
        self._define(
            element, make("IfcPropertySet", self._guid(name, element.GlobalId), None, name, None, entries)
        )

    def volume(self, element: Any, name: str, volume: float) -> None:
        """A set of quantities with the volume."""
        make = self.file.create_entity
        quantity = make("IfcQuantityVolume", "Volume", None, None, volume)
        guid = self._guid(name, element.GlobalId)
        self._define(element, make("IfcElementQuantity", guid, None, name, None, None, [quantity]))

    def _define(self, element: Any, definition: Any) -> None:
        self.file.create_entity(
            "IfcRelDefinesByProperties",
            self._guid("defines", definition.GlobalId),
            RelatedObjects=[element],
            RelatingPropertyDefinition=definition,
        )


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
