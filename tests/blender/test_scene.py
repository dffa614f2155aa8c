# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene that docs/reference/project_file.md promises, read back from a saved .blend."""

import tempfile
import unittest
from pathlib import Path

import bpy
import numpy as np
import realmodel
from blender_state import coordinates, corners, drawn_areas, empty_file, inventory, open_edges, volume
from made_projects import LIBRARY, main_rock, one_rock, other_rock, two_rocks
from panel_case import PanelCase
from realmodel.bl.objects import meshes, model_tree
from realmodel.bl.pictures import batch
from realmodel.bl.scene import built_scene
from realmodel.core import Library, Project, Property, build


def tagged(kind):
    return [item for item in bpy.context.scene.objects if item.get("realmodel") == kind]


class SavedScene(unittest.TestCase):
    """Two rock masses at UTM coordinates, written to a .blend and opened again."""

    @classmethod
    def setUpClass(cls):
        cls.model = build(two_rocks())
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "model.blend"
            bpy.ops.wm.read_factory_settings()  # with the cube, light and camera of the startup file
            realmodel.register()
            batch.write_scene(cls.model)
            batch.save_blend(path)
            realmodel.unregister()  # the scene says what it is without the add-on
            empty_file()
            bpy.ops.wm.open_mainfile(filepath=str(path))
        cls.origin = np.array(bpy.context.scene["realmodel_origin"])

    def blocks(self):
        """Pairs of an object and the model's block, by what the custom properties say."""
        model = self.model
        key = {(model.project.rocks[b.rock].name, b.name): n for n, b in enumerate(model.blocks)}
        return [(o, key[o["realmodel_rock"], o["realmodel_block"]]) for o in tagged("block")]

    def test_collections(self):
        top = bpy.context.scene.collection
        self.assertEqual([c.name for c in top.children], ["Zwei Körper"])
        self.assertEqual(len(top.objects), 0)
        project = top.children[0]
        self.assertEqual([c.name for c in project.children], ["hill", "outlier"])
        for rock in project.children:
            children = [c.name for c in rock.children]
            self.assertEqual(children, [f"{rock.name} interfaces", f"{rock.name} blocks"])
            for child, kind in zip(rock.children, ("interface", "block"), strict=True):
                self.assertTrue(len(child.objects))
                for item in child.objects:
                    self.assertEqual(item["realmodel"], kind)
                    self.assertEqual(item["realmodel_rock"], rock.name)

    def test_nothing_of_the_startup_file_is_left(self):
        self.assertEqual({o.type for o in bpy.data.objects}, {"MESH"})
        self.assertNotIn("Cube", bpy.data.objects)

    def test_interfaces_are_the_input_triangulations(self):
        expected = [(r, s) for r in self.model.project.rocks for s in r.surfaces]
        interfaces = tagged("interface")
        found = {(item["realmodel_rock"], item["realmodel_surface"]): item for item in interfaces}
        self.assertEqual(len(found), len(interfaces))
        self.assertEqual(set(found), {(r.name, s.name) for r, s in expected})
        for number, (rock, given) in enumerate(expected):
            item = found[rock.name, given.name]
            self.assertEqual(item.name.split(".")[0], given.name)
            self.assertEqual(item["realmodel_property"], given.property)
            vertices, triangles = self.model.surface(number)
            np.testing.assert_array_equal(corners(item.data)[1].reshape(-1, 3), triangles)
            away = np.abs(coordinates(item.data) + self.origin - vertices).max()
            self.assertLess(away, 1e-5)

    def test_every_block_that_exists_is_one_object(self):
        pairs = self.blocks()
        existing = [n for n, b in enumerate(self.model.blocks) if b.cells]
        self.assertEqual(sorted(n for _, n in pairs), existing)
        self.assertLess(len(existing), len(self.model.blocks))  # "Gone" is gone
        for item, number in pairs:
            block = self.model.blocks[number]
            self.assertEqual(item["realmodel_property"], block.property)
            self.assertEqual(item["realmodel_surface"], self.model.surface_names[block.surface])
            self.assertEqual(item.name.split(".")[0], block.name)

    def test_blocks_are_closed(self):
        for item, number in self.blocks():
            boundary = self.model.block_boundary(number)
            self.assertEqual(open_edges(item.data), 0, item.name)
            self.assertEqual(len(item.data.polygons), len(boundary.face_offsets) - 1)
            self.assertEqual(len(item.data.vertices), len(boundary.vertices))

    def test_volumes(self):
        for item, number in self.blocks():
            expected = self.model.blocks[number].volume
            self.assertAlmostEqual(volume(item.data) / expected, 1.0, delta=1e-5, msg=item.name)

    def test_walls_are_drawn_without_folds(self):
        """Polygons, concave walls among them, and the triangles they are drawn with have one area."""
        for item, _ in self.blocks():
            polygons, drawn = drawn_areas(item.data)
            np.testing.assert_allclose(drawn, polygons, rtol=1e-3, atol=1e-3, err_msg=item.name)

    def test_faces_know_their_surface(self):
        for item, number in self.blocks():
            values = np.empty(len(item.data.polygons), np.int32)
            item.data.attributes[meshes.FACE_SURFACE].data.foreach_get("value", values)
            np.testing.assert_array_equal(values, self.model.block_boundary(number).face_surface)

    def test_blocks_are_flat_shaded_and_surfaces_smooth(self):
        for kind, wanted in (("block", False), ("interface", True)):
            for item in tagged(kind):
                smooth = np.full(len(item.data.polygons), not wanted)
                item.data.polygons.foreach_get("use_smooth", smooth)
                self.assertTrue((smooth == wanted).all(), item.name)

    def test_one_material_for_each_property(self):
        shared = {}
        for item, _ in self.blocks():
            self.assertEqual(len(item.data.materials), 1)
            material = item.data.materials[0]
            self.assertEqual(material["realmodel_property"], item["realmodel_property"])
            shared.setdefault(item["realmodel_property"], set()).add(material.name)
        self.assertEqual({key: len(names) for key, names in shared.items()}, dict.fromkeys(shared, 1))
        self.assertEqual(set(shared), {0, 1, 2, 3, 4})
        self.assertEqual(len({next(iter(names)) for names in shared.values()}), len(shared))

    def test_colors(self):
        # Worked out by hand from IEC 61966-2-1: 0xe0 is 0.745404, 0x20 is 0.014444, 0xb3 is 0.450786.
        expected = {
            2: ("Sandstone", (0.745404, 0.014444, 0.014444)),
            0: ("no property", (0.450786, 0.450786, 0.450786)),
        }
        for item, _ in self.blocks():
            material = item.data.materials[0]
            name, color = expected.get(item["realmodel_property"], (material.name, None))
            self.assertEqual(material.name, name)
            nodes = [n for n in material.node_tree.nodes if n.type == "BSDF_PRINCIPLED"]
            base = tuple(nodes[0].inputs["Base Color"].default_value)
            np.testing.assert_allclose(base, tuple(material.diffuse_color), atol=1e-7)
            if color is not None:
                np.testing.assert_allclose(base, (*color, 1.0), atol=1e-5)
            elif item["realmodel_property"]:
                self.assertEqual(name, LIBRARY.get(item["realmodel_property"]).name)

    def test_origin_keeps_utm_coordinates(self):
        self.assertTrue((np.abs(self.origin[:2] - (377500, 5397935)) < 100).all(), self.origin)
        self.assertTrue((self.origin == np.rint(self.origin)).all(), "not a round number")
        self.assertEqual(self.origin[2], 0.0)  # heights keep their own zero
        for item, number in self.blocks():
            exact = self.model.block_boundary(number).vertices
            away = np.abs(coordinates(item.data) + self.origin - exact).max()
            self.assertLess(away, 1e-5)
            self.assertEqual(tuple(item.location), (0.0, 0.0, 0.0))

    def test_viewports_see_the_model(self):
        spaces = [s for screen in bpy.data.screens for a in screen.areas for s in a.spaces]
        viewports = [space for space in spaces if space.type == "VIEW_3D"]
        self.assertTrue(viewports)
        for space in viewports:
            self.assertGreater(space.clip_end, 2.0 * space.region_3d.view_distance)


