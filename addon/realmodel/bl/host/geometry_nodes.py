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

    def stored(self, geometry, name, value, domain="POINT", kind=None):
        """The geometry with an attribute. kind: of its data; None: a vector or a float, as the value is."""
        is_vector = getattr(value, "type", "") == "VECTOR"
        node = self.new("GeometryNodeStoreNamedAttribute")
        node.data_type, node.domain = kind or ("FLOAT_VECTOR" if is_vector else "FLOAT"), domain
        node.inputs["Name"].default_value = name
        self.link(geometry, next(s for s in node.inputs if s.type == "GEOMETRY"))
        self.link(value, next(s for s in node.inputs if s.name == "Value" and s.enabled))
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

    def separated(self, geometry, selection):
        """The selected faces, and the others."""
        node = self.new("GeometryNodeSeparateGeometry")
        node.domain = "FACE"
        self.link(geometry, node.inputs["Geometry"])
        self.link(selection, node.inputs["Selection"])
        return node.outputs["Selection"], node.outputs["Inverted"]

    def rotation(self):
        """The rotation of the object, as Euler angles."""
        node = self.new("GeometryNodeObjectInfo")
        self.link(self.of("GeometryNodeSelfObject", 0), node.inputs["Object"])
        return node.outputs["Rotation"]

    def turned(self, vector):
        """A vector of the object's coordinates as the world has it, but for the object's scale."""
        node = self.new("ShaderNodeVectorRotate")
        node.rotation_type = "EULER_XYZ"
        self.link(vector, node.inputs["Vector"])
        self.link(self.rotation(), node.inputs["Rotation"])
        return node.outputs[0]

    def upright(self, instances):
        """Instances turned in their places as if the object were not: the inverse of its rotation, axis by
        axis, as Euler angles have an order."""
        for axis in (2, 1, 0):
            angles = self.new("ShaderNodeCombineXYZ")
            angle = self.math("MULTIPLY", self.part(self.rotation(), axis), -1.0)
            self.link(angle, angles.inputs[axis])
            node = self.new("GeometryNodeRotateInstances")
            for name, value in (
                ("Instances", instances),
                ("Rotation", angles.outputs[0]),
                ("Pivot Point", self.of("GeometryNodeInputPosition", "Position")),
                ("Local Space", False),
            ):
                self.link(value, node.inputs[name])
            instances = node.outputs[0]
        return instances

    def random(self, low, high, number):
        """A random number, or vector, for each point. number: another one has other values."""
        node = self.new("FunctionNodeRandomValue")
        kind = "VECTOR" if isinstance(low, tuple) else "VALUE"
        node.data_type = "FLOAT_VECTOR" if kind == "VECTOR" else "FLOAT"
        for name, value in (("Min", low), ("Max", high)):
            self.link(value, next(s for s in node.inputs if s.name == name and s.enabled))
        self.link(number, node.inputs["Seed"])
        return of_type(node.outputs, kind)

    def on(self, domain, value):
        """A number or a vector as a domain has it."""
        node = self.new("GeometryNodeFieldOnDomain")
        node.domain = domain
        node.data_type = "FLOAT_VECTOR" if value.type == "VECTOR" else "FLOAT"
        kind = "VECTOR" if value.type == "VECTOR" else "VALUE"
        self.link(value, of_type(node.inputs, kind))
        return of_type(node.outputs, kind)


def of_type(sockets, kind, name=None):
    """The socket of a type: before 5.0 nodes have one for each, of which one is in use."""
    return next(
        s
        for s in sockets
        if s.type == kind
        and s.enabled
        and s.name not in ("Exists", "Name", "Index")
        and (name is None or s.name == name)
    )
