# SPDX-License-Identifier: GPL-3.0-or-later
"""Looking at a built model: display modes, stages, blocks moved apart, colors, sections, views, capture,
coordinates. The model stays what it is in all of them."""

import itertools
import time
from unittest import mock

import blender_state
import bpy
import numpy as np
import realmodel
from made_projects import LIBRARY
from realmodel import props_view
from realmodel.bl.display import cuts, preparing, replacing
from realmodel.core import build
from view_case import Case


def setUpModule():
    realmodel.register()


def tearDownModule():
    realmodel.unregister()


class Modes(Case):
    def test_every_mode_shows_its_own_objects_and_leaves_the_model(self):
        before = self.contents()
        blocks, interfaces = {o.name for o in self.blocks().values()}, {f"S{k}" for k in range(5)}
        seen = {}
        for mode in ("POINTS", "LINES", "AREAS", "SURFACES", "POLYHEDRA", "BLOCKS"):
            self.settings.display = mode
            bpy.context.view_layer.update()
            seen[mode] = self.in_sight("block"), self.in_sight("interface"), len(self.in_sight("view"))
            wires = {o.show_wire for o in self.blocks().values()}
            self.assertEqual(wires, {mode == "AREAS"}, mode)
        self.assertEqual(seen["BLOCKS"], (blocks, set(), 0))
        self.assertEqual(seen["AREAS"], (blocks, set(), 0))
        self.assertEqual(seen["SURFACES"], (set(), interfaces, 0))
        self.assertEqual(seen["POINTS"], (set(), set(), 0))
        self.assertEqual(seen["LINES"], (set(), set(), 0))
        self.assertEqual(seen["POLYHEDRA"], (set(), set(), len(blocks)))
        self.assertEqual(self.contents(), before)
        self.assertEqual([o for o in bpy.data.objects if o.get("realmodel") == "view"], [])

    def test_what_is_drawn_as_points_and_lines(self):
        from realmodel.bl.display import modes

        blocks, interfaces = set(self.blocks().values()), {bpy.data.objects[f"S{k}"] for k in range(5)}
        for mode in ("POINTS", "LINES"):
            self.settings.display = mode
            for subject, wanted in (
                ("BLOCKS", blocks),
                ("INTERFACES", interfaces),
                ("BOTH", blocks | interfaces),
            ):
                self.settings.view.subject = subject
                self.assertEqual(set(modes.drawn(self.scene)), wanted)
        self.settings.display = "BLOCKS"
        self.assertEqual(modes.drawn(self.scene), [])

    def test_polyhedra_are_the_cells_a_little_smaller(self):
        from realmodel.bl.display import cells

        self.settings.display = "POLYHEDRA"
        columns = build(self.project)
        for block in columns.blocks:
            if not block.cells:
                continue
            body = bpy.data.objects[f"{block.name} cells"]
            self.assertEqual(body.parent, self.blocks()[block.name])
            self.assertEqual(blender_state.open_edges(body.data), 0)
            volume = blender_state.volume(body.data)
            self.assertAlmostEqual(volume / block.volume, cells.SHRINK**3, places=4)
            self.assertEqual(body.material_slots[0].material, self.blocks()[block.name].data.materials[0])
            self.assertFalse(body.hide_render)
            self.assertTrue(self.blocks()[block.name].hide_render)
        self.settings.display = "BLOCKS"
        self.assertFalse(any(item.hide_render for item in self.blocks().values()))

    def test_interfaces_have_the_colors_of_the_blocks_beneath(self):
        self.settings.display = "SURFACES"
        from realmodel.bl.objects import materials

        for name, property_id in (("S1", 2), ("S3", 4), ("S2", 3)):
            color = bpy.data.objects[name].material_slots[0].material.diffuse_color
            wanted = materials.linear_color(LIBRARY.get(property_id).color)
            np.testing.assert_allclose(color[:3], wanted, atol=1e-6, err_msg=name)

    def test_interfaces_are_smooth_and_blocks_are_not(self):
        for item in self.scene.objects:
            smooth = np.ones(len(item.data.polygons), bool)
            item.data.polygons.foreach_get("use_smooth", smooth)
            self.assertEqual(set(smooth.tolist()), {item["realmodel"] == "interface"}, item.name)

    def test_what_the_user_hid_stays_hidden(self):
        item = self.blocks()["Sand"]
        item.hide_set(True)
        self.settings.color_by = "BLOCK"
        bpy.ops.realmodel.build()
        self.assertTrue(self.blocks()["Sand"].hide_get())

    def test_interfaces_beside_blocks_do_not_flicker(self):
        interface = bpy.data.objects["S1"]
        self.assertEqual(interface.display_type, "WIRE")
        self.settings.display = "SURFACES"
        self.assertEqual(interface.display_type, "TEXTURED")
        self.settings.display = "AREAS"
        self.settings.view.subject = "INTERFACES"
        self.assertEqual(interface.display_type, "TEXTURED")
        self.settings.view.subject = "BOTH"
        self.assertEqual(interface.display_type, "WIRE")
        self.settings.display = "SURFACES"
        interface.display_type = "BOUNDS"  # by the user
        self.settings.display = "BLOCKS"
        self.assertEqual(interface.display_type, "BOUNDS")

    def test_without_blocks_the_interfaces_are_seen(self):
        bpy.ops.realmodel.clear()
        self.assertEqual(self.in_sight("interface"), {f"S{k}" for k in range(5)})
        self.assertEqual(bpy.data.objects["S1"].display_type, "TEXTURED")

    def test_hidden_properties(self):
        bpy.ops.realmodel.hide_property(property_id=2, action="HIDE")
        self.assertNotIn(self.blocks()["Sand"].name, self.in_sight())
        self.assertTrue(self.blocks()["Sand"].hide_render)
        bpy.ops.realmodel.hide_property(property_id=2, action="ONLY")
        self.assertEqual(self.in_sight("block"), {self.blocks()["Sand"].name})
        bpy.ops.realmodel.hide_property(property_id=2, action="TOGGLE")
        self.assertEqual(self.in_sight("block"), set())
        bpy.ops.realmodel.hide_property(action="ALL")
        self.assertEqual(self.in_sight("block"), {o.name for o in self.blocks().values()})
        self.assertFalse(self.blocks()["Sand"].hide_render)
        with self.assertRaisesRegex(RuntimeError, "no block has property 77"):
            bpy.ops.realmodel.hide_property(property_id=77)

    def test_the_modes_say_nothing_before_a_build(self):
        bpy.ops.realmodel.clear()
        for mode in ("POINTS", "LINES", "AREAS", "SURFACES", "POLYHEDRA", "BLOCKS"):
            self.settings.display = mode
        self.settings.stage, self.settings.explode = 1, 1.0
        for call in (
            lambda: bpy.ops.realmodel.section(location=(50, 40, 10)),
            lambda: bpy.ops.realmodel.section_plane(),
            lambda: bpy.ops.realmodel.hide_property(property_id=1),
            lambda: bpy.ops.realmodel.coordinates(location=(50, 40, 10)),
        ):
            with self.assertRaisesRegex(RuntimeError, "no model yet"):
                call()


