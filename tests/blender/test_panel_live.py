# SPDX-License-Identifier: GPL-3.0-or-later
"""The live rebuild: what starts it, what it keeps, and that it ends."""

import time
from unittest import mock

import bpy
from blender_state import volume
from panel_case import PanelCase, ops, raise_by, select, stack
from realmodel.bl.display import shown_models
from realmodel.bl.objects import built_models, model_tree, viewports
from realmodel.bl.scene import live


class Live(PanelCase):
    def setUp(self):
        super().setUp()
        self.items = stack(0.0, 10.0, 20.0)
        ops.build()
        self.model.live = True
        self.live_is_done()

    def block(self):
        return bpy.data.objects["S2 block"]

    def test_an_edit(self):
        raise_by(self.items[2], 5.0)
        self.live_is_done()
        self.assertAlmostEqual(volume(self.block().data), 15e4, delta=1.0)
        self.assertAlmostEqual(self.volumes()["S2 block"], 15e4, delta=1.0)

    def test_an_edit_that_blender_has_not_reported_when_a_build_ends(self):
        raise_by(self.items[2], 5.0)
        while not live._work._jobs:
            time.sleep(live._work.look())
        for job, _ in live._work._jobs.values():
            job.wait()
        for vertex in self.items[2].data.vertices:
            vertex.co.z += 2.0
        self.items[2].data.update()  # Blender evaluates it later
        self.live_is_done()
        self.assertAlmostEqual(volume(self.block().data), 17e4, delta=1.0)

    def test_moving_the_object_and_a_setting(self):
        self.items[2].location.z += 2.0
        bpy.context.view_layer.update()
        self.live_is_done()
        self.assertAlmostEqual(volume(self.block().data), 12e4, delta=1.0)
        self.model.rocks[0].surfaces[0].name = "renamed"
        self.model.rocks[0].base_elevation = -1.0
        self.live_is_done()
        self.assertIn("base block", self.volumes())

    def test_a_modifier(self):
        modifier = self.items[2].modifiers.new("up", "DISPLACE")
        modifier.direction, modifier.mid_level, modifier.strength = "Z", 0.0, 3.0
        bpy.context.view_layer.update()
        self.live_is_done()
        self.assertAlmostEqual(volume(self.block().data), 13e4, delta=1.0)

    def test_at_a_stage(self):
        """The stage that is shown is made with the model, and stays."""
        self.model.stage = 1
        self.assertEqual(len(self.block().data.polygons), 0)
        with mock.patch.object(shown_models.StageRequest, "make", side_effect=AssertionError("made again")):
            raise_by(self.items[1], 5.0)
            self.live_is_done()
        self.assertEqual(self.model.stage, 1)
        self.assertEqual(len(self.block().data.polygons), 0)
        self.assertAlmostEqual(volume(bpy.data.objects["S1 block"].data), 15e4, delta=1.0)
        self.assertAlmostEqual(self.volumes()["S2 block"], 5e4, delta=1.0)

    def test_edit_mode(self):
        self.items[2].hide_set(False)
        select(self.items[2])
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="SELECT")
        bpy.ops.transform.translate(value=(0.0, 0.0, 4.0))
        live.touch(self.scene)
        self.live_is_done()
        self.assertEqual(bpy.context.mode, "EDIT_MESH")
        self.assertAlmostEqual(volume(self.block().data), 14e4, delta=1.0)
        bpy.ops.object.mode_set(mode="OBJECT")

    def test_undo_in_edit_mode_after_a_new_name(self):
        """The undo steps of edit mode find objects by name."""
        if not bpy.ops.ed.undo_push.poll():
            self.skipTest("this Blender has no undo in background")
        select(self.items[2])
        bpy.ops.ed.undo_push(message="before")
        bpy.ops.object.mode_set(mode="EDIT")
        for message in ("first", "second"):
            bpy.ops.ed.undo_push(message=message)
        self.model.rocks[0].surfaces[2].name = "other"
        self.live_is_done()
        bpy.ops.ed.undo()  # Blender is still there
        self.assertEqual(bpy.context.mode, "EDIT_MESH")
        bpy.ops.object.mode_set(mode="OBJECT")

    def test_undo_in_edit_mode_after_a_build_without_the_object(self):
        """What is edited is not removed; it is the user's own."""
        if not bpy.ops.ed.undo_push.poll():
            self.skipTest("this Blender has no undo in background")
        block = self.block()
        select(block)
        bpy.ops.ed.undo_push(message="before")
        bpy.ops.object.mode_set(mode="EDIT")
        for message in ("first", "second"):
            bpy.ops.ed.undo_push(message=message)
        model_tree.remove_objects([block])
        self.assertNotIn(model_tree.TAG, block)
        bpy.ops.ed.undo()  # Blender is still there
        self.assertEqual(bpy.context.mode, "EDIT_MESH")
        bpy.ops.object.mode_set(mode="OBJECT")

    def test_it_keeps_selection_and_materials(self):
        mine = bpy.data.materials.new("mine")
        self.block().data.materials[0] = mine
        select(self.block())
        mesh = self.block().data
        raise_by(self.items[2], 5.0)
        self.live_is_done()
        self.assertEqual((self.block().data, self.block().data.materials[0]), (mesh, mine))
        self.assertTrue(self.block().select_get())
        self.assertEqual(bpy.context.view_layer.objects.active, self.block())

    def test_other_work_postpones_it(self):
        """As Make Ensemble, which needs the processors: no change is lost."""
        raise_by(self.items[2], 5.0)
        live.postpone_work()
        self.assertTrue(live.is_working())
        while not live._work._jobs:
            time.sleep(live._work.look())
        live.postpone_work()
        self.live_is_done()
        self.assertAlmostEqual(self.volumes()["S2 block"], 15e4, delta=1.0)

    def test_a_build_by_hand_is_cancelled(self):
        """What Auto would have built is discarded with it, and the panel says so until the next change."""
        raise_by(self.items[2], 5.0)
        live.postpone_work(but=self.scene.name)
        self.assertFalse(live.is_working())
        live.cancelled(self.scene.name)
        activity = bpy.context.window_manager.realmodel
        self.assertIn("cancelled", activity.problem)
        raise_by(self.items[2], 1.0)
        self.live_is_done()
        self.assertEqual(activity.problem, "")
        self.assertAlmostEqual(self.volumes()["S2 block"], 16e4, delta=1.0)
        live.cancelled(self.scene.name)
        self.assertEqual(activity.problem, "", "the model is as new as its input")

    def test_what_no_handler_sees_is_built_all_the_same(self):
        """As where the window of a build is closed, or a build changes what it was made from."""
        raise_by(self.items[2], 5.0)
        live.postpone_work(but=self.scene.name)
        self.assertFalse(live.is_working())
        self.look_again_until_done()
        self.assertAlmostEqual(self.volumes()["S2 block"], 15e4, delta=1.0)
        self.assertFalse(self.model.is_outdated)
        activity = bpy.context.window_manager.realmodel
        self.assertEqual(activity.problem, "")
        with mock.patch.object(live, "check", return_value=True) as check:
            self.look_again_until_done()
            self.assertEqual(check.call_count, 2)  # it is built once more, not without end
        self.assertIn("differs from its input", activity.problem)

    def look_again_until_done(self):
        live.look_again(self.scene.name)
        until = time.monotonic() + 60.0
        while live.is_working() or live.is_checking():
            self.assertLess(time.monotonic(), until, "it does not end")
            live._checks.look()
            live._work.look()
            time.sleep(0.005)

    def test_a_refusal_is_shown_and_mended(self):
        vertices = self.items[1].data.vertices
        vertices[6].co.x += 60.0
        raise_by(self.items[1], 0.0)
        self.live_is_done()
        activity = bpy.context.window_manager.realmodel
        self.assertIn("overlap in plan", activity.problem)
        self.assertEqual(activity.problem_object, "S1")
        self.assertEqual(list(viewports._status.values()), [activity.problem])
        self.assertAlmostEqual(volume(self.block().data), 1e5, delta=1.0)
        vertices[6].co.x -= 60.0
        raise_by(self.items[1], 1.0)
        self.live_is_done()
        self.assertEqual(activity.problem, "")
        self.assertEqual(list(viewports._status.values()), [""])
        self.assertAlmostEqual(volume(self.block().data), 9e4, delta=1.0)

    def test_the_bad_place_is_selected(self):
        self.items[1].data.vertices[6].co.x += 60.0
        raise_by(self.items[1], 0.0)
        self.live_is_done()
        ops.show_problem()
        self.assertEqual((bpy.context.mode, bpy.context.object.name), ("EDIT_MESH", "S1"))
        bpy.ops.object.mode_set(mode="OBJECT")
        chosen = [p.index for p in self.items[1].data.polygons if p.select]
        self.assertTrue(chosen)
        self.assertLess(len(chosen), 16)

    def test_one_model_is_kept_however_often_it_is_built(self):
        for _ in range(4):
            raise_by(self.items[2], 1.0)
            self.live_is_done()
        self.assertEqual(len(built_models._models), 1)

    def test_switched_off_nothing_follows(self):
        self.model.live = False
        raise_by(self.items[2], 5.0)
        self.assertIsNone(live._work.look())
        self.assertAlmostEqual(volume(self.block().data), 1e5, delta=1.0)

    def test_its_own_changes_start_nothing(self):
        raise_by(self.items[2], 5.0)
        self.live_is_done()
        bpy.context.view_layer.update()
        self.assertIsNone(live._work.look())

    def test_what_is_evaluated_in_the_same_shape_is_not_built_again(self):
        """Or colors that are written into an interface when a cut is displayed would never end."""
        before = self.model.built_stamp
        self.items[2].data.update()
        bpy.context.view_layer.update()
        self.live_is_done()
        self.assertEqual(self.model.built_stamp, before)
        self.assertFalse(self.model.is_outdated)

    def test_an_interpolated_interface_follows_its_settings_and_hands(self):
        ops.open_sample(sample="two_layers", build=False)
        self.model.live = True
        self.live_is_done()
        row, before = self.model.rocks[0].surfaces[1], self.volumes()
        self.assertTrue(before)
        row.method = "idw"
        self.live_is_done()
        self.assertNotEqual(self.volumes(), before)
        self.assertEqual(row.source, "POINTS_FILE")
        bpy.context.view_layer.update()
        self.live_is_done()
        raise_by(row.interface, 1.0)
        self.live_is_done()
        self.assertEqual(row.source, "MESH_OBJECT")
