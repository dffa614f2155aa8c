# SPDX-License-Identifier: GPL-3.0-or-later
"""Worn edges without a finer mesh: nodes in the materials of weathered blocks.

The shader rounds normals near edges (Cycles) and makes edges pale in patches (both renderers). How far is an
attribute that the modifier of each weathered block has, so that others of the same material keep sharp
edges, at no cost. Materials of which no block is weathered have no such nodes.
"""

from ..host import versions
from ..host.nodes import Nodes, group_once

ATTRIBUTE = "realmodel_wear"  # of weathered blocks: how far edges are worn, model units
KEY = "realmodel_edge_wear"  # on the node group, and on the node
_SAMPLES = 4  # rays of a sample that look for edges
_PALE = 0.5  # how much brighter edges are


def put_on(material):
    """Adds worn edges to the nodes of a material, unless they are there."""
    tree = material.node_tree
    if tree is None or material.library is not None or _node(tree) is not None:
        return
    shader = next((node for node in tree.nodes if node.type == "BSDF_PRINCIPLED"), None)
    if shader is None:
        return
    node = tree.nodes.new("ShaderNodeGroup")
    node.node_tree = group_once("ShaderNodeTree", "RealModel Edge Wear", KEY, _fill)
    node.name = KEY
    color, normal = (_source(shader.inputs[name]) for name in ("Base Color", "Normal"))
    if color is not None and color.node.type == "MIX":  # the last factor of a look's color: see looks
        color = next(s for s in color.node.inputs if s.name == "B" and s.enabled)
        _pass_through(tree, color, node, "Color")
    if normal is not None and normal.node.type == "BUMP":
        tree.links.new(node.outputs["Normal"], normal.node.inputs["Normal"])
    elif normal is None:
        tree.links.new(node.outputs["Normal"], shader.inputs["Normal"])


def take_off(material):
    """Removes them."""
    tree = material.node_tree
    node = None if tree is None or material.library is not None else _node(tree)
    if node is None:
        return
    before = _source(node.inputs["Color"])
    for link in list(node.outputs["Color"].links):
        tree.links.new(before, link.to_socket)
    tree.nodes.remove(node)


def has(material):
    """Whether a material has them."""
    return material.node_tree is not None and _node(material.node_tree) is not None


def _node(tree):
    return tree.nodes.get(KEY)


def _source(socket):
    return socket.links[0].from_socket if socket.is_linked else None


def _pass_through(tree, socket, node, name):
    """Puts a node into the link to a socket."""
    tree.links.new(_source(socket), node.inputs[name])
    tree.links.new(node.outputs[name], socket)


def _fill(group):
    versions.add_group_socket(group, "Color", "NodeSocketColor")
    for name, kind in (("Color", "NodeSocketColor"), ("Normal", "NodeSocketVector")):
        versions.add_group_socket(group, name, kind, is_output=True)
    nodes = Nodes(group)
    group_input, made = nodes.new("NodeGroupInput"), nodes.new("NodeGroupOutput")
    wear = nodes.new("ShaderNodeAttribute")
    wear.attribute_name = ATTRIBUTE
    wear = wear.outputs["Fac"]
    place = nodes.vector("SCALE", nodes.of("ShaderNodeTexCoord", "Object"), nodes.math("DIVIDE", 0.4, wear))
    uneven = nodes.ramp(nodes.noise(place, 1.0, 4.0), 0.3, 0.7, 0.15, 1.0)
    radius = nodes.math("MULTIPLY", wear, uneven)
    bevel = nodes.new("ShaderNodeBevel")
    bevel.samples = _SAMPLES
    nodes.link(radius, bevel.inputs["Radius"])
    nodes.link(bevel.outputs["Normal"], made.inputs["Normal"])
    edge = nodes.new("ShaderNodeAmbientOcclusion")
    edge.inside, edge.only_local, edge.samples = True, True, _SAMPLES
    nodes.link(radius, edge.inputs["Distance"])
    pale = nodes.ramp(edge.outputs["AO"], 0.6, 1.0, 1.0 + _PALE, 1.0)
    nodes.link(nodes.vector("SCALE", group_input.outputs["Color"], pale), made.inputs["Color"])