class Stages(Case):
    def all_is_made(self):
        """Nothing is waited for where there is no window."""

    def volumes(self):
        return {
            row.name: blender_state.volume(row.object.data)
            for row in self.settings.results
            if row.object is not None and len(row.object.data.polygons)
        }

    def assert_shows(self, model):
        found = self.volumes()
        self.assertEqual(set(found), {block.name for block in model.blocks if block.cells})
        for block in model.blocks:
            if block.cells:
                self.assertAlmostEqual(found[block.name] / block.volume, 1.0, places=5, msg=block.name)
                self.assertEqual(blender_state.open_edges(self.blocks()[block.name].data), 0)

    def test_the_slider_replays(self):
        whole, objects = self.contents(), self.blocks()
        self.assertEqual(self.settings.stage, 4)
        for stage in (0, 1, 2, 3, 2, 4):
            self.settings.stage = stage
            self.assert_shows(self.model.stage(stage))
            for name, item in objects.items():
                self.assertEqual(self.blocks()[name], item)
            gone = self.blocks().get("Gone")
            self.assertEqual(gone is not None, stage == 2)
            if gone is not None:
                self.assertEqual(gone.data.materials[0].get("realmodel_property"), 3)
        self.assertEqual(self.contents(), whole)
        self.settings.stage = 99
        self.assertEqual(self.settings.stage, 4)

    def test_the_slider_of_the_panel_ends_at_the_youngest_surface(self):
        slider, name = self.settings.stage_slider, props_view.stage_slider_name(4)
        bounds = slider.bl_rna.properties[name]
        self.assertEqual((bounds.soft_min, bounds.soft_max), (0, 4))
        setattr(slider, name, 2)
        self.assertEqual(self.settings.stage, 2)
        self.assert_shows(self.model.stage(2))
        self.settings.stage = 3
        self.assertEqual(getattr(slider, name), 3)
        setattr(slider, props_view.stage_slider_name(2), 2)  # another model's, drawn before rows were added
        self.assertEqual(self.settings.stage, 2)
        self.assertIsNone(props_view.stage_slider_name(0), "there is nothing to slide through")
        self.assertIsNone(props_view.stage_slider_name(props_view.MOST + 1))
        self.assertFalse(bounds.is_animatable, "keyframes belong to the stage itself")

    def test_blocks_that_are_not_there_are_out_of_sight(self):
        self.settings.stage = 1
        self.all_is_made()
        self.assertEqual(self.in_sight("block"), {self.blocks()[n].name for n in ("base block", "Sand")})

    def test_a_build_at_a_stage_stays_there(self):
        self.settings.stage = 2
        bpy.ops.realmodel.build()
        self.assertEqual(self.settings.stage, 2)
        self.assert_shows(self.model.stage(2))

    def test_after_opening_the_file_again(self):
        self.settings.stage = 2
        path = str(self.folder / "saved.blend")
        bpy.ops.wm.save_as_mainfile(filepath=path, check_existing=False)
        for file in self.folder.glob("*"):
            if file.suffix != ".blend":
                file.unlink()
        bpy.ops.wm.open_mainfile(filepath=path)
        self.scene = bpy.context.scene
        self.settings = self.scene.realmodel
        self.assert_shows(self.model.stage(2))
        self.settings.stage = 3
        self.assert_shows(self.model.stage(3))
        self.settings.stage = 4
        self.assert_shows(self.model)
        self.assertNotIn("Gone", self.blocks())

    def test_keyframes(self):
        for frame, stage in ((1, 0), (5, 4)):
            self.settings.stage = stage
            self.scene.keyframe_insert("realmodel.stage", frame=frame)
        action = self.scene.animation_data.action
        curves = action.fcurves if hasattr(action, "fcurves") else []
        for curve in curves:
            for point in curve.keyframe_points:
                point.interpolation = "LINEAR"
        for frame in (1, 2, 3, 4, 5, 3):
            self.scene.frame_set(frame)
            self.assert_shows(self.model.stage(frame - 1) if frame < 5 else self.model)

    def test_an_animation_renders_the_stages(self):
        self.test_keyframes()
        seen = []

        def look(_scene, depsgraph=None):
            seen.append({name for name, volume in self.volumes().items() if volume > 0})

        self.scene.frame_start, self.scene.frame_end = 1, 3
        self.look_from_the_south(48)
        self.scene.render.filepath = str(self.folder / "frame")
        bpy.app.handlers.render_post.append(look)
        try:
            bpy.ops.render.render(animation=True)
        finally:
            bpy.app.handlers.render_post.remove(look)
        self.settings.stage = 4
        self.assert_shows(self.model)
        self.assertNotIn("Gone", self.blocks())
        self.assertEqual([m.name for m in bpy.data.meshes if not m.users], [])
        heights = [_opaque_rows(self.folder / f"frame{k:04d}.png") for k in (1, 2, 3)]
        self.assertEqual(seen[0], {"base block"})
        self.assertEqual(seen[2], {"base block", "Sand", "Gone"})
        self.assertLess(heights[0], heights[1])
        self.assertLess(heights[1], heights[2])


