# SPDX-License-Identifier: GPL-3.0-or-later
"""Beds of filled meshes in files of other programs, which are imported into Blender again."""

import unittest.mock

import bpy
import numpy as np
from blender_state import coordinates, inventory, volume
from boolean_case import ball
from panel_case import PanelCase, ops, select
from realmodel.bl.scene import scene_export

SIZE = 64
NAMES = ["A Bed 1", "A Bed 2", "A Bed 3"]


def read(path):
    """The objects that Blender imports from a file, by their names."""
    before = set(bpy.data.objects)
    if path.suffix == ".glb":
        if not hasattr(np, "bool"):
            np.bool = bool  # Debian's Blender 3.4 imports by this old name, which its NumPy has no more
        bpy.ops.import_scene.gltf(filepath=str(path))
    elif path.suffix == ".obj":
        bpy.ops.wm.obj_import(filepath=str(path))
    elif path.suffix == ".fbx":
        bpy.ops.import_scene.fbx(filepath=str(path))
    else:
        bpy.ops.wm.usd_import(filepath=str(path))
    made = [obj for obj in bpy.data.objects if obj not in before and obj.type == "MESH"]
    bpy.context.view_layer.update()
    return {obj.name: obj for obj in made}


def images(material):
    """{name of the input of the shader: image} of a material that was imported."""
    tree, found = material.node_tree, {}
    shader = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
    for socket in shader.inputs:
        pending = [link.from_node for link in socket.links]
        while pending:
            node = pending.pop()
            if node.type == "TEX_IMAGE":
                found[socket.name] = node.image
            pending += [link.from_node for inner in node.inputs for link in inner.links]
    return found


def triangles(mesh):
    mesh.calc_loop_triangles()
    return len(mesh.loop_triangles)


def size(item):
    at = coordinates(item.data) @ np.array(item.matrix_world)[:3, :3].T
    return np.ptp(at, axis=0)


