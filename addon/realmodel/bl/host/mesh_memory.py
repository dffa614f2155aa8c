# SPDX-License-Identifier: GPL-3.0-or-later
"""Direct access to the corners, polygons and edges of a mesh as arrays, in Blender 3.4 and 3.5.

In these two versions Python sets them number by number (`foreach_set`, 30 ns each): a mesh of two million
triangles takes 2.1 s, in which the window freezes, and 0.16 s here. Newer versions store them as attributes,
which are copied in one piece (0.27 s in 4.5). The records of 3.4 and 3.5 will not change anymore, so here the
memory at `as_pointer` is used as an array. A small mesh is tested once; where its memory is not as expected,
`foreach_set` is used.

The mesh must belong to `bpy.data` or be an evaluated mesh that still exists. An array is invalid after the
next change of the mesh. Only arrays of newly added elements may be written to.
"""

import ctypes
from functools import cache

import bpy
import numpy as np

_CORNER = np.dtype([("vertex", "<i4"), ("edge", "<i4")])
_POLYGON = np.dtype(
    [("start", "<i4"), ("count", "<i4"), ("unused", "<i2"), ("flag", "i1"), ("padding", "i1")]
)
_EDGE = np.dtype([("vertices", "<i4", 2), ("crease", "i1"), ("bevel", "i1"), ("flag", "<i2")])
SMOOTH = 1  # in a polygon's flag
DRAWN = 2 | 32  # in an edge's flag: in the viewport and in renders


def corners(mesh):
    """Records "vertex" and "edge", one for each corner."""
    return _records(mesh.loops, _CORNER)


def polygons(mesh):
    """Records "start", "count" and "flag", one for each polygon."""
    return _records(mesh.polygons, _POLYGON)


def edges(mesh):
    """Records "vertices" (2,) and "flag", one for each edge."""
    return _records(mesh.edges, _EDGE)


def _records(collection, dtype):
    if not len(collection):
        return np.empty(0, dtype)
    memory = (ctypes.c_char * (len(collection) * dtype.itemsize)).from_address(collection[0].as_pointer())
    return np.frombuffer(memory, dtype)


@cache
def is_known():
    """Whether this Blender stores meshes in the records of this module."""
    if bpy.app.version >= (3, 6, 0):
        return False
    mesh = bpy.data.meshes.new("realmodel")
    try:
        mesh.from_pydata([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [], [(0, 1, 2), (2, 3, 0)])
        mesh.polygons[1].use_smooth = True
        return all(
            _agrees(records, kind, collection, names)
            for records, kind, collection, names in (
                (corners(mesh), _CORNER, mesh.loops, {"vertex": "vertex_index", "edge": "edge_index"}),
                (polygons(mesh), _POLYGON, mesh.polygons, {"start": "loop_start", "count": "loop_total"}),
                (edges(mesh), _EDGE, mesh.edges, {"vertices": "vertices"}),
            )
        ) and (polygons(mesh)["flag"] & SMOOTH).tolist() == [0, SMOOTH]
    finally:
        bpy.data.meshes.remove(mesh)


def _agrees(records, kind, collection, names):
    """Whether records have the spacing and the values that Blender's own properties have. names: {field of a
    record: property}."""
    apart = collection[1].as_pointer() - collection[0].as_pointer()
    return apart == kind.itemsize and all(
        np.array_equal(records[field], np.array([getattr(element, name) for element in collection]))
        for field, name in names.items()
    )
