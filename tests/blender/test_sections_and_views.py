# SPDX-License-Identifier: GPL-3.0-or-later
"""Sections, the cut along the movable plane, views, pictures and coordinates."""

import blender_state
import bpy
import numpy as np
import realmodel
from view_case import Case


def setUpModule():
    realmodel.register()


def tearDownModule():
    realmodel.unregister()


def areas_by_material(item):
    """{library ID: area of the faces that have its material}."""
    mesh, found = item.data, {}
    for polygon in mesh.polygons:
        material = mesh.materials[polygon.material_index]
        key = material["realmodel_property"]
        found[key] = found.get(key, 0.0) + polygon.area
    return found


class Sections(Case):
    def test_an_exact_section(self):
        before = self.contents()
        bpy.ops.realmodel.section(location=(50.0, 40.0, 10.0), normal=(0.0, -2.0, 0.0))
        item = bpy.context.view_layer.objects.active
        self.assertEqual(item["realmodel"], "section")
        at = blender_state.coordinates(item.data)
        np.testing.assert_allclose(at[:, 1], 40.0, atol=1e-4)
        exact = self.model.section((50.0, 40.0, 10.0), (0.0, -2.0, 0.0))
        wanted = {}
        for area, key in zip(exact.polygon_areas, exact.property, strict=True):
            wanted[int(key)] = wanted.get(int(key), 0.0) + area
        found = areas_by_material(item)
        self.assertEqual(set(found), set(wanted))
        for key, area in wanted.items():
            self.assertAlmostEqual(found[key] / area, 1.0, places=4)
        shared = {m for o in self.blocks().values() for m in o.data.materials}
        self.assertLessEqual(set(item.data.materials), shared)
        self.assertEqual(self.contents(), before)

    def test_it_shares_materials_with_blocks_that_are_built_again(self):
        bpy.ops.realmodel.section(location=(50.0, 40.0, 10.0), normal=(0.0, -2.0, 0.0))
        used = set(bpy.context.view_layer.objects.active.data.materials)
        names = {material.name for material in used}
        bpy.ops.realmodel.clear()
        bpy.ops.realmodel.build()
        self.assertLessEqual(used, {m for o in self.blocks().values() for m in o.data.materials})
        self.assertEqual({material.name for material in used}, names)

    def test_at_a_stage(self):
        self.settings.stage = 2
        bpy.ops.realmodel.section(location=(50.0, 40.0, 10.0), normal=(1.0, 0.0, 0.0))
        found = areas_by_material(bpy.context.view_layer.objects.active)
        self.assertAlmostEqual(found[3], 80.0 * (32.0 - 22.5), delta=0.1)

    def test_refused(self):
        before = blender_state.inventory()
        with self.assertRaisesRegex(RuntimeError, "does not meet the model"):
            bpy.ops.realmodel.section(location=(500.0, 0.0, 0.0), normal=(1.0, 0.0, 0.0))
        with self.assertRaisesRegex(RuntimeError, "normal is zero"):
            bpy.ops.realmodel.section(location=(50.0, 40.0, 10.0), normal=(0.0, 0.0, 0.0))
        self.assertEqual(blender_state.inventory(), before)


def line(name, *points, cyclic=False):
    """An active curve through points."""
    curve = bpy.data.curves.new(name, "CURVE")
    curve.dimensions = "3D"
    spline = curve.splines.new("POLY")
    spline.points.add(len(points) - 1)
    for point, at in zip(spline.points, points, strict=True):
        point.co = (*at, 0.0, 1.0)
    spline.use_cyclic_u = cyclic
    item = bpy.data.objects.new(name, curve)
    bpy.context.scene.collection.objects.link(item)
    bpy.context.view_layer.objects.active = item
    return item