class Renders(Case):
    def opaque(self):
        """The share of a render in which something is seen."""
        path = self.folder / "render.png"
        self.scene.render.filepath = str(path)
        bpy.ops.render.render(write_still=True)
        return float((_alpha(path) > 0.5).mean())

    def test_points_and_lines_as_thick_as_on_the_screen(self):
        self.look_from_the_south(160)
        before = self.contents()
        self.settings.display = "BLOCKS"
        shown = {"BLOCKS": self.opaque()}
        for mode in ("POINTS", "LINES"):
            self.settings.display = mode
            shown[mode] = self.opaque()
            self.assertEqual([o.name for o in self.scene.objects if o.get("realmodel_view") == "marks"], [])
        self.assertLess(0.005, shown["POINTS"])
        self.assertLess(shown["POINTS"], shown["LINES"])
        self.assertLess(shown["LINES"], 0.8 * shown["BLOCKS"])
        self.settings.display = "BLOCKS"
        self.assertEqual(self.opaque(), shown["BLOCKS"])
        self.assertEqual(self.contents(), before)
        self.assertEqual([m.name for m in bpy.data.meshes if not m.users], [])


class WithAWindow(Stages):
    """In a window nothing waits: what takes long is made in a thread, and shown when it is there."""

    def setUp(self):
        super().setUp()
        self.enterContext(mock.patch.object(replacing, "must_finish_now", lambda: False))

    def assert_shows(self, model):
        self.all_is_made()
        super().assert_shows(model)

    def all_is_made(self):
        works = (preparing._work, cuts._work)
        while any(work.is_working() for work in works):
            for work in works:
                work.look()
            time.sleep(0.005)

    def test_the_stage_before_stays_until_the_next_is_there(self):
        self.settings.stage = 1
        self.assertEqual(set(self.volumes()), {"base block", "Sand", "Cap"})
        self.settings.stage = 2
        self.assert_shows(self.model.stage(2))

    def test_cells(self):
        self.settings.display = "POLYHEDRA"
        self.assertEqual(self.in_sight(), self.in_sight("block"))
        self.assertTrue(preparing.is_working(self.scene))
        self.all_is_made()
        self.assertEqual(self.in_sight("block"), set())
        self.assertEqual(len(self.in_sight("view")), 3)
        self.settings.stage = 1
        self.all_is_made()
        self.assertEqual(len(self.in_sight("view")), 2)

    def test_cells_of_a_half(self):
        bpy.ops.realmodel.section_plane(axis="Z")
        self.settings.view.plane.location.z = 15.0
        self.settings.display = "POLYHEDRA"
        self.all_is_made()
        found = [item for item in self.scene.objects if item.get("realmodel_view") == "cells"]
        self.assertTrue(found)
        self.assertLess(max(blender_state.coordinates(item.data)[:, 2].max() for item in found), 15.0)

    def test_a_new_build_stops_what_is_made_of_the_old_one(self):
        self.settings.stage = 1
        preparing._work.look()
        bpy.ops.realmodel.build()
        self.assert_shows(self.model.stage(1))

    test_an_animation_renders_the_stages = None  # nobody waits then


