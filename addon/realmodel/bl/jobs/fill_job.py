# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh object eroded or filled with strata: its shape read on the main thread, the work done in another
thread, and what comes of it put into the scene. In between only names are kept, no Blender data.

Beds are laid in the world, without vertical exaggeration, and stay with the object where it is moved. Their
objects stand where the filled one stands and have its coordinates, of which those of its vertices stay the
same to the last bit.
"""

import bpy
import numpy as np

from ...core import BuildFailed, InputRefused, filling
from ...core.base.triangles import without_flat
from ...core.display import polygon_mesh
from ...core.filling.scree import REPOSE
from ..host.thread_job import ThreadJob
from ..objects import exaggeration, filled_beds, meshes, placing
from ..objects.boolean_job import VOLUME
from ..objects.filled_beds import BED, named
from ..shading import rock_layers, strata_modifier, strata_values

_EROSION, _SHARE = 0.3, 0.9  # of the progress: where erosion and where filling end
_COARSER = 3  # times as few faces on an area of scree as on the rock


class _StrataJob(ThreadJob):
    """What erosion and filling share. warnings: of what was left out, once it is done."""

    warnings: tuple[str, ...] | list[str] = ()

    def __init__(self, scene, item):
        """item: the object, with its modifier Strata."""
        self._scene, self._name = scene.name, item.name
        values = item.realmodel_strata
        beds, matrix = strata_modifier.beds_of(item)
        self._shape = strata_modifier.base_shape(item, matrix)
        self._beds, self._closing = beds, (values.base_depth, values.close_holes)
        self._strata = strata_values.strata_of(values, beds.high - beds.low)
        self._erosion = strata_values.erosion_of(values)
        self._has_masks, self._scree = values.masks, values.scree

    def _close(self):
        """Sets the mesh that is filled, and beds that reach through it. Raises InputRefused."""
        self._mesh = self._shape.closed(*self._closing)
        self._beds = self._beds.reaching(self._mesh[0])
        self._unit = filling.mean_thickness(self._beds, self._mesh[0])

    def _eroded(self, job):
        kept = filling.kept_of(*self._mesh, len(self._shape.triangles))
        with named(self._name):
            return filling.eroded_within(job, self._mesh, kept, self._beds, self._strata, self._erosion)

    def _heaped(self, job, mesh):
        """The scree of a mesh in the coordinates of the object: vertices, triangles, how far down vertices
        are, and what strata_modifier.set_rubble takes. None where there is none."""
        if not self._scree:
            return None
        faces = (len(mesh[1]) if self._erosion is None else self._erosion.faces) // _COARSER
        try:
            vertices, triangles, down = filling.scree_within(
                job, mesh, self._scree, REPOSE, self._strata.seed, max(faces, 1000)
            )
        except InputRefused as error:
            self.warnings = [*self.warnings, f"no scree: {error.what}"]
            return None
        scale = placing.mean_scale(self._shape.matrix)
        _, rocks = filling.rocks_of_beds(self._beds.count, self._strata.palette, self._strata.seed)
        pieces = [
            (rocks[bed] - 1, (places / scale, of))
            for bed, (places, of) in filling.rubble_within(job, self._beds, self._strata, self._unit)
        ]
        return *self._local((vertices, triangles)), down, pieces, self._unit / scale

    def _joints(self, places):
        """(V,) float32 how near places in the world are to a joint, from 0 to 1."""
        return filling.joints_at(places, self._beds, self._strata, self._unit)

    def _local(self, mesh):
        """A mesh in the coordinates of the object, with its faces outward there."""
        local = self._shape.to_local(mesh[0]).astype(np.float32)
        triangles = without_flat(local.astype(np.float64), mesh[1])
        return local, triangles[:, ::-1] if self._shape.is_mirrored else triangles

    def _object(self):
        scene = bpy.data.scenes.get(self._scene)
        obj = None if scene is None else scene.objects.get(self._name)
        if obj is None or obj.type != "MESH" or strata_modifier.beds_of(obj) is None:
            raise BuildFailed(f"object '{self._name}' is gone; nothing was changed")
        return obj


class ErosionJob(_StrataJob):
    """Shows the eroded mesh of an object in its modifier. `run` and `finish` return how many faces it has.
    BYTES: of memory for a face, about."""

    BYTES = 700

    def _work(self, job):
        self._close()
        with job.part(0.0, _SHARE):
            eroded = self._eroded(job)
        with job.part(_SHARE, 1.0):
            heap = self._heaped(job, eroded)
        vertices, triangles = filling.divided_at_beds(*eroded, self._beds)
        return self._local((vertices, triangles)), self._joints(vertices), heap

    def _put(self, made):
        obj = self._object()
        (vertices, triangles), joints, heap = made
        count, down = len(triangles), np.zeros(len(vertices))
        if heap is not None:
            of_scree, others, down_scree, *rubble = heap
            triangles = np.concatenate([triangles, others + len(vertices)])
            vertices, down = np.concatenate([vertices, of_scree]), np.append(down, down_scree)
            strata_modifier.set_rubble(obj, *rubble)
        mesh = meshes.triangle_mesh(f"{obj.name} Eroded", vertices, triangles)
        joints = np.append(joints, np.zeros(len(vertices) - len(joints), np.float32))
        mesh.attributes.new(rock_layers.JOINTS, "FLOAT", "POINT").data.foreach_set("value", joints)
        strata_modifier.mark_scree(mesh, np.arange(len(triangles)) >= count, down)
        strata_modifier.show_eroded(obj, mesh)
        return len(triangles)


class FillJob(_StrataJob):
    """Fills an object with its strata. `run` and `finish` return the collection of the beds, which replace
    earlier ones of the object."""

    def __init__(self, scene, item):
        super().__init__(scene, item)
        self._matrix = exaggeration.true_matrix(item)
        self._surface = rock_layers.surface_of(item)

    def _work(self, job):
        self._close()
        mesh, begin = self._mesh, 0.0
        if self._erosion is not None:
            begin = _EROSION
            with job.part(0.0, begin):
                mesh = self._eroded(job)
        with job.part(begin, _SHARE), named(self._name):
            model, places = filling.fill_within(job, mesh, self._beds, self._strata)
        with job.phase(_SHARE, 1.0, "making meshes"):
            local = self._shape.to_local(places)
            solids = polygon_mesh.of_blocks(model, np.zeros(3), self._threads, vertices=local)
            matrix = self._shape.matrix
            solids = [None if shape is None else filled_beds.exposed(shape, matrix) for shape in solids]
            beds = [shape for shape, of in zip(solids, model.blocks, strict=True) if shape and of.property]
            near = [self._joints(self._shape.to_world(shape.coordinates)) for shape in beds]
            layers = rock_layers.of_beds(beds, self._matrix, self._surface, near, self._threads)
            heap = self._heaped(job, mesh)
        return model, solids, layers, heap, self._beds.numbers(self._shape.vertices)

    # -- in the main thread

    def _put(self, made):
        model, solids, layers, heap, masks = made
        obj = self._object()
        collection = self._emptied(obj)
        self.warnings = [*self.warnings, *(warning.text for warning in model.warnings)]
        beds = [pair for pair in zip(model.blocks, solids, strict=True) if pair[0].property]  # without gaps
        digits = len(str(len(beds)))
        for number, (block, shape) in enumerate(beds, 1):
            if shape is None:
                continue
            name = f"{obj.name} Bed {number:0{digits}}"
            bed = bpy.data.objects.new(name, meshes.new_mesh(name, shape))
            rock = block.property - 1
            bed.data.materials.append(strata_modifier.material_of(obj, rock))
            bed[BED], bed[VOLUME] = number, block.volume
            placing.stand_at(bed, obj)
            collection.objects.link(bed)
        if heap is not None:
            name = f"{obj.name} Scree"
            vertices, triangles, down, *rubble = heap
            scree = bpy.data.objects.new(name, meshes.triangle_mesh(name, vertices, triangles))
            strata_modifier.set_rubble(obj, *rubble)
            strata_modifier.put_scree_on(scree, obj, down)
            placing.stand_at(scree, obj)
            collection.objects.link(scree)
        beds = list(collection.objects)
        if self._has_masks:
            self._add_masks(collection, obj, masks)
        slots = [s.material for s in obj.material_slots] if obj.realmodel_strata.keep_materials else []
        solid = [bed for bed in beds if BED in bed]
        rock_layers.finish(bpy.data.scenes[self._scene], solid, layers, slots)
        for bed in solid if self._shape.is_mirrored else ():
            bed.data.flip_normals()
        placing.hide(obj)
        placing.select(beds)
        return collection

    def _emptied(self, obj):
        """The collection of the object's beds, without those that were there."""
        collection = obj.realmodel_strata.beds_in
        scene = bpy.data.scenes[self._scene]
        if collection is None or collection not in scene.collection.children_recursive:
            where = obj.users_collection[0] if obj.users_collection else scene.collection
            collection = bpy.data.collections.new(f"{obj.name} Strata")
            where.children.link(collection)
            obj.realmodel_strata.beds_in = collection
        for bed in [item for item in collection.objects if strata_modifier.is_made(item)]:
            bpy.data.meshes.remove(bed.data)  # and its object with it
        return collection

    def _add_masks(self, collection, obj, numbers):
        """A hidden copy of the object whose vertices have the number of their bed, and a mask of each bed."""
        mesh = strata_modifier.base_mesh(obj)
        mesh.name = f"{obj.name} Bed Masks"
        stored = mesh.attributes.get(BED) or mesh.attributes.new(BED, "INT", "POINT")
        stored.data.foreach_set("value", numbers + 1)
        digits = len(str(self._strata.beds))
        for number in range(self._strata.beds):
            mask = mesh.attributes.new(f"Bed {number + 1:0{digits}}", "FLOAT", "POINT")
            mask.data.foreach_set("value", (numbers == number).astype(np.float32))
        copy = bpy.data.objects.new(mesh.name, mesh)
        placing.stand_at(copy, obj)
        collection.objects.link(copy)
        bpy.context.view_layer.update()  # or it would not know the copy
        placing.hide(copy)
