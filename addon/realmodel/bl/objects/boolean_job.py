# SPDX-License-Identifier: GPL-3.0-or-later
"""Booleans of two mesh objects: read on the main thread, intersected in another thread, and the main thread
updates the scene. In between only names are kept, no Blender data.

Both are intersected in world coordinates, in double precision. The result has the coordinates of the first
object, whose vertices stay in place to the last bit.
"""

from dataclasses import dataclass

import bpy
import numpy as np

from ...core import BuildFailed, InputRefused
from ...core.display.polygon_mesh import MeshParts, Operand, mesh_of_parts
from ...core.results.booleans import SURFACES, intersect_within
from ..host import versions
from ..host.thread_job import ThreadJob
from . import mesh_data, meshes, model_tree, placing, shapes

DIVIDE = "DIVIDE"
VOLUME = "realmodel_volume"  # on the object of a sub-block
OPERATIONS = (  # items of an enum
    ("UNION", "Union", "Join the selected solid to the active one"),
    ("INTERSECT", "Intersect", "Keep the part inside both solids"),
    ("DIFFERENCE", "Difference", "Subtract the selected solid from the active one"),
    (
        DIVIDE,
        "Divide",
        "Divide both objects, open or closed, along their intersection: into parts of their surfaces, the "
        "solids that these enclose with their volumes, and the loops where they meet",
    ),
)
_BOUNDARIES = {"UNION": "union", "INTERSECT": "intersection", "DIFFERENCE": "difference"}
_MOST_PARTS = 1000
_SHARE = 0.8  # of the progress that intersecting takes


@dataclass(eq=False)
class _Part:
    """An object to be made of a division."""

    name: str
    kind: str  # "sub_surface" or "sub_block"
    parts: MeshParts
    volume: float | None = None


@dataclass(eq=False)
class _Loop:
    name: str
    vertices: np.ndarray  # (N, 3) in the world
    is_closed: bool