def _opaque_rows(path):
    """Rows of a picture in which something is seen."""
    return int((_alpha(path).max(axis=1) > 0.5).sum())


def _alpha(path):
    """(height, width) how opaque a picture is."""
    image = bpy.data.images.load(str(path))
    flat = np.empty(image.size[0] * image.size[1] * image.channels, np.float32)
    image.pixels.foreach_get(flat)
    shape = image.size[1], image.size[0], image.channels
    bpy.data.images.remove(image)
    return flat.reshape(shape)[:, :, 3]


class Apart(Case):
    def heights(self):
        bpy.context.view_layer.update()
        return {name: item.matrix_world.translation.copy() for name, item in self.blocks().items()}

    def test_upwards_the_order_of_age(self):
        meshes = {n: blender_state.coordinates(o.data).tobytes() for n, o in self.blocks().items()}
        self.settings.explode = 1.0
        at = self.heights()
        rising = [at[name].z for name in ("base block", "Sand", "Cap")]
        self.assertEqual(rising, sorted(rising))
        self.assertGreater(rising[-1], rising[0] + 10.0)
        self.assertEqual(
            {n: blender_state.coordinates(o.data).tobytes() for n, o in self.blocks().items()}, meshes
        )
        self.settings.explode = 0.0
        self.assertEqual([tuple(v) for v in self.heights().values()], [(0.0, 0.0, 0.0)] * len(at))

    def test_the_user_s_own_place_stays(self):
        item = self.blocks()["Sand"]
        item.location, item.delta_location = (5.0, 6.0, 7.0), (1.0, 0.0, 0.0)
        for direction in ("Z", "CENTER", "BLOCK"):
            self.settings.explode_direction = direction
            self.settings.explode = 0.7
            self.assertEqual(tuple(item.location), (5.0, 6.0, 7.0))
            self.assertGreater((item.delta_location - item.delta_location.__class__((1, 0, 0))).length, 0.1)
            self.settings.explode = 0.0
            self.assertEqual(tuple(item.location), (5.0, 6.0, 7.0))
            np.testing.assert_allclose(item.delta_location, (1.0, 0.0, 0.0), atol=1e-4)

    def test_side_by_side_nothing_overlaps(self):
        self.settings.explode_direction = "BLOCK"
        self.settings.explode = 1.0
        at = self.heights()
        spans = sorted(
            (blender_state.coordinates(o.data)[:, 0].min() + at[n].x, n) for n, o in self.blocks().items()
        )
        for (left, name), (right, _) in itertools.pairwise(spans):
            width = np.ptp(blender_state.coordinates(self.blocks()[name].data)[:, 0])
            self.assertGreaterEqual(right, left + width)

    def test_a_build_and_a_stage_keep_it(self):
        self.settings.explode = 1.0
        before = self.heights()
        bpy.ops.realmodel.build()
        self.assertEqual(self.heights(), before)
        self.settings.stage = 1
        self.assertEqual(self.heights()["Sand"], before["Sand"])


