# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects of the scene as input of a model: triangulations, points, outlines.

All coordinates are model coordinates: object coordinates in the world, plus the model origin. Modifiers and
geometry nodes count: the evaluated mesh is used, including an edit in progress in Edit Mode.
"""

import hashlib
from contextlib import contextmanager

import bpy
import numpy as np

from ...core import InputRefused
from ...core.base.algebra import begins_run
from ..host import versions
from . import exaggeration, meshes

_THIN = 0.01  # of the length of a stroke


@contextmanager
def evaluated_mesh(item, depsgraph, all_layers=False):
    """The mesh of an object as the viewport shows it, with its modifiers. all_layers: with its attributes, UV
    maps and vertex groups. Raises InputRefused where there is none: the object was deleted, and only settings
    point to it."""
    if item.mode == "EDIT":
        item.update_from_editmode()
    is_plain = item.type == "MESH" and not item.modifiers and item.data.shape_keys is None
    if is_plain and item.mode in ("EDIT", "OBJECT"):
        yield item.data  # there is nothing to evaluate
        return
    evaluated = item.evaluated_get(depsgraph)
    mesh = evaluated.to_mesh(preserve_all_data_layers=all_layers, depsgraph=depsgraph)
    if mesh is None:
        raise InputRefused(
            f"object '{item.name}' was deleted from the scene",
            advice="undo that, or choose another object",
        )
    try:
        yield mesh
    finally:
        evaluated.to_mesh_clear()


def offsets(item, mesh):
    """(V, 3) float64: a mesh's vertices in the world without vertical exaggeration and model origin."""
    coordinates = meshes.mesh_coordinates(mesh).astype(np.float64)
    matrix = exaggeration.true_matrix(item)
    if (matrix == np.eye(4)).all():
        return coordinates
    return coordinates @ matrix[:3, :3].T + matrix[:3, 3]


def mesh_triangles(mesh):
    """(T, 3) int32 triangles of a mesh."""
    if len(mesh.loops) == 3 * len(mesh.polygons):  # all are triangles: ten times as fast as Blender's way
        corners, starts = versions.corner_vertices(mesh), versions.polygon_starts(mesh)
        return corners[starts[:, None] + np.arange(3, dtype=np.int32)]
    mesh.calc_loop_triangles()
    corners = np.empty(3 * len(mesh.loop_triangles), np.int32)
    mesh.loop_triangles.foreach_get("vertices", corners)
    return corners.reshape(-1, 3)


def triangle_polygons(mesh):
    """(T,) int32: the polygon that each of `mesh_triangles` is of."""
    mesh.calc_loop_triangles()
    polygons = np.empty(len(mesh.loop_triangles), np.int32)
    mesh.loop_triangles.foreach_get("polygon_index", polygons)
    return polygons


def require_open(item):
    """Refuses an object whose mesh is closed: it has two heights at each position. Raises InputRefused."""
    mesh = item.data
    used = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("edge_index", used)
    if len(used) and (np.bincount(used, minlength=len(mesh.edges)) == 2).all():
        raise InputRefused(
            f"{item.name} is a closed solid; RealModel takes open sheets, such as a grid",
            advice="choose a mesh with one elevation at each position",
        )


def triangulation(item, depsgraph):
    """(V, 3) float64 offsets from the origin and (T, 3) int32 triangles of a mesh object."""
    with evaluated_mesh(item, depsgraph) as mesh:
        return offsets(item, mesh), mesh_triangles(mesh)


def points(item, depsgraph):
    """(P, 3) float64 offsets from the origin: the vertices of a mesh object."""
    with evaluated_mesh(item, depsgraph) as mesh:
        return offsets(item, mesh)


def digest(given, triangles):
    """The digest by which changes of a mesh are detected: of its offsets, rounded to float32 as in Blender,
    and its triangles."""
    hasher = hashlib.blake2b(digest_size=16)
    hasher.update(np.ascontiguousarray(given, np.float32).tobytes())
    hasher.update(np.ascontiguousarray(triangles, np.int32).tobytes())
    return hasher.hexdigest()


def with_full_digits(given, triangles, model_origin, stored_vertices, stored_triangles):
    """(V, 3) float64 model coordinates of a mesh that was made from stored ones: vertices that were not moved
    keep all the digits that they had before Blender rounded them; moved ones have their present
    coordinates."""
    moved = given + model_origin
    if stored_vertices is None or stored_vertices.shape != given.shape:
        return moved
    if not np.array_equal(meshes.without_repeated_corners(stored_triangles), triangles):
        return moved
    same = np.asarray(given, np.float32) == np.asarray(stored_vertices - model_origin, np.float32)
    return np.where(same, stored_vertices, moved)


def rings(item, depsgraph):
    """The outlines of a curve or mesh object seen from above, each (N, 2) float64 offsets from the origin.

    Of a mesh with faces the border, otherwise its edges; inner loops are holes (even-odd).
    Raises InputRefused where they do not close.
    """
    with evaluated_mesh(item, depsgraph) as mesh:
        plan = offsets(item, mesh)[:, :2]
        edges = _bounding_edges(mesh)
    where = f"region object '{item.name}'"
    if not len(edges):
        raise InputRefused(
            "it has no edges", item=where, advice="draw an outline, or choose a curve or a mesh that has one"
        )
    degree = np.bincount(edges.ravel(), minlength=len(plan))
    odd = np.flatnonzero((degree != 2) & (degree != 0))
    if len(odd):
        x, y = plan[odd[0]]
        what = "its outline is open" if degree[odd[0]] == 1 else "its outline touches or crosses itself"
        raise InputRefused(
            f"{what} near ({x:.6g}, {y:.6g})",
            item=where,
            advice="close the curve (Toggle Cyclic), or join the ends of the edges",
        )
    return [plan[chain[:-1]] for chain in _chains(edges, degree)]


