# SPDX-License-Identifier: GPL-3.0-or-later
"""The picture: every block is seen in its color, and the scene is left alone."""

import colorsys
import tempfile
from pathlib import Path
from types import SimpleNamespace

import bpy
import numpy as np
from blender_state import empty_file, inventory, pixels
from bpy_extras.object_utils import world_to_camera_view
from made_projects import LIBRARY, other_rock, surface, two_rocks
from mathutils import Matrix, Vector
from panel_case import PanelCase, ops
from realmodel.bl.display import colors, viewpoints
from realmodel.bl.host import versions
from realmodel.bl.pictures import batch, picture
from realmodel.bl.scene import built_scene
from realmodel.core import OutputFailed, Project, Rock, build
from realmodel.operators.pictures import set_up_first


def share_of_hue(image, color, tolerance=0.05):
    """Part of a picture's pixels that have the hue of "#rrggbb" and are not grey."""
    wanted = colorsys.rgb_to_hsv(*(int(color[i : i + 2], 16) / 255.0 for i in (1, 3, 5)))[0]
    flat = image.reshape(-1, 3)
    hsv = np.array([colorsys.rgb_to_hsv(*(float(c) for c in pixel)) for pixel in flat])
    away = np.abs((hsv[:, 0] - wanted + 0.5) % 1.0 - 0.5)
    return float(np.mean((away < tolerance) & (hsv[:, 1] > 0.3)))