class Rebuild(PanelCase):
    """A model in place of an earlier one, and failures."""

    def setUp(self):
        super().setUp()
        mesh = bpy.data.meshes.new("tree")
        self.tree = bpy.data.objects.new("tree", mesh)
        self.scene.collection.objects.link(self.tree)

    def test_replaces_the_earlier_model_and_nothing_else(self):
        built_scene.write_model(self.scene, build(two_rocks()))
        inside = bpy.data.objects.new("hammer", None)  # the user's own, put among the blocks
        bpy.data.collections["hill blocks"].objects.link(inside)
        smaller = build(Project("Hill", [main_rock()], LIBRARY), cells="blocks")
        built_scene.write_model(self.scene, smaller)
        self.assertEqual(self.model.collection.name, "Hill")
        self.assertNotIn("outlier", bpy.data.collections)
        names = {o.name for o in model_tree.model_objects(self.scene)}
        existing = {b.name for b in smaller.blocks if b.cells}
        self.assertEqual(names, {"S0", "S1", "S2", "S3", "S4"} | existing)
        self.assertIn("hammer", self.scene.objects)
        self.assertIn("tree", self.scene.collection.objects)
        self.assertEqual(len(bpy.data.meshes), len(names) + 1)
        self.assertNotIn("Gravel", bpy.data.materials)

    def test_blocks_without_columns_are_drawn_alike(self):
        model = build(two_rocks(), cells="blocks")
        built_scene.write_model(self.scene, model)
        volumes = {(b.rock, b.name): b.volume for b in model.blocks}
        rocks = [rock.name for rock in model.project.rocks]
        for item in model_tree.model_objects(self.scene, "block"):
            expected = volumes[rocks.index(item["realmodel_rock"]), item["realmodel_block"]]
            self.assertAlmostEqual(volume(item.data) / expected, 1.0, delta=1e-5, msg=item.name)
            self.assertEqual(open_edges(item.data), 0, item.name)
            polygons, drawn = drawn_areas(item.data)
            np.testing.assert_allclose(drawn, polygons, rtol=1e-3, atol=1e-3, err_msg=item.name)

    def test_same_model_twice_is_the_same_scene(self):
        model = build(two_rocks())
        built_scene.write_model(self.scene, model)
        before = inventory()
        built_scene.write_model(self.scene, model)
        self.assertEqual(inventory(), before)

    def test_a_material_is_kept_and_follows_the_library(self):
        built_scene.write_model(self.scene, build(one_rock()))
        material = bpy.data.materials["Sandstone"]
        material["mine"] = "texture"
        entries = [Property(2, "Grès", color="#00ff00") if p.id == 2 else p for p in LIBRARY]
        built_scene.write_model(self.scene, build(Project("Hill", [main_rock()], Library(entries))))
        self.assertEqual(bpy.data.materials["Grès"]["mine"], "texture")
        np.testing.assert_allclose(bpy.data.materials["Grès"].diffuse_color, (0, 1, 0, 1), atol=1e-6)
        self.assertNotIn("Sandstone", bpy.data.materials)

    def test_a_material_takes_the_name_of_one_that_goes(self):
        built_scene.write_model(self.scene, build(one_rock()))
        one = main_rock()
        for surface in one.surfaces:
            surface.property = 1
        library = Library([Property(1, "Sandstone", color="#102030")])
        built_scene.write_model(self.scene, build(Project("Hill", [one], library)))
        self.assertEqual([m.name for m in bpy.data.materials], ["Sandstone"])
        self.assertEqual(bpy.data.materials[0]["realmodel_property"], 1)

    def test_in_an_opened_file_other_objects_stay(self):
        with tempfile.TemporaryDirectory() as folder:
            path = str(Path(folder) / "mine.blend")
            bpy.ops.wm.save_as_mainfile(filepath=path)
            bpy.ops.wm.open_mainfile(filepath=path)
            batch.write_scene(build(one_rock()))
        self.assertIn("tree", bpy.context.scene.objects)
        self.assertEqual(len(tagged("interface")), 5)

    def test_two_scenes_each_with_its_model(self):
        second = bpy.data.scenes.new("second")
        built_scene.write_model(self.scene, build(one_rock()))
        first_objects = {o.name for o in model_tree.model_objects(self.scene)}
        outlier = build(Project("Hill", [other_rock()], LIBRARY))
        built_scene.write_model(second, outlier)
        self.assertEqual({o.name for o in model_tree.model_objects(self.scene)}, first_objects)
        surfaces = [o["realmodel_surface"] for o in model_tree.model_objects(second, "interface")]
        self.assertEqual(surfaces, ["S0", "S1", "S2"])
        built_scene.remove_model(second)
        self.assertEqual({o.name for o in model_tree.model_objects(self.scene)}, first_objects)
        self.assertEqual(model_tree.model_objects(second), [])

    def test_remove_model_leaves_only_other_objects(self):
        self.model.exists = False  # and makes the settings
        before = inventory()
        built_scene.write_model(self.scene, build(two_rocks()))
        built_scene.remove_model(self.scene)
        self.assertEqual(inventory(), before)

    def test_a_stage_is_a_scene_too(self):
        model = build(one_rock()).stage(1)
        built_scene.write_model(self.scene, model)
        self.assertEqual(len(model_tree.model_objects(self.scene, "interface")), 2)
        existing = sum(bool(b.cells) for b in model.blocks)
        self.assertEqual(len(model_tree.model_objects(self.scene, "block")), existing)

    def test_triangles_without_corners_of_their_own_are_left_out(self):
        mesh = meshes.triangle_mesh("m", np.eye(3, dtype=np.float32), [[0, 1, 2], [0, 1, 1]])
        self.assertEqual(len(mesh.polygons), 1)
        self.assertFalse(mesh.validate(), "Blender had to mend the mesh")


if __name__ == "__main__":
    unittest.main()
