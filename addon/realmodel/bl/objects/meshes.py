# SPDX-License-Identifier: GPL-3.0-or-later
"""Conversion of arrays to Blender meshes and back."""

import bpy
import numpy as np

from ...core.display.polygon_mesh import PolygonMesh
from ..host import versions
from . import meshes_ahead

# Face attribute: global index of the surface a face lies on; -1 a vertical wall, -2 the flat base
FACE_SURFACE = "realmodel_surface"
# Face attribute of blocks that faults divide: the number of the compartment that a face bounds
FACE_COMPARTMENT = "realmodel_compartment"
# Attributes of blocks (realmodel.core.display.bedding): kind, domain
BEDDING = {
    "height": ("FLOAT", "CORNER"),
    "thickness": ("FLOAT", "CORNER"),
    "depth": ("FLOAT", "CORNER"),
    "is_top": ("BOOLEAN", "FACE"),
    "age": ("FLOAT", "FACE"),
}
PREFIX = "realmodel_"


def new_mesh(name, shape):
    """A new mesh datablock, bpy.types.Mesh, of a core.display.polygon_mesh.PolygonMesh, whose coordinates
    are offsets from the model origin. The surface that each polygon lies on becomes the face attribute
    `realmodel_surface`, the compartment that it bounds `realmodel_compartment`, and where corners lie in
    their layers those of BEDDING, with `realmodel_` before their names.

    Arrays go to Blender as they are: a million quads, with their edges, in less than a tenth of a second.
    A mesh that was made ahead is there already.
    """
    return meshes_ahead.take(shape) or _made_now(name, shape)


def slices(shapes):
    """The meshes of shapes - (name, PolygonMesh) each - to be made ahead: meshes_ahead.Slices."""
    return meshes_ahead.Slices(shapes, _made_now)


def _made_now(name, shape):
    mesh = bpy.data.meshes.new(name)
    try:
        _fill(mesh, shape)
    except BaseException:
        bpy.data.meshes.remove(mesh)
        raise
    return mesh


def triangle_mesh(name, coordinates, triangles, smooth=False):
    """A new mesh datablock of triangles; (V, 3) float32, (T, 3) integers.

    Triangles that repeat a corner are left out: they have no area, the model leaves them out too,
    and Blender's edge tables take harm from them.
    """
    triangles = without_repeated_corners(triangles)
    offsets = np.arange(0, 3 * len(triangles) + 1, 3, dtype=np.int32)
    coordinates = np.ascontiguousarray(coordinates, np.float32)
    return new_mesh(name, PolygonMesh(coordinates, offsets, triangles.ravel(), smooth=smooth))


def line_mesh(name, coordinates, edges):
    """A new mesh datablock of points (V, 3) and lines (E, 2) between them, without faces."""
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(coordinates))
    mesh.vertices.foreach_set("co", np.ascontiguousarray(coordinates, np.float32).ravel())
    if len(edges):
        mesh.edges.add(len(edges))
        mesh.edges.foreach_set("vertices", np.ascontiguousarray(edges, np.int32).ravel())
    mesh.update(calc_edges_loose=True)  # other edges without faces are not drawn in Blender 3.4
    return mesh


def without_repeated_corners(triangles):
    """(T, 3) int32: the triangles whose corners are three different vertices."""
    triangles = np.asarray(triangles, np.int32).reshape(-1, 3)
    repeated = (
        (triangles[:, 0] == triangles[:, 1])
        | (triangles[:, 1] == triangles[:, 2])
        | (triangles[:, 2] == triangles[:, 0])
    )
    return triangles[~repeated]


def refill(mesh, shape):
    """Replaces the vertices and polygons of a mesh; its materials stay. The datablock is the same, so
    references to it stay valid."""
    mesh.clear_geometry()
    _fill(mesh, shape)


def holds(mesh, shape):
    """Whether a mesh has these vertices and corners of polygons already."""
    if len(mesh.vertices) != len(shape.coordinates) or len(mesh.loops) != len(shape.corners):
        return False
    return (
        np.array_equal(mesh_coordinates(mesh), shape.coordinates)
        and np.array_equal(versions.corner_vertices(mesh), shape.corners)
        and _holds(mesh, FACE_COMPARTMENT, shape.face_compartment)
        and all(_holds(mesh, PREFIX + name, wanted) for name, wanted in _bedding(shape))
    )


def _bedding(shape):
    """(name, values or None) of each attribute of the bedding of a PolygonMesh."""
    return [(name, None if shape.bedding is None else getattr(shape.bedding, name)) for name in BEDDING]


def _holds(mesh, name, wanted):
    if wanted is None or name not in mesh.attributes:
        return wanted is None and name not in mesh.attributes
    return np.array_equal(values(mesh, name, wanted.dtype), wanted)


def values(mesh, name, dtype):
    """The values of an attribute of numbers."""
    found = np.empty(len(mesh.attributes[name].data), dtype)
    mesh.attributes[name].data.foreach_get("value", found)
    return found


def _fill(mesh, shape):
    versions.fill_mesh(mesh, shape)
    for name, given in ((FACE_SURFACE, shape.face_surface), (FACE_COMPARTMENT, shape.face_compartment)):
        if given is not None and len(given):
            attribute = mesh.attributes.new(name, "INT", "FACE")
            attribute.data.foreach_set("value", given)
    for name, given in _bedding(shape):
        if given is not None and len(given):
            attribute = mesh.attributes.new(PREFIX + name, *BEDDING[name])
            attribute.data.foreach_set("value", given)


def mesh_coordinates(mesh):
    """(V, 3) float32 vertex coordinates of a mesh."""
    coordinates = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", coordinates)
    return coordinates.reshape(-1, 3)
