# SPDX-License-Identifier: GPL-3.0-or-later
"""Vertical exaggeration is display only."""

import bpy
import numpy as np
import realmodel
from blender_state import coordinates
from panel_case import raise_by
from realmodel.bl.display import coordinates as places
from realmodel.bl.display import cuts
from realmodel.bl.objects import exaggeration
from view_case import Case


def top(item):
    matrix = np.array(item.matrix_world)
    return (coordinates(item.data) @ matrix[:3, :3].T + matrix[:3, 3])[:, 2].max()


def setUpModule():
    realmodel.register()


def tearDownModule():
    realmodel.unregister()


class Exaggeration(Case):
    def stretch(self, factor):
        self.settings.view.exaggeration = factor
        bpy.context.view_layer.update()

    def test_all_that_is_shown_is_stretched_and_no_mesh_changes(self):
        before = self.contents()
        self.stretch(5.0)
        self.assertEqual({k: v[0] for k, v in self.contents().items()}, {k: v[0] for k, v in before.items()})
        base = min(coordinates(item.data)[:, 2].min() for item in self.blocks().values())
        for item in [*self.blocks().values(), *(row.interface for row in self.settings.rocks[0].surfaces)]:
            high = coordinates(item.data)[:, 2].max()
            self.assertAlmostEqual(top(item), base + 5.0 * (high - base), places=3, msg=item.name)
        self.stretch(1.0)
        self.assertEqual(self.contents(), before)
        self.assertFalse([item for item in self.scene.objects if item.type == "EMPTY" or item.parent])

    def test_a_build_reads_what_is_there(self):
        self.settings.view.exaggeration = 7.0
        volumes = [row.volume_exact for row in self.settings.results]
        surface = self.settings.rocks[0].surfaces[4]
        raise_by(surface.interface, 1.0)
        bpy.ops.realmodel.build()
        self.assertNotEqual([row.volume_exact for row in self.settings.results], volumes)
        raise_by(surface.interface, -1.0)
        bpy.ops.realmodel.build()
        for row, volume in zip(self.settings.results, volumes, strict=True):
            self.assertAlmostEqual(float(row.volume_exact), float(volume), delta=1e-3 * (1 + float(volume)))
        self.assertEqual(surface.source, "MESH_OBJECT")

    def test_a_build_without_edits_is_the_same(self):
        volumes = [row.volume_exact for row in self.settings.results]
        self.stretch(3.0)
        bpy.ops.realmodel.build()
        self.assertEqual([row.volume_exact for row in self.settings.results], volumes)
        self.assertEqual(self.settings.rocks[0].surfaces[4].source, "MESH_FILE")

    def test_the_cut_stays_in_its_rock(self):
        bpy.ops.realmodel.section_plane(axis="Z")
        self.settings.view.plane.location.z = 12.0
        bpy.ops.realmodel.section_update()
        before = cuts.plane_in_model(self.scene)
        self.stretch(4.0)
        for was, now in zip(before, cuts.plane_in_model(self.scene), strict=True):
            np.testing.assert_allclose(now, was, atol=1e-4)
        self.settings.view.plane.rotation_euler = (0.4, 0.2, 0.0)
        bpy.ops.realmodel.section_update()
        point, normal = cuts.plane_in_model(self.scene)
        low = [
            (coordinates(o.data) - point) @ normal
            for o in self.scene.objects
            if o.get("realmodel_view") == "cut"
        ]
        self.assertLess(max(values.max() for values in low), 1e-2)
        bpy.ops.realmodel.section()
        section = next(o for o in self.scene.objects if o.get("realmodel") == "section")
        self.assertLess(np.abs((coordinates(section.data) - point) @ normal).max(), 1e-2)
        self.assertIsNotNone(section.parent)

    def test_coordinates_are_true(self):
        self.stretch(10.0)
        at = exaggeration.matrix(self.scene) @ (50.0, 40.0, 5.0, 1.0)
        place = places.under_ray(self.scene, (50.0, 40.0, 1000.0), (0.0, 0.0, -1.0))
        self.assertAlmostEqual(place.z, 24.4, places=3)
        self.assertAlmostEqual(places.at_point(self.scene, at[:3]).z, 5.0, places=4)

    def test_a_new_model_leaves_nothing_behind(self):
        self.stretch(2.0)
        bpy.ops.realmodel.new()
        self.assertFalse([item for item in self.scene.objects if item.type == "EMPTY"])