class Fences(Case):
    LINE = ((10.0, 10.0), (60.0, 10.0), (60.0, 70.0))

    def test_along_a_curve(self):
        line("Line", *self.LINE)
        bpy.ops.realmodel.fence()
        item = bpy.context.view_layer.objects.active
        self.assertEqual((item["realmodel"], item.name), ("section", "Fence"))
        exact = self.model.fence(self.LINE)
        found = areas_by_material(item)
        for key in np.unique(exact.property).tolist():
            wanted = exact.polygon_areas[exact.property == key].sum()
            self.assertAlmostEqual(found[key] / wanted, 1.0, places=4)
        at = blender_state.coordinates(item.data)
        self.assertTrue(((abs(at[:, 1] - 10) < 1e-4) | (abs(at[:, 0] - 60) < 1e-4)).all())

    def test_again_along_the_line_of_the_fence_that_was_made(self):
        line("Line", *self.LINE)
        bpy.ops.realmodel.fence()
        first = bpy.context.view_layer.objects.active
        bpy.ops.realmodel.fence()
        again = bpy.context.view_layer.objects.active
        self.assertNotEqual(again, first)
        self.assertTrue(np.array_equal(*(blender_state.coordinates(item.data) for item in (first, again))))
        bpy.data.objects.remove(bpy.data.objects["Line"])
        with self.assertRaisesRegex(RuntimeError, "it is not one line"):
            bpy.ops.realmodel.fence()

    def test_flat_beside_the_model(self):
        line("Line", *self.LINE)
        heights = []
        for number, make in enumerate((bpy.ops.realmodel.fence, bpy.ops.realmodel.fence)):
            bpy.context.view_layer.objects.active = bpy.data.objects["Line"]
            make(flat=True)
            at = blender_state.coordinates(bpy.context.view_layer.objects.active.data)
            self.assertAlmostEqual(np.ptp(at[:, 0]), 110.0, places=3)  # 50 and 60 along the line
            self.assertLess(at[:, 1].max(), -1.0 - 10 * number)  # to the south
            self.assertEqual(np.ptp(at[:, 1]), 0.0)
            heights.append(at[:, 2].max())
        self.assertAlmostEqual(heights[0], heights[1], places=5)
        bpy.ops.realmodel.section(location=(50.0, 40.0, 10.0), normal=(0.0, 0.0, 1.0), flat=True)
        at = blender_state.coordinates(bpy.context.view_layer.objects.active.data)
        self.assertGreater(at[:, 0].min(), 100.0)  # a map to the east
        self.assertEqual(np.ptp(at[:, 2]), 0.0)

    def test_what_is_no_line(self):
        before = blender_state.inventory()
        bpy.context.view_layer.objects.active = None
        with self.assertRaisesRegex(RuntimeError, "active object has no lines"):
            bpy.ops.realmodel.fence()
        self.assertEqual(blender_state.inventory(), before)
        item = line("Two", (0.0, 0.0), (10.0, 0.0))
        item.data.splines.new("POLY").points.add(2)
        for point, x in zip(item.data.splines[1].points, (20.0, 30.0, 40.0), strict=True):
            point.co = (x, 5.0, 0.0, 1.0)
        before = blender_state.inventory()
        with self.assertRaisesRegex(RuntimeError, "it is not one line"):
            bpy.ops.realmodel.fence()
        line("Away", (1000.0, 0.0), (2000.0, 0.0))
        with self.assertRaisesRegex(RuntimeError, "does not meet the model"):
            bpy.ops.realmodel.fence()

    def test_a_closed_line_comes_back(self):
        line("Ring", (20.0, 20.0), (60.0, 20.0), (60.0, 60.0), cyclic=True)
        bpy.ops.realmodel.fence()
        found = areas_by_material(bpy.context.view_layer.objects.active)
        exact = self.model.fence([(20, 20), (60, 20), (60, 60), (20, 20)])
        self.assertAlmostEqual(sum(found.values()) / exact.area, 1.0, places=4)

    def test_drawings_in_the_colors_of_the_library(self):
        line("Line", *self.LINE)
        row = self.settings.library[0]
        row.color = (1.0, 0.0, 1.0)
        for number, ending in enumerate(("svg", "png", "dxf", "vtu", "csv")):
            path = self.folder / f"section.{ending}"
            bpy.ops.realmodel.save_section(
                filepath=str(path),
                along=("LINE", "PLANE")[number % 2],
                location=(50, 40, 10),
                exaggeration=2.0,
            )
            self.assertGreater(path.stat().st_size, 1000)
        text = (self.folder / "section.svg").read_text()
        self.assertIn('fill="#ff00ff"', text)
        self.assertIn("vertical exaggeration 2", text)
        before = sorted(self.folder.iterdir())
        with self.assertRaisesRegex(RuntimeError, "there is no section plane"):
            bpy.ops.realmodel.save_section(filepath=str(self.folder / "other.svg"))
        with self.assertRaisesRegex(RuntimeError, "must end in"):
            bpy.ops.realmodel.save_section(filepath=str(self.folder / "other.bmp"), location=(50, 40, 10))
        self.assertEqual(sorted(self.folder.iterdir()), before)


