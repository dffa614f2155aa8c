# SPDX-License-Identifier: GPL-3.0-or-later
"""The hero scenes of blend_samples: they open without the add-on's help, complete, and are small."""

import unittest
from pathlib import Path

import bpy
from blender_state import open_edges

FOLDER = Path(__file__).resolve().parents[2] / "blend_samples" / "heroes"
NAMES = ("arch", "badlands", "canyon", "island", "quarry", "sea_cliff")
MOST = 3_000_000  # bytes of a file


class HeroScenes(unittest.TestCase):
    def test_there_are_six_small_files(self):
        files = sorted(FOLDER.glob("*.blend"))
        self.assertEqual([file.stem for file in files], list(NAMES))
        for file in files:
            self.assertLessEqual(file.stat().st_size, MOST, file.name)

    def test_they_are_complete(self):
        for name in NAMES:
            with self.subTest(name):
                bpy.ops.wm.open_mainfile(filepath=str(FOLDER / f"{name}.blend"), load_ui=False)
                scene = bpy.context.scene
                self.assertEqual(scene.camera.type, "CAMERA")
                self.assertTrue(any(item.type == "LIGHT" for item in scene.objects))
                self.assertTrue(scene.world.use_nodes)
                self.assertEqual(len(bpy.data.libraries), 0)
                self.assertEqual([image.name for image in bpy.data.images if image.source == "FILE"], [])
                self.assertTrue(any(item.name.startswith("Figure") for item in scene.objects))
                self.assertEqual(bpy.utils.blend_paths(absolute=False), [])
                self._check_strata(scene)

    def _check_strata(self, scene):
        """Each object with strata has its modifier and an eroded mesh, or closed beds."""
        filled = [item for item in scene.objects if "realmodel_bed" in item]
        strata = [item for item in scene.objects if any(m.name == "Strata" for m in item.modifiers)]
        self.assertTrue(strata)
        for item in strata:
            self.assertTrue(open_edges(item.data) == 0, item.name)
        for bed in filled:
            self.assertTrue(open_edges(bed.data) == 0, bed.name)
        if not filled:
            eroded = [mesh for mesh in bpy.data.meshes if " Eroded" in mesh.name]
            self.assertEqual(len(eroded), len(strata))
            for mesh in eroded:
                self.assertGreater(len(mesh.polygons), 10_000, mesh.name)
