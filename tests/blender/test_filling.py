# SPDX-License-Identifier: GPL-3.0-or-later
"""Fill with Strata: beds as objects, where they stand, materials, masks, the preview, and what is refused."""

import math
from itertools import pairwise

import bpy
import numpy as np
from blender_state import coordinates, inventory, open_edges, volume
from boolean_case import ball, cube
from bpy_extras.object_utils import world_to_camera_view
from mathutils import Vector
from panel_case import PanelCase, ops, select, sheet
from realmodel.bl.jobs.fill_job import FillJob
from realmodel.bl.objects.filled_beds import FilledShape
from realmodel.bl.shading import strata_modifier, strata_presets
from realmodel.core import Cancelled


def shape_of(item):
    return FilledShape.of(item, bpy.context.evaluated_depsgraph_get())


def evaluated(item):
    return item.evaluated_get(bpy.context.evaluated_depsgraph_get()).data


def numbers_of(mesh, name="realmodel_bed", dtype=np.int32):
    attribute = mesh.attributes[name]
    values = np.empty(len(attribute.data), dtype)
    attribute.data.foreach_get("value", values)
    return values


class Filling(PanelCase):
    def filled(self, item, **settings):
        select(item)
        ops.fill_with_strata(**settings)
        found = bpy.data.collections[f"{item.name} Strata"]
        return [bed for bed in found.objects if "realmodel_volume" in bed]

    def test_beds_are_closed_and_together_the_mesh(self):
        item = ball("A", 2.0, (5.0, 1.0, -3.0))
        item.scale, item.rotation_euler = (1.0, -2.0, 0.5), (0.3, 0.1, -0.4)
        bpy.context.view_layer.update()
        before = coordinates(item.data)
        beds = self.filled(item, beds=7, faults=2, fold_amplitude=0.1, unconformity=0.7)
        self.assertEqual([bed.name for bed in beds], [f"A Bed {n}" for n in range(1, 8)])
        for bed in beds:
            self.assertFalse(bed.data.validate(verbose=True), bed.name)
            self.assertEqual(open_edges(bed.data), 0)
            self.assertEqual(bed.matrix_world, item.matrix_world)
            self.assertAlmostEqual(bed["realmodel_volume"], volume(bed.data), delta=1e-5)
        self.assertAlmostEqual(sum(volume(bed.data) for bed in beds), volume(item.data), places=4)
        kept = {tuple(place) for bed in beds for place in coordinates(bed.data).tolist()}
        self.assertTrue(kept.issuperset(map(tuple, before.tolist())))
        self.assertEqual(coordinates(item.data).tobytes(), before.tobytes())
        self.assertTrue(item.hide_get() and item.hide_render)
        self.assertEqual(set(bpy.context.selected_objects), set(beds))

    def test_rocks_of_a_palette(self):
        beds = self.filled(cube("A"), beds=20, palette="COAL", rock_looks=False)
        used = [bed.material_slots[0].material for bed in beds]
        names = {"Gray Sandstone", "Coal", "Gray Mudstone", "Brown Siltstone", "Pale Limestone"}
        self.assertEqual({material.name for material in used}, names)
        self.assertTrue(all(a != b for a, b in pairwise(used)))
        self.assertFalse(any("realmodel_look" in material for material in used))

    def test_looks_follow_the_rock(self):
        beds = self.filled(cube("A"), beds=20, palette="COAL")
        looks = {bed.material_slots[0].material.name: bed.material_slots[0].material for bed in beds}
        self.assertEqual(looks["Coal"]["realmodel_look"], "COAL")
        self.assertEqual(looks["Brown Siltstone"]["realmodel_look"], "SHALE")
        self.assertIn("realmodel_thickness", beds[3].data.attributes)

    def test_presets_set_values_that_others_override(self):
        for preset, count in (
            ("CLIFF", 14),
            ("CANYON", 24),
            ("ISLAND", 9),
            ("FOLDED", 16),
            ("OVERTURNED", 16),
            ("FAULTED", 14),
            ("PRINT", 4),
        ):
            item = cube(preset)
            self.assertEqual(len(self.filled(item, preset=preset, rock_looks=False)), count)
        self.assertEqual(len(self.filled(cube("Other"), preset="CLIFF", beds=5, rock_looks=False)), 5)

    def test_modifiers_count_and_the_object_keeps_them(self):
        item = cube("A")
        array = item.modifiers.new("Array", "ARRAY")
        array.relative_offset_displace = (2.0, 0.0, 0.0)
        beds = self.filled(item, beds=3, dip=0.0)
        self.assertAlmostEqual(sum(bed["realmodel_volume"] for bed in beds), 16.0)
        self.assertEqual([modifier.name for modifier in item.modifiers], ["Array", "Strata"])

    def test_a_terrain_down_to_a_base(self):
        item = sheet("Hills", lambda x, y: 10 + 5 * math.sin(x / 9) * math.cos(y / 11), n=16)
        low = coordinates(item.data)[:, 2]
        beds = self.filled(item, beds=6, dip=0.1, base_depth=1.0)
        floor = min(coordinates(bed.data)[:, 2].min() for bed in beds)
        self.assertAlmostEqual(floor, low.min() - max(np.ptp(low), 10.0), places=4)
        self.assertTrue(all(not open_edges(bed.data) for bed in beds))

    def test_gaps_and_pegs_for_a_print(self):
        item = cube("A")
        beds = self.filled(item, preset="PRINT", pegs=1, peg_size=0.2, rock_looks=False)
        self.assertEqual([bed.name for bed in beds], [f"A Bed {n}" for n in range(1, 5)])
        self.assertTrue(all(not open_edges(bed.data) for bed in beds))
        lost = volume(item.data) - sum(volume(bed.data) for bed in beds)
        gap, peg = 0.004 * 2.0, 0.2 * 2.0
        self.assertGreater(lost, 3 * 4.0 * gap)
        self.assertLess(lost, 3 * (4.0 * gap + ((peg + 2 * gap) ** 2 - peg**2) * peg) + 1e-6)
        for lower, upper in pairwise(beds):
            top, floor = coordinates(lower.data)[:, 2].max(), coordinates(upper.data)[:, 2].min()
            self.assertGreater(top, floor, "the peg reaches into the next bed")

    def test_light_and_camera_see_the_beds_where_there_is_no_model(self):
        self.refused(ops.set_up_picture, "fill a mesh with strata")
        self.filled(ball("A", 2.0, (5.0, 1.0, -3.0)), beds=4)
        ops.set_up_picture()
        bpy.context.view_layer.update()
        corners = [Vector((5.0 + x, 1.0 + y, -3.0 + z)) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
        for corner in corners:
            seen = world_to_camera_view(self.scene, self.scene.camera, corner)
            self.assertTrue(0.0 < seen.x < 1.0 and 0.0 < seen.y < 1.0 and seen.z > 0.0)
        self.refused(ops.animate_stages, "there is no model yet")
        ops.turntable(frames=4)
        self.assertEqual(self.scene.frame_end, 4)

    def test_masks_of_beds(self):
        item = ball("A", 2.0)
        self.filled(item, beds=4, masks=True, dip=0.0)
        copy = bpy.data.objects["A Bed Masks"]
        self.assertTrue(copy.hide_get() and copy.hide_render)
        self.assertEqual(coordinates(copy.data).tobytes(), coordinates(item.data).tobytes())
        number = np.empty(len(copy.data.vertices), np.int32)
        copy.data.attributes["realmodel_bed"].data.foreach_get("value", number)
        self.assertEqual(set(number.tolist()), {1, 2, 3, 4})
        for bed in range(1, 5):
            mask = np.empty(len(number), np.float32)
            copy.data.attributes[f"Bed {bed}"].data.foreach_get("value", mask)
            self.assertEqual(mask.tolist(), (number == bed).astype(float).tolist())
        height = coordinates(copy.data)[:, 2]
        self.assertLess(height[number == 1].max(), height[number == 2].max())

    def test_vertical_exaggeration_does_not_count(self):
        item = cube("A")
        select(item)
        plain = FilledShape.of(item, bpy.context.evaluated_depsgraph_get()).vertices
        empty = bpy.data.objects.new("Vertical Exaggeration", None)
        empty["realmodel_exaggeration"] = True
        empty.scale.z = 3.0
        bpy.context.collection.objects.link(empty)
        item.parent = empty
        bpy.context.view_layer.update()
        self.assertEqual(shape_of(item).vertices.tobytes(), plain.tobytes())

    def test_the_modifier_and_the_solid_agree(self):
        """In a turned, mirrored and scaled object, after it was moved and sculpted."""
        for preset in ("ISLAND", "FOLDED", "OVERTURNED", "FAULTED"):
            with self.subTest(preset):
                item = ball(preset, 2.0, (5.0, 1.0, -3.0), n=32)
                item.scale, item.rotation_euler = (1.0, -2.0, 0.5), (0.3, 0.1, -0.4)
                select(item)
                ops.strata_preset(preset=preset)
                item.location.x += 2.0
                item.rotation_euler.z += 1.0
                item.data.vertices[0].co *= 1.4
                shown = evaluated(item)
                beds, matrix = strata_modifier.beds_of(item)
                random = np.random.default_rng(1)
                item.data.vertices.foreach_set("co", random.uniform(-1.0, 1.0, 3 * len(item.data.vertices)))
                item.data.update()
                shown = evaluated(item)
                places = coordinates(shown).astype(float) @ matrix[:3, :3].T + matrix[:3, 3]
                same = beds.numbers(places) + 1 == numbers_of(shown)
                self.assertGreater(same.mean(), 0.999, "but within rounding of a boundary")
                self.assertGreater(len(set(numbers_of(shown).tolist())), 4)
                _, share, thickness = beds.places(places)
                self.assertLess(
                    np.abs(share - numbers_of(shown, "realmodel_height", np.float32))[same].max(), 2e-3
                )
                self.assertTrue(
                    np.allclose(
                        thickness[same], numbers_of(shown, "realmodel_thickness", np.float32)[same], 1e-3
                    )
                )

    def test_beds_stay_while_the_mesh_is_sculpted_and_fit_again(self):
        item = ball("A", 2.0, n=32)
        select(item)
        ops.strata_preset(preset="CANYON")
        before = numbers_of(evaluated(item))
        top = int(coordinates(item.data)[:, 2].argmax())
        item.data.vertices[top].co.z += 3.0
        item.data.update()
        after = numbers_of(evaluated(item))
        self.assertEqual(np.flatnonzero(before != after).tolist(), [] if before[top] == after[top] else [top])
        beds, _ = strata_modifier.beds_of(item)
        item.realmodel_strata.faces, item.realmodel_strata.scree = 5000, 0.5
        ops.strata_erode()
        self.assertEqual(strata_modifier.beds_of(item)[0].to_json(), beds.to_json())
        strata_modifier.show_eroded(item, None)
        ops.strata_fit()
        self.assertGreater((numbers_of(evaluated(item)) != after).mean(), 0.5)

    def test_values_of_the_object_change_what_is_shown(self):
        item = ball("A", 2.0, n=32)
        select(item)
        ops.strata_preset(preset="CLIFF")
        item.realmodel_strata.beds = 5
        self.assertEqual(set(numbers_of(evaluated(item)).tolist()), {1, 2, 3, 4, 5})
        rocks = {slot.name for slot in evaluated(item).materials if slot is not None}
        self.assertIn("Chalk", rocks)
        item.realmodel_strata.palette = "COAL"
        rocks = {slot.name for slot in evaluated(item).materials if slot is not None}
        self.assertIn("Coal", rocks)
        item.realmodel_strata.dip = 0.5
        item.realmodel_strata.fold_amplitude, item.realmodel_strata.fold_wavelength = 0.2, 1e-5
        self.assertIn("too narrow", item.realmodel_strata.problem)
        item.realmodel_strata.fold_wavelength = 0.5
        self.assertEqual(item.realmodel_strata.problem, "")
        self.assertEqual(len(item.material_slots), 0, "the materials of the mesh stay")
        ops.strata_remove()
        self.assertEqual(len(item.modifiers), 0)
        self.assertFalse([obj for obj in bpy.data.objects if "Table" in obj.name])
        self.refused(ops.strata_remove, "the active object has no strata")

    def test_a_copy_has_beds_of_its_own_once_they_change(self):
        item = ball("A", 2.0, n=32)
        select(item)
        ops.strata_preset(preset="CANYON")
        other = item.copy()
        other.data = item.data.copy()
        bpy.context.collection.objects.link(other)
        other.realmodel_strata.beds = 3
        self.assertEqual(numbers_of(evaluated(other)).max(), 3)
        self.assertEqual(numbers_of(evaluated(item)).max(), 24)

    def test_a_second_fill_replaces_the_first(self):
        item = ball("A", 2.0, n=32)
        first = {bed.name for bed in self.filled(item, beds=7)}
        ops.strata_edit()
        self.assertFalse(item.hide_get() or item.hide_render)
        self.assertTrue(all(bpy.data.objects[name].hide_get() for name in first))
        item.realmodel_strata.beds = 4
        before = inventory()
        ops.fill_with_strata(use_dialog=False)
        beds = item.realmodel_strata.beds_in.objects
        self.assertEqual([bed.name for bed in beds], [f"A Bed {n}" for n in range(1, 5)])
        self.assertEqual(len(bpy.data.collections["A Strata"].objects), 4)
        self.assertNotEqual(inventory(), before)

    def test_erosion_is_shown_and_made_solid(self):
        item = ball("A", 2.0, n=32)
        item.rotation_euler = (0.2, 0.3, 0.1)
        item.scale.x = -1.0
        select(item)
        ops.strata_preset(preset="CANYON")
        item.realmodel_strata.faces = 5000
        before = coordinates(item.data)
        ops.strata_erode()
        shown = evaluated(item)
        self.assertGreater(len(shown.polygons), 1500)
        self.assertEqual(coordinates(item.data).tobytes(), before.tobytes())
        joints = numbers_of(shown, "realmodel_joints", np.float32)
        self.assertTrue(0.0 <= joints.min() < 0.1 and 0.9 < joints.max() <= 1.0)
        left = abs(volume(shown))
        lost = left / abs(volume(item.data))
        self.assertTrue(0.3 < lost < 0.99, lost)
        self.assertGreater(volume(shown) * volume(item.data), 0, "faces look outward as before")
        ops.fill_with_strata(use_dialog=False)
        beds = item.realmodel_strata.beds_in.objects
        self.assertTrue(all(not open_edges(bed.data) for bed in beds))
        self.assertAlmostEqual(sum(abs(volume(bed.data)) for bed in beds) / left, 1.0, places=4)
        ops.strata_edit()
        self.assertFalse(strata_modifier.shows_erosion(item))
        ops.strata_erode()
        self.assertTrue(strata_modifier.shows_erosion(item))
        bpy.ops.object.mode_set(mode="SCULPT")
        bpy.context.view_layer.update()
        self.assertFalse(strata_modifier.shows_erosion(item), "strokes change the mesh itself")
        bpy.ops.object.mode_set(mode="OBJECT")

    def test_scree_of_a_tilted_object_lies_as_the_world_has_it(self):
        """On eroded and on solid beds, with stones that are pieces of them."""
        ops.strata_rock_add(kind="CLIFF", size=20.0, faces=20_000)
        item = bpy.context.active_object
        item.rotation_euler, item.scale = (0.1, -0.1, 0.8), (0.5, 0.5, 0.5)
        bpy.context.view_layer.update()
        item.realmodel_strata.scree, item.realmodel_strata.stones = 1.0, 4.0
        ops.strata_fit()
        ops.strata_erode()
        self.stones_lie_on_scree(item, item)
        ops.fill_with_strata(use_dialog=False)
        heap = bpy.data.objects[f"{item.name} Scree"]
        self.stones_lie_on_scree(heap, item)
        count = len([obj for obj in bpy.data.objects if obj.get("realmodel_scatter")])
        ops.strata_edit()
        ops.fill_with_strata(use_dialog=False)
        self.assertEqual(len([o for o in bpy.data.objects if o.get("realmodel_scatter")]), count)

    def stones_lie_on_scree(self, item, rock):
        mesh, turn = evaluated(item), np.array(item.matrix_world)
        places = coordinates(mesh) @ turn[:3, :3].T + turn[:3, 3]
        is_scree = numbers_of(mesh, "realmodel_scree", bool)
        corners = np.array([polygon.vertices[:] for polygon in mesh.polygons])[is_scree]
        at = places[corners]
        normal = np.cross(at[:, 1] - at[:, 0], at[:, 2] - at[:, 0])
        area = np.linalg.norm(normal, axis=1)
        slope = np.degrees(np.arccos(normal[:, 2] / area))
        # what lies beneath the ground, or in the rock, has other slopes
        shares, ends = np.histogram(slope, np.arange(20.0, 64.0, 4.0), weights=area)
        self.assertIn(ends[shares.argmax()], (32.0, 36.0))
        depsgraph = bpy.context.evaluated_depsgraph_get()
        rocks = {material.name for material in rock.evaluated_get(depsgraph).data.materials if material}
        found = []
        for each in depsgraph.object_instances:
            if each.is_instance and each.parent.original == item:
                self.assertIn(each.object.data.materials[0].name, rocks)
                up = np.array(each.matrix_world)[:3, 2]
                found.append((*each.matrix_world.translation, np.linalg.norm(up), up[2] / np.linalg.norm(up)))
        found = np.array(found)
        self.assertGreater(len(found), 50)
        middle = at.mean(axis=1)
        away = [np.linalg.norm(middle - place, axis=1).min() for place in found[:, :3]]
        self.assertLess(max(away), 1.2, "from the middle of a triangle")
        self.assertGreater(found[:, 4].mean(), 0.7, "they lie on their bedding plane")
        largest = found[:, 3] > np.quantile(found[:, 3], 0.9)
        self.assertLess(found[largest, 2].mean(), found[:, 2].mean())

    def test_text_and_suzanne(self):
        """Text whose letters lie apart, and a monkey with open eyes, which are closed."""
        curve = bpy.data.curves.new("Text", "FONT")
        curve.body, curve.extrude = "R8", 0.2
        text = bpy.data.objects.new("Text", curve)
        bpy.context.collection.objects.link(text)
        select(text)
        bpy.ops.object.convert(target="MESH")
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="SELECT")
        bpy.ops.mesh.remove_doubles(threshold=1e-5)
        bpy.ops.object.mode_set(mode="OBJECT")
        text.rotation_euler.x = math.pi / 2
        bpy.ops.mesh.primitive_monkey_add(location=(5.0, 0.0, 0.0))
        monkey = bpy.context.active_object
        for item, preset in ((text, "CANYON"), (monkey, "OVERTURNED"), (monkey, "FAULTED")):
            select(item)
            item.hide_set(False)
            ops.strata_preset(preset=preset) if item == text else ops.fill_with_strata(
                preset=preset, close_holes=True, faces=4000
            )
            select(item)
            item.hide_set(False)
            item.realmodel_strata.faces = 4000
            ops.strata_erode()
            left = abs(volume(evaluated(item)))
            self.assertTrue(strata_modifier.shows_erosion(item))
            self.assertEqual(open_edges(evaluated(item)), 0, len(evaluated(item).polygons))
            self.assertGreater(left, 0.0)
            ops.fill_with_strata(use_dialog=False)
            beds = [bed for bed in item.realmodel_strata.beds_in.objects if "realmodel_bed" in bed]
            self.assertTrue(all(not open_edges(bed.data) and volume(bed.data) > 0 for bed in beds))
            self.assertAlmostEqual(sum(volume(bed.data) for bed in beds) / left, 1.0, places=3)

    def test_rocks_of_the_add_menu(self):
        for kind in strata_presets.SHAPES:
            ops.strata_rock_add(kind=kind, size=4.0, seed=2, faces=4000)
            item = bpy.context.active_object
            self.assertEqual(item.type, "MESH")
            self.assertTrue(2.0 < item.dimensions.x < 4.5)
            self.assertGreater(len(set(numbers_of(evaluated(item)).tolist())), 4)
            self.assertTrue(strata_modifier.shows_erosion(item))

    def test_holes_are_closed_on_request(self):
        item = ball("A", 2.0, n=32)
        select(item)
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="DESELECT")
        bpy.ops.object.mode_set(mode="OBJECT")
        for number in (40, 41, 700):
            item.data.polygons[number].select = True
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.delete(type="FACE")
        bpy.ops.object.mode_set(mode="OBJECT")
        self.refused(ops.fill_with_strata, "A: it is open, for example near .* close it")
        beds = self.filled(item, close_holes=True, beds=4)
        self.assertTrue(all(not open_edges(bed.data) for bed in beds))

    def test_cancelled_and_refused_work_leaves_everything_as_it_was(self):
        item = ball("A", n=64)
        select(item)
        before = inventory()
        ops.strata_preset(preset="FOLDED")
        item.realmodel_strata.beds = 40
        before = inventory()
        job = FillJob(self.scene, item)
        job.start()
        job.cancel()
        job.wait()
        with self.assertRaises(Cancelled):
            job.finish()
        self.refused(ops.fill_with_strata, "too narrow", fold_amplitude=0.1, fold_wavelength=1e-5)
        self.assertEqual(inventory(), before)
        opened = cube("Open")
        opened.data.clear_geometry()
        opened.data.from_pydata([(0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)], [], [(0, 1, 2, 3)])
        select(opened)
        self.refused(ops.fill_with_strata, "Open: it is open, for example near .* close it")
        empty = bpy.data.objects.new("Empty", None)
        bpy.context.collection.objects.link(empty)
        select(empty)
        self.refused(ops.fill_with_strata, "the active object is no mesh")

    def test_the_surface_of_the_mesh_keeps_smooth_shading_uvs_materials_and_groups(self):
        """On a ball whose upper half is smooth, and whose UV maps and weights are linear in space; mirrored,
        too."""
        for scale in (1.0, -1.0):
            with self.subTest(scale=scale):
                self.check_what_the_surface_keeps(scale)

    def check_what_the_surface_keeps(self, scale):
        item = ball(f"A{scale:.0f}", 2.0)
        item.scale.x = scale
        bpy.context.view_layer.update()
        mesh = item.data
        mesh.polygons.foreach_set("use_smooth", [polygon.center.z > 0 for polygon in mesh.polygons])
        for name in ("Lower", "Upper"):
            mesh.materials.append(bpy.data.materials.new(name))
        mesh.polygons.foreach_set("material_index", [polygon.center.z > 0 for polygon in mesh.polygons])
        group = item.vertex_groups.new(name="West")
        for number, (x, _, _) in enumerate(coordinates(mesh).tolist()):
            if x < 0.0:
                group.add([number], -x / 2.0, "REPLACE")
        vertices = np.empty(len(mesh.loops), np.int32)
        mesh.loops.foreach_get("vertex_index", vertices)
        for name, plan in (("UVMap", slice(0, 2)), ("Paint", slice(1, 3))):
            uv = np.ascontiguousarray(coordinates(mesh)[vertices][:, plan], np.float32)
            mesh.uv_layers.new(name=name).data.foreach_set("uv", uv.ravel())
        kept = 0
        for bed in self.filled(item, beds=4, dip=0.3, keep_materials=True):
            mesh = bed.data
            self.assertEqual([layer.name for layer in mesh.uv_layers], ["UVMap", "UVMap of Mesh", "Paint"])
            self.assertEqual(mesh.uv_layers.active.name, "UVMap")
            self.assertEqual([group.name for group in bed.vertex_groups], ["West"])
            for polygon in mesh.polygons:
                corners = [mesh.vertices[vertex].co for vertex in polygon.vertices]
                outside = abs(polygon.center.length - 2.0) < 0.05 and polygon.center.dot(polygon.normal) > 1.9
                material = mesh.materials[polygon.material_index].name
                if not outside:
                    self.assertFalse(polygon.use_smooth)
                    self.assertNotIn(material.split(".")[0], ("Lower", "Upper"))
                    continue
                kept += 1
                if abs(polygon.center.z) > 0.2:
                    self.assertEqual(polygon.use_smooth, polygon.center.z > 0)
                    self.assertEqual(material.split(".")[0], "Upper" if polygon.center.z > 0 else "Lower")
                for loop, corner in zip(polygon.loop_indices, corners, strict=True):
                    np.testing.assert_allclose(
                        mesh.uv_layers["UVMap of Mesh"].data[loop].uv, corner[:2], atol=1e-4
                    )
                    np.testing.assert_allclose(mesh.uv_layers["Paint"].data[loop].uv, corner[1:], atol=1e-4)
                    entry = next(iter(mesh.vertices[mesh.loops[loop].vertex_index].groups), None)
                    weight = 0.0 if entry is None else entry.weight
                    if abs(corner[0]) > 0.2:
                        self.assertAlmostEqual(weight, max(-corner[0] / 2.0, 0.0), delta=0.003)
        self.assertGreater(kept, 500)