class Cuts(Case):
    def halves(self):
        return {o["realmodel_block"]: o for o in bpy.data.objects if o.get("realmodel_view") == "cut"}

    def assert_cut_at(self, point, normal):
        half = self.model.cut_by_plane(point, normal).below
        found = self.halves()
        self.assertEqual(set(found), {block.name for block in half.blocks if block.cells})
        for block in half.blocks:
            if block.cells:
                item = found[block.name]
                self.assertEqual(blender_state.open_edges(item.data), 0)
                self.assertAlmostEqual(blender_state.volume(item.data) / block.volume, 1.0, places=4)
                self.assertEqual(item.material_slots[0].material, self.blocks()[block.name].data.materials[0])

    def test_the_plane_moves_and_turns(self):
        before = self.contents()
        bpy.ops.realmodel.section_plane(axis="Y")
        plane = self.settings.view.plane
        bpy.context.view_layer.update()
        middle = plane.matrix_world.translation
        self.assert_cut_at(tuple(middle), (0.0, -1.0, 0.0))
        self.assertEqual(self.in_sight("block"), set())
        self.assertTrue(all(o.hide_render for o in self.blocks().values()))
        plane.location = (30.0, 0.0, 0.0)
        plane.rotation_euler = (0.0, np.pi / 2, 0.0)
        bpy.ops.realmodel.section_update()
        self.assert_cut_at((30.0, 0.0, 0.0), (1.0, 0.0, 0.0))
        bpy.ops.realmodel.section_flip()
        self.assert_cut_at((30.0, 0.0, 0.0), (-1.0, 0.0, 0.0))
        self.settings.view.use_section = False
        self.assertEqual(self.halves(), {})
        self.assertEqual(self.in_sight("block"), {o.name for o in self.blocks().values()})
        bpy.ops.realmodel.section_remove()
        self.assertEqual(self.contents(), before)
        self.assertEqual([c.name for c in bpy.data.collections if c.get("realmodel") == "view"], [])
        with self.assertRaisesRegex(RuntimeError, "no section plane"):
            bpy.ops.realmodel.section_remove()
        with self.assertRaisesRegex(RuntimeError, "no cut is shown"):
            bpy.ops.realmodel.section_update()

    def test_it_follows_the_stage_the_build_and_the_mode(self):
        bpy.ops.realmodel.section_plane(axis="X")
        self.settings.stage = 2
        self.assertEqual(set(self.halves()), {"base block", "Sand", "Gone"})
        self.settings.display = "POLYHEDRA"
        volume = sum(
            blender_state.volume(o.data) for o in bpy.data.objects if o.get("realmodel_view") == "cells"
        )
        self.settings.display = "BLOCKS"
        half = sum(blender_state.volume(o.data) for o in self.halves().values())
        self.assertAlmostEqual(volume / half, 0.88**3, places=3)
        self.settings.stage = 4
        self.assertEqual(set(self.halves()), {"base block", "Sand", "Cap"})
        bpy.ops.realmodel.build()
        self.assertEqual(set(self.halves()), {"base block", "Sand", "Cap"})
        bpy.ops.realmodel.clear()
        self.assertEqual(self.halves(), {})

    def test_keyframes_of_the_plane(self):
        bpy.ops.realmodel.section_plane(axis="X")
        plane = self.settings.view.plane
        for frame, x in ((1, 20.0), (5, 60.0)):
            plane.location.x = x
            plane.keyframe_insert("location", frame=frame)
        for frame in (1, 5, 1):
            self.scene.frame_set(frame)
            at = np.concatenate([blender_state.coordinates(o.data) for o in self.halves().values()])
            self.assertAlmostEqual(at[:, 0].max(), {1: 20.0, 5: 60.0}[frame], places=3)

    def test_the_section_lies_where_the_plane_is(self):
        bpy.ops.realmodel.section_plane(axis="X")
        self.settings.view.plane.location.x = 20.0
        bpy.ops.realmodel.section()
        at = blender_state.coordinates(bpy.context.view_layer.objects.active.data)
        np.testing.assert_allclose(at[:, 0], 20.0, atol=1e-4)

    def test_any_object_may_be_the_plane_and_may_be_deleted(self):
        empty = bpy.data.objects.new("Empty", None)
        self.scene.collection.objects.link(empty)
        empty.location = (0.0, 30.0, 0.0)
        empty.rotation_euler = (np.pi / 2, 0.0, 0.0)
        self.settings.view.plane = empty
        self.settings.view.use_section = True
        self.assert_cut_at((0.0, 30.0, 0.0), (0.0, -1.0, 0.0))
        bpy.data.objects.remove(empty)
        self.settings.display = "AREAS"
        self.assertEqual(self.in_sight("block"), {o.name for o in self.blocks().values()})


