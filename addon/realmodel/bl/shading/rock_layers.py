# SPDX-License-Identifier: GPL-3.0-or-later
"""What blocks and beds have for other programs and for Solid shading: a UV map, the color of the rock, and
values of their vertices."""

import bpy
import numpy as np

from ...core.base.work import native_module, on_threads
from ...core.display import box_projection, polygon_mesh
from ...core.display.wetness import wetness
from ..host import versions
from ..host.threads import threads
from ..objects import exaggeration, filled_beds, meshes, model_tree, shapes
from ..project import library_rows
from . import looks, strata_modifier, weathering

UV_MAP = "UVMap"  # along the bedding; polygons of different places overlap
COLOR = "Rock Color"  # a color attribute, the active one
KEPT = "{} of Mesh"  # the UV map of a filled mesh that has the name of UV_MAP
_NEAR = 1e-5  # of the size of a mesh: what is farther from it is not its surface
HARDNESS, WETNESS = "realmodel_hardness", "realmodel_wetness"  # of vertices, from 0 to 1


def write(scene, items, size=0.0):
    """Gives beds and blocks the UV map and the values. size: the length in the scene of a UV unit, 0: a
    texture unit of the looks. Returns that length."""
    if not items:
        return size
    size = size or _texture_unit(scene, items[0])
    places = [_places(obj) for obj in items]
    heights = np.concatenate([at[:, 2] for at in places])
    low, high = float(heights.min(initial=np.inf)), float(heights.max(initial=-np.inf))
    for obj, at in zip(items, places, strict=True):
        mesh = obj.data
        if not len(mesh.polygons):
            continue
        arrays = arrays_of(mesh)
        set_uv(mesh, UV_MAP, projection(mesh, at, arrays, size).uv)
        _set_color(mesh, next((slot.material for slot in obj.material_slots if slot.material), None))
        edges = versions.edge_vertices(mesh)
        wet = wetness(at, *arrays[:2], edges, low, high)
        _set(mesh, WETNESS, "FLOAT", wet)
        if filled_beds.BED in obj:
            hardness = weathering.hardness_of_bed(obj)
            _set(mesh, filled_beds.BED, "INT", np.full(len(at), obj[filled_beds.BED], np.int32))
        else:
            hardness = weathering.hardness_of(library_rows.find(scene, obj.get(model_tree.PROPERTY)))
        _set(mesh, HARDNESS, "FLOAT", np.full(len(at), hardness, np.float32))
    return size


def finish(scene, source, beds):
    """Gives new beds what `write` does, and on the surface of the mesh that they fill, which is still shown,
    its smooth shading and UV maps; elsewhere these are along the bedding."""
    bpy.context.view_layer.update()  # or it would not know where they stand
    write(scene, beds)
    with (
        strata_modifier.without_erosion(source) as depsgraph,
        shapes.evaluated_mesh(source, depsgraph, all_layers=True) as mesh,
    ):
        polygons = shapes.triangle_polygons(mesh)
        corners = np.empty(3 * len(polygons), np.int32)
        mesh.loop_triangles.foreach_get("loops", corners)
        corners = corners.reshape(-1, 3)
        smooth = np.empty(len(mesh.polygons), bool)
        mesh.polygons.foreach_get("use_smooth", smooth)
        uvs = {layer.name: uv_of(layer) for layer in mesh.uv_layers}
        vertices = versions.corner_vertices(mesh)[corners]
        triangles = meshes.mesh_coordinates(mesh)[vertices].astype(np.float64)
    if not beds or not (uvs or smooth.any()):
        return
    parts = []
    for bed in beds:
        offsets, vertices, _ = arrays_of(bed.data)
        at = meshes.mesh_coordinates(bed.data)[vertices].astype(np.float64)
        middle = np.add.reduceat(at, offsets[:-1]) / np.diff(offsets)[:, None]
        parts.append((bed.data, np.diff(offsets), at, middle))
    middles = np.concatenate([middle for *_, middle in parts])
    nearest, away = native_module().nearest_triangles(triangles, middles, execution=on_threads(threads()))
    is_kept = away <= _NEAR * float(np.ptp(triangles.reshape(-1, 3), axis=0).max())
    ends = np.cumsum([len(middle) for *_, middle in parts])[:-1]
    for (mesh, counts, at, _), near, kept in zip(
        parts, np.split(nearest, ends), np.split(is_kept, ends), strict=True
    ):
        if smooth.any():
            mesh.polygons.foreach_set("use_smooth", kept & smooth[polygons[near]])
            versions.break_at_flat(mesh)
        rows = np.flatnonzero(np.repeat(kept, counts))
        triangle = np.repeat(near, counts)[rows]
        weights = polygon_mesh.barycentric(at[rows, None], triangles[triangle])[:, 0]
        for name, values in uvs.items():
            layer = mesh.uv_layers.new(name=KEPT.format(name) if name == UV_MAP else name, do_init=False)
            if layer is not None:  # there may be eight
                made = uv_of(mesh.uv_layers[UV_MAP])
                made[rows] = polygon_mesh.interpolated(values, corners[triangle], weights)
                mesh.uv_layers[layer.name].data.foreach_set("uv", made.ravel())


