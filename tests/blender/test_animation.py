# SPDX-License-Identifier: GPL-3.0-or-later
"""Turntable and animated stages: what each frame shows, and what the operators leave behind."""

import itertools
import math

import bpy
import numpy as np
import realmodel
from blender_state import pixels, volume
from bpy_extras.object_utils import world_to_camera_view
from mathutils import Vector
from realmodel.bl.host import versions
from realmodel.bl.pictures import picture
from view_case import Case

ops = bpy.ops.realmodel


def setUpModule():
    realmodel.register()


def tearDownModule():
    realmodel.unregister()


class Turntable(Case):
    def own(self):
        return sorted(item[picture.KEY] for item in self.scene.objects if picture.KEY in item)

    def test_the_camera_goes_around_and_sees_all_of_the_model(self):
        self.scene.render.resolution_x, self.scene.render.resolution_y = 320, 200
        self.settings.view.show_legend = False
        ops.turntable(frames=8, elevation=math.radians(20.0))
        self.assertEqual((self.scene.frame_start, self.scene.frame_end), (1, 8))
        corners = [Vector((x, y, z)) for x in (0, 100) for y in (0, 80) for z in (0, 26)]
        origin = Vector(self.scene["realmodel_origin"])
        azimuths, reach = [], []
        for frame in range(1, 10):
            self.scene.frame_set(frame)
            camera = self.scene.camera
            there = [world_to_camera_view(self.scene, camera, corner - origin) for corner in corners]
            reach.append([max(abs(2 * p.x - 1), abs(2 * p.y - 1)) for p in there])
            at = camera.matrix_world.translation + origin - Vector((50.0, 40.0, 13.0))
            azimuths.append(math.degrees(math.atan2(at.y, at.x)))
            self.assertGreater(at.z, 0.0)
        turned = np.diff(azimuths) % 360.0
        np.testing.assert_allclose(turned, 45.0, atol=0.1)
        self.assertLess(np.max(reach), 1.0)
        self.assertGreater(np.max(reach), 0.8)

    def test_its_own_earlier_ones_are_replaced(self):
        camera = bpy.data.objects.new("mine", bpy.data.cameras.new("mine"))
        self.scene.collection.objects.link(camera)
        ops.turntable(frames=10)
        ops.turntable(frames=6)
        kinds = ["camera", "ground", "sun", "turntable"]
        self.assertEqual(self.own(), kinds)
        self.assertEqual(len(bpy.data.actions), 1)
        self.assertEqual(self.scene.frame_end, 6)
        ops.set_up_picture(view="MODEL")
        self.assertEqual(self.own(), kinds[:3])
        self.assertEqual(len(bpy.data.actions), 0)
        self.assertIsNone(self.scene.camera.parent)
        self.assertIn("mine", self.scene.objects)

    def test_a_low_sun_is_warm_and_throws_long_shadows(self):
        ops.set_up_picture(view="MODEL")
        lamp = next(item for item in self.scene.objects if item.type == "LIGHT")
        self.assertEqual(tuple(lamp.data.color), (1.0, 1.0, 1.0))
        ops.set_up_picture(view="MODEL", sun_azimuth=math.radians(270.0), sun_elevation=math.radians(10.0))
        self.scene.view_layers[0].update()
        self.assertEqual(len([item for item in self.scene.objects if item.type == "LIGHT"]), 1)
        red, _, blue = lamp.data.color
        self.assertGreater(red, 1.2 * blue)
        towards = lamp.matrix_world.to_quaternion() @ Vector((0.0, 0.0, 1.0))
        expected = (-math.cos(math.radians(10.0)), 0.0, math.sin(math.radians(10.0)))
        np.testing.assert_allclose(towards, expected, atol=1e-5)

    def test_refused_before_a_build(self):
        ops.clear()
        for operator in (ops.turntable, ops.animate_stages):
            with self.assertRaisesRegex(RuntimeError, "press Build first"):
                operator()


class Stages(Case):
    def volumes(self):
        return {name: volume(item.data) for name, item in self.blocks().items() if item.data.polygons}

    def assert_shows(self, stage):
        model = self.model if stage == 4 else self.model.stage(stage)
        expected = {block.name: block.volume for block in model.blocks if block.volume > 0}
        found = self.volumes()
        self.assertEqual(set(found), set(expected))
        for name in expected:
            self.assertAlmostEqual(found[name] / expected[name], 1.0, places=3)

    def test_each_stage_is_shown_for_its_frames(self):
        ops.animate_stages(frames=3)
        self.assertEqual((self.scene.frame_start, self.scene.frame_end), (1, 15))
        self.assertTrue(self.scene.render.use_lock_interface)
        self.assertIn("Lock Interface", ops.animate_stages.get_rna_type().description)
        self.assertEqual(self.settings.stage, 4)
        self.assert_shows(4)
        for frame, stage in ((1, 0), (3, 0), (4, 1), (9, 2), (12, 3), (13, 4), (15, 4)):
            self.scene.frame_set(frame)
            self.assert_shows(stage)

    def test_keyframes_are_replaced(self):
        self.scene.keyframe_insert("realmodel.stage", frame=50)
        self.scene.keyframe_insert("realmodel.explode", frame=7)
        ops.animate_stages(frames=3)
        ops.animate_stages(frames=2)
        curves = versions.curves(self.scene)
        self.assertEqual({curve.data_path for curve in curves}, {"realmodel.stage", "realmodel.explode"})
        points = curves.find("realmodel.stage").keyframe_points
        self.assertEqual([tuple(p.co) for p in points], [(1 + 2 * n, n) for n in range(5)])
        self.assertEqual({p.interpolation for p in points}, {"CONSTANT"})

    def test_the_longer_animation_gives_the_range(self):
        ops.turntable(frames=30)
        ops.animate_stages(frames=3)
        self.assertEqual(self.scene.frame_end, 30)
        ops.animate_stages(frames=8)
        self.assertEqual(self.scene.frame_end, 40)
        ops.turntable(frames=12)
        self.assertEqual(self.scene.frame_end, 40)
        self.assertEqual(len(bpy.data.actions), 2)

    def test_a_rendered_animation_grows_and_turns(self):
        self.look_from_the_south(32)  # skips where nothing can render
        render = self.scene.render
        render.resolution_x, render.resolution_y = 96, 60
        self.settings.view.show_legend = False
        ops.animate_stages(frames=1)
        ops.turntable(frames=5, scene_settings=True)
        self.scene.objects["RealModel Ground"].hide_render = True
        self.scene.cycles.samples, self.scene.cycles.use_denoising = 1, False
        render.film_transparent, render.image_settings.color_mode = True, "RGB"
        render.image_settings.file_format = "PNG"
        render.filepath = str(self.folder / "frame_")
        render.use_file_extension = True
        bpy.ops.render.render(animation=True)
        files = sorted(self.folder.glob("frame_*.png"))
        self.assertEqual(len(files), 5)
        images = [pixels(file) for file in files]
        rock = [(image.max(axis=2) > 0.02).sum() for image in images]
        self.assertGreater(min(rock), 20)
        self.assertGreater(rock[2], 1.1 * rock[0])
        for a, b in itertools.pairwise(images):
            self.assertGreater(np.abs(a - b).max(), 0.1)
