# SPDX-License-Identifier: GPL-3.0-or-later
"""Exact sections as mesh objects with the materials of their layers."""

import bpy
import numpy as np

from ...core import InputRefused
from ...core.display.polygon_mesh import PolygonMesh
from ...core.results.sections.section_drawing import flattened, is_vertical
from ..objects import meshes, model_tree, shapes
from ..objects.origin import offsets_from
from ..project import library_rows, project_settings
from . import bodies, explosion, shown_models

FLAT = "realmodel_flat"  # on the object of a section that lies beside the model
LINE = "realmodel_line"  # on the object of a fence: the object of its line
BLOCK_ATTRIBUTE = "realmodel_block"  # of each face: the number of its block, as in the results


_AWAY = 2e-3  # of the model's size: offset of a section from the cut face, against flickering
_BESIDE = 0.12  # of the model's size: distance of flat sections from the model


def by_plane(scene, location, normal):
    """The core's Section of a scene's model, at its stage. location, normal: three numbers each; location in
    the coordinates of the scene (to which the model origin is added), the normal of any length. Raises
    UsageError for a plane that is none, InputRefused for one that does not meet the model, BuildFailed."""
    point = np.asarray(location, np.float64) + project_settings.model_origin(scene)
    return colored(scene, shown_models.at_stage(scene, scene.realmodel.stage).section(point, normal))


def along(scene, item, depsgraph):
    """The core's Fence of a scene's model, at its stage, along the line of a curve or mesh object. Raises
    InputRefused, BuildFailed."""
    return through(scene, shapes.polyline(item, depsgraph) + project_settings.model_origin(scene)[:2])


def line_of(item):
    """The object of the line of a fence; of another object itself."""
    return item.get(LINE) or item


def through(scene, line):
    """The core's Fence of a scene's model, at its stage, along a line (N, 2) in model coordinates. Raises
    InputRefused, BuildFailed."""
    return colored(scene, shown_models.at_stage(scene, scene.realmodel.stage).fence(line))


def colored(scene, section):
    """A section in the colors that the library has now."""
    if not len(section):
        raise InputRefused("the section does not meet the model", advice="move it to the blocks, or turn it")
    for block, property_id in set(zip(section.block.tolist(), section.property.tolist(), strict=True)):
        row = library_rows.find(scene, property_id)
        if row is not None and row.has_color:
            section.block_colors[block] = tuple(row.color)
    return section


def add(scene, found, name, flat=False):
    """A mesh object of a Section or Fence.

    Every face has its block's number in the attribute "realmodel_block" and its property's material. flat:
    unrolled beside the model, distances to the right and heights upright, level planes as a map.
    """
    origin = project_settings.model_origin(scene)
    places = _beside(scene, found, origin) if flat else offsets_from(origin, found.vertices)
    used, corners = np.unique(found.polygon_vertices, return_inverse=True)
    shape = PolygonMesh(places[used], found.offsets.astype(np.int32), corners.astype(np.int32))
    mesh = meshes.new_mesh(name, shape)
    ids = np.unique(found.property)
    for property_id in ids.tolist():
        mesh.materials.append(library_rows.material_of(scene, property_id))
    slots = np.searchsorted(ids, found.property).astype(np.int32)
    mesh.polygons.foreach_set("material_index", slots)
    attribute = mesh.attributes.new(BLOCK_ATTRIBUTE, "INT", "FACE")
    attribute.data.foreach_set("value", np.ascontiguousarray(found.block, np.int32))
    mesh.update()
    obj = bpy.data.objects.new(name, mesh)
    if flat:
        obj[FLAT] = True
    stand(scene, obj, None if flat else found.plane)
    return obj


def stand(scene, item, plane):
    """Adds the object of a section to the scene. plane: of the section, if it is plane."""
    item[model_tree.TAG] = "section"
    if plane is not None:
        normal = np.asarray(plane[1], np.float64)
        item.location = _AWAY * _size(scene) * normal / np.linalg.norm(normal)
    bodies.view_collection(scene).objects.link(item)


def _size(scene):
    low, high = explosion.bounds(scene)
    return float(np.linalg.norm(np.asarray(high) - low))


def _beside(scene, section, origin):
    """(V, 3) float32: the section unrolled to the south of the model, a map to the east of it."""
    low, high = (np.asarray(corner, np.float64) for corner in explosion.bounds(scene))
    flat, size = flattened(section), _size(scene)
    if not is_vertical(section) and np.ptp(section.vertices[:, 2]) == 0:
        shift = (high[0] - low[0] + _BESIDE * size, 0.0)
        return np.column_stack([flat - origin[:2] + shift, np.full(len(flat), low[2])]).astype(np.float32)
    number = sum(FLAT in obj for obj in scene.objects)
    upright = flat[:, 1] - origin[2] if is_vertical(section) else low[2] + flat[:, 1]
    south = np.full(len(flat), low[1] - (number + 1) * _BESIDE * size)
    return np.column_stack([low[0] + flat[:, 0], south, upright]).astype(np.float32)