class Viewed(Case):
    def view(self):
        from realmodel.bl.objects import viewports

        return viewports.spaces(bpy.context)[0].region_3d


class Views(Viewed):
    def test_the_six_directions(self):
        towards = {
            "FRONT": (0, 1, 0),
            "BACK": (0, -1, 0),
            "LEFT": (1, 0, 0),
            "RIGHT": (-1, 0, 0),
            "TOP": (0, 0, -1),
            "BOTTOM": (0, 0, 1),
        }
        for direction, wanted in towards.items():
            bpy.ops.realmodel.view(direction=direction)
            looking = self.view().view_rotation.to_matrix() @ _vector((0, 0, -1))
            np.testing.assert_allclose(looking, wanted, atol=1e-6, err_msg=direction)
            self.assertEqual(self.view().view_perspective, "ORTHO")
            np.testing.assert_allclose(self.view().view_location[:2], (50.0, 40.0), atol=1e-3)
        with self.assertRaises(TypeError):
            bpy.ops.realmodel.view(direction="ASKEW")

    def test_previous_and_next(self):
        bpy.ops.realmodel.view(direction="FRONT")
        front = tuple(self.view().view_rotation)
        bpy.ops.realmodel.view(direction="TOP")
        top = tuple(self.view().view_rotation)
        bpy.ops.realmodel.view_previous()
        np.testing.assert_allclose(self.view().view_rotation, front, atol=1e-5)
        bpy.ops.realmodel.view_next()
        np.testing.assert_allclose(self.view().view_rotation, top, atol=1e-5)
        with self.assertRaisesRegex(RuntimeError, "not a later view"):
            bpy.ops.realmodel.view_next()
        bpy.ops.realmodel.view_previous()
        bpy.ops.realmodel.view(direction="LEFT")
        with self.assertRaisesRegex(RuntimeError, "not a later view"):
            bpy.ops.realmodel.view_next()

    def test_the_model_in_the_frame(self):
        self.view().view_location = (1e4, 0.0, 0.0)
        bpy.ops.realmodel.view_all()
        np.testing.assert_allclose(self.view().view_location, (50.0, 40.0, 12.4), atol=0.5)
        self.assertGreater(self.view().view_distance, 50.0)
        bpy.ops.realmodel.new()
        with self.assertRaisesRegex(RuntimeError, "no model is visible"):
            bpy.ops.realmodel.view_all()


def _vector(numbers):
    from mathutils import Vector

    return Vector(numbers)


class Pictures(Viewed):
    def capture(self, name, **settings):
        path = self.folder / name
        bpy.ops.realmodel.capture(filepath=str(path), **settings)
        return blender_state.pixels(path)

    def colors_seen(self, pixels):
        """Names of the library's colors that many pixels come near to in hue."""
        wanted = {"Granite": (0.54, 0.17, 0.89), "Sandstone": (0.88, 0.13, 0.13), "Marl": (0.13, 0.63, 0.25)}
        found = set()
        flat = pixels.reshape(-1, 3)
        flat = flat[np.ptp(flat, axis=1) > 0.2]
        for name, color in wanted.items():
            cosine = flat @ np.array(color) / np.linalg.norm(flat, axis=1) / np.linalg.norm(color)
            if np.count_nonzero(cosine > 0.985) > 20:
                found.add(name)
        return found

    def test_each_mode_is_a_picture_of_its_own(self):
        from realmodel.bl.objects import viewports

        self.view().view_rotation = viewports.view_rotation().to_quaternion()
        bpy.ops.realmodel.view_all()
        seen, before = {}, blender_state.inventory()
        for mode in ("POINTS", "LINES", "AREAS", "SURFACES", "POLYHEDRA", "BLOCKS"):
            self.settings.display = mode
            pixels = self.capture(f"{mode}.png", width=320, height=200)
            self.assertEqual(pixels.shape, (200, 320, 3))
            colors = self.colors_seen(pixels)
            if mode == "POINTS":  # neighbours share most of their points
                self.assertIn("Granite", colors)
            elif mode != "SURFACES":
                self.assertEqual(colors, {"Granite", "Sandstone", "Marl"}, mode)
            else:
                self.assertIn("Marl", colors)
            seen[mode] = pixels
        names = list(seen)
        for number, one in enumerate(names):
            for other in names[number + 1 :]:
                different = (np.abs(seen[one] - seen[other]).max(axis=2) > 0.1).mean()
                self.assertGreater(different, 0.003, f"{one} and {other} look alike")
        self.assertEqual(set(blender_state.inventory()), set(before))

    def test_the_cut_is_seen_filled(self):
        bpy.ops.realmodel.view(direction="TOP")
        whole = self.capture("whole.png", width=160, height=120)
        self.assertEqual(self.colors_seen(whole), {"Marl"})
        bpy.ops.realmodel.section_plane(axis="Z")
        self.settings.view.plane.location.z = 15.0
        bpy.ops.realmodel.section_update()
        self.assertEqual(self.colors_seen(self.capture("cut.png", width=160, height=120)), {"Sandstone"})

    def test_refused(self):
        for path, words in (
            ("", "no file for the picture"),
            ("x.jpg", "ends in .png"),
            ("no/x.png", "folder"),
        ):
            with self.assertRaisesRegex(RuntimeError, words):
                bpy.ops.realmodel.capture(filepath=path and str(self.folder / path), width=32, height=32)
        bpy.ops.realmodel.hide_property(property_id=1, action="ONLY")
        bpy.ops.realmodel.hide_property(property_id=1, action="HIDE")
        with self.assertRaisesRegex(RuntimeError, "nothing is visible"):
            bpy.ops.realmodel.capture(filepath=str(self.folder / "x.png"), width=32, height=32)
        self.assertEqual([p.name for p in self.folder.glob("*.png")], [])


