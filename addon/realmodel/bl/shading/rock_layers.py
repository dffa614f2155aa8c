# SPDX-License-Identifier: GPL-3.0-or-later
"""What blocks and beds have for other programs and for Solid shading: a UV map, the color of the rock, and
values of their vertices."""

from dataclasses import dataclass, field

import numpy as np

from ...core.base.work import native_module, on_threads
from ...core.display import box_projection, polygon_mesh
from ...core.display.wetness import wetness
from ..host import versions
from ..objects import exaggeration, filled_beds, meshes, model_tree, placing, shapes
from ..project import library_rows
from . import looks, strata_modifier, weathering

UV_MAP = "UVMap"  # along the bedding; polygons of different places overlap
COLOR = "Rock Color"  # a color attribute, the active one
KEPT = "{} of Mesh"  # the UV map of a filled mesh that has the name of UV_MAP
_NEAR = 1e-5  # of the size of a mesh: what is farther from it is not its surface
# of vertices, from 0 to 1
HARDNESS, WETNESS, JOINTS = "realmodel_hardness", "realmodel_wetness", "realmodel_joints"


def write(scene, items, size=0.0):
    """Gives beds and blocks the UV map and the values. size: the length in the scene of a UV unit, 0: a
    texture unit of the looks. Returns that length."""
    if not items:
        return size
    size = size or _texture_unit(scene, items[0])
    places = [placed(meshes.mesh_coordinates(obj.data), exaggeration.true_matrix(obj)) for obj in items]
    ends = _ends(places)
    for obj, at in zip(items, places, strict=True):
        mesh = obj.data
        if len(mesh.polygons):
            arrays = arrays_of(mesh)
            wet = wetness(at, *arrays[:2], versions.edge_vertices(mesh), *ends)
            _put(scene, obj, BedLayers(projection(mesh, at, arrays, size).uv, wet))
    return size


def surface_of(item):
    """The surface of a mesh that beds fill: triangles (T, 3, 3); of each its polygon (T,),
    and its loops and vertices (T, 3); of polygons whether they are smooth (F,) and their material slots (F,);
    {name: UV map (C, 2)} and {name: weights (V,)}."""
    with (
        strata_modifier.without_erosion(item, strata_modifier.SHOW_ROCKS) as depsgraph,
        shapes.evaluated_mesh(item, depsgraph, all_layers=True) as mesh,
    ):
        polygons = shapes.triangle_polygons(mesh)
        loops = np.empty((len(polygons), 3), np.int32)
        mesh.loop_triangles.foreach_get("loops", loops.ravel())
        smooth, slots = np.empty(len(mesh.polygons), bool), np.empty(len(mesh.polygons), np.int32)
        mesh.polygons.foreach_get("use_smooth", smooth)
        mesh.polygons.foreach_get("material_index", slots)
        weights = {group.name: np.zeros(len(mesh.vertices), np.float32) for group in item.vertex_groups}
        of_group = list(weights.values())
        for number, vertex in enumerate(mesh.vertices if weights else ()):
            for entry in vertex.groups:
                of_group[entry.group][number] = entry.weight
        vertices = versions.corner_vertices(mesh)[loops]
        triangles = meshes.mesh_coordinates(mesh)[vertices].astype(np.float64)
        uvs = {layer.name: uv_of(layer) for layer in mesh.uv_layers}
    return triangles, polygons, loops, vertices, smooth, slots, uvs, weights


@dataclass(eq=False)
class BedLayers:
    """What a mesh gets: uv (C, 2) float32, wet (V,) and, of beds, joints (V,). On the surface of the mesh
    that beds fill also what that has there: smooth (F,), slots (F,), -1 elsewhere, uvs (C, 2) and weights
    (V,) by their names. Elsewhere UV maps are along the bedding."""

    uv: np.ndarray
    wet: np.ndarray
    joints: np.ndarray | None = None
    smooth: np.ndarray | None = None
    slots: np.ndarray | None = None
    uvs: dict = field(default_factory=dict)
    weights: dict = field(default_factory=dict)


def of_beds(solids, matrix, surface, joints, threads):
    """BedLayers of new beds, in any thread. solids: their PolygonMesh; matrix: (4, 4) to the scene; surface:
    as of `surface_of`, both in its coordinates; joints: (V,) of each."""
    scale = placing.mean_scale(matrix)
    extents = np.concatenate([[s.coordinates.min(axis=0), s.coordinates.max(axis=0)] for s in solids])
    unit = float(np.linalg.norm(np.ptp(extents, axis=0)) or 1.0) * scale / looks.UNITS
    places = [placed(solid.coordinates, matrix) for solid in solids]
    ends = _ends(places)
    found = []
    middles = [
        np.add.reduceat(s.coordinates[s.corners], s.offsets[:-1]) / np.diff(s.offsets)[:, None]
        for s in solids
    ]
    nearest = native_module().nearest_triangles(
        surface[0], np.concatenate(middles).astype(np.float64), execution=on_threads(threads)
    )
    parts = np.cumsum([len(middle) for middle in middles])[:-1]
    for solid, at, near, *closest in zip(
        solids, places, joints, *(np.split(part, parts) for part in nearest), strict=True
    ):
        arrays = solid.offsets, solid.corners, solid.corner_edges
        above = solid.bedding.height * solid.bedding.thickness
        uv = box_projection.project(at, arrays, unit, (solid.face_surface >= 0, above)).uv
        made = BedLayers(uv, wetness(at, *arrays[:2], solid.edges, *ends), near)
        _keep(made, solid, surface, *closest)
        found.append(made)
    return found


