# SPDX-License-Identifier: GPL-3.0-or-later
"""Contacts and fault sticks that are drawn on a plane, and images in their place."""

import bpy
import numpy as np
from panel_case import PanelCase, ops, outline, select, sheet, stack
from realmodel.bl.field import drawn_data, placed_images
from realmodel.bl.objects import exaggeration
from realmodel.bl.project import compartments, project_settings, settings
from realmodel.bl.scene import data_objects
from recording_layout import draw_tab


class DrawnData(PanelCase):
    def curve(self, places, name="drawn"):
        """A line through places of the scene, as the active object."""
        curve = bpy.data.curves.new(name, "CURVE")
        curve.dimensions = "3D"
        spline = curve.splines.new("POLY")
        spline.points.add(len(places) - 1)
        for point, place in zip(spline.points, places, strict=True):
            point.co = (*place, 1.0)
        item = bpy.data.objects.new(name, curve)
        bpy.context.collection.objects.link(item)
        select(item)
        return item

    def points_model(self):
        """A level base, and a surface through points that are stored in the .blend, in a square."""
        sheet_item = sheet("base", 0.0)
        select(sheet_item)
        ops.from_selected()
        path = self.folder / "top.csv"
        path.write_text("x,y,z\n" + "".join(f"{x},{y},20\n" for x in (5, 95) for y in (5, 95)))
        ops.surface_add(filepath=str(path))
        self.model.rocks[0].region = outline("region", [(0, 0), (100, 0), (100, 100), (0, 100)])
        self.model.rocks[0].edge_length = 10.0
        self.model.rocks[0].surfaces[1].method = "natural_neighbour"
        ops.build()
        self.model.rocks[0].active_surface = 1
        return self.model.rocks[0].surfaces[1]

    def test_contacts_join_the_points_of_the_surface(self):
        row = self.points_model()
        before = self.volumes()["top block"]
        self.curve([(30, 50, 30), (50, 50, 35), (70, 50, 30)])
        ops.draw_contacts(use_object=True)
        points = data_objects.read_points(self.scene, row)
        self.assertEqual(len(points), 7)
        self.assertEqual(points[4:].tolist(), [[30, 50, 30], [50, 50, 35], [70, 50, 30]])
        self.assertTrue(self.model.is_outdated)
        ops.build()
        self.assertGreater(self.volumes()["top block"], before + 1000)
        self.save_and_open()
        row = self.model.rocks[0].surfaces[1]
        self.assertEqual(len(data_objects.read_points(self.scene, row)), 7)

    def pencil(self, *strokes):
        """A grease pencil object with strokes through places of the scene, as the active object."""
        is_old = not hasattr(bpy.data, "grease_pencils_v3") and bpy.app.version < (5, 0, 0)
        known = bpy.data.grease_pencils if is_old else getattr(bpy.data, "grease_pencils_v3", None)
        data = (bpy.data.grease_pencils if known is None else known).new("pencil")
        layer = data.layers.new("lines", set_active=True)
        frame = layer.frames.new(1)
        for places in strokes:
            if is_old:
                stroke = frame.strokes.new()
                stroke.points.add(len(places))
            else:
                frame.drawing.add_strokes([len(places)])
                stroke = frame.drawing.strokes[-1]
            for point, place in zip(stroke.points, places, strict=True):
                setattr(point, "co" if is_old else "position", place)
        item = bpy.data.objects.new("pencil", data)
        bpy.context.collection.objects.link(item)
        select(item)
        return item, layer

    def test_contacts_are_strokes_of_grease_pencil(self):
        row = self.points_model()
        item, layer = self.pencil(
            [(30.0, 50.0, 30.0 + 0.001 * n) for n in range(3)] + [(40.0, 50.0, 31.0), (50.0, 50.0, 32.0)],
            [(x, 60.0, 30.0) for x in np.linspace(20, 80, 601)],
        )
        item.location.z = 5.0
        bpy.context.view_layer.update()
        self.assertIn("From Active Object", draw_tab(bpy.context).labels)
        ops.draw_contacts(use_object=True)
        points = data_objects.read_points(self.scene, row)[4:]
        np.testing.assert_allclose(points[:3], [(30, 50, 35), (40, 50, 36), (50, 50, 37)], atol=1e-4)
        long = points[3:]
        self.assertTrue(80 < len(long) < 103, len(long))  # of 601
        np.testing.assert_allclose(long[[0, -1]], [(20, 60, 35), (80, 60, 35)], atol=1e-4)
        layer.hide = True
        self.refused(ops.draw_contacts, "it has no strokes", use_object=True)

    def test_the_live_model_follows(self):
        self.points_model()
        before = self.volumes()["top block"]
        self.model.live = True
        self.curve([(50, 40, 35), (50, 60, 35)])
        ops.draw_contacts(use_object=True)
        self.live_is_done()
        self.assertGreater(self.volumes()["top block"], before + 1000)

    def test_contacts_join_a_points_object_where_it_stands(self):
        row = self.points_model()
        item = bpy.data.objects.new("points", bpy.data.meshes.new("points"))
        item.data.vertices.add(3)
        item.location, item.scale = (10.0, 0.0, 0.0), (2.0, 2.0, 1.0)
        bpy.context.collection.objects.link(item)
        row.source, row.object = "POINTS_OBJECT", item
        self.curve([(30, 50, 30), (50, 50, 35)])
        bpy.context.view_layer.update()
        ops.draw_contacts(use_object=True)
        self.assertEqual([tuple(v.co) for v in item.data.vertices][3:], [(10, 25, 30), (20, 25, 35)])

    def test_a_ready_mesh_takes_none(self):
        stack(0.0, 20.0)
        ops.build()
        self.curve([(30, 50, 30), (50, 50, 35)])
        self.refused(ops.draw_contacts, "takes no points", use_object=True)
        self.refused(ops.draw_contacts, "nothing was drawn")

    def test_a_fault_is_drawn_stick_by_stick(self):
        stack(0.0, 20.0)
        ops.fault_body_add(empty=True, kind="FAULT")
        row = self.model.faults[0]
        for y in (-5.0, 50.0, 105.0):
            self.curve([(40, y, 30), (50, y, -10)])
            ops.draw_stick(use_object=True)
        self.assertEqual((row.source, row.object.name), ("STICKS_OBJECT", "fault sticks"))
        self.assertTrue(row.object.show_in_front, "within the blocks nobody would see it")
        self.assertEqual(len(row.object.data.edges), 3)
        ops.build()
        self.assertEqual(len(self.model.results), 1)
        self.assertEqual(len(compartments.names(self.scene)), 2)
        self.curve([(40, 120, 30)])
        self.refused(ops.draw_stick, "no edges", use_object=True)

    def test_sticks_of_a_file_stay(self):
        stack(0.0, 20.0)
        path = self.folder / "f.pol"
        sticks = [[(40.0 + h / 4, y, h) for h in (30, 10, -10)] for y in (-5, 105)]
        path.write_text("".join("".join(f"{x} {y} {z}\n" for x, y, z in s) + "999 999 999\n" for s in sticks))
        ops.fault_body_add(filepath=str(path))
        row = self.model.faults[0]
        self.curve([(48, 50, 30), (38, 50, -10)])
        ops.draw_stick(use_object=True)
        self.assertEqual(row.source, "STICKS_OBJECT")
        self.assertEqual(len(row.object.data.vertices), 8)
        self.assertEqual(len(row.object.data.edges), 5)
        ops.build()

    def test_the_ray_meets_the_plane_where_it_is_shown(self):
        stack(0.0, 20.0)
        ops.build()
        select()
        with self.assertRaisesRegex(Exception, "nothing to draw on"):
            drawn_data.plane(bpy.context)
        ops.section_plane(axis="Y")
        self.model.view.exaggeration = 4.0
        bpy.context.view_layer.update()
        point, normal = drawn_data.plane(bpy.context)
        place = np.array([30.0, point[1], 12.0])
        shown = project_settings.in_world(self.scene, place)[0]
        self.assertAlmostEqual(shown[2], 48.0, places=4)
        ray = shown + np.array([1.0, -50.0, 7.0]), (-1.0, 50.0, -7.0)
        found = drawn_data.on_plane(self.scene, ray, (point, normal))
        self.assertTrue(np.allclose(found, place, atol=1e-4), found)
        self.assertIsNone(drawn_data.on_plane(self.scene, ((0, 0, 0), (1, 0, 0)), (point, normal)))

    def picture(self, name="scan.png", size=(40, 20)):
        image = bpy.data.images.new(name, *size)
        image.filepath_raw, image.file_format = str(self.folder / name), "PNG"
        image.save()
        bpy.data.images.remove(image)
        return str(self.folder / name)

    def corners(self, item):
        """Where the lower left and the upper right corner of a placed image are, in the model."""
        width, height = item.data.size
        longest = max(width, height)
        matrix = exaggeration.true_matrix(item)
        ends = np.array([(0, 0, 0, 1), (width / longest, height / longest, 0, 1)])
        return (ends @ matrix.T)[:, :3] + project_settings.model_origin(self.scene)

    def test_a_scanned_section_stands_where_its_points_say(self):
        stack(0.0, 20.0)
        ops.build()
        path = self.picture()
        ops.image_place(filepath=path, kind="SECTION", first="10, 20", second="90 80", heights="-5; 45")
        item = bpy.context.active_object
        self.assertTrue(np.allclose(self.corners(item), [[10, 20, -5], [90, 80, 45]], atol=1e-4))
        self.assertIsNotNone(item.data.packed_file)
        self.assertEqual(item.empty_image_depth, "FRONT", "within the blocks nobody would see it")
        _, normal = drawn_data.plane(bpy.context)
        self.assertTrue(np.allclose(np.cross(normal, [0.6, -0.8, 0]), 0, atol=1e-6), normal)
        self.model.view.exaggeration = 3.0
        bpy.context.view_layer.update()
        self.assertTrue(np.allclose(self.corners(item), [[10, 20, -5], [90, 80, 45]], atol=1e-4))
        self.assertAlmostEqual(item.matrix_world.translation.z, -15.0, places=3)
        self.save_and_open()
        item = bpy.data.objects["scan"]
        self.assertIn(settings.IMAGE, item)
        self.assertEqual(tuple(item.data.size), (40, 20))

    def test_points_inside_of_an_image_place_it_too(self):
        path = self.picture()
        ops.image_place(
            filepath=path,
            kind="SECTION",
            first="0,0",
            second="100,0",
            heights="0,10",
            first_pixel=(10, 5),
            second_pixel=(30, 15),
        )
        item = bpy.context.active_object
        self.assertTrue(np.allclose(self.corners(item), [[-50, 0, -5], [150, 0, 15]], atol=1e-4))

    def test_a_map_is_turned_and_scaled(self):
        path = self.picture(size=(20, 20))
        ops.image_place(
            filepath=path,
            kind="MAP",
            first="100,100",
            second="100,140",
            heights="7",
            first_pixel=(0, 0),
            second_pixel=(20, 0),
        )
        item = bpy.context.active_object
        self.assertTrue(np.allclose(self.corners(item), [[100, 100, 7], [60, 140, 7]], atol=1e-4))
        plane = placed_images.plane_of(self.scene, item)
        self.assertTrue(np.allclose(plane[1], [0, 0, 1]))

    def test_what_places_no_image_is_refused(self):
        path = self.picture()
        given = {"filepath": path, "first": "0,0", "second": "100,0", "heights": "0,10"}
        before = len(bpy.data.images)
        self.refused(ops.image_place, "both points are one", **{**given, "second": "0, 0"})
        self.refused(ops.image_place, "both elevations are the same", **{**given, "heights": "3,3"})
        self.refused(ops.image_place, "elevations must be a number", **{**given, "kind": "MAP"})
        self.refused(ops.image_place, "second point must be two numbers", **{**given, "second": "east"})
        self.refused(
            ops.image_place, "differ in x and in y", **given, first_pixel=(3, 3), second_pixel=(3, 9)
        )
        text = self.folder / "x.png"
        text.write_text("no image")
        self.refused(ops.image_place, "no image that Blender reads", **{**given, "filepath": str(text)})
        self.assertEqual(len(bpy.data.images), before)
