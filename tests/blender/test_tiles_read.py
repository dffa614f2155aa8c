# SPDX-License-Identifier: GPL-3.0-or-later
"""A model in tiles comes into Blender: coarse as a whole, or tile by tile."""

import contextlib
from concurrent.futures import Future
from unittest import mock

import bpy
import numpy as np
from panel_case import SAMPLES, PanelCase, ops
from realmodel.bl.objects import model_tree, origin
from realmodel.core import load_project
from realmodel.distributed import build, tile_folder
from realmodel.distributed.workers import Workers


class NoWorkers(Workers):
    """This process does all tasks, for Blender's Python has no Dask."""

    def __init__(self):
        super().__init__(Future())

    def in_any_order(self, *arguments, **options):
        return super().in_any_order(*arguments, **{**options, "here": True})


class TilesCase(PanelCase):
    sample, size = "two_layers", (60, 60)

    def setUp(self):
        super().setUp()
        nobody = contextlib.nullcontext(NoWorkers())
        with mock.patch.object(tile_folder, "workers_of", lambda *_: nobody):
            project = load_project(SAMPLES / self.sample / "project.toml")
            self.tiled = build(project, self.folder / "tiles", self.size)
        self.path = str(self.folder / "tiles" / "tiles.toml")

    def objects(self):
        return [item for item in self.scene.objects if item.get(model_tree.TAG) == "tile"]

    def volume(self, item):
        item.data.calc_loop_triangles()
        corners = np.array([t.vertices[:] for t in item.data.loop_triangles])
        a, b, c = np.array([v.co for v in item.data.vertices])[corners].transpose(1, 0, 2)
        return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


class Tiles(TilesCase):
    def test_all_of_it_is_coarse(self):
        ops.tiles_read(filepath=self.path, squares=20)
        found = {item.name: item for item in self.objects()}
        self.assertEqual(set(found), {block.name for block in self.tiled.blocks})
        for block in self.tiled.blocks:
            item = found[block.name]
            self.assertAlmostEqual(self.volume(item) / block.volume, 1.0, delta=0.25)
            self.assertEqual(item[model_tree.BLOCK], block.name)
            self.assertEqual(item[model_tree.PROPERTY], block.property)
            self.assertEqual(item.data.materials[0].name, self.tiled.project.library.get(block.property).name)
        self.assertIn(origin.KEY, self.scene)
        self.assertEqual([c.name for c in self.scene.collection.children], [f"{self.tiled.name} tiles"])

    def test_chosen_tiles_are_as_they_are(self):
        ops.tiles_read(filepath=self.path, what="TILES", column=1)
        tile = next(t for t in self.tiled.tiles if (t.column, t.row) == (1, 0))
        found = {item[model_tree.BLOCK]: item for item in self.objects()}
        for block, volume in zip(self.tiled.blocks, tile.volumes, strict=True):
            self.assertAlmostEqual(self.volume(found[block.name]) / volume, 1.0, places=3)
        top = self.scene.collection.children[0]
        self.assertEqual([c.name for c in top.children], [tile.name])
        ops.tiles_read(filepath=self.path, what="TILES", columns=9, rows=9)
        self.assertEqual(
            len(self.scene.collection.children[1].children), len([t for t in self.tiled.tiles if t.cells])
        )

    def test_the_model_of_the_scene_stays(self):
        ops.open_sample(sample="two_layers")
        before = self.volumes()
        zero = list(self.scene[origin.KEY])
        ops.tiles_read(filepath=self.path, squares=10)
        self.assertEqual(self.volumes(), before)
        self.assertEqual(list(self.scene[origin.KEY]), zero)
        ops.clear()
        self.assertEqual(len(self.objects()), len(self.tiled.blocks))

    def test_refusals_leave_nothing(self):
        self.refused(ops.tiles_read, "2 columns and 1 rows", filepath=self.path, what="TILES", column=5)
        self.refused(ops.tiles_read, "no file for the tiles", filepath="")
        self.refused(ops.tiles_read, r"no tiles\.toml", filepath=str(self.folder / "x.toml"))
        file = self.tiled.tiles[-1].file
        file.write_bytes(file.read_bytes()[:-9])
        self.refused(ops.tiles_read, "has changed", filepath=self.path)
        self.scene[origin.KEY] = [1e9, 0.0, 0.0]
        self.refused(ops.tiles_read, "from the zero of the scene", filepath=self.path)
        self.assertEqual(self.objects(), [])
        self.assertEqual(len(bpy.data.collections), 0)


class TilesWithFaults(TilesCase):
    sample, size = "fault_blocks", (1100, 900)

    def test_chosen_tiles_are_as_they_are(self):
        ops.tiles_read(filepath=self.path, what="TILES", columns=9, rows=9)
        for block in self.tiled.blocks:
            parts = [item for item in self.objects() if item[model_tree.BLOCK] == block.name]
            self.assertGreater(len(parts), 1)
            volume = sum(self.volume(item) for item in parts)
            self.assertAlmostEqual(volume / block.volume, 1.0, places=3)

    def test_all_of_it_is_coarse(self):
        ops.tiles_read(filepath=self.path, squares=30)
        found = {item.name: item for item in self.objects()}
        self.assertEqual(set(found), {block.name for block in self.tiled.blocks})
        for block in self.tiled.blocks:
            self.assertAlmostEqual(self.volume(found[block.name]) / block.volume, 1.0, delta=0.25)