class BooleanJob(ThreadJob):
    """A Boolean of two mesh objects of a scene.

    operation: one of OPERATIONS. keep: the objects stay as they are, and the result is a new one.
    """

    def __init__(self, scene, first, second, operation, depsgraph, keep=False):
        """Reads both objects. Raises InputRefused."""
        self._scene, self._names = scene.name, (first.name, second.name)
        self._operation, self._keep = operation, keep
        if operation != DIVIDE and not keep:
            _require_own(first)
        self._matrix = np.array(first.matrix_world, np.float64)
        read = [_read(obj, depsgraph) for obj in (first, second)]
        self._local = read[0][2]
        self._operands = tuple(entry[0] for entry in read)
        self._layers = tuple(entry[1] for entry in read)

    # -- in the thread

    def _work(self, job):
        try:
            surfaces = [(operand.vertices, operand.triangles) for operand in self._operands]
            intersection = intersect_within(job, *surfaces, _SHARE)
            with job.phase(_SHARE, 1.0, "copying materials and attributes"):
                if self._operation == DIVIDE:
                    return self._divided(intersection, job)
                return self._solid(intersection)
        except InputRefused as error:
            if error.item not in SURFACES:
                raise
            name = self._names[SURFACES.index(error.item)]
            raise InputRefused(
                error.what, item=name, advice=error.advice, triangles=error.triangles, place=error.place
            ) from error

    def _solid(self, intersection):
        rows, is_turned = intersection.boundary(_BOUNDARIES[self._operation])
        if not len(rows):
            raise InputRefused(
                f"nothing is left: {self._nothing()}", advice="move the objects, or choose another operation"
            )
        return self._mesh(intersection, rows, is_turned)

    def _nothing(self):
        first, second = self._names
        if self._operation == "INTERSECT":
            return f"{first} and {second} have no volume in common"
        return f"{first} lies inside of {second}"

    def _mesh(self, intersection, rows, is_turned):
        mirror = np.linalg.det(self._matrix[:3, :3]) < 0
        return mesh_of_parts(intersection, rows, is_turned, self._operands, mirror)

    def _divided(self, intersection, job):
        count = len(intersection.sub_surfaces) + len(intersection.sub_blocks) + len(intersection.loops)
        if count > _MOST_PARTS:
            raise InputRefused(
                f"the objects divide one another into {count} parts, and {_MOST_PARTS} objects are the most",
                advice="use simpler meshes",
            )
        made = []
        for number, part in enumerate(intersection.sub_surfaces):
            name = self._surface_name(intersection, part)
            made.append(
                _Part(name, "sub_surface", self._mesh(intersection, part.triangles, _none(part.triangles)))
            )
            job.step(number / count)
        for number, block in enumerate(intersection.sub_blocks):
            parts = self._mesh(intersection, *intersection.rows_of(number))
            made.append(_Part(self._block_name(intersection, block), "sub_block", parts, block.volume))
            job.step(len(made) / count)
        for loop in intersection.loops:
            name = f"Loop, {loop.kind.replace('_', ' ').title()}"
            rows, is_closed = loop.vertices, loop.kind == "hard_closed"
            if not is_closed and rows[0] == rows[-1]:
                rows, is_closed = rows[:-1], True
            made.append(_Loop(name, intersection.vertices[rows], is_closed))
        return made

    def _surface_name(self, intersection, part):
        name, other = self._names[part.source], self._names[1 - part.source]
        if not intersection.is_closed[1 - part.source]:
            return f"Part of {name}"
        below, above = intersection.sides(part, 1 - part.source)
        where = "on" if below != above else "inside" if below else "outside"
        return f"{name} {where} {other}"

    def _block_name(self, intersection, block):
        first, second = self._names
        if block.in_a and block.in_b:
            return f"{first} and {second}"
        if not (block.in_a or block.in_b):
            return f"Enclosed by {first} and {second}"
        name, other = (first, second) if block.in_a else (second, first)
        return f"{name} without {other}" if all(intersection.is_closed) else f"Part of {name}"

    # -- in the main thread

    def _put(self, made):
        scene = bpy.data.scenes.get(self._scene)
        items = [None if scene is None else scene.objects.get(name) for name in self._names]
        for name, obj in zip(self._names, items, strict=True):
            if obj is None or obj.type != "MESH":
                raise BuildFailed(f"object '{name}' is gone; nothing was changed")
            if obj.mode != "OBJECT":
                raise BuildFailed(f"object '{name}' is being edited; nothing was changed")
        if self._operation == DIVIDE:
            return self._put_divided(scene, made, *items)
        return self._put_solid(made, *items)

    def _put_solid(self, parts, first, second):
        template = _template(first)
        try:
            mesh, left_out = self._new_mesh(template, parts)
        finally:
            bpy.data.meshes.remove(template)
        if self._keep:
            mesh.name = f"{first.name} {self._operation.title()}"
            target = bpy.data.objects.new(mesh.name, mesh)
            placing.stand_at(target, first)
            for collection in first.users_collection:
                collection.objects.link(target)
        else:
            target = first
            _replace_mesh(first, mesh)
            placing.hide(second)
        mesh_data.write_groups(target, parts, self._layers)
        placing.select([target])
        return target, left_out

    def _put_divided(self, scene, made, first, second):
        where = first.users_collection[0] if first.users_collection else scene.collection
        top = bpy.data.collections.new(f"{first.name} divided by {second.name}")
        where.children.link(top)
        kinds = {}
        left_out = []
        for kind, name in (("sub_surface", "Sub-Surfaces"), ("sub_block", "Sub-Blocks"), ("loop", "Loops")):
            kinds[kind] = bpy.data.collections.new(name)
            top.children.link(kinds[kind])
        templates = [_template(obj) for obj in (first, second)]
        for entry in made:
            if isinstance(entry, _Loop):
                kind, mesh = "loop", _loop_mesh(entry, self._matrix)
            else:
                kind = entry.kind
                template = templates[0 if len(entry.parts.sources[0].polygons) else 1]
                mesh, lost = self._new_mesh(template, entry.parts)
                mesh.name = entry.name
                left_out += [name for name in lost if name not in left_out]
            obj = bpy.data.objects.new(entry.name, mesh)
            obj[model_tree.TAG] = kind
            placing.stand_at(obj, first)
            kinds[kind].objects.link(obj)
            if kind != "loop":
                mesh_data.write_groups(obj, entry.parts, self._layers)
            if kind == "sub_block":
                obj[VOLUME] = entry.volume
        for template in templates:
            bpy.data.meshes.remove(template)
        for collection in kinds.values():
            if not len(collection.objects):
                bpy.data.collections.remove(collection)
        if not self._keep:
            for obj in (first, second):
                placing.hide(obj)
        placing.select(top.all_objects)
        return top, left_out

    def _new_mesh(self, template, parts):
        mesh = template.copy()
        try:
            meshes.refill(mesh, parts.shape(self._coordinates(parts)))
            return mesh, mesh_data.write(mesh, parts, self._layers)
        except BaseException:
            bpy.data.meshes.remove(mesh)
            raise

    def _coordinates(self, parts):
        """(V, 3) float32 in the coordinates of the first object; its own vertices are copied, not
        recomputed."""
        coordinates = _to_local(parts.vertices, self._matrix)
        source = parts.sources[0]
        is_vertex = source.vertex_weights.max(axis=1) == 1.0
        nearest = source.vertex_of[is_vertex, source.vertex_weights[is_vertex].argmax(axis=1)]
        coordinates[source.vertices[is_vertex]] = self._local[nearest]
        return coordinates


