# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes nodes of a geometry node tree, one expression after the other."""

from .nodes import Nodes

_OUTPUTS = {
    "BOOLEAN": "BOOLEAN",
    "INT": "INT",
    "FLOAT": "VALUE",
    "FLOAT_VECTOR": "VECTOR",
}  # types of sockets


class GeometryNodes(Nodes):
    """Makes nodes of a geometry node tree."""

    def to(self, kind, geometry, **given):
        """The geometry that a node makes of another. given: its inputs by their names."""
        node = self.new(kind)
        self.link(geometry, next(s for s in node.inputs if s.type == "GEOMETRY"))
        for name, value in given.items():
            self.link(value, node.inputs[name])
        return next(s for s in node.outputs if s.type == "GEOMETRY")

    def named(self, name, kind):
        """An attribute by its whole name. kind: of its data."""
        node = self.new("GeometryNodeInputNamedAttribute")
        node.data_type = kind
        node.inputs["Name"].default_value = name
        return of_type(node.outputs, _OUTPUTS[kind])

    def stored(self, geometry, name, value, kind="FLOAT", domain="POINT"):
        """The geometry with an attribute."""
        node = self.new("GeometryNodeStoreNamedAttribute")
        node.data_type, node.domain = kind, domain
        node.inputs["Name"].default_value = name
        self.link(geometry, next(s for s in node.inputs if s.type == "GEOMETRY"))
        self.link(value, of_type(node.inputs, _OUTPUTS[kind], "Value"))
        return next(s for s in node.outputs if s.type == "GEOMETRY")

    def nearest(self, geometry, place):
        """The number of the point of a geometry that is nearest to a position."""
        node = self.new("GeometryNodeSampleNearest")
        self.link(geometry, next(s for s in node.inputs if s.type == "GEOMETRY"))
        self.link(place, node.inputs["Sample Position"])
        return node.outputs["Index"]

    def at(self, geometry, index, value, kind):
        """The value of a field at the point of a geometry with a number."""
        node = self.new("GeometryNodeSampleIndex")
        node.data_type = kind
        self.link(geometry, next(s for s in node.inputs if s.type == "GEOMETRY"))
        self.link(value, of_type(node.inputs, _OUTPUTS[kind], "Value"))
        self.link(index, node.inputs["Index"])
        return of_type(node.outputs, _OUTPUTS[kind])

    def either(self, geometry, other, is_other):
        """One of two geometries."""
        node = self.new("GeometryNodeSwitch")
        node.input_type = "GEOMETRY"
        self.link(is_other, next(s for s in node.inputs if s.name == "Switch" and s.enabled))
        for value, socket in zip(
            (geometry, other), (s for s in node.inputs if s.type == "GEOMETRY"), strict=True
        ):
            self.link(value, socket)
        return next(s for s in node.outputs if s.type == "GEOMETRY")

    def mesh_of(self, item):
        """The geometry of an object in its own coordinates."""
        node = self.new("GeometryNodeObjectInfo")
        self.link(item, node.inputs["Object"])
        node.inputs["As Instance"].default_value = False
        return node.outputs["Geometry"]


def of_type(sockets, kind, name=None):
    """The socket of a type that a node shows."""
    return next(s for s in sockets if s.type == kind and s.enabled and (name is None or s.name == name))
