# SPDX-License-Identifier: GPL-3.0-or-later
"""Strata shown on a mesh before they are made: a temporary copy whose faces have the colors of their beds."""

import bpy
import numpy as np

from ...core.display import polygon_mesh
from ...core.filling import PALETTES, lay_beds, rocks_of_beds
from ..objects import materials, meshes, placing, viewports

_NAME = "Strata Preview"
_MOST = 100_000  # triangles that larger ones are divided into: each has one color
_LONG = 0.7  # of the longest edge: the edges beyond it are divided together


def divided(vertices, triangles):
    """Vertices (V, 3) and triangles (T, 3), the longest edges of which are halved as often as there are no
    more than 100,000, so that walls are not of tall triangles; edges stay straight."""
    corners = vertices[triangles]
    while True:
        lengths = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
        longest = lengths.max(axis=1)
        chosen = longest > _LONG * longest.max()
        if len(corners) + np.count_nonzero(chosen) > _MOST:
            break
        turn = (lengths[chosen].argmax(axis=1)[:, None] + np.arange(3)) % 3
        a, b, c = np.take_along_axis(corners[chosen], turn[:, :, None], axis=1).transpose(1, 0, 2)
        middle = (a + b) / 2
        halves = [np.stack(half, axis=1) for half in ((a, middle, c), (middle, b, c))]
        corners = np.concatenate([corners[~chosen], *halves])
    return corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3)


class FillPreview:
    """The copy of an object stands in its place until `remove`."""

    def __init__(self, item, shape):
        """item: the object; shape: its fill_job.FilledShape."""
        self._item, self._shape = item.name, shape
        self._was_selected = item.select_get()
        self._mesh, self._middles = None, None
        self._closed = None
        self._copy = bpy.data.objects.new(_NAME, bpy.data.meshes.new(_NAME)).name
        copy = bpy.data.objects[self._copy]
        placing.stand_at(copy, item)
        bpy.context.scene.collection.objects.link(copy)
        for name, color in next(iter(PALETTES.values())):
            made = materials.new_material(f"{_NAME} {name}", materials.NO_PROPERTY, color)
            del made[materials.KEY]
            copy.data.materials.append(made)
        item.hide_set(True)
        bpy.context.view_layer.objects.active = copy  # a hidden object is not: the dialog would not end

    def show(self, strata, depth):
        """Colors the faces by their beds; depth: as of FilledShape.closed. Raises InputRefused."""
        mesh = bpy.data.objects[self._copy].data
        closed = self._shape.closed(depth)
        if closed is not self._closed:
            vertices, triangles = divided(*closed)
            local = self._shape.to_local(vertices).astype(np.float32)
            meshes.refill(mesh, polygon_mesh.of_triangles(local, triangles))
            self._closed, self._middles = closed, vertices[triangles].mean(axis=1)
        beds = lay_beds(strata, closed[0])
        _, rocks = rocks_of_beds(beds.count, strata.palette, strata.seed)
        for material, (_, color) in zip(mesh.materials, PALETTES[strata.palette], strict=True):
            materials.set_color(material, color)
        rows = np.array(rocks, np.int32)[beds.numbers(self._middles)] - 1
        mesh.polygons.foreach_set("material_index", rows)
        mesh.update()
        viewports.redraw()

    def remove(self):
        """Removes the copy; the object is shown again, and selected if it was."""
        copy = bpy.data.objects.get(self._copy)
        if copy is not None:
            mesh = copy.data
            made = list(mesh.materials)
            bpy.data.objects.remove(copy)
            bpy.data.meshes.remove(mesh)
            for material in made:
                bpy.data.materials.remove(material)
        obj = bpy.data.objects.get(self._item)
        if obj is not None and obj.name in bpy.context.view_layer.objects:
            obj.hide_set(False)
            obj.select_set(self._was_selected)
            bpy.context.view_layer.objects.active = obj
        viewports.redraw()
