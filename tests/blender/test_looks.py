# SPDX-License-Identifier: GPL-3.0-or-later
"""Rock looks: chosen by name, rendered, with the colors of the library."""

import os
import subprocess
import sys
from pathlib import Path

import bpy
import numpy as np
import render_eevee
from blender_state import empty_file
from panel_case import PanelCase, ops, stack
from realmodel.bl.objects import materials
from realmodel.bl.shading import looks
from realmodel.core.project.looks import LOOKS

PIXELS = 64
FOR_EEVEE = ("FLAT", "SHALE", "GRAVEL")  # each with a texture takes seconds on a processor


class Looks(PanelCase):
    def setUp(self):
        super().setUp()
        stack(0.0, 20.0, 40.0)
        self.model.library.clear()
        for name, rock, color in (("lower", "shale", (0.4, 0.4, 0.5)), ("Coal seam", "", (0.5, 0.4, 0.3))):
            ops.library_add(name=name)
            self.model.library[-1].rock, self.model.library[-1].color = rock, color
        for number in (1, 2):
            self.model.rocks[0].surfaces[number].property_id = self.model.library[number - 1].id
        ops.build()

    def material(self, number):
        return bpy.data.objects[f"S{number} block"].data.materials[0]

    def rendered(self):
        """(height, width, 3) of the blocks seen from the south, without the legend."""
        for item in self.scene.objects:
            item.hide_render = item.get("realmodel") == "interface"
        if self.scene.camera is None:
            camera = bpy.data.cameras.new("camera")
            camera.type, camera.ortho_scale = "ORTHO", 40.0
            item = bpy.data.objects.new("camera", camera)
            middle = self.scene["realmodel_origin"]
            item.location = (50.0 - middle[0], -200.0 - middle[1], 20.0 - middle[2])
            item.rotation_euler = (np.pi / 2, 0.0, 0.0)
            lamp = bpy.data.objects.new("lamp", bpy.data.lights.new("lamp", "SUN"))
            lamp.rotation_euler = (np.pi / 2 - 0.7, 0.0, 0.5)
            lamp.data.energy, lamp.data.angle = 3.0, 0.0
            for each in (item, lamp):
                self.scene.collection.objects.link(each)
            self.scene.camera = item
            self.scene.world = None
        render = self.scene.render
        render.engine = "CYCLES"
        self.scene.cycles.samples, self.scene.cycles.use_denoising = 8, False
        render.resolution_x = render.resolution_y = PIXELS
        render.resolution_percentage = 100
        render.filepath = str(self.folder / "look.png")
        render.image_settings.file_format = "PNG"
        bpy.ops.render.render(write_still=True)
        image = bpy.data.images.load(render.filepath)
        pixels = np.array(image.pixels[:], np.float32).reshape(PIXELS, PIXELS, -1)[:, PIXELS // 2 :, :3]
        bpy.data.images.remove(image)
        return pixels

    def test_they_are_chosen_by_name_and_kept_by_builds(self):
        ops.rock_looks()
        self.assertEqual([self.material(n)[looks.KEY] for n in (1, 2)], ["SHALE", "COAL"])
        ops.build()
        self.assertEqual(self.material(1)[looks.KEY], "SHALE")
        self.assertEqual(self.material(1)[materials.KEY], self.model.library[0].id)

    def test_only_the_active_property(self):
        self.model.active_property = 1
        ops.rock_looks(look="GRASS", only_active=True)
        self.assertEqual(self.material(2)[looks.KEY], "GRASS")
        self.assertNotIn(looks.KEY, self.material(1))

    def test_laminae_lie_level_in_level_layers(self):
        ops.rock_looks(look="FLAT")
        flat = self.rendered()
        ops.rock_looks(look="SHALE", scale=20.0)
        laminated = self.rendered()
        lower = slice(4, PIXELS // 2 - 4)  # rows of one block
        plain = flat[lower].std(axis=(0, 1)).max()
        self.assertLess(plain, 0.01)
        mean = laminated[lower].mean(axis=1)
        self.assertGreater(mean.std(axis=0).max(), 3.0 * plain)
        along = laminated[lower] - mean[:, None]
        self.assertGreater(mean.std(axis=0).max(), along.std(axis=1).mean())
        ops.rock_looks(look="SHALE", scale=20.0, seed=5)
        self.assertGreater(np.abs(self.rendered() - laminated).max(), 0.02)

    def test_every_look_renders_in_the_color_of_its_property(self):
        self.assertEqual(len(LOOKS), 15)
        for key in LOOKS:
            ops.rock_looks(look=key)
            found = self.rendered()[4 : PIXELS // 2 - 4].mean(axis=(0, 1))
            self.assertLess(found.max(), 0.95, key)  # no missing texture, which is pink
            self.assertGreater(found.min(), 0.02, key)
            if key != "GRASS":  # which is brown below the ground
                self.assertGreater(found[2], 0.95 * found[0], key)

    def test_eevee_renders_looks(self):
        """In the color of the property, textured; laminae along the layers. In a process of its own: OpenGL
        may be missing in ways that end Blender."""
        keys = tuple(LOOKS) if os.environ.get("EVERY_LOOK") else FOR_EEVEE
        file, script = self.folder / "eevee.png", Path(render_eevee.__file__)
        command = [
            bpy.app.binary_path,
            "-b",
            "--factory-startup",
            "--python-exit-code",
            "1",
            "-P",
            script,
            "--",
        ]
        if not bpy.app.binary_path:
            command = [sys.executable, script, "--"]
        done = subprocess.run([*command, file, *keys], capture_output=True, text=True, check=False)
        if not file.is_file():
            self.fail(f"{done.stdout[-2000:]}{done.stderr[-2000:]}")
        image = bpy.data.images.load(str(file))
        width, height = image.size
        pixels = np.array(image.pixels[:], np.float32).reshape(height, width, -1)[:, :, :3]
        bpy.data.images.remove(image)
        side = render_eevee.TILE
        for number, key in enumerate(keys):
            row, column = (place * side for place in divmod(number, render_eevee.COLUMNS))
            tile = pixels[row + 4 : row + side - 4, column + 4 : column + side - 4]
            red, green, blue = tile.mean(axis=(0, 1))
            self.assertGreater(blue, max(red, 0.05), key)  # neither pink nor black
            self.assertGreater(green, 0.05, key)
            spread = tile.std(axis=(0, 1)).max()
            (self.assertLess if key == "FLAT" else self.assertGreater)(spread, 0.004, key)
            if key == "SHALE":
                level, across = (tile.mean(axis=axis).std(axis=0).max() for axis in (1, 0))
                self.assertGreater(level, 2.0 * across)

    def test_a_changed_color_reaches_the_look(self):
        ops.rock_looks()
        self.model.library[0].color = (1.0, 0.0, 0.0)
        found = self.rendered()[4 : PIXELS // 2 - 4].mean(axis=(0, 1))
        self.assertGreater(found[0], 3 * found[2])

    def test_refused_without_blocks(self):
        ops.clear()
        self.refused(ops.rock_looks, "no block has these properties")

    def test_the_library_says_the_look(self):
        lower, coal = self.model.library
        coal.look, coal.look_scale, coal.look_seed, coal.hardness = "SALT", 0.3, 7, 0.45
        self.assertEqual(self.material(2)[looks.KEY], "SALT")
        self.assertNotIn(looks.KEY, self.material(1))
        lower.look = "AUTO"
        self.assertEqual(self.material(1)[looks.KEY], "SHALE")
        lower.rock = "granite"
        self.assertEqual(self.material(1)[looks.KEY], "GRANITE")
        path = str(self.folder / "m.toml")
        ops.save_project(filepath=path)
        text = (self.folder / "m_library.toml").read_text()
        for line in (
            'look = "auto"',
            'look = "salt"',
            "look_scale = 0.3",
            "look_seed = 7",
            "hardness = 0.45",
        ):
            self.assertEqual(text.count(f"{line}\n"), 1, line)
        empty_file()
        ops.open_project(filepath=path)
        ops.build()
        self.assertEqual([self.material(n)[looks.KEY] for n in (1, 2)], ["GRANITE", "SALT"])
        self.assertEqual(list(self.material(2)[looks.TEXTURE]), [float(np.float32(0.3)), 7.0])

    def test_nodes_of_the_user_stay_until_another_look_is_chosen(self):
        ops.rock_looks(look="SALT")
        tree = self.material(1).node_tree
        tree.nodes.new("ShaderNodeValue").name = "mine"
        ops.build()
        self.assertIn("mine", tree.nodes)
        self.model.library[0].look_seed = 3
        self.assertNotIn("mine", tree.nodes)
