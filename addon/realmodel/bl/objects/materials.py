# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials: one for each property of the library, shared by all blocks that have it."""

import bpy

from ...core.project.looks import linear, rgb
from ..host import versions

KEY = "realmodel_property"
COLOR = "Property Color"  # the node of a look (looks.py) that has the color of the property
NO_PROPERTY = 0
NEUTRAL_GRAY = "#b3b3b3"


def linear_color(color):
    """Scene-linear (red, green, blue) of an sRGB color "#rrggbb".

    Both the Principled base color and the viewport color (`diffuse_color`, subtype COLOR) are
    scene-linear, so both take this value.
    """
    return tuple(map(linear, rgb(color)))


def name_and_color(library, property_id):
    """The name and the color ("#rrggbb") of a property in the library. Property 0 means that none was given;
    it, and an ID without a color, is a neutral gray."""
    entry = None if library is None else library.get(property_id)
    if entry is None:
        return ("no property" if property_id == NO_PROPERTY else f"property {property_id}"), NEUTRAL_GRAY
    return entry.name, entry.color or NEUTRAL_GRAY


def new_material(name, property_id, color):
    """A new material datablock: matt rock of one color ("#rrggbb")."""
    material = bpy.data.materials.new(name)
    try:
        material[KEY] = property_id
        material.use_nodes = True
        principled = next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
        versions.make_matt(principled)
        material.roughness = 1.0
        set_color(material, color)
    except BaseException:
        bpy.data.materials.remove(material)
        raise
    return material


def give(item, material):
    """Sets the material of a block to that of its property, unless the user has set another."""
    slots = item.data.materials
    if not len(slots):
        slots.append(material)
    elif slots[0] is None or KEY in slots[0]:
        slots[0] = material


def set_color(material, color):
    """Set the color "#rrggbb" of a material in its Principled shader and for the viewport."""
    rgba = (*linear_color(color), 1.0)
    material.diffuse_color = rgba
    if material.node_tree:
        for node in material.node_tree.nodes:
            if node.name == COLOR:
                node.outputs[0].default_value = rgba
            elif node.type == "BSDF_PRINCIPLED":  # exporters read it even where something is linked to it
                node.inputs["Base Color"].default_value = rgba