class Coordinates(Case):
    def test_at_a_point(self):
        from realmodel.bl.display import coordinates

        bpy.ops.realmodel.coordinates(location=(50.0, 40.0, 12.0))
        place = coordinates.last(self.scene)
        self.assertEqual((place.block, place.rock, place.surface), ("Sand", "hill", "S1"))
        self.assertEqual((place.property_id, place.property), (2, "Sandstone"))
        np.testing.assert_allclose((place.x, place.y, place.z), (50.0, 40.0, 12.0), atol=1e-4)
        self.assertAlmostEqual(place.thickness, 18.0 - 10.0, places=3)
        self.scene.cursor.location = (20.0, 30.0, 5.0)
        bpy.ops.realmodel.coordinates()
        self.assertEqual(coordinates.last(self.scene).block, "base block")
        with self.assertRaisesRegex(RuntimeError, "no block at this position"):
            bpy.ops.realmodel.coordinates(location=(50.0, 40.0, 400.0))
        self.assertIsNone(coordinates.last(self.scene))

    def test_on_a_wall(self):
        """Rounding puts a place on a wall inside or outside of the block."""
        from realmodel.bl.display import coordinates

        random = np.random.default_rng(3)
        for aim in np.column_stack([random.uniform(5, 95, 40), np.zeros(40), random.uniform(12, 16, 40)]):
            start = aim + random.uniform((-90, -300, -20), (90, -50, 20))
            place = coordinates.under_ray(self.scene, start, aim - start)
            self.assertEqual(place.block, "Sand")
            self.assertGreater(place.thickness, 4.0)

    def test_along_a_ray_also_where_blocks_were_moved(self):
        from realmodel.bl.display import coordinates

        for explode in (0.0, 1.0):
            self.settings.explode = explode
            place = coordinates.under_ray(self.scene, (33.3, 21.7, 500.0), (0.0, 0.0, -1.0))
            self.assertEqual(place.block, "Cap")
            np.testing.assert_allclose((place.x, place.y, place.z), (33.3, 21.7, 24.217), atol=1e-3)
            self.assertAlmostEqual(place.thickness, 24.217 - (19.0 - 0.666), places=3)
        self.assertIsNone(coordinates.under_ray(self.scene, (500.0, 0.0, 500.0), (0.0, 0.0, -1.0)))
        bpy.ops.realmodel.hide_property(property_id=3, action="HIDE")
        self.assertEqual(
            coordinates.under_ray(self.scene, (33.3, 21.7, 500.0), (0.0, 0.0, -1.0)).block, "Sand"
        )

    def test_distances_from_an_origin(self):
        from realmodel.bl.display import coordinates

        with self.assertRaisesRegex(RuntimeError, "no coordinates were displayed"):
            bpy.ops.realmodel.set_origin(action="PLACE")
        bpy.ops.realmodel.coordinates(location=(50.0, 40.0, 12.0))
        bpy.ops.realmodel.set_origin(action="PLACE")
        bpy.ops.realmodel.coordinates(location=(53.0, 36.0, 5.0))
        away = coordinates.from_zero(self.scene, coordinates.last(self.scene))
        np.testing.assert_allclose(away, (3.0, -4.0, -7.0), atol=1e-4)
        bpy.ops.realmodel.set_origin(action="NONE")
        self.assertIsNone(coordinates.from_zero(self.scene, coordinates.last(self.scene)))
