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
from ...core.display.mesh_parts import MeshParts, Operand, mesh_of_parts
from ...core.results.booleans import SURFACES, intersect_within
from ..host import versions
from ..host.thread_job import ThreadJob
from . import mesh_data, meshes, model_tree, placing, shapes

DIVIDE = "DIVIDE"
VOLUME = "realmodel_volume"  # on the object of a sub-block
OPERATIONS = (  # items of an enum
    ("UNION", "Union", "Join the selected solid to the active one"),
    ("INTERSECT", "Intersect", "Keep what is inside of both solids"),
    ("DIFFERENCE", "Difference", "Take the selected solid from the active one"),
    (
        DIVIDE,
        "Divide",
        "Divide both objects, open or closed, along one another: into parts of their surfaces, the solids "
        "that these enclose with their volumes, and the loops in which they meet",
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
        read = [_read(item, depsgraph) for item in (first, second)]
        self._local = read[0][2]
        self._operands = tuple(entry[0] for entry in read)
        self._layers = tuple(entry[1] for entry in read)

    # -- in the thread

    def _work(self, job):
        try:
            surfaces = [(operand.vertices, operand.triangles) for operand in self._operands]
            found = intersect_within(job, *surfaces, _SHARE)
            with job.phase(_SHARE, 1.0, "taking over materials and attributes"):
                if self._operation == DIVIDE:
                    return self._divided(found, job)
                return self._solid(found)
        except InputRefused as error:
            if error.item not in SURFACES:
                raise
            name = self._names[SURFACES.index(error.item)]
            raise InputRefused(
                error.what, item=name, advice=error.advice, triangles=error.triangles, place=error.place
            ) from error

    def _solid(self, found):
        rows, is_turned = found.boundary(_BOUNDARIES[self._operation])
        if not len(rows):
            raise InputRefused(
                f"nothing is left: {self._nothing()}", advice="move the objects, or choose another operation"
            )
        return self._mesh(found, rows, is_turned)

    def _nothing(self):
        first, second = self._names
        if self._operation == "INTERSECT":
            return f"{first} and {second} have no volume in common"
        return f"{first} lies inside of {second}"

    def _mesh(self, found, rows, is_turned):
        mirror = np.linalg.det(self._matrix[:3, :3]) < 0
        return mesh_of_parts(found, rows, is_turned, self._operands, mirror)

    def _divided(self, found, job):
        count = len(found.sub_surfaces) + len(found.sub_blocks) + len(found.loops)
        if count > _MOST_PARTS:
            raise InputRefused(
                f"the objects divide one another into {count} parts, and {_MOST_PARTS} objects are the most",
                advice="use simpler meshes",
            )
        made = []
        for number, part in enumerate(found.sub_surfaces):
            name = self._surface_name(found, part)
            made.append(_Part(name, "sub_surface", self._mesh(found, part.triangles, _none(part.triangles))))
            job.step(number / count)
        for number, block in enumerate(found.sub_blocks):
            parts = self._mesh(found, *found.rows_of(number))
            made.append(_Part(self._block_name(found, block), "sub_block", parts, block.volume))
            job.step(len(made) / count)
        for loop in found.loops:
            name = f"Loop, {loop.kind.replace('_', ' ').title()}"
            rows, is_closed = loop.vertices, loop.kind == "hard_closed"
            if not is_closed and rows[0] == rows[-1]:
                rows, is_closed = rows[:-1], True
            made.append(_Loop(name, found.vertices[rows], is_closed))
        return made

    def _surface_name(self, found, part):
        own, other = self._names[part.source], self._names[1 - part.source]
        if not found.is_closed[1 - part.source]:
            return f"Part of {own}"
        below, above = found.sides(part, 1 - part.source)
        where = "on" if below != above else "inside" if below else "outside"
        return f"{own} {where} {other}"

    def _block_name(self, found, block):
        first, second = self._names
        if block.in_a and block.in_b:
            return f"{first} and {second}"
        if not (block.in_a or block.in_b):
            return f"Enclosed by {first} and {second}"
        own, other = (first, second) if block.in_a else (second, first)
        return f"{own} without {other}" if all(found.is_closed) else f"Part of {own}"

    # -- in the main thread

    def _put(self, made):
        scene = bpy.data.scenes.get(self._scene)
        items = [None if scene is None else scene.objects.get(name) for name in self._names]
        for name, item in zip(self._names, items, strict=True):
            if item is None or item.type != "MESH":
                raise BuildFailed(f"object '{name}' is gone; nothing was changed")
            if item.mode != "OBJECT":
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
        templates = [_template(item) for item in (first, second)]
        for entry in made:
            if isinstance(entry, _Loop):
                kind, mesh = "loop", _loop_mesh(entry, self._matrix)
            else:
                kind = entry.kind
                template = templates[0 if len(entry.parts.sources[0].polygons) else 1]
                mesh, lost = self._new_mesh(template, entry.parts)
                mesh.name = entry.name
                left_out += [name for name in lost if name not in left_out]
            item = bpy.data.objects.new(entry.name, mesh)
            item[model_tree.TAG] = kind
            placing.stand_at(item, first)
            kinds[kind].objects.link(item)
            if kind != "loop":
                mesh_data.write_groups(item, entry.parts, self._layers)
            if kind == "sub_block":
                item[VOLUME] = entry.volume
        for template in templates:
            bpy.data.meshes.remove(template)
        for collection in kinds.values():
            if not len(collection.objects):
                bpy.data.collections.remove(collection)
        if not self._keep:
            for item in (first, second):
                placing.hide(item)
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
        found = _to_local(parts.vertices, self._matrix)
        own = parts.sources[0]
        there = own.vertex_weights.max(axis=1) == 1.0
        nearest = own.vertex_of[there, own.vertex_weights[there].argmax(axis=1)]
        found[own.vertices[there]] = self._local[nearest]
        return found


def _template(item):
    """A mesh without contents that has the settings of an object's mesh."""
    mesh = item.data.copy()
    if mesh.shape_keys is not None:  # only an object can take them away
        holder = bpy.data.objects.new("", mesh)
        holder.shape_key_clear()
        bpy.data.objects.remove(holder)
    mesh.clear_geometry()
    mesh.materials.clear()
    return mesh


def _replace_mesh(item, mesh):
    """An object has another mesh. It has the result of the modifiers, so these go."""
    old, name = item.data, item.data.name
    slots = [(slot.link, slot.material) for slot in item.material_slots]
    item.data = mesh
    item.modifiers.clear()
    for slot, (link, material) in zip(item.material_slots, slots, strict=False):
        if link == "OBJECT":
            slot.link, slot.material = link, material
    if not old.users and old.library is None:
        bpy.data.meshes.remove(old)
        mesh.name = name


def _none(rows):
    return np.zeros(len(rows), bool)


def _read(item, depsgraph):
    """Reads an object: its Operand, mesh_data.Layers, and local coordinates (V, 3) float32."""
    matrix = np.array(item.matrix_world, np.float64)
    determinant = np.linalg.det(matrix[:3, :3])
    if determinant == 0 or not np.isfinite(determinant):
        raise InputRefused("its scale is zero along an axis", item=item.name, advice="give it another scale")
    with shapes.evaluated_mesh(item, depsgraph, all_layers=True) as mesh:
        if not len(mesh.polygons):
            raise InputRefused("it has no faces", item=item.name, advice="choose another object")
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
        return operand, mesh_data.read(mesh, item), local


def _to_local(places, matrix):
    inverse = np.linalg.inv(matrix)
    return (places @ inverse[:3, :3].T + inverse[:3, 3]).astype(np.float32)


def _loop_mesh(loop, matrix):
    places = _to_local(loop.vertices, matrix)
    ends = np.arange(len(places), dtype=np.int32)
    edges = np.stack([ends, np.roll(ends, -1)], axis=1)
    edges = edges if loop.is_closed else edges[:-1]
    return meshes.line_mesh(loop.name, places, edges)


def _require_own(item):
    """Refuses an object of a model, whose mesh the next build would replace. Raises InputRefused."""
    if item.get(model_tree.TAG) in model_tree.OBJECT_KINDS:
        raise InputRefused(
            "it is an object of the model, which a build makes anew",
            item=item.name,
            advice="choose Keep Operands, so that the result is an object of its own",
        )
