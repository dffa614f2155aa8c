# SPDX-License-Identifier: GPL-3.0-or-later
"""The entities of an IFC file, with names and identifiers that the same model always gets."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from ...base.units import METERS, UNIT_NAMES
from ...cells.model_data import ModelData
from .contents import stable_uuid

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
        """Triangles (T, 3) of vertices of the model."""
        make = self.file.create_entity
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