def uv_of(layer):
    """(C, 2) float32 of a UV map."""
    values = np.empty((len(layer.data), 2), np.float32)
    layer.data.foreach_get("uv", values.ravel())
    return values


def arrays_of(mesh):
    """The offsets (F + 1,), corners (C,) and edges of corners (C,) of a mesh."""
    edges = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("edge_index", edges)
    offsets = np.append(versions.polygon_starts(mesh), np.int32(len(mesh.loops)))
    return offsets, versions.corner_vertices(mesh), edges


def projection(mesh, places, arrays, size):
    """The box_projection.Projection of a mesh. places: (V, 3) of its vertices in the scene; arrays: as of
    `arrays_of`."""
    surface = values_of(mesh, meshes.FACE_SURFACE, np.int32)
    height, thickness = (
        values_of(mesh, meshes.PREFIX + name, np.float32) for name in ("height", "thickness")
    )
    is_known = surface is not None and height is not None and thickness is not None
    return box_projection.project(
        places, arrays, size, (surface >= 0, height * thickness) if is_known else None
    )


def set_uv(mesh, name, uv):
    """Makes a UV map the active one. uv: (C, 2) float32."""
    layer = mesh.uv_layers.get(name) or mesh.uv_layers.new(name=name, do_init=False)
    if layer is None:  # there may be eight
        mesh.uv_layers.remove(mesh.uv_layers[-1])
        layer = mesh.uv_layers.new(name=name, do_init=False)
    layer.data.foreach_set("uv", np.ascontiguousarray(uv, np.float32).ravel())
    mesh.uv_layers[name].active = True
    mesh.uv_layers[name].active_render = True


def _texture_unit(scene, item):
    """That of the looks of an object at scale 1, in the scene."""
    if filled_beds.BED not in item:
        return looks.diagonal(scene) / looks.UNITS
    scale = abs(np.linalg.det(exaggeration.true_matrix(item)[:3, :3])) ** (1.0 / 3.0)
    return filled_beds.size(item) * scale / looks.UNITS


def _places(item):
    """(V, 3) where the vertices of an object are in the scene, without its location, so that they keep their
    digits, but for their elevation."""
    matrix = exaggeration.true_matrix(item)
    places = meshes.mesh_coordinates(item.data).astype(np.float64) @ matrix[:3, :3].T
    places[:, 2] += matrix[2, 3]
    return places


def _set_color(mesh, material):
    old = mesh.color_attributes.get(COLOR)
    if old is not None:
        mesh.color_attributes.remove(old)
    color = (0.8, 0.8, 0.8, 1.0) if material is None else tuple(material.diffuse_color)
    made = mesh.color_attributes.new(COLOR, "BYTE_COLOR", "POINT")
    made.data.foreach_set("color", np.tile(np.array(color, np.float32), len(mesh.vertices)))
    number = [entry.name for entry in mesh.color_attributes].index(COLOR)
    mesh.color_attributes.active_color_index = mesh.color_attributes.render_color_index = number


def values_of(mesh, name, dtype):
    """(N,) of an attribute, or None where there is none."""
    attribute = mesh.attributes.get(name)
    if attribute is None:
        return None
    values = np.empty(len(attribute.data), dtype)
    attribute.data.foreach_get("value", values)
    return values


def _set(mesh, name, kind, values):
    """An attribute of the vertices of a mesh."""
    attribute = mesh.attributes.get(name) or mesh.attributes.new(name, kind, "POINT")
    attribute.data.foreach_set("value", values)