def _template(obj):
    """A mesh without contents that has the settings of an object's mesh."""
    mesh = obj.data.copy()
    if mesh.shape_keys is not None:  # only an object can take them away
        holder = bpy.data.objects.new("", mesh)
        holder.shape_key_clear()
        bpy.data.objects.remove(holder)
    mesh.clear_geometry()
    mesh.materials.clear()
    return mesh


def _replace_mesh(obj, mesh):
    """An object has another mesh. It has the result of the modifiers, so these go."""
    old, name = obj.data, obj.data.name
    slots = [(slot.link, slot.material) for slot in obj.material_slots]
    obj.data = mesh
    obj.modifiers.clear()
    for slot, (link, material) in zip(obj.material_slots, slots, strict=False):
        if link == "OBJECT":
            slot.link, slot.material = link, material
    if not old.users and old.library is None:
        bpy.data.meshes.remove(old)
        mesh.name = name


def _none(rows):
    return np.zeros(len(rows), bool)


def _read(obj, depsgraph):
    """Reads an object: its Operand, mesh_data.Layers, and local coordinates (V, 3) float32."""
    matrix = np.array(obj.matrix_world, np.float64)
    determinant = np.linalg.det(matrix[:3, :3])
    if determinant == 0 or not np.isfinite(determinant):
        raise InputRefused("its scale is zero along an axis", item=obj.name, advice="give it another scale")
    with shapes.evaluated_mesh(obj, depsgraph, all_layers=True) as mesh:
        if not len(mesh.polygons):
            raise InputRefused("it has no faces", item=obj.name, advice="choose another object")
        local = meshes.mesh_coordinates(mesh)
        starts = versions.polygon_starts(mesh)
        mesh.calc_loop_triangles()
        corners = np.empty(3 * len(mesh.loop_triangles), np.int32)
        mesh.loop_triangles.foreach_get("loops", corners)
        corner_edges = np.empty(len(mesh.loops), np.int32)
        mesh.loops.foreach_get("edge_index", corner_edges)
        operand = Operand(
            vertices=local.astype(np.float64) @ matrix[:3, :3].T + matrix[:3, 3],
            offsets=np.append(starts, len(mesh.loops)).astype(np.int64),
            corner_vertices=versions.corner_vertices(mesh),
            corner_edges=corner_edges,
            triangle_corners=corners.reshape(-1, 3),
            triangle_polygons=shapes.triangle_polygons(mesh),
            is_mirrored=bool(determinant < 0),
        )
        return operand, mesh_data.read(mesh, obj), local


def _to_local(places, matrix):
    inverse = np.linalg.inv(matrix)
    return (places @ inverse[:3, :3].T + inverse[:3, 3]).astype(np.float32)


def _loop_mesh(loop, matrix):
    places = _to_local(loop.vertices, matrix)
    ends = np.arange(len(places), dtype=np.int32)
    edges = np.stack([ends, np.roll(ends, -1)], axis=1)
    edges = edges if loop.is_closed else edges[:-1]
    return meshes.line_mesh(loop.name, places, edges)


def _require_own(obj):
    """Refuses an object of a model, whose mesh the next build would replace. Raises InputRefused."""
    if obj.get(model_tree.TAG) in model_tree.OBJECT_KINDS:
        raise InputRefused(
            "it is an object of the model, which a build makes anew",
            item=obj.name,
            advice="choose Keep Operands, so that the result is an object of its own",
        )
