# SPDX-License-Identifier: GPL-3.0-or-later
"""Weathering: a modifier of geometry nodes on blocks, whose meshes stay as they are."""

import math

import bpy
import numpy as np
from mathutils import Vector, noise
from mathutils.bvhtree import BVHTree
from panel_case import PanelCase, ops, raise_by, select, stack
from realmodel.bl.host import versions
from realmodel.bl.objects import meshes
from realmodel.bl.shading import edge_wear, looks, weathering


class Counting(bpy.types.RenderEngine):
    """A renderer that counts the instances that it is to render."""

    bl_idname, bl_label = "COUNTING", "Counting"
    counts = {}

    def render(self, depsgraph):
        for each in depsgraph.object_instances:
            if each.is_instance:
                name = each.object.data.name.partition(".")[0]
                self.counts[name] = self.counts.get(name, 0) + 1


def polygons_of(item):
    """The vertices and polygons of a mesh without modifiers."""
    return meshes.mesh_coordinates(item.data).tolist(), [tuple(p.vertices) for p in item.data.polygons]


class Weathering(PanelCase):
    def setUp(self):
        super().setUp()
        self.sheets = stack(0.0, 20.0, lambda x, y: 40.0 + 0.1 * x + 0.6 * max(0.0, y - 50.0))
        self.model.library.clear()
        for name, rock in (("lower", "shale"), ("upper", "granite")):
            ops.library_add(name=name)
            self.model.library[-1].rock = rock
        for number in (1, 2):
            self.model.rocks[0].surfaces[number].property_id = self.model.library[number - 1].id
        ops.build()

    def block(self, number):
        return bpy.data.objects[f"S{number} block"]

    def evaluated(self, number):
        """(V, 3) vertices, names of the materials of the polygons, and how each faces up."""
        bpy.context.view_layer.update()
        item = self.block(number).evaluated_get(bpy.context.evaluated_depsgraph_get())
        mesh = item.data
        slots = [material.name for material in mesh.materials]
        names = np.array([slots[polygon.material_index] for polygon in mesh.polygons])
        return meshes.mesh_coordinates(mesh), names, np.array([p.normal.z for p in mesh.polygons])

    def test_the_evaluated_mesh_is_worn_and_the_block_is_not(self):
        plain = [meshes.mesh_coordinates(self.block(n).data) for n in (1, 2)]
        volumes, files = self.volumes(), [self.folder / name for name in ("plain.ply", "weathered.ply")]
        ops.export(filepath=str(files[0]))
        ops.weathering(strength=2.0, detail=3)
        ops.export(filepath=str(files[1]))
        self.assertEqual(*(file.read_bytes() for file in files))
        low = self.evaluated(1)[0]
        for number in (1, 2):
            self.assertTrue(
                np.array_equal(meshes.mesh_coordinates(self.block(number).data), plain[number - 1])
            )
            found = self.evaluated(number)[0]
            self.assertGreater(len(found), 20 * len(plain[number - 1]))
        self.assertEqual(self.volumes(), volumes)
        # Walls fall back; the base and the sheet between the blocks stay where they are.
        self.assertLess(np.ptp(low[:, 0]), np.ptp(plain[0][:, 0]) - 0.5)
        for level in (plain[0][:, 2].min(), plain[0][:, 2].max()):
            middle = np.abs(low[:, :2] - plain[0][:, :2].mean(axis=0)).max(axis=1)
            inside = (middle < 40.0) & (np.abs(low[:, 2] - level) < 1.0)
            self.assertGreater(np.count_nonzero(inside), 20)
            self.assertLess(np.abs(low[inside, 2] - level).max(), 0.01)
        self.assertFalse(self.block(1).modifiers[0].show_in_editmode)
        ops.weathering_remove()
        self.assertEqual(len(self.evaluated(1)[0]), len(plain[0]))
        self.refused(ops.weathering_remove, "no block is weathered")

    def test_only_what_is_seen_is_subdivided_and_within_a_budget(self):
        def polygons():
            mesh = self.block(1).evaluated_get(bpy.context.evaluated_depsgraph_get()).data
            surface = meshes.values(mesh, "realmodel_surface", np.int32)
            return np.count_nonzero(surface == -1), np.count_nonzero((surface != -1) & (surface != -3))

        bpy.context.view_layer.update()
        seen, hidden = polygons()
        corners = sum(
            p.loop_total
            for p, a in zip(
                self.block(1).data.polygons,
                self.block(1).data.attributes["realmodel_surface"].data,
                strict=True,
            )
            if a.value == -1
        )
        ops.weathering(detail=3)
        self.assertEqual(polygons(), (16 * corners, hidden))
        ops.weathering(detail=3, most_faces=3000)
        found = versions.group_input(weathering.modifier_of(self.block(1)), "Detail")
        self.assertLess(found, 3)
        self.assertEqual(polygons(), (corners * 4 ** (found - 1), hidden))
        ops.weathering(detail=3, most_faces=1)
        self.assertEqual(polygons(), (seen, hidden))

    def test_detail_follows_the_distance_to_the_camera(self):
        self.refused(ops.weathering, "the scene has no camera", adaptive=True)
        camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
        bpy.context.collection.objects.link(camera)
        camera.location = (50.0, -10.0, 30.0)
        self.scene.camera = camera
        bpy.context.view_layer.update()
        ops.weathering(detail=6, most_faces=60_000)
        even = versions.group_input(weathering.modifier_of(self.block(2)), "Detail")
        ops.weathering(detail=6, most_faces=60_000, adaptive=True)
        detail = versions.group_input(weathering.modifier_of(self.block(2)), "Detail")
        self.assertGreater(detail, even)
        counts, sizes = 0, {}
        for number in (1, 2):
            worn = self.block(number).evaluated_get(bpy.context.evaluated_depsgraph_get()).data
            counts += len(worn.polygons)
            for polygon in worn.polygons:
                away = (polygon.center - camera.location).length
                if polygon.normal.z > 0.5 and number == 2:
                    sizes.setdefault(int(away // 25), []).append(polygon.area)
        self.assertLess(counts, 90_000)
        areas = [np.mean(sizes[far]) for far in sorted(sizes)]
        self.assertGreater(areas[-1], 6.0 * areas[0])

    def test_lengths_are_those_of_the_beds(self):
        found = {}
        for beds in (10, 20):
            bpy.ops.mesh.primitive_cube_add(size=20.0, location=(500.0 * beds, 0.0, 10.0))
            ops.fill_with_strata(beds=beds, dip=0.0, palette="COAL")
            chosen = list(bpy.context.selected_objects)
            ops.weathering()
            found[beds] = versions.group_input(weathering.modifier_of(chosen[0]), "Strength")
        self.assertAlmostEqual(
            found[10] / found[20], 1.75, delta=0.3
        )  # a bed is a 20th of the diagonal at most
        self.assertAlmostEqual(found[20], 0.5, delta=0.15)

    def test_sheets_between_blocks_do_not_stick_out(self):
        """Polygons are smaller here than what is worn away."""
        ops.weathering(strength=6.0, detail=5)
        for number, most in ((1, 49.0), (2, 49.7)):
            found = self.evaluated(number)[0]
            away = np.abs(found - (found.min(axis=0) + found.max(axis=0)) / 2)[:, :2]
            self.assertLess(away[away[:, 1] < 30.0, 0].max(), most)

    def test_soft_rock_falls_back_behind_hard_rock(self):
        ops.weathering(strength=3.0, rounding=0.0, detail=3)
        soft, hard = (np.ptp(self.evaluated(n)[0][:, 0]) for n in (1, 2))
        self.assertLess(soft, hard - 0.2)
        self.model.library[0].hardness, self.model.library[1].hardness = 1.0, 0.01
        soft, hard = (np.ptp(self.evaluated(n)[0][:, 0]) for n in (1, 2))
        self.assertLess(hard, soft - 0.2)

    def test_grass_on_level_ground_and_scree_on_slopes(self):
        ops.weathering(strength=0.2, detail=3, grass_slope=math.radians(22.0), scree_slope=math.radians(60.0))
        _, names, up = self.evaluated(2)
        self.assertEqual(set(names), {"upper", "Grass", "Scree"})
        self.assertEqual(set(names[up < 0.2]), {"upper"})
        self.assertGreater(up[names == "Grass"].mean(), up[names == "Scree"].mean() + 0.05)
        self.assertEqual(set(self.evaluated(1)[1]), {"lower"})  # which no ground is of
        ops.weathering(strength=0.2, grass_slope=0.0, scree_slope=0.0)
        self.assertEqual(set(self.evaluated(2)[1]), {"upper"})

    def test_grass_on_a_few_large_faces(self):
        bpy.ops.mesh.primitive_cube_add(size=20.0, location=(500.0, 0.0, 10.0))
        ops.fill_with_strata(beds=2, dip=0.0, palette="COAL")
        ops.weathering(strength=0.0, detail=0)
        highest = max(bpy.context.selected_objects, key=lambda item: item.name)
        worn = highest.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
        self.assertIn("Grass", {worn.materials[p.material_index].name for p in worn.polygons})

    def test_up_is_the_worlds_where_the_mesh_is_turned(self):
        bpy.ops.mesh.primitive_cube_add(size=20.0, location=(500.0, 0.0, 10.0))
        bpy.context.object.rotation_euler = (math.radians(90.0), math.radians(20.0), math.radians(50.0))
        bpy.context.object.scale = (1.0, 1.0, 1.0)
        ops.fill_with_strata(beds=2, dip=0.0, palette="COAL")
        ops.weathering(strength=0.0, detail=3, grass_slope=math.radians(40.0), plants=1.0)
        highest = max(bpy.context.selected_objects, key=lambda item: item.name)
        depsgraph = bpy.context.evaluated_depsgraph_get()
        worn = highest.evaluated_get(depsgraph)
        turn, slots = worn.matrix_world.to_3x3(), [m.name for m in worn.data.materials]
        up = [(turn @ p.normal).z for p in worn.data.polygons if slots[p.material_index] == "Grass"]
        self.assertGreater(len(up), 20)
        self.assertGreater(min(up), 0.6)
        tufts = [
            (each.matrix_world.to_3x3() @ Vector((0.0, 0.0, 1.0))).normalized().z
            for each in depsgraph.object_instances
            if each.is_instance and each.parent == worn and each.object.data.name == "Grass Tuft"
        ]
        self.assertGreater(len(tufts), 20)
        self.assertGreater(min(tufts), 0.9)

    def test_only_selected_blocks_and_again_changes_them(self):
        select(self.block(2))
        ops.weathering(seed=1)
        self.assertIsNone(weathering.modifier_of(self.block(1)))
        first = self.evaluated(2)[0]
        ops.weathering(seed=2)
        self.assertEqual(len(self.block(2).modifiers), 1)
        self.assertEqual(len([g for g in bpy.data.node_groups if weathering.KEY in g]), 1)
        self.assertGreater(np.abs(self.evaluated(2)[0] - first).max(), 0.05)

    def test_builds_files_and_live_editing_keep_it(self):
        ops.weathering(seed=4)
        modifier = weathering.modifier_of(self.block(2))
        versions.set_group_input(modifier, "Hardness", 0.125)  # by hand
        versions.set_group_input(modifier, "Edge Rounding", 0.25)
        before = np.ptp(self.evaluated(2)[0][:, 2])
        raise_by(self.sheets[2], 30.0)
        ops.build()
        self.assertGreater(np.ptp(self.evaluated(2)[0][:, 2]), before + 25.0)
        self.model.live = True
        raise_by(self.sheets[2], -30.0)
        self.live_is_done()
        self.assertAlmostEqual(np.ptp(self.evaluated(2)[0][:, 2]), before, delta=1.0)
        self.save_and_open()
        modifier = weathering.modifier_of(self.block(2))
        found = [versions.group_input(modifier, name) for name in ("Seed", "Hardness", "Edge Rounding")]
        self.assertEqual(found, [4, 0.125, 0.25])
        self.assertAlmostEqual(np.ptp(self.evaluated(2)[0][:, 2]), before, delta=1.0)

    def scattered(self, item):
        """{name: places} of the instances of an evaluated object."""
        bpy.context.view_layer.update()
        found = {}
        for each in bpy.context.evaluated_depsgraph_get().object_instances:
            if each.is_instance and each.parent.original == item:
                name = each.object.data.name.partition(".")[0]
                found.setdefault(name, []).append(tuple(each.matrix_world.translation))
        return found

    def rendered_instances(self):
        """{name: count} of the instances that a render has."""
        bpy.utils.register_class(Counting)
        try:
            self.scene.render.engine = Counting.bl_idname
            self.scene.render.resolution_x = self.scene.render.resolution_y = 8
            self.scene.camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
            Counting.counts.clear()
            bpy.ops.render.render()
        finally:
            bpy.utils.unregister_class(Counting)
        return dict(Counting.counts)

    def test_plants_and_stones_stand_on_the_ground(self):
        ops.weathering(strength=0.2, plants=2.0, scree_slope=math.radians(60.0))
        found = self.scattered(self.block(2))
        self.assertEqual(set(found), {"Grass Tuft", "Stone"})
        points = self.evaluated(2)[0]
        for places in found.values():
            self.assertGreater(len(places), 20)
            for place in places[:20]:
                self.assertLess(np.linalg.norm(points - place, axis=1).min(), 8.0)
        self.assertEqual(self.scattered(self.block(1)), {})  # which no ground is of
        self.assertFalse(any(item.get("realmodel_scatter") for item in self.scene.objects))
        counted = self.rendered_instances()
        for name, places in found.items():
            self.assertGreater(counted[name], 3 * len(places))  # the viewport shows fewer
        ops.weathering(strength=0.2)
        self.assertEqual(self.scattered(self.block(2)), {})

    def test_beds_of_a_filled_mesh(self):
        bpy.ops.mesh.primitive_cube_add(size=20.0, location=(500.0, 0.0, 10.0))
        bpy.context.object.rotation_euler.x = math.pi / 2
        ops.fill_with_strata(beds=3, dip=0.0, palette="COAL")
        beds = sorted(bpy.context.selected_objects, key=lambda item: item.name)
        top = [np.array([a.value for a in bed.data.attributes["realmodel_is_top"].data]) for bed in beds]
        self.assertEqual([found.any() for found in top], [False, False, True])
        ops.weathering(strength=1.0, detail=4, plants=1.0)
        self.assertIsNone(weathering.modifier_of(self.block(2)))
        hard = []
        for bed in beds:
            worn = bed.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
            self.assertLess(np.ptp(meshes.mesh_coordinates(worn)[:, 0]), 20.0)
            hard.append(versions.group_input(weathering.modifier_of(bed), "Hardness"))
        looks = [bed.material_slots[0].material["realmodel_look"] for bed in beds]
        np.testing.assert_allclose(hard, [weathering.LOOKS[look].hardness for look in looks], rtol=1e-6)
        ops.weathering_remove()
        self.assertFalse(any(bed.modifiers for bed in beds))

    def test_edges_are_worn_in_materials_without_a_finer_mesh(self):
        materials = [self.block(n).data.materials[0] for n in (1, 2)]
        plain, corners = [self.evaluated(n)[0] for n in (1, 2)], len(self.block(2).data.vertices)
        select(self.block(2))
        ops.weathering(strength=0.0, detail=0, wear=2.0, grass_slope=0.0, scree_slope=0.0)
        places = [{tuple(place) for place in found.tolist()} for found in (self.evaluated(2)[0], plain[1])]
        self.assertEqual(*places)
        self.assertEqual(len(plain[1]), corners)
        worn = self.block(2).evaluated_get(bpy.context.evaluated_depsgraph_get()).data
        values = np.array([v.value for v in worn.attributes[edge_wear.ATTRIBUTE].data])
        thickness = looks.diagonal(self.scene) / 20  # at most: the blocks are thicker
        np.testing.assert_allclose(values, 0.2 * thickness, rtol=1e-5)
        self.assertNotIn(edge_wear.ATTRIBUTE, self.block(2).data.attributes)
        self.assertEqual([edge_wear.has(material) for material in materials], [False, True])
        ops.rock_looks(look="GRANITE")
        self.assertEqual([edge_wear.has(material) for material in materials], [False, True])
        tree = materials[1].node_tree
        mixed = next(link.from_node for link in tree.links if link.to_socket.name == "Base Color")
        self.assertIn(edge_wear.KEY, [link.from_node.name for link in tree.links if link.to_node == mixed])
        count = len(tree.nodes)
        ops.weathering(strength=0.0, detail=0, wear=1.0)
        self.assertEqual(len(tree.nodes), count)
        ops.weathering_remove()
        self.assertFalse(edge_wear.has(materials[1]))
        seen = next(node for node in tree.nodes if node.type == "MIX")
        self.assertTrue(all(s.is_linked for s in seen.inputs if s.name in "AB" and s.enabled))

    def exposed(self, items):
        """(F, 3) normals of all exposed polygons, evaluated."""
        bpy.context.view_layer.update()
        found = []
        for item in items:
            mesh = item.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
            is_top = meshes.values(mesh, "realmodel_is_top", bool)
            surface = meshes.values(mesh, "realmodel_surface", np.int32)
            normals = np.empty(3 * len(mesh.polygons), np.float32)
            mesh.polygons.foreach_get("normal", normals)
            found.append(normals.reshape(-1, 3)[is_top | (surface == -1)])
        return np.concatenate(found)

    def filled(self, rough, **settings):
        """The beds of a body whose surface is rough."""
        body = bpy.context.object
        for vertex in body.data.vertices:
            place = vertex.co.copy()
            vertex.co *= 1.0 + rough * (noise.noise(0.35 * place) + 0.3 * noise.noise(1.5 * place))
        ops.fill_with_strata(rock_looks=False, **settings)
        return list(bpy.context.selected_objects)

    def sphere(self):
        bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=4, radius=10.0)
        return self.filled(0.25, beds=8)

    def cow(self):
        """A body with a head and four legs."""
        parts = [((0, 0, 9), (6, 3, 3)), ((7, 0, 11), (2, 1.5, 2)), ((9, 0, 10.5), (1.5, 1, 1))]
        parts += [((x, y, 4), (1, 1, 5)) for x in (-4, 4) for y in (-2, 2)]
        for place, scale in parts:
            bpy.ops.mesh.primitive_uv_sphere_add(segments=16, ring_count=12, location=place, scale=scale)
        made = [item for item in self.scene.objects if item.name.startswith("Sphere")]
        select(*made)
        bpy.ops.object.join()
        remesh = bpy.context.object.modifiers.new("Remesh", "REMESH")
        remesh.mode, remesh.voxel_size = "VOXEL", 0.7
        bpy.ops.object.modifier_apply(modifier="Remesh")
        return self.filled(0.02, beds=10, dip=0.3)

    def example(self):
        ops.open_sample(sample="castle_hill")
        return [row.object for row in self.model.results]

    def test_no_face_is_turned_over(self):
        for body, strengths in ((self.sphere, (1.0, 20.0)), (self.cow, (5.0,)), (self.example, (20.0,))):
            items = body()
            select(*items)
            ops.weathering(strength=0.0, rounding=0.0)
            before = self.exposed(items)
            for strength in strengths:
                with self.subTest(body.__name__, strength=strength):
                    ops.weathering(strength=strength)
                    after = self.exposed(items)
                    self.assertEqual(len(after), len(before))
                    self.assertFalse(np.count_nonzero((after * before).sum(axis=1) < 0.0))
                    self.assertGreater(
                        np.count_nonzero(np.abs(after - before).max(axis=1) > 0.01), len(after) / 4
                    )

    def test_no_crack_is_seen_between_beds(self):
        items = self.sphere()
        ops.weathering(detail=2)
        bpy.context.view_layer.update()
        depsgraph = bpy.context.evaluated_depsgraph_get()
        worn = [BVHTree.FromObject(item, depsgraph) for item in items]
        plain = [BVHTree.FromPolygons(*polygons) for polygons in map(polygons_of, items)]
        deepest = versions.group_input(weathering.modifier_of(items[0]), "Deepest")
        for away in np.random.default_rng(5).normal(size=(3000, 3)):
            away = Vector(away).normalized()
            first = [
                min(hit[3] for tree in trees if (hit := tree.ray_cast(30.0 * away, -away))[0] is not None)
                for trees in (plain, worn)
            ]
            self.assertLess(first[1] - first[0], 1.5 * deepest)

    def rendered(self, item):
        """(48, 48, 3) of the western end of a block's southern wall; its edge is at column 8."""
        side, seen = 48, 24.0
        low = meshes.mesh_coordinates(item.data).min(axis=0)
        if self.scene.camera is None:
            camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
            camera.data.type, camera.data.ortho_scale = "ORTHO", seen
            camera.location = low + np.array([8.0, -50.0, 10.0])
            camera.rotation_euler.x = math.pi / 2
            lamp = bpy.data.objects.new("lamp", bpy.data.lights.new("lamp", "SUN"))
            lamp.rotation_euler, lamp.data.energy = (math.pi / 2 - 0.4, 0.0, 0.3), 3.0
            for each in (camera, lamp):
                self.scene.collection.objects.link(each)
            self.scene.camera, self.scene.world = camera, None
        render = self.scene.render
        render.engine = "CYCLES"
        self.scene.cycles.samples, self.scene.cycles.use_denoising = 4, False
        render.resolution_x = render.resolution_y = side
        render.resolution_percentage = 100
        render.filepath, render.image_settings.file_format = str(self.folder / "worn.png"), "PNG"
        bpy.ops.render.render(write_still=True)
        image = bpy.data.images.load(render.filepath)
        pixels = np.array(image.pixels[:], np.float32).reshape(side, side, -1)[:, :, :3]
        bpy.data.images.remove(image)
        return pixels

    def test_worn_edges_are_seen_and_faces_stay(self):
        ops.rock_looks(look="LIMESTONE")
        item = self.block(2)
        given = {"strength": 0.0, "detail": 0, "grass_slope": 0.0, "scree_slope": 0.0}
        ops.weathering(wear=0.0, **given)
        sharp = self.rendered(item)
        ops.weathering(wear=3.6, **given)
        changed = np.abs(self.rendered(item) - sharp).max(axis=2)[18:30]
        self.assertGreater(sharp[18:30, 8:].mean(), 0.02)  # the wall is seen
        self.assertLess(changed[:, 20:44].max(), 0.004)
        self.assertGreater(changed[:, 8:10].mean(), 0.015)

    def test_one_undo_step(self):
        bpy.ops.ed.undo_push(message="before")
        ops.weathering()
        bpy.ops.ed.undo_push(message="after")
        bpy.ops.ed.undo()
        self.assertIsNone(weathering.modifier_of(self.block(1)))