class RockExport(PanelCase):
    def setUp(self):
        super().setUp()
        item = ball("A", 2.0, (5.0, 1.0, -3.0))
        select(item)
        ops.fill_with_strata(beds=3, dip=0.1)
        self.beds = {bed.name: bed for bed in bpy.data.collections["A Strata"].objects}
        self.counts = {name: len(bed.data.vertices) for name, bed in self.beds.items()}
        self.triangles = {name: triangles(bed.data) for name, bed in self.beds.items()}
        self.volumes = {name: volume(bed.data) for name, bed in self.beds.items()}
        self.sizes = {name: size(bed) for name, bed in self.beds.items()}

    def exported(self, ending, **options):
        """What Blender imports again, in an empty file."""
        path = self.folder / f"rock.{ending}"
        before = inventory()
        options.setdefault("picture_size", SIZE)
        self.assertEqual(ops.export_scene(filepath=str(path), **options), {"FINISHED"})
        self.assertEqual(inventory(), before)
        bpy.ops.wm.read_homefile(use_empty=True)
        bpy.ops.preferences.addon_enable(module="io_scene_gltf2")
        return read(path)

    def assert_shapes(self, found, has_vertices=True):
        self.assertEqual(sorted(name.replace("_", " ") for name in found), NAMES)
        for key, item in found.items():
            name = key.replace("_", " ")
            self.assertEqual(triangles(item.data), self.triangles[name])
            if has_vertices:
                self.assertEqual(len(item.data.vertices), self.counts[name])
            scale = abs(np.linalg.det(np.array(item.matrix_world)[:3, :3]))
            self.assertAlmostEqual(abs(volume(item.data)) * scale, self.volumes[name], delta=1e-3)
            np.testing.assert_allclose(size(item), self.sizes[name], atol=1e-3)

    def assert_pictures(self, found, inputs, layout="OBJECT"):
        pictures = set()
        for item in found.values():
            self.assertEqual(len(item.data.materials), 1)
            shown = images(item.data.materials[0])
            self.assertLessEqual(set(inputs), set(shown))  # 3.4 imports the gloss as a picture, too
            pictures.add(shown["Base Color"])
            for image in shown.values():
                self.assertEqual(tuple(image.size), (SIZE, SIZE))
                values = np.array(image.pixels[:]).reshape(-1, 4)
                self.assertGreater(values[:, :3].max(), 0.1)
            uv = np.empty(2 * len(item.data.loops), np.float32)
            item.data.uv_layers[0].data.foreach_get("uv", uv)
            self.assertTrue(uv.min() >= 0.0 and uv.max() <= 1.0)
            self.assertGreater(np.ptp(uv), 0.5 if layout == "OBJECT" else 0.05)
        self.assertEqual(len(pictures), len(found) if layout == "OBJECT" else 1)

    def test_gltf(self):
        maps = {"COLOR", "ROUGHNESS", "NORMAL", "OCCLUSION"}
        found = self.exported("glb", layout="OBJECT", maps=maps)
        self.assert_shapes(found, has_vertices=False)  # glTF divides vertices along seams
        self.assert_pictures(found, ["Base Color", "Roughness", "Metallic", "Normal"])
        item = found["A Bed 1"]
        self.assertEqual(len(item.data.uv_layers), 2)
        self.assertEqual(item["realmodel_bed"], 1)
        nodes = item.data.materials[0].node_tree.nodes
        names = [node.node_tree.name for node in nodes if node.type == "GROUP"]
        self.assertEqual(names, ["glTF Material Output"])
        self.assertEqual([path.name for path in self.folder.iterdir()], ["rock.glb"])

    def test_one_atlas_in_obj(self):
        found = self.exported("obj", layout="ATLAS")
        self.assert_shapes(found)
        self.assert_pictures(found, ["Base Color", "Roughness", "Normal"], layout="ATLAS")
        self.assertEqual(len(list(self.folder.glob("rock_Rock_Atlas_*.png"))), 3)

    def test_fbx_with_colors(self):
        found = self.exported("fbx", layout="OBJECT")
        self.assert_shapes(found)
        self.assert_pictures(found, ["Base Color", "Roughness", "Normal"])
        for item in found.values():
            self.assertEqual(len(item.data.color_attributes), 1)
            self.assertEqual(len(item.data.uv_layers), 2)

    def test_usd(self):
        if not bpy.app.build_options.usd:
            self.skipTest("this Blender cannot write USD")
        found = self.exported("usdc", layout="OBJECT")
        self.assert_shapes({item.parent.name if item.parent else name: item for name, item in found.items()})
        self.assert_pictures(found, ["Base Color", "Roughness", "Normal"])

    def exported_after_baking(self, ending):
        """The pictures come into the file, or beside it, from the folder where Bake Looks has put them."""
        textures = self.folder / "textures"
        ops.bake_looks(directory=str(textures), picture_size=SIZE, plain_materials=True)
        with unittest.mock.patch.object(scene_export.Baking, "make", side_effect=AssertionError):
            found = self.exported(ending)
        self.assert_pictures(found, ["Base Color", "Roughness", "Normal"])
        beside = sorted(path.name for path in self.folder.glob("A_Bed_*.png"))
        self.assertEqual(beside, [] if ending == "glb" else sorted(path.name for path in textures.iterdir()))

    def test_what_was_baked_before_is_not_baked_again(self):
        self.exported_after_baking("fbx")

    def test_what_was_baked_before_in_gltf(self):
        self.exported_after_baking("glb")

    def test_what_was_baked_before_in_usd(self):
        if not bpy.app.build_options.usd:
            self.skipTest("this Blender cannot write USD")
        self.exported_after_baking("usdc")

    def test_levels_of_detail_and_hulls(self):
        found = self.exported("fbx", bake_looks=False, levels_of_detail=True, collision="EACH")
        wanted = [f"{name}_LOD{level}" for name in NAMES for level in range(3)]
        wanted += [f"UCX_{name}_LOD0_00" for name in NAMES]
        self.assertEqual(sorted(found), sorted(wanted))
        for name in NAMES:
            levels = [triangles(found[f"{name}_LOD{level}"].data) for level in range(3)]
            self.assertEqual(levels[0], self.triangles[name])
            self.assertLess(levels[1], 0.45 * levels[0])
            self.assertLess(levels[2], 0.6 * levels[1])
            hull = found[f"UCX_{name}_LOD0_00"]
            self.assertGreater(abs(volume(hull.data)), 0.9 * self.volumes[name])
            np.testing.assert_allclose(size(hull), self.sizes[name], atol=1e-3)

    def test_one_hull_around_all(self):
        found = self.exported("glb", bake_looks=False, collision="WHOLE")
        self.assertEqual(sorted(found), [*NAMES, "UCX_A Bed 1_00"])
        np.testing.assert_allclose(size(found["UCX_A Bed 1_00"]), [4.0, 4.0, 4.0], atol=1e-2)

    def test_fbx_needs_its_add_on(self):
        with unittest.mock.patch.object(scene_export.bpy, "ops") as fake:
            fake.export_scene = []
            with self.assertRaisesRegex(Exception, "add-on for FBX is off"):
                scene_export._require_exporter(scene_export._write_fbx)
