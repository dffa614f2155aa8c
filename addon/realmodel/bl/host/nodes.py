# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes nodes of a tree, of a material or of geometry, one expression after the other."""

import bpy


def group_once(kind, name, key, fill, version=True):
    """The node group whose property `key` is this version, made and filled by `fill` where there is none."""
    for group in bpy.data.node_groups:
        if group.get(key) == version and group.library is None:
            return group
    group = bpy.data.node_groups.new(name, kind)
    try:
        group[key] = version
        fill(group)
    except BaseException:
        bpy.data.node_groups.remove(group)
        raise
    return group


def modifier_with(item, key):
    """The modifier of an object whose node group has a property `key`, or None."""
    modifiers = (m for m in item.modifiers if m.type == "NODES" and m.node_group and key in m.node_group)
    return next(modifiers, None)


class Nodes:
    """Makes nodes of a tree, in columns by their number."""

    def __init__(self, tree):
        self.tree = tree

    def new(self, kind):
        node = self.tree.nodes.new(kind)
        count = len(self.tree.nodes)
        node.location = (-220.0 * (count // 5), -240.0 * (count % 5))
        return node

    def link(self, value, socket):
        """Links or sets an input. value: an output, or the value of the input without a link."""
        if isinstance(value, (float, int, tuple, str)):
            socket.default_value = value
        else:
            self.tree.links.new(value, socket)

    def of(self, kind, output):
        return self.new(kind).outputs[output]

    def math(self, operation, *values):
        node = self.new("ShaderNodeMath")
        node.operation = operation
        for value, socket in zip(values, node.inputs, strict=False):  # few operations take three
            self.link(value, socket)
        return node.outputs[0]

    def vector(self, operation, first, second=None):
        node = self.new("ShaderNodeVectorMath")
        node.operation = operation
        self.link(first, node.inputs[0])
        if second is not None:
            self.link(second, node.inputs["Scale" if operation == "SCALE" else 1])
        return node.outputs["Value" if operation == "DOT_PRODUCT" else "Vector"]

    def about(self, value, strength):
        """A value from 0 to 1 around 0, times a strength."""
        return self.math("MULTIPLY", self.math("SUBTRACT", value, 0.5), strength)

    def mixed(self, low, high, share):
        """Between two values, at a share of the way."""
        return self.math("MULTIPLY_ADD", self.math("SUBTRACT", high, low), share, low)

    def total(self, values):
        total = values[0] if values else 0.0
        for value in values[1:]:
            total = self.math("ADD", total, value)
        return total

    def part(self, vector, axis):
        apart = self.new("ShaderNodeSeparateXYZ")
        self.link(vector, apart.inputs[0])
        return apart.outputs[axis]

    def ramp(self, value, low, high, at_low, at_high):
        """A smooth step."""
        node = self.new("ShaderNodeMapRange")
        node.interpolation_type = "SMOOTHSTEP"
        for socket, source in zip(node.inputs[:5], (value, low, high, at_low, at_high), strict=True):
            self.link(source, socket)
        return node.outputs[0]

    def noise(self, place, scale, detail, dimensions="3D"):
        node = self.new("ShaderNodeTexNoise")
        node.noise_dimensions = dimensions
        self.link(place, node.inputs["Vector"])
        node.inputs["Scale"].default_value, node.inputs["Detail"].default_value = scale, detail
        return node.outputs[0]
