# SPDX-License-Identifier: GPL-3.0-or-later
"""The asset library of the rock looks and of the presets of Fill with Strata."""

import bpy
import numpy as np
from panel_case import PanelCase, ops
from realmodel.bl.shading import look_assets, looks, strata_presets
from realmodel.core.project.looks import LOOKS
from realmodel.ui.menu import REALMODEL_MT_object


class LookAssets(PanelCase):
    def setUp(self):
        super().setUp()
        known = bpy.context.preferences.filepaths.asset_libraries
        before = [library.name for library in known]
        self.addCleanup(self.forget, before)

    @staticmethod
    def forget(before):
        known = bpy.context.preferences.filepaths.asset_libraries
        for number in reversed(range(len(known))):
            if known[number].name not in before:
                bpy.ops.preferences.asset_library_remove(index=number)

    def libraries(self):
        known = bpy.context.preferences.filepaths.asset_libraries
        return [library for library in known if str(self.folder) in library.path]

    def test_the_search_finds_the_command_without_a_model(self):
        entries = REALMODEL_MT_object.entries(None, bpy.context)
        self.assertIn("install_looks", [entry[0] for entry in entries if entry is not None])

    def test_materials_are_assets_with_a_catalog_and_previews(self):
        ops.install_looks(directory=str(self.folder))
        self.assertFalse([m.name for m in bpy.data.materials])
        self.assertEqual([library.name for library in self.libraries()], [look_assets.LIBRARY])
        path = self.folder / look_assets.FILE
        self.assertLess(path.stat().st_size, 2e6)
        with bpy.data.libraries.load(str(path), assets_only=True) as (found, wanted):
            known = [look.label for look in LOOKS.values()]
            known += [f"{label} Strata" for label, _ in strata_presets.PRESETS.values()]
            self.assertEqual(sorted(found.materials), sorted(known))
            wanted.materials = found.materials
        catalogs = (self.folder / look_assets.CATALOGS).read_text()
        seen = set()
        for material in wanted.materials:
            if (preset := material.get(strata_presets.KEY)) is None:
                self.assertIn(f"{material.asset_data.catalog_id}:Rock Looks:", catalogs)
                self.assertEqual(LOOKS[material[looks.KEY]].label, material.name)
            else:
                self.assertIn(f"{material.asset_data.catalog_id}:Strata:", catalogs)
                self.assertEqual(f"{strata_presets.PRESETS[preset][0]} Strata", material.name)
            pixels = np.array(material.preview.image_pixels_float[:])
            self.assertEqual(len(pixels), 4 * 128 * 128)
            self.assertGreater(pixels.reshape(-1, 4)[:, :3].std(), 0.02)
            seen.add(pixels.tobytes())
        self.assertEqual(len(seen), len(known))

    def test_a_mesh_has_the_preset_of_its_material(self):
        bpy.ops.mesh.primitive_cube_add()
        item = bpy.context.object
        self.assertIsNone(strata_presets.of_item(item))
        for material in (bpy.data.materials.new("plain"), strata_presets.material("OVERTURNED")):
            item.data.materials.append(material)
        self.assertEqual(strata_presets.of_item(item), "OVERTURNED")

    def test_a_material_has_layers_on_an_object_that_has_none(self):
        """Its laminae follow the height in the object."""
        ops.install_looks(directory=str(self.folder))
        with bpy.data.libraries.load(str(self.folder / look_assets.FILE), assets_only=True) as (_, wanted):
            wanted.materials = ["Shale"]
        bpy.ops.mesh.primitive_cube_add(size=4.0)
        bpy.context.object.data.materials.append(wanted.materials[0])
        camera = bpy.data.cameras.new("camera")
        camera.type, camera.ortho_scale = "ORTHO", 3.0
        eye = bpy.data.objects.new("camera", camera)
        eye.location, eye.rotation_euler = (0.0, -20.0, 0.0), (np.pi / 2, 0.0, 0.0)
        lamp = bpy.data.objects.new("lamp", bpy.data.lights.new("lamp", "SUN"))
        lamp.rotation_euler, lamp.data.energy = (np.pi / 2 - 0.5, 0.0, 0.4), 3.0
        for item in (eye, lamp):
            self.scene.collection.objects.link(item)
        self.scene.camera, render = eye, self.scene.render
        render.engine, render.resolution_percentage = "CYCLES", 100
        self.scene.cycles.samples, self.scene.cycles.use_denoising = 4, False
        render.resolution_x = render.resolution_y = 48
        render.filepath = str(self.folder / "cube.png")
        bpy.ops.render.render(write_still=True)
        image = bpy.data.images.load(render.filepath)
        pixels = np.array(image.pixels[:], np.float32).reshape(48, 48, -1)[:, :, 1]
        self.assertGreater(pixels.mean(axis=1).std(), 2.0 * pixels.mean(axis=0).std())

    def test_twice_is_one_library(self):
        ops.install_looks(directory=str(self.folder))
        ops.install_looks(directory=str(self.folder))
        self.assertEqual(len(self.libraries()), 1)
        self.assertEqual(len(list(self.folder.iterdir())), 2)

    def test_a_folder_that_cannot_be_written(self):
        (self.folder / "file").write_text("")
        before = len(bpy.data.materials)
        self.refused(ops.install_looks, "file", directory=str(self.folder / "file"))
        self.assertEqual(len(bpy.data.materials), before)
        self.assertFalse(self.libraries())
