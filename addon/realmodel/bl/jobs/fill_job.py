# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh object filled with strata: its shape read on the main thread, filled in another thread, and beds as
objects of the scene. In between only names are kept, no Blender data.

Beds are laid in the world, without vertical exaggeration. Their objects stand where the filled one stands and
have its coordinates, of which those of its vertices stay the same to the last bit.
"""

from dataclasses import dataclass, field

import bpy
import numpy as np

from ...core import BuildFailed, InputRefused
from ...core.base.triangles import welded
from ...core.display import polygon_mesh
from ...core.filling import ITEM, closed_mesh, fill_within, lay_beds
from ...core.project.looks import look_of
from ..host.thread_job import ThreadJob
from ..objects import exaggeration, filled_beds, materials, meshes, placing, shapes
from ..objects.boolean_job import VOLUME
from ..objects.filled_beds import BED
from ..shading import looks, rock_layers

_SHARE = 0.9  # of the progress that filling takes


@dataclass(eq=False)
class FilledShape:
    """The shape of an object that is to be filled.

    local: (V, 3) float32, in its own coordinates; matrix: (4, 4) from there to the world; vertices: (V, 3)
    float64 in the world; triangles: (T, 3).
    """

    name: str
    local: np.ndarray
    matrix: np.ndarray
    vertices: np.ndarray
    triangles: np.ndarray
    _closed: dict = field(default_factory=dict)

    @classmethod
    def of(cls, item, depsgraph):
        """Reads an object. Raises InputRefused."""
        matrix = exaggeration.true_matrix(item)
        determinant = np.linalg.det(matrix[:3, :3])
        if determinant == 0 or not np.isfinite(determinant):
            raise InputRefused(
                "its scale is zero along an axis", item=item.name, advice="give it another scale"
            )
        with shapes.evaluated_mesh(item, depsgraph) as mesh:
            if not len(mesh.polygons):
                raise InputRefused("it has no faces", item=item.name, advice="choose another object")
            local = meshes.mesh_coordinates(mesh)
            offsets = shapes.offsets(item, mesh)
            return cls(item.name, local, matrix, offsets, shapes.mesh_triangles(mesh))

    @property
    def is_mirrored(self):
        """Whether faces that face outward in the world face inward in the object's coordinates."""
        return bool(np.linalg.det(self.matrix[:3, :3]) < 0)

    def closed(self, depth):
        """Vertices in the world and triangles of what is filled. depth: of the base of an open mesh beneath
        its lowest point, as a share of its height, or of a tenth of its width where that is more. Raises
        InputRefused."""
        if depth not in self._closed:
            low, high = self.vertices.min(axis=0), self.vertices.max(axis=0)
            size = high - low
            base = low[2] - depth * max(size[2], 0.1 * size[:2].max())
            with named(self.name):
                self._closed = {depth: closed_mesh(self.vertices, self.triangles, float(base))}
        return self._closed[depth]

    def to_local(self, places):
        """(N, 3) float64: places in the world in the coordinates of the object, without any change of its own
        vertices."""
        inverse = np.linalg.inv(self.matrix)
        local = places @ inverse[:3, :3].T + inverse[:3, 3]
        same = welded(np.concatenate([self.vertices, places]))[len(self.vertices) :]
        is_vertex = same < len(self.vertices)
        local[is_vertex] = self.local[same[is_vertex]]
        return local


class named:
    """Within it refusals of the mesh name the object."""

    def __init__(self, name):
        self._name = name

    def __enter__(self):
        return self

    def __exit__(self, _kind, error, _trace):
        if isinstance(error, InputRefused) and error.item in (ITEM, None):
            raise InputRefused(
                error.what, item=self._name, advice=error.advice, triangles=error.triangles, place=error.place
            ) from error