def new_outline(scene, name, corners, z):
    """A closed curve object through corners (N, 2), at a height, in the coordinates of a scene."""
    curve = bpy.data.curves.new(name, "CURVE")
    curve.dimensions = "3D"
    spline = curve.splines.new("POLY")
    spline.points.add(len(corners) - 1)
    spline.points.foreach_set("co", np.array([(x, y, z, 1.0) for x, y in corners], np.float32).ravel())
    spline.use_cyclic_u = True
    obj = bpy.data.objects.new(name, curve)
    scene.collection.objects.link(obj)
    return obj


def plan_lines(item, depsgraph):
    """The edges of a curve or mesh object seen from above, each a line (2, 2), and its loose vertices, each a
    point (1, 2), as float64 offsets from the origin. Raises InputRefused where it has neither."""
    with evaluated_mesh(item, depsgraph) as mesh:
        plan = offsets(item, mesh)[:, :2]
        edges = versions.edge_vertices(mesh)
    loose = np.setdiff1d(np.arange(len(plan)), edges)
    segments = [line for line in plan[edges] if (line[0] != line[1]).any()]
    segments += list(plan[loose][:, None])
    if not segments:
        raise InputRefused(
            "it has no edges and no vertices", item=f"object '{item.name}'", advice="choose another object"
        )
    return segments


def polyline(item, depsgraph):
    """The one line of a curve or mesh object seen from above, (N, 2) float64 offsets from the origin, as it
    was drawn; a closed one ends where it begins. Raises InputRefused where it is no line."""
    all_lines, what = lines(item, depsgraph), f"object '{item.name}'"
    if len(all_lines) > 1:
        raise InputRefused("it is not one line", item=what, advice="leave one line without branches")
    line = all_lines[0][:, :2]
    line = line[begins_run(line)]
    if len(line) < 2:
        raise InputRefused("seen from above it is a point", item=what, advice="draw a line")
    return line


def strokes(item):
    """The strokes of a grease pencil object, each (N, 3) float64 offsets from the origin. A hand draws points
    by the hundred: those nearer to the one before than a hundredth of the stroke's length are left out, but
    for its ends. Raises InputRefused where there are none."""
    matrix = exaggeration.true_matrix(item)
    stroke_lines = [thinned(line @ matrix[:3, :3].T + matrix[:3, 3]) for line in versions.strokes(item)]
    if not stroke_lines:
        advice = "draw on a layer that is shown, at the present frame"
        raise InputRefused("it has no strokes", item=f"object '{item.name}'", advice=advice)
    return stroke_lines


def thinned(line):
    """A line (N, 3) without points that are nearer to the one before than a hundredth of its length."""
    steps = np.linalg.norm(np.diff(line, axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    indices = [0]
    for number in range(1, len(line) - 1):
        if along[number] - along[indices[-1]] >= _THIN * along[-1]:
            indices.append(number)
    if len(line) > 1 and along[-1] > 0.0:
        if len(indices) > 1 and along[-1] - along[indices[-1]] < _THIN * along[-1]:
            indices.pop()
        indices.append(len(line) - 1)
    return line[indices]


def lines(item, depsgraph):
    """The lines of a curve, mesh or grease pencil object, each (N, 3) float64 offsets from the origin, as
    they were drawn; closed ones end where they begin. Raises InputRefused where there are none, or they have
    branches."""
    if item.type in versions.GREASE_PENCIL:
        return strokes(item)
    with evaluated_mesh(item, depsgraph) as mesh:
        places = offsets(item, mesh)
        edges = versions.edge_vertices(mesh)
    degree = np.bincount(edges.ravel(), minlength=len(places))
    what = f"object '{item.name}'"
    if not len(edges):
        raise InputRefused(
            "it has no edges", item=what, advice="draw a line, such as a curve seen from above"
        )
    if (degree > 2).any():
        raise InputRefused("it is not one line", item=what, advice="leave one line without branches")
    return [places[chain] for chain in _chains(edges, degree)]


def _chains(edges, degree):
    """The vertex numbers of each line of edges without branches, open ones first; closed ones end where they
    begin. degree: (V,), how many edges are at each vertex."""
    onward = [[] for _ in degree]
    for a, b in edges.tolist():
        onward[a].append(b)
        onward[b].append(a)
    left, chains = degree > 0, []
    for start in [*np.flatnonzero(degree == 1).tolist(), *np.flatnonzero(degree == 2).tolist()]:
        if not left[start]:
            continue
        chain, before = [start], -1
        while (following := next((k for k in onward[chain[-1]] if k != before), None)) is not None:
            before = chain[-1]
            chain.append(following)
            if following == start:
                break
        left[chain] = False
        chains.append(chain)
    return chains


def has_edges(item, depsgraph):
    """Whether there is an edge in a curve or mesh object."""
    with evaluated_mesh(item, depsgraph) as mesh:
        return len(mesh.edges) > 0


def _bounding_edges(mesh):
    """(E, 2) the edges that only one face uses; all edges of a mesh that has no faces."""
    edges = versions.edge_vertices(mesh)
    if not len(mesh.polygons):
        return edges
    used = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("edge_index", used)
    return edges[np.bincount(used, minlength=len(edges)) == 1]
