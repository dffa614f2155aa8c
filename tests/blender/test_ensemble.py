# SPDX-License-Identifier: GPL-3.0-or-later
"""A small ensemble in the scene: the table, the section and its colors, undo, cancel, and the .blend."""

import bpy
import numpy as np
from blender_state import inventory
from panel_case import PanelCase, ops, outline, select
from realmodel.bl.display import ensembles, shown_models
from realmodel.bl.jobs import ensemble_job
from realmodel.bl.objects.stored_arrays import StoredArrays
from realmodel.core import Cancelled
from realmodel.core.ensembles import Realizer

COUNT = 6


class EnsembleInTheScene(PanelCase):
    def setUp(self):
        super().setUp()
        ops.open_sample(sample="two_layers")
        if not len(self.model.results):
            ops.build()

    @property
    def group(self):
        return self.model.ensemble

    def blocks(self):
        return StoredArrays(ensembles.item_of(self.scene), ensembles.BLOCKS)["blocks"]

    def slots(self):
        mesh = ensembles.item_of(self.scene).data
        found = np.empty(len(mesh.polygons), np.int32)
        mesh.polygons.foreach_get("material_index", found)
        return found

    def names(self):
        """Of the material of each face."""
        materials = [material.name for material in ensembles.item_of(self.scene).data.materials]
        return np.array(materials)[self.slots()]

    def test_the_same_as_in_python(self):
        self.assertEqual(ops.ensemble(realizations=COUNT, seed=3), {"FINISHED"})
        model = shown_models.whole(self.scene, None)
        realizer = Realizer(model, 3)
        models = [realizer.realization(number) for number in range(COUNT)]
        table = ensembles.table(self.scene)
        self.assertEqual((table["count"], table["seed"]), (COUNT, 3))
        for number, row in enumerate(table["blocks"]):
            drawn = [each.blocks[number].volume for each in models]
            np.testing.assert_allclose(row["percentiles"], np.percentile(drawn, [10, 50, 90]))
            self.assertAlmostEqual(row["mean"], np.mean(drawn), places=5)
        item = ensembles.item_of(self.scene)
        self.assertTrue(item.show_in_front, "within the blocks nobody would see it")
        mesh = item.data
        origin = np.array(self.scene.get("realmodel_origin", (0, 0, 0)))
        centers = np.array([face.center for face in mesh.polygons]) + origin
        blocks = self.blocks()
        found = np.array([each.block_at(centers) for each in models])
        self.assertLess((found != blocks).mean(), 0.01)  # single precision at borders of blocks
        self.assertGreater((blocks != blocks[0]).any(axis=0).sum(), 10)

    def test_colors_of_the_section(self):
        ops.ensemble(realizations=COUNT)
        agree = (self.blocks() == self.blocks()[0]).all(axis=0)
        self.assertGreater(agree.sum(), 100)
        slots = self.slots()
        self.assertEqual(set(slots[agree].tolist()), {0})
        self.assertTrue((slots[~agree] > 0).all())
        self.assertIn("Entropy", ensembles.key(self.scene).title)
        self.group.color_by = "PROBABILITY"
        self.group.block = "Clay"
        clay = (self.blocks() == 0).mean(axis=0)
        np.testing.assert_array_equal(self.slots(), np.rint(clay * 14))
        self.assertIn("Clay", ensembles.key(self.scene).title)
        self.group.color_by = "REALIZATION"
        for number in (1, COUNT):
            self.group.realization = number
            names = np.array(["Clay", "Sand", "Outside"])[self.blocks()[number - 1]]
            np.testing.assert_array_equal(self.names(), names)
        self.assertIsNone(ensembles.key(self.scene))
        slider = self.model.realization_slider
        setattr(slider, f"of_{COUNT}", 2)
        self.assertEqual(self.group.realization, 2)

    def height_factor(self):
        bpy.context.view_layer.update()
        return ensembles.item_of(self.scene).matrix_world[2][2]

    def test_it_is_exaggerated_with_the_model(self):
        self.model.view.exaggeration = 3.0
        ops.ensemble(realizations=2)
        self.assertAlmostEqual(self.height_factor(), 3.0, places=5)
        self.model.view.exaggeration = 1.0
        self.assertAlmostEqual(self.height_factor(), 1.0, places=5)

    def test_removed_it_leaves_nothing(self):
        before = inventory()
        ops.ensemble(realizations=2)
        self.assertNotEqual(inventory(), before)
        ops.ensemble(realizations=3)  # in place of the first
        self.assertEqual(len([item for item in self.scene.objects if ensembles.BLOCKS in item]), 1)
        ops.ensemble_remove()
        self.assertEqual(inventory(), before)
        self.assertIsNone(ensembles.table(self.scene))
        self.refused(ops.ensemble_remove, "there is no ensemble")

    def test_along_the_section_plane_and_a_curve(self):
        ops.section_plane(axis="X")
        ops.ensemble(realizations=2)
        places = np.array([vertex.co for vertex in ensembles.item_of(self.scene).data.vertices])
        self.assertLess(np.ptp(places[:, 0]), 1e-3)
        low, high = self.model.view.bounds_low, self.model.view.bounds_high
        select(outline("line", [(low[0], low[1]), (high[0], high[1])], cyclic=False))
        ops.ensemble(realizations=2, along="LINE")
        places = np.array([vertex.co for vertex in ensembles.item_of(self.scene).data.vertices])
        self.assertGreater(np.ptp(places[:, 0]), 10)
        select()
        self.refused(ops.ensemble, "curve", realizations=2, along="LINE")

    def test_cancelled_or_failed_the_scene_is_as_it_was(self):
        ops.ensemble(realizations=2)
        before = inventory(), self.group.table
        job = ensemble_job.EnsembleJob(self.scene, 1000, 0)
        job.start()
        while job.state()[0] < 0.01 and not job.done:
            pass
        job.cancel()
        while not job.done:
            pass
        with self.assertRaises(Cancelled):
            job.finish()
        self.assertEqual((inventory(), self.group.table), before)
        plane = ops.section_plane(axis="X") and self.model.view.plane
        plane.location.x = 1e6
        bpy.context.view_layer.update()
        self.refused(ops.ensemble, "does not meet the model", realizations=2)
        self.assertEqual(self.group.table, before[1])

    def test_another_model_makes_it_outdated(self):
        ops.ensemble(realizations=2)
        self.assertFalse(ensembles.is_outdated(self.scene))
        job = ensemble_job.EnsembleJob(self.scene, 2, 0)
        job.start()
        job.wait()
        ops.build()
        self.assertTrue(ensembles.is_outdated(self.scene))
        with self.assertRaisesRegex(Exception, "another model was built at the same time"):
            job.finish()

    def test_it_is_in_the_blend(self):
        ops.ensemble(realizations=COUNT)
        self.group.color_by = "REALIZATION"
        before = self.blocks().copy(), ensembles.table(self.scene)
        self.save_and_open()
        np.testing.assert_array_equal(self.blocks(), before[0])
        self.assertEqual(ensembles.table(self.scene), before[1])
        self.assertFalse(ensembles.is_outdated(self.scene))
        self.group.realization = 3
        names = np.array(["Clay", "Sand", "Outside"])[self.blocks()[2]]
        np.testing.assert_array_equal(self.names(), names)
        ops.ensemble(realizations=COUNT)  # the model is built again for it
        np.testing.assert_array_equal(self.blocks(), before[0])

    def test_undo(self):
        bpy.context.preferences.edit.use_global_undo = True
        bpy.ops.ed.undo_push(message="built")
        ops.ensemble(realizations=2)
        bpy.ops.ed.undo_push(message="ensemble")
        bpy.ops.ed.undo()
        self.assertIsNone(ensembles.table(self.scene))
        self.assertIsNone(ensembles.item_of(self.scene))
        bpy.ops.ed.redo()
        self.assertEqual(ensembles.table(self.scene)["count"], 2)
        self.group.color_by = "REALIZATION"
        self.group.realization = 2
        names = np.array(["Clay", "Sand", "Outside"])[self.blocks()[1]]
        np.testing.assert_array_equal(self.names(), names)