class FillJob(ThreadJob):
    """Fills a shape with strata. `run` and `finish` return the collection of the beds.

    shape: FilledShape. strata: core.Strata. depth: as of FilledShape.closed. has_looks: the rocks get looks,
    otherwise their colors alone. has_masks: a copy of the object gets a mask of each bed. warnings: of what
    was left out, once it is done.
    """

    warnings = ()

    def __init__(self, scene, shape, strata, depth, has_looks=True, has_masks=False):
        """Raises InputRefused for a shape that cannot be closed."""
        self._scene, self._shape, self._strata = scene.name, shape, strata
        self._mesh = shape.closed(depth)
        self._has_looks, self._has_masks = has_looks, has_masks

    def _work(self, job):
        with job.part(0.0, _SHARE), named(self._shape.name):
            beds = lay_beds(self._strata, self._mesh[0])
            model, places = fill_within(job, self._mesh, beds, self._strata)
        with job.phase(_SHARE, 1.0, "making meshes"):
            local = self._shape.to_local(places)
            solids = polygon_mesh.of_blocks(model, np.zeros(3), self._threads, vertices=local)
            solids = [
                None if shape is None else filled_beds.exposed(shape, self._shape.matrix) for shape in solids
            ]
        return model, solids, beds.numbers(self._shape.vertices)

    # -- in the main thread

    def _put(self, made):
        model, solids, masks = made
        scene = bpy.data.scenes.get(self._scene)
        obj = None if scene is None else scene.objects.get(self._shape.name)
        if obj is None or obj.type != "MESH":
            raise BuildFailed(f"object '{self._shape.name}' is gone; nothing was changed")
        where = obj.users_collection[0] if obj.users_collection else scene.collection
        collection = bpy.data.collections.new(f"{obj.name} Strata")
        where.children.link(collection)
        self.warnings = [warning.text for warning in model.warnings]
        rocks = {}
        beds = [pair for pair in zip(model.blocks, solids, strict=True) if pair[0].property]  # without gaps
        digits = len(str(len(beds)))
        for number, (block, shape) in enumerate(beds, 1):
            if shape is None:
                continue
            if block.property not in rocks:
                rocks[block.property] = self._material(model.project.library.get(block.property))
            name = f"{obj.name} Bed {number:0{digits}}"
            bed = bpy.data.objects.new(name, meshes.new_mesh(name, shape))
            if self._shape.is_mirrored:
                bed.data.flip_normals()
            bed.data.materials.append(rocks[block.property])
            bed[BED], bed[VOLUME] = number, block.volume
            placing.stand_at(bed, obj)
            collection.objects.link(bed)
        beds = list(collection.objects)
        if self._has_masks:
            self._add_masks(collection, obj, masks)
        rock_layers.finish(scene, obj, beds)
        placing.hide(obj)
        placing.select(beds)
        return collection

    def _material(self, rock):
        """A new material of a rock; those that models have of the library stay apart."""
        made = materials.new_material(rock.name, materials.NO_PROPERTY, rock.color)
        del made[materials.KEY]
        if self._has_looks:
            diagonal = float(np.linalg.norm(np.ptp(self._shape.local, axis=0)))
            looks.apply(made, look_of(rock.name), 1.0, self._strata.seed + rock.id, diagonal)
        return made

    def _add_masks(self, collection, obj, numbers):
        """A hidden copy of the object whose vertices have the number of their bed, and a mask of each bed."""
        depsgraph = bpy.context.evaluated_depsgraph_get()
        mesh = bpy.data.meshes.new_from_object(obj.evaluated_get(depsgraph))
        mesh.name = f"{obj.name} Bed Masks"
        mesh.attributes.new(BED, "INT", "POINT").data.foreach_set("value", numbers + 1)
        digits = len(str(self._strata.beds))
        for number in range(self._strata.beds):
            mask = mesh.attributes.new(f"Bed {number + 1:0{digits}}", "FLOAT", "POINT")
            mask.data.foreach_set("value", (numbers == number).astype(np.float32))
        copy = bpy.data.objects.new(mesh.name, mesh)
        placing.stand_at(copy, obj)
        collection.objects.link(copy)
        bpy.context.view_layer.update()  # or it would not know the copy
        placing.hide(copy)