class Render(PanelCase):
    def render(self, model, size=(240, 150)):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "picture.png.part"
            batch.write_scene(model)
            before = inventory()
            factor = batch.render(path, size, samples=8)
            self.assertEqual(inventory(), before, "rendering changed the file")
            self.assertEqual([p.name for p in Path(folder).iterdir()], ["picture.png.part"])
            self.assertEqual(path.read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
            image = pixels(path)
        self.assertEqual(image.shape, (size[1], size[0], 3))
        return factor, image

    def assert_all_seen(self, model, image):
        for number in {block.property for block in model.blocks if block.cells} - {0}:
            color = LIBRARY.get(number).color
            self.assertGreater(share_of_hue(image, color), 0.002, f"property {number}, {color}")

    def test_every_block_is_seen_in_its_color(self):
        empty_file()
        model = build(two_rocks())
        factor, image = self.render(model)
        self.assertEqual(factor, 1.0)
        self.assert_all_seen(model, image)

    def test_the_model_fills_the_frame(self):
        empty_file()
        _, image = self.render(build(two_rocks()))
        colored = np.ptp(image, axis=2) > 0.15
        columns, rows = colored.any(axis=0), colored.any(axis=1)
        self.assertGreater(max(np.ptp(np.flatnonzero(seen)) / len(seen) for seen in (columns, rows)), 0.7)
        for edge in (colored[0], colored[-1], colored[:, 0], colored[:, -1]):
            self.assertFalse(edge.any(), "the model is cut off by the frame")

    def test_a_lens_deep_inside_is_brought_to_light(self):
        empty_file()

        def lens(x, y):
            return 9.0 + 6.0 * max(0.0, 1.0 - ((x - 30.0) ** 2 + (y - 55.0) ** 2) / 150.0)

        rock = Rock(
            "r",
            [
                surface("S0", lambda x, y: 10.0, property=1),
                surface("S1", lens, property=3, grid={"columns": 40, "rows": 30}),
                surface("S2", lambda x, y: 20.0, property=2),
            ],
            base_elevation=0.0,
        )
        model = build(Project("Lens", [rock], LIBRARY))
        _, image = self.render(model)
        self.assert_all_seen(model, image)

    def test_a_flat_model_is_exaggerated(self):
        empty_file()
        flat = other_rock()
        for given in flat.surfaces:
            given.vertices[:, 2] *= 0.02
        factor, _ = self.render(build(Project("Flat", [flat], LIBRARY)), (160, 100))
        self.assertEqual(factor, 50.0)  # 0.3 high, 80 wide

    def test_an_empty_scene_is_refused(self):
        empty_file()
        with tempfile.TemporaryDirectory() as folder:
            with self.assertRaisesRegex(OutputFailed, "no block"):
                batch.render(Path(folder) / "p.png")
            self.assertEqual(list(Path(folder).iterdir()), [])

    def test_a_folder_that_is_not_there(self):
        batch.write_scene(build(two_rocks()))
        before = inventory()
        with self.assertRaises(OutputFailed):
            batch.render("/nowhere/p.png", (16, 10), samples=1)
        with self.assertRaises(OutputFailed):
            batch.save_blend("/nowhere/m.blend")
        self.assertEqual(inventory(), before)

    def test_sizes_of_any_shape_frame_the_model(self):
        points = np.random.default_rng(3).random((500, 3)) * (80.0, 50.0, 20.0)
        for size in ((1600, 1000), (400, 900), (500, 500)):
            matrix, distance = picture.camera_matrix(points, size)
            self.assertGreater(distance, 0.0)
            inverse = np.array(matrix.inverted())
            local = points @ inverse[:3, :3].T + inverse[:3, 3]
            tangents = np.array(size) / max(size) * np.tan(picture.FIELD_OF_VIEW / 2.0)
            reach = np.abs(local[:, :2] / -local[:, 2:]) / tangents
            self.assertLess(reach.max(), 1.0)
            self.assertGreater(reach.max(), 0.85)

    def test_the_legend_has_properties_from_above_as_in_the_rock_masses(self):
        rocks = []
        for east, ids in ((0.0, (2, 3)), (200.0, (4, 2))):
            levels = [surface(f"S{n}", lambda x, y, n=n: 9.0 * n, grid={"x0": east}) for n in range(3)]
            for level, number in zip(levels[1:], ids, strict=True):
                level.property = number
            rocks.append(Rock(f"at {east}", levels))
        batch.write_scene(build(Project("two", rocks, LIBRARY)))
        names = [name for name, _ in colors.key(self.scene).entries]
        self.assertEqual(names, ["Sandstone", "Marl", "Gravel"])

    def test_a_legend_takes_width_only_where_it_would_cover_the_model(self):
        size, corner = (1600, 1000), (0.2, 0.25)
        box = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
        self.assertEqual(picture.left_of_points(box * (900.0, 50.0, 20.0), size, corner), 0.0)
        # A tower fills the height of the picture, but only its middle.
        self.assertEqual(picture.left_of_points(box * (20.0, 20.0, 400.0), size, corner), 0.0)
        floor = box * (80.0, 80.0, 1.0)
        self.assertEqual(picture.left_of_points(floor, size, (0.5, 0.6)), 0.5)


class SetUp(PanelCase):
    def scene_settings(self):
        scene = self.scene
        return scene.world, scene.render.engine, scene.view_settings.view_transform

    def test_only_an_empty_scene_gets_a_world_and_a_renderer_unasked(self):
        def mesh():
            self.scene.collection.objects.link(bpy.data.objects.new("tree", bpy.data.meshes.new("tree")))

        def lamp():
            lamp = bpy.data.objects.new("lamp", bpy.data.lights.new("lamp", "SUN"))
            self.scene.collection.objects.link(lamp)

        def world():
            self.scene.world = bpy.data.worlds.new("mine")

        def engine():
            self.scene.render.engine = "BLENDER_WORKBENCH"

        def transform():
            self.scene.view_settings.view_transform = "Raw"

        def nothing():
            pass

        for own in (mesh, lamp, world, engine, transform, nothing):
            for operator in (ops.set_up_picture, ops.turntable):
                with self.subTest(own.__name__):
                    bpy.ops.wm.read_homefile(use_factory_startup=True)
                    built_scene.write_model(self.scene, build(two_rocks()))
                    own()
                    before = self.scene_settings()
                    operator()
                    self.assertEqual(self.scene_settings() == before, own is not nothing)
                    self.assertTrue(any(picture.KEY in item for item in self.scene.objects))
                    operator(scene_settings=True)
                    self.assertIn(picture.KEY, self.scene.world)
                    self.assertEqual(self.scene_settings()[1:], ("CYCLES", "Standard"))

    def test_camera_and_sun_for_the_next_render(self):
        batch.write_scene(build(two_rocks()))
        own = bpy.data.objects.new("mine", bpy.data.cameras.new("mine"))
        self.scene.collection.objects.link(own)
        self.scene.camera = own
        before = self.scene_settings()
        ops.set_up_picture(view="MODEL")
        camera = self.scene.camera
        self.assertNotEqual(camera, own)
        self.assertIn("mine", self.scene.objects)
        self.assertEqual(self.scene_settings(), before)
        ops.set_up_picture(view="MODEL", scene_settings=True)
        self.assertNotEqual(self.scene_settings()[0], before[0])
        self.assertEqual(self.scene.camera, camera)
        self.assertEqual(len([o for o in self.scene.objects if o.type in ("CAMERA", "LIGHT")]), 3)
        before = inventory()
        render = self.scene.render
        render.resolution_x, render.resolution_y, render.filepath = 240, 150, str(self.folder / "f12.png")
        self.scene.cycles.samples = 8
        ops.render_picture()
        bpy.ops.render.render(write_still=True)
        self.assertEqual(set(inventory()) - set(before), {("images", "Render Result")})
        image = pixels(self.folder / "f12.png")
        for number in (1, 2, 3):
            self.assertGreater(share_of_hue(image, LIBRARY.get(number).color), 0.002, number)

    def test_a_camera_that_looks_elsewhere_is_told_from_one_of_the_model(self):
        batch.write_scene(build(two_rocks()))
        self.assertFalse(viewpoints.camera_sees(self.scene))
        ops.set_up_picture(view="MODEL")
        bpy.context.view_layer.update()
        self.assertTrue(viewpoints.camera_sees(self.scene))
        self.scene.camera.matrix_world = Matrix.Translation((1e5, 0.0, 0.0))
        bpy.context.view_layer.update()
        self.assertFalse(viewpoints.camera_sees(self.scene))

    def test_a_cut_model_is_in_the_middle_of_its_picture(self):
        batch.write_scene(build(two_rocks()))
        ops.section_plane(axis="X")
        plane = self.model.view.plane
        plane.location.x -= 0.25 * np.ptp(viewpoints.model_points(self.scene)[:, 0])
        ops.section_update()
        whole, left = viewpoints.model_points(self.scene), viewpoints.model_points(self.scene, cut=True)
        self.assertLess(left[:, 0].max(), whole[:, 0].max() - 1.0)
        self.model.view.show_legend = False
        ops.set_up_picture(view="MODEL")
        bpy.context.view_layer.update()
        seen = [world_to_camera_view(self.scene, self.scene.camera, Vector(place)) for place in left]
        for axis in "xy":
            middle = sum(f(getattr(at, axis) for at in seen) for f in (min, max)) / 2
            self.assertAlmostEqual(middle, 0.5, delta=0.02)

    def test_the_legend_is_in_every_picture(self):
        batch.write_scene(build(two_rocks()))
        self.model.view.show_north = self.model.view.show_scale = self.model.view.show_axes = True
        ops.set_up_picture(view="MODEL")
        render = self.scene.render
        render.resolution_x, render.resolution_y, render.filepath = 480, 300, str(self.folder / "f12.png")
        render.image_settings.file_format = "PNG"
        self.scene.cycles.samples = 1
        bpy.ops.render.render(write_still=True)
        ops.capture(filepath=str(self.folder / "capture.png"), width=480, height=300)
        batch.render(self.folder / "batch.png", (480, 300), samples=1)
        for name in ("f12", "capture", "batch"):
            paper = pixels(self.folder / f"{name}.png")[-60:, 8:60]
            swatches = np.ptp(paper, axis=2) > 0.3
            self.assertGreater(swatches.mean(), 0.02, name)
            self.assertGreater((paper.min(axis=2) > 0.93).mean(), 0.2, name)
        self.model.view.show_legend = False
        batch.render(self.folder / "none.png", (480, 300), samples=4)
        self.assertEqual((np.ptp(pixels(self.folder / "none.png")[-60:, 8:60], axis=2) > 0.3).mean(), 0.0)

    def test_a_scene_that_writes_videos_since_blender_5_writes_pictures_then(self):
        newer, older = SimpleNamespace(media_type="VIDEO"), SimpleNamespace()
        for settings in (newer, older):
            versions.write_images(settings)
        self.assertEqual((vars(newer), vars(older)), ({"media_type": "IMAGE"}, {}))


class Unasked(PanelCase):
    """Light and camera of the first build from the panel: only where the user has set up none."""

    def begin(self):
        bpy.ops.wm.read_homefile(use_factory_startup=True)
        built_scene.write_model(self.scene, build(two_rocks()))

    def test_the_startup_file_gets_light_and_camera(self):
        self.begin()
        startup = self.scene.camera
        before = np.array(startup.matrix_world)
        self.assertTrue(set_up_first(self.scene))
        self.assertNotEqual(self.scene.camera, startup)
        self.assertEqual(np.array(startup.matrix_world).tobytes(), before.tobytes())
        self.assertTrue(bpy.data.objects["Light"].hide_render and bpy.data.objects["Cube"].hide_render)
        bpy.context.view_layer.update()
        self.assertTrue(viewpoints.camera_sees(self.scene))

    def test_what_is_the_users_stays(self):
        def moved():
            bpy.data.objects["Camera"].location.x += 0.1

        def lamp():
            item = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "SUN"))
            self.scene.collection.objects.link(item)

        def sky():
            self.scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.5

        def picture_as_sky():
            self.scene.world.node_tree.nodes.new("ShaderNodeTexEnvironment")

        def renderer():
            self.scene.render.engine = "BLENDER_WORKBENCH"

        def asked():
            ops.set_up_picture(view="MODEL", sun_azimuth=1.0)

        for change in (moved, lamp, sky, picture_as_sky, renderer, asked):
            with self.subTest(change.__name__):
                self.begin()
                change()
                before = inventory()
                self.assertFalse(set_up_first(self.scene))
                self.assertEqual(inventory(), before)
                self.assertFalse(bpy.data.objects["Light"].hide_render)

    def test_an_edited_cube_is_no_longer_that_of_the_startup_file(self):
        self.begin()
        bpy.data.objects["Cube"].data.vertices[0].co.z = -2.0
        self.assertTrue(set_up_first(self.scene))
        self.assertFalse(bpy.data.objects["Cube"].hide_render)

    def test_another_model_is_framed_until_light_or_camera_is_changed(self):
        def turned():
            self.scene.camera.rotation_euler.z += 0.1

        def dimmed():
            lamps = (item for item in self.scene.objects if item.type == "LIGHT")
            next(lamp for lamp in lamps if picture.KEY in lamp).data.energy = 1.0

        def turning():
            ops.turntable(frames=4)

        for change in (turned, dimmed, turning):
            with self.subTest(change.__name__):
                self.begin()
                self.assertTrue(set_up_first(self.scene))
                built_scene.write_model(self.scene, build(Project("other", [other_rock()], LIBRARY)))
                self.assertTrue(set_up_first(self.scene))
                change()
                self.assertFalse(set_up_first(self.scene))

    def test_without_a_model_nothing_is_added(self):
        bpy.ops.wm.read_homefile(use_factory_startup=True)
        before = inventory()
        self.assertFalse(set_up_first(self.scene))
        self.assertEqual(inventory(), before)
