# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene in other programs: names, materials and custom properties, as trimesh and Pixar's USD read them
in the tests' own Python (build/venv)."""

import json
import subprocess
import unittest
import unittest.mock
from pathlib import Path

import bpy
import numpy as np
from blender_state import inventory
from panel_case import PanelCase, ops, select, stack
from realmodel.bl.objects.materials import linear_color
from realmodel.bl.scene import scene_export
from realmodel.bl.shading import looks
from realmodel.core import InputRefused
from realmodel.core.project.looks import hex_color

FOLDER = Path(__file__).resolve().parent
READER = FOLDER.parents[1] / "build" / "venv" / "bin" / "python"
SIZE = 128
SAND, COAL = (0.8, 0.6, 0.3), (0.2, 0.15, 0.1)


def seen_in(path):
    """The output of read_scene.py for a file. Skips the test where it is not there."""
    if not READER.is_file():
        raise unittest.SkipTest(f"there is no {READER}: scripts/test.sh makes it")
    command = [str(READER), str(FOLDER / "read_scene.py"), str(path)]
    done = subprocess.run(command, capture_output=True, text=True, env={"PATH": "/usr/bin:/bin"})
    if done.returncode == 3:
        raise unittest.SkipTest(done.stdout.strip())
    if done.returncode:
        raise AssertionError(done.stderr)
    return json.loads(done.stdout)


