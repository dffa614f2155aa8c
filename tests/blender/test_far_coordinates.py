# SPDX-License-Identifier: GPL-3.0-or-later
"""A model in map coordinates: what the panel shows and takes are coordinates of the model."""

import bpy
import numpy as np
from blender_state import coordinates
from panel_case import PanelCase, ops
from realmodel.bl.objects import materials
from realmodel.bl.pictures import batch
from realmodel.bl.project import project_settings
from realmodel.core import build, load_project
from realmodel.core.project.looks import hex_color
from realmodel.core.results.automatic_library import PALETTE

PROJECT = """
format = 1
name = "far"
[[rock]]
name = "basin"
region = [[270000, 3912000], [331000, 3912000], [331000, 3965000], [270000, 3965000]]
edge_length = 10000
"""
SURFACE = """
[[rock.surface]]
name = "{name}"
points = "{name}.csv"
method = "constant"
"""


class FarCoordinates(PanelCase):
    def setUp(self):
        super().setUp()
        text = PROJECT
        for name, height in (("S0", -900.0), ("S1", -100.0)):
            (self.folder / f"{name}.csv").write_text(f"x,y,z\n299670,3937895,{height}\n")
            text += SURFACE.format(name=name)
        (self.folder / "project.toml").write_text(text)
        ops.open_project(filepath=str(self.folder / "project.toml"))
        ops.build()

    def test_east_and_north_count_from_one_origin(self):
        np.testing.assert_array_equal(self.scene["realmodel_origin"], [300000.0, 3940000.0, 0.0])
        block = self.model.results[0].object
        x, y, _ = (coordinates(block.data) + np.array(self.scene["realmodel_origin"])).T
        self.assertEqual((x.min(), x.max(), y.min(), y.max()), (270000.0, 331000.0, 3912000.0, 3965000.0))

    def test_the_plane_is_shown_and_moved_in_model_coordinates(self):
        for exaggeration in (1.0, 5.0):
            self.model.view.exaggeration = exaggeration
            ops.section_plane(axis="Y")
            view, plane = self.model.view, self.model.view.plane
            bpy.context.view_layer.update()
            self.assertEqual((view.plane_x, view.plane_y), ("300500.000", "3938500.000"))
            self.assertEqual(view.plane_z, "-500.000")
            view.plane_x, view.plane_y, view.plane_z = "290,000.5", "3920000.25", "-300"
            bpy.context.view_layer.update()
            np.testing.assert_array_equal(plane.location, (-9999.5, -19999.75, -300.0))
            self.assertEqual(view.plane_y, "3920000.250")
            view.plane_y = "here"
            view.plane_y = "nan"
            self.assertEqual(view.plane_y, "3920000.250")
            ops.section()
            made = bpy.context.view_layer.objects.active
            found = coordinates(made.data)[:, 1] + project_settings.model_origin(self.scene)[1]
            np.testing.assert_allclose(found, 3920000.25, atol=0.01)
            ops.section_remove()
            self.assertEqual(view.plane_x, "")

    def test_without_a_library_layers_are_colored_as_imported_points_are(self):
        imported = list(PALETTE[:2])
        self.assertEqual([row.name for row in self.model.library], ["S0", "S1"])
        self.assertEqual([hex_color(row.color) for row in self.model.library], imported)
        block = self.model.results[0]
        self.assertEqual((block.property_id, block.object["realmodel_property"]), (2, 2))
        color = block.object.data.materials[0].diffuse_color[:3]
        np.testing.assert_allclose(color, materials.linear_color(imported[1]), atol=1e-6)

    def test_so_is_what_batch_writes_while_its_exports_keep_what_the_file_says(self):
        model = build(load_project(self.folder / "project.toml"))
        batch.write_scene(model)
        self.assertEqual([row.property_id for row in self.model.results], [2])
        self.assertEqual([row.name for row in self.model.library], ["S0", "S1"])
        self.assertEqual([block.property for block in model.blocks], [0])
        ops.build()
        self.assertEqual([row.property_id for row in self.model.results], [2])
