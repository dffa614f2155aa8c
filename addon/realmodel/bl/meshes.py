# SPDX-License-Identifier: GPL-3.0-or-later
"""Arrays to Blender meshes and back."""

import bpy
import numpy as np

from . import versions

# Face attribute: global index of the surface a face lies on; -1 a vertical wall, -2 the flat base
FACE_SURFACE = "realmodel_surface"

_corners = {}  # by the name of a mesh: the corners that it was given last, where asking Blender takes long


def new_mesh(name, coordinates, offsets, corners, face_surface=None):
    """A new mesh datablock.

    coordinates: (V, 3) float32, offsets from the model origin.
    offsets, corners: (F+1,) and (sum,) integers, polygons as in the cell complex.
    face_surface: (F,) int32 or None, stored as the face attribute `realmodel_surface`.

    Returns bpy.types.Mesh. float32 and int32 go to Blender without conversion, a million quads
    in about 0.4 s, of which the edges are half.
    """
    mesh = bpy.data.meshes.new(name)
    try:
        _fill(mesh, coordinates, offsets, corners, face_surface)
    except BaseException:
        bpy.data.meshes.remove(mesh)
        raise
    return mesh


def triangle_mesh(name, coordinates, triangles):
    """A new mesh datablock of triangles; (V, 3) float32, (T, 3) integers.

    Triangles that repeat a corner are left out: they have no area, the model leaves them out too,
    and Blender's edge tables take harm from them.
    """
    triangles = without_repeated_corners(triangles)
    return new_mesh(name, coordinates, np.arange(0, 3 * len(triangles) + 1, 3), triangles.ravel())


def surface_mesh(name, coordinates, triangles):
    """A new mesh datablock of a surface: `triangle_mesh`, shaded smooth."""
    mesh = triangle_mesh(name, coordinates, triangles)
    versions.shade_smooth(mesh)
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


def refill(mesh, coordinates, offsets, corners, face_surface=None):
    """Gives a mesh other vertices and polygons in the place of those that it has; its materials stay.

    The arrays are those of `new_mesh`. The datablock stays the same, so nothing that points to it has to
    know.
    """
    mesh.clear_geometry()
    _fill(mesh, coordinates, offsets, corners, face_surface)


def holds(mesh, coordinates, corners):
    """Whether a mesh has these vertices and corners of polygons already: to look is a third of the work of
    filling it."""
    if len(mesh.vertices) != len(coordinates) or len(mesh.loops) != len(corners):
        return False
    if not np.array_equal(mesh_coordinates(mesh), coordinates):
        return False
    found = _corners.get(mesh.name_full)
    if found is None or len(found) != len(mesh.loops):
        found = versions.corner_vertices(mesh)
    return np.array_equal(found, corners)


def forget():
    """What is known of meshes may no longer be so: Blender has undone something or opened a file."""
    _corners.clear()


def _fill(mesh, coordinates, offsets, corners, face_surface):
    corners = np.ascontiguousarray(corners, np.int32)
    versions.fill_mesh(
        mesh,
        np.ascontiguousarray(coordinates, np.float32),
        np.ascontiguousarray(offsets, np.int32),
        corners,
    )
    if versions.READS_CORNERS_SLOWLY:
        _corners[mesh.name_full] = corners
    if face_surface is not None:
        attribute = mesh.attributes.new(FACE_SURFACE, "INT", "FACE")
        attribute.data.foreach_set("value", np.ascontiguousarray(face_surface, np.int32))


def mesh_coordinates(mesh):
    """(V, 3) float32 vertex coordinates of a mesh."""
    coordinates = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", coordinates)
    return coordinates.reshape(-1, 3)