class SceneExport(PanelCase):
    def setUp(self):
        super().setUp()
        stack(0.0, 20.0, 40.0)
        self.model.library.clear()
        for number, (name, color) in enumerate((("Grès d'été", SAND), ("Coal seam", COAL)), 1):
            ops.library_add(name=name)
            row = self.model.library[-1]
            row.color, row.age, row.has_color = color, f"age {number}", True
            self.model.rocks[0].surfaces[number].property_id = row.id
        ops.build()
        ops.rock_looks()
        if "gltf" not in dir(bpy.ops.export_scene):
            bpy.ops.preferences.addon_enable(module="io_scene_gltf2")

    def assert_as_it_was(self, before):
        after = inventory()
        self.assertEqual([key for key in before | after if before.get(key) != after.get(key)], [])

    def exported(self, ending, **options):
        """What a reader sees of the exported model, by the names of blocks."""
        path = self.folder / f"model.{ending}"
        before = inventory()
        selected = [item.name for item in bpy.context.selected_objects]
        self.assertEqual(ops.export_scene(filepath=str(path), picture_size=SIZE, **options), {"FINISHED"})
        self.assert_as_it_was(before)
        self.assertEqual([item.name for item in bpy.context.selected_objects], selected)
        self.assertEqual(bpy.context.mode, "OBJECT")
        return seen_in(path)

    def assert_whole(self, found, is_obj=False):
        if is_obj:  # for which Blender writes no spaces
            found = {name.replace("_", " "): seen for name, seen in found.items()}
        self.assertEqual(sorted(found), ["S1 block", "S2 block"])
        for number, (block, name, color) in enumerate(
            (("S1 block", "Grès d'été", SAND), ("S2 block", "Coal seam", COAL)), 1
        ):
            seen = found[block]
            self.assertAlmostEqual(seen["volume"], 2e5, delta=1.0)
            self.assertEqual(seen["material"], name.replace(" ", "_") if is_obj else name)
            if not is_obj:
                own = seen["properties"]
                self.assertEqual(own["realmodel_property"], self.model.library[number - 1].id)
                self.assertEqual(own["realmodel_block"], block)
                self.assertEqual(own["realmodel_name"], name)
                self.assertEqual(own["realmodel_property_age"], f"age {number}")
            yield seen, linear_color(hex_color(color))

    def assert_colored(self, found, **options):
        for seen, color in self.assert_whole(found, **options):
            np.testing.assert_allclose(seen["color"], color, atol=0.01)
            self.assertIsNone(seen["picture"])

    def assert_pictured(self, found, **options):
        for seen, color in self.assert_whole(found, **options):
            mean, deviation = (np.array(seen["picture"][key]) for key in ("mean", "deviation"))
            np.testing.assert_allclose(mean, color, rtol=0.35, atol=0.015)  # beds differ
            self.assertGreater(deviation.max(), 0.02 * mean.max())
            np.testing.assert_allclose(seen["color"], 1.0, atol=0.01)

    def test_gltf(self):
        self.assert_pictured(self.exported("glb"))
        self.assertEqual([path.name for path in self.folder.iterdir()], ["model.glb"])

    def test_gltf_without_pictures(self):
        self.assert_colored(self.exported("glb", bake_looks=False))

    def test_obj(self):
        select(bpy.data.objects["S1"])
        self.assert_pictured(self.exported("obj"), is_obj=True)
        self.assertEqual(len(list(self.folder.glob("model_*_color.png"))), 2)

    def test_obj_without_pictures(self):
        self.assert_colored(self.exported("obj", bake_looks=False), is_obj=True)

    def test_usd(self):
        if not bpy.app.build_options.usd:
            with unittest.mock.patch.object(
                scene_export, "Baking", side_effect=AssertionError
            ):  # before that
                self.refused(ops.export_scene, "cannot write USD", filepath=str(self.folder / "m.usda"))
            self.skipTest("this Blender cannot write USD")
        self.assert_pictured(self.exported("usdc"))
        self.assert_colored(self.exported("usda", bake_looks=False))

    def test_blenders_own_export_has_the_colors_of_looks(self):
        path = self.folder / "own.glb"
        select(*(bpy.data.objects[f"S{n} block"] for n in (1, 2)))
        bpy.ops.export_scene.gltf(filepath=str(path), use_selection=True, export_extras=True)
        for block, color in (("S1 block", SAND), ("S2 block", COAL)):
            seen = seen_in(path)[block]
            np.testing.assert_allclose(seen["color"], linear_color(hex_color(color)), atol=0.01)
            self.assertIn("realmodel_property", seen["properties"])

    def test_only_what_is_displayed_and_selected(self):
        bpy.data.objects["S1 block"].hide_set(True)
        self.assertEqual(list(self.exported("glb")), ["S2 block"])
        select(bpy.data.objects["S1"])
        path = str(self.folder / "none.glb")
        self.refused(ops.export_scene, "no object of the model", filepath=path, only_selected=True)
        self.assertFalse(Path(path).exists())

    def test_displaced_blocks_and_those_without_a_look(self):
        ops.rock_looks(look="FLAT")
        self.model.explode = 1.0
        seen = self.exported("glb")
        self.assertEqual({block["picture"] for block in seen.values()}, {None})
        self.assertGreater(seen["S2 block"]["low"][1], seen["S1 block"]["high"][1])  # y is up in glTF

    def test_weathered_blocks_have_a_picture_for_each_material(self):
        """Grass lies on the ground of the upper block, whose walls are coal."""
        ops.weathering(strength=0.2, detail=2, grass_slope=0.5, scree_slope=0.0)
        found = {seen["material"]: seen["picture"] for seen in self.exported("glb").values()}
        self.assertEqual(sorted(found), ["Coal seam", "Grass", "Grès d'été"])
        red, green, blue = found["Grass"]["mean"]
        self.assertGreater(green, 1.2 * max(red, blue))
        for name, color in (("Grès d'été", SAND), ("Coal seam", COAL)):
            color = linear_color(hex_color(color))
            np.testing.assert_allclose(found[name]["mean"], color, rtol=0.35, atol=0.015)

    def test_where_it_fails_the_scene_is_as_it_was(self):
        before = inventory()
        path = str(self.folder / "nowhere" / "m.glb")
        self.refused(ops.export_scene, "there is no folder", filepath=path)
        with unittest.mock.patch.object(looks, "show_pictures", side_effect=InputRefused("no picture")):
            self.refused(
                ops.export_scene, "no picture", filepath=str(self.folder / "m.glb"), picture_size=SIZE
            )
        self.assert_as_it_was(before)
        self.assertEqual(list(self.folder.iterdir()), [])
