# SPDX-License-Identifier: GPL-3.0-or-later
"""Colors that change within an object: elevation, thickness of the layer, standard deviation.

They are a color attribute, as Blender's solid shading shows no other colors within a mesh; renders take the
same attribute by the material `material()`. All objects have one scale, which the legend shows.
"""

import colorsys

import bpy
import numpy as np

from ...core.drawing import color_scale
from ...core.results import layer_values
from ..host import versions
from ..objects import materials, meshes, shapes, uncertainty
from ..project import project_settings, settings
from . import bodies

ATTRIBUTE = "realmodel_shade"
_GOLDEN = 0.618034  # of the circle of hues: no two of the first dozens come near each other
TITLES = {"ELEVATION": "Elevation", "THICKNESS": "Thickness", "UNCERTAINTY": "Standard Deviation"}
COMPARTMENT = "COMPARTMENT"  # a color for each: of the corners of faces, as neighbors differ
IN_MESH = (*TITLES, COMPARTMENT)  # ways of coloring that are an attribute of meshes
_FROM_ZERO = ("THICKNESS", "UNCERTAINTY")


def apply(scene, by):
    """Sets or removes the colors in the meshes of blocks and interfaces, and of the bodies that stand for
    them. by: one of IN_MESH; for any other value the colors are removed."""
    shown = list(_shown(scene))
    if by == COMPARTMENT:
        for obj, _ in shown:
            if _takes(obj):
                _write_compartments(obj.data)
        return
    if by not in TITLES:
        for obj, _ in shown:
            remove(obj)
        return
    value = _value_of(scene, by)
    shaded = [(obj, value(pair, meshes.mesh_coordinates(obj.data))) for obj, pair in shown if _takes(obj)]
    finite = [values[np.isfinite(values)] for _, values in shaded]
    finite = np.concatenate(finite) if finite else np.empty(0)
    low, high = (float(finite.min()), float(finite.max())) if len(finite) else (0.0, 0.0)
    limits = (0.0 if by in _FROM_ZERO else low, high)
    scene.realmodel.view.shade_limits = limits
    for obj, values in shaded:
        write(obj.data, color_scale.colors(values, limits))


def limits(scene):
    """The values at the ends of the scale."""
    return tuple(scene.realmodel.view.shade_limits)


def remove(item):
    attribute = item.data.color_attributes.get(ATTRIBUTE) if _takes(item) else None
    if attribute is not None:
        item.data.color_attributes.remove(attribute)


def material():
    """The material that shows the attribute."""
    scale = next((m for m in bpy.data.materials if m.get(ATTRIBUTE) and m.library is None), None)
    if scale is not None:
        return scale
    made = materials.new_material("Color Scale", materials.NO_PROPERTY, materials.NEUTRAL_GRAY)
    del made[materials.KEY]
    made[ATTRIBUTE] = True
    nodes = made.node_tree.nodes
    attribute = nodes.new("ShaderNodeAttribute")
    attribute.attribute_name = ATTRIBUTE
    shader = next(node for node in nodes if node.type == "BSDF_PRINCIPLED")
    made.node_tree.links.new(attribute.outputs["Color"], shader.inputs["Base Color"])
    return made


def _takes(obj):
    return obj.type == "MESH" and obj.mode == "OBJECT" and obj.data.library is None


def _shown(scene):
    """(object, (rock mass, surface) whose layer it shows) of all that has colors."""
    of_blocks = {
        row.object: (row.rock, row.surface) for row in scene.realmodel.results if row.object is not None
    }
    yield from of_blocks.items()
    for kind in (bodies.CUT, bodies.CELLS):
        yield from (
            (body, of_blocks[block])
            for block, body in bodies.of_kind(scene, kind).items()
            if block in of_blocks
        )
    surviving = bodies.of_kind(scene, bodies.SURVIVING)
    for place, row in settings.interface_rows(scene):
        rock = "" if isinstance(place[0], str) else scene.realmodel.rocks[place[0]].name
        yield from (
            (obj, (rock, row.name))
            for obj in (row.interface, surviving.get(row.interface))
            if obj is not None and obj.type == "MESH"
        )


def _value_of(scene, by):
    """A function of (rock mass, surface) and coordinates (N, 3): the values there, (N,), NaN for unknown."""
    if by == "ELEVATION":
        base = project_settings.model_origin(scene)[2]
        return lambda pair, places: places[:, 2] + base
    sources = {}
    if by == "THICKNESS":
        for row in scene.realmodel.results:
            if row.object is not None and row.object.type == "MESH" and len(row.object.data.polygons):
                mesh = row.object.data
                sources[row.rock, row.surface] = meshes.mesh_coordinates(mesh), shapes.mesh_triangles(mesh)
        function = layer_values.thickness
    else:
        for rock, surface in settings.surface_rows(scene):
            deviation = None if surface.interface is None else uncertainty.deviation(surface.interface)
            if deviation is not None:
                mesh = surface.interface.data
                plan = meshes.mesh_coordinates(mesh)[:, :2]
                sources[rock.name, surface.name] = (
                    np.column_stack([plan, deviation]),
                    shapes.mesh_triangles(mesh),
                )
        function = layer_values.at_places

    def value(pair, places):
        if pair not in sources:
            return np.full(len(places), np.nan)
        vertices, triangles = sources[pair]
        return function(vertices.astype(np.float64), triangles, places[:, :2])

    return value


def compartment_color(number):
    """(red, green, blue), sRGB, of a compartment; any two of the first dozens differ."""
    hue, brightness = (0.58 + number * _GOLDEN) % 1.0, (0.92, 0.72)[number % 2]
    return colorsys.hsv_to_rgb(hue, 0.55, brightness)


def _write_compartments(mesh):
    """Colors by the face attribute of compartments; gray where a mesh has none, as a fault."""
    if not len(mesh.polygons):
        return
    attribute = mesh.attributes.get(meshes.FACE_COMPARTMENT)
    if attribute is None:
        colors = np.full((len(mesh.loops), 4), 0.7)
    else:
        number = np.empty(len(attribute.data), np.int32)
        attribute.data.foreach_get("value", number)
        table = np.array([(*compartment_color(n), 1.0) for n in range(int(number.max()) + 1)])
        starts = np.append(versions.polygon_starts(mesh), len(mesh.loops))
        colors = np.repeat(table[number], np.diff(starts), axis=0)
    write(mesh, colors, "CORNER")


def write(mesh, colors, domain="POINT"):
    """Writes colors, (V, 4) sRGB, of the vertices of a mesh, or of its face corners."""
    if not len(colors):
        return
    attribute = mesh.color_attributes.get(ATTRIBUTE)
    if attribute is not None and attribute.domain != domain:
        mesh.color_attributes.remove(attribute)
        attribute = None
    if attribute is None:
        attribute = mesh.color_attributes.new(ATTRIBUTE, "BYTE_COLOR", domain)
    attribute.data.foreach_set("color_srgb", colors.ravel())
    mesh.color_attributes.active_color = mesh.color_attributes[ATTRIBUTE]
    mesh.update()