class Colors(Case):
    def colors(self):
        return {n: tuple(o.material_slots[0].material.diffuse_color) for n, o in self.blocks().items()}

    def test_each_rule(self):
        before = {n: o.data.materials[0] for n, o in self.blocks().items()}
        library = self.colors()
        for rule in ("BLOCK", "AGE"):
            self.settings.color_by = rule
            found = self.colors()
            self.assertEqual(len(set(found.values())), len(found), rule)
            self.assertNotEqual(found, library)
        self.settings.color_by = "ROCK"
        self.assertEqual(len(set(self.colors().values())), 1)
        self.assertEqual({n: o.data.materials[0] for n, o in self.blocks().items()}, before)
        self.settings.color_by = "PROPERTY"
        self.assertEqual(self.colors(), library)
        names = [m.name for m in bpy.data.materials if m.name.startswith(("Block", "Age", "Rock"))]
        self.assertEqual(names, [])

    def test_the_library_s_color_follows_at_once(self):
        self.settings.library[1].color = (0.0, 0.0, 1.0)
        np.testing.assert_allclose(self.colors()["Sand"][:3], (0.0, 0.0, 1.0), atol=1e-6)

    def test_the_user_s_own_material_stays(self):
        mine = bpy.data.materials.new("mine")
        slot = self.blocks()["Sand"].material_slots[0]
        slot.link, slot.material = "OBJECT", mine
        for rule in ("BLOCK", "PROPERTY"):
            self.settings.color_by = rule
            self.assertEqual(self.blocks()["Sand"].material_slots[0].material, mine)

    def test_nothing_stays_of_a_model_that_is_removed(self):
        self.settings.display, self.settings.color_by = "POLYHEDRA", "AGE"
        bpy.ops.realmodel.section_plane()
        bpy.ops.realmodel.section_remove()
        bpy.ops.realmodel.new()
        self.assertEqual([m.name for m in bpy.data.materials], [])
        self.assertEqual([c.name for c in bpy.data.collections], [])
        self.assertEqual([o.name for o in bpy.data.objects], [])