def _keep(made, solid, surface, near, away):
    """Adds what the filled mesh has on its surface. near, away: (F,) its triangles nearest to polygons."""
    triangles, polygons, loops, vertices, smooth, slots, uvs, all_weights = surface
    counts = np.diff(solid.offsets)
    at = solid.coordinates[solid.corners].astype(np.float64)
    kept = away <= _NEAR * float(np.ptp(triangles.reshape(-1, 3), axis=0).max())
    polygon = polygons[near]
    made.smooth = kept & smooth[polygon]
    made.slots = np.where(kept, slots[polygon], -1)
    rows = np.flatnonzero(np.repeat(kept, counts))
    triangle = np.repeat(near, counts)[rows]
    shares = polygon_mesh.barycentric(at[rows, None], triangles[triangle])[:, 0]
    for name, values in uvs.items():
        made.uvs[name] = uv = made.uv.copy()
        uv[rows] = polygon_mesh.interpolated(values, loops[triangle], shares)
    for name, values in all_weights.items():
        made.weights[name] = weights = np.zeros(len(solid.coordinates), np.float32)
        of_corner = polygon_mesh.interpolated(values[:, None], vertices[triangle], shares)
        weights[solid.corners[rows]] = of_corner[:, 0]


def finish(scene, beds, layers, slots):
    """Gives new beds their BedLayers. slots: materials that the surface of the filled mesh keeps, if any."""
    for bed, made in zip(beds, layers, strict=True):
        _put(scene, bed, made)
        mesh = bed.data
        if made.smooth.any():
            mesh.polygons.foreach_set("use_smooth", made.smooth)
            versions.break_at_flat(mesh)
        for name, values in made.uvs.items():
            layer = mesh.uv_layers.new(name=KEPT.format(name) if name == UV_MAP else name, do_init=False)
            if layer is not None:  # there may be eight
                mesh.uv_layers[layer.name].data.foreach_set("uv", values.ravel())
        if slots and (made.slots >= 0).any():
            rocks = len(mesh.materials)
            for material in slots:
                mesh.materials.append(material)
            index = np.where(made.slots < 0, 0, rocks + np.minimum(made.slots, len(slots) - 1))
            mesh.polygons.foreach_set("material_index", index.astype(np.int32))
        for name, values in made.weights.items():
            group = bed.vertex_groups.new(name=name)
            steps = np.rint(values * 255.0).astype(int)
            for step in np.unique(steps[steps > 0]).tolist():  # one by one would take seconds
                group.add(np.flatnonzero(steps == step).tolist(), step / 255.0, "REPLACE")


def placed(coordinates, matrix):
    """(V, 3) where vertices are in the scene, without its location, so that they keep their digits, but for
    their elevation."""
    places = coordinates.astype(np.float64) @ matrix[:3, :3].T
    places[:, 2] += matrix[2, 3]
    return places


def _ends(places):
    """The lowest and the highest elevation of places (V, 3), of several meshes."""
    heights = np.concatenate([at[:, 2] for at in places])
    return float(heights.min(initial=np.inf)), float(heights.max(initial=-np.inf))


def _put(scene, obj, made):
    mesh = obj.data
    set_uv(mesh, UV_MAP, made.uv)
    _set_color(mesh, next((slot.material for slot in obj.material_slots if slot.material), None))
    _set(mesh, WETNESS, "FLOAT", made.wet)
    if made.joints is not None:
        _set(mesh, JOINTS, "FLOAT", made.joints)
    if filled_beds.BED in obj:
        hardness = weathering.hardness_of_bed(obj)
        _set(mesh, filled_beds.BED, "INT", np.full(len(made.wet), obj[filled_beds.BED], np.int32))
    else:
        hardness = weathering.hardness_of(library_rows.find(scene, obj.get(model_tree.PROPERTY)))
    _set(mesh, HARDNESS, "FLOAT", np.full(len(made.wet), hardness, np.float32))


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
    scale = placing.mean_scale(exaggeration.true_matrix(item))
    return filled_beds.size(item) * scale / looks.UNITS


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
