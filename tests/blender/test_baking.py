# SPDX-License-Identifier: GPL-3.0-or-later
"""Unwrap Rock and Bake Looks: UV maps, colors and attributes of beds and blocks, and pictures of looks."""

import unittest.mock

import bpy
import numpy as np
from blender_state import coordinates, corners, inventory
from boolean_case import ball, cube
from panel_case import PanelCase, ops, select, stack
from realmodel.bl.jobs.bake_job import BakeJob
from realmodel.bl.shading import looks
from realmodel.core import BuildFailed, Cancelled

SIZE = 64


def uv_of(mesh, name):
    values = np.empty(2 * len(mesh.loops), np.float32)
    mesh.uv_layers[name].data.foreach_get("uv", values)
    return values.reshape(-1, 2).astype(float)


def attribute(mesh, name, dtype=np.float32):
    values = np.empty(len(mesh.attributes[name].data), dtype)
    mesh.attributes[name].data.foreach_get("value", values)
    return values


def areas(mesh, places, uv):
    """(F,) of the polygons in space, and in UV."""
    starts, vertices = corners(mesh)
    following = np.arange(len(vertices)) + 1
    following[starts[1:] - 1] = starts[:-1]
    at = places[vertices] - places.mean(axis=0)
    space = np.linalg.norm(np.add.reduceat(np.cross(at, at[following]), starts[:-1]), axis=1) / 2
    near = uv - uv[np.repeat(starts[:-1], np.diff(starts))]
    turn = near[:, 0] * near[following, 1] - near[:, 1] * near[following, 0]
    return space, np.abs(np.add.reduceat(turn, starts[:-1])) / 2


def pixels(path):
    image = bpy.data.images.load(str(path))
    values = np.empty(4 * image.size[0] * image.size[1], np.float32)
    image.pixels.foreach_get(values)
    size = tuple(image.size)
    bpy.data.images.remove(image)
    return values.reshape(-1, 4), size


class Rock(PanelCase):
    def filled(self, item, **settings):
        select(item)
        ops.fill_with_strata(**settings)
        return [bed for bed in bpy.data.collections[f"{item.name} Strata"].objects if "realmodel_bed" in bed]

    def settings(self):
        """What a bake must leave as it is."""
        scene = self.scene
        return (
            scene.render.engine,
            [obj.name for obj in bpy.context.selected_objects],
            bpy.context.view_layer.objects.active.name,
            [obj.name for obj in scene.objects if obj.hide_render],
            "cycles" in scene.keys() and (scene.cycles.samples, scene.cycles.use_denoising),  # noqa: SIM118
        )


class Unwrap(Rock):
    def test_beds_have_one_density_and_little_stretch_wherever_they_stand(self):
        item = ball("A", 2.0, (500.0, 1.0, -3.0))
        item.scale, item.rotation_euler = (1.0, -2.0, 0.5), (0.3, 0.1, -0.4)
        bpy.context.view_layer.update()
        beds = self.filled(item, beds=5, fold_amplitude=0.1)
        for size in (0.0, 0.5):
            if size:
                select(*beds)
                ops.unwrap(texture_size=size)
            shares = []
            for bed in beds:
                mesh, turn = bed.data, np.array(bed.matrix_world)
                self.assertEqual(mesh.uv_layers.active.name, "UVMap")
                places = coordinates(mesh) @ turn[:3, :3].T
                space, flat = areas(mesh, places, uv_of(mesh, "UVMap"))
                shares.append((flat / space)[space > 1e-6 * space.max()])
            density = np.sqrt(np.concatenate(shares))
            self.assertLess(density.max() / density.min(), 1.5)
            if size:
                self.assertAlmostEqual(density.max(), 1.0 / size, delta=0.02)

    def test_colors_and_attributes_of_beds(self):
        item = ball("A", 2.0)
        beds = self.filled(item, beds=6, palette="COAL", dip=0.0)
        wet = []
        for number, bed in enumerate(beds, 1):
            mesh = bed.data
            color = mesh.color_attributes.active_color
            self.assertEqual((color.name, color.domain), ("Rock Color", "POINT"))
            wanted = bed.material_slots[0].material.diffuse_color
            np.testing.assert_allclose(tuple(color.data[0].color), tuple(wanted), atol=0.01)
            self.assertEqual(set(attribute(mesh, "realmodel_bed", np.int32).tolist()), {number})
            self.assertEqual(len(set(attribute(mesh, "realmodel_hardness").tolist())), 1)
            wet.append(attribute(mesh, "realmodel_wetness"))
            joints = attribute(mesh, "realmodel_joints")
            self.assertTrue((np.clip(joints, 0.0, 1.0) == joints).all())
            self.assertIn("realmodel_height", mesh.attributes)
        self.assertTrue(all(part.min() >= 0.0 and part.max() <= 1.0 for part in wet))
        self.assertGreater(wet[0].mean(), 0.5)
        self.assertLess(wet[-1].mean(), 0.1)
        hard = {
            bed.material_slots[0].material.name: attribute(bed.data, "realmodel_hardness")[0] for bed in beds
        }
        self.assertGreater(len(set(hard.values())), 1)

    def test_blocks_of_a_model(self):
        stack(0.0, 10.0, 30.0)
        ops.build()
        blocks = [row.object for row in self.model.results]
        self.assertFalse(blocks[0].data.uv_layers)
        ops.unwrap()
        for block in blocks:
            mesh = block.data
            space, flat = areas(mesh, coordinates(mesh), uv_of(mesh, "UVMap"))
            unit = looks.diagonal(self.scene) / looks.UNITS
            np.testing.assert_allclose(flat, space / unit**2, rtol=1e-3)
            self.assertIn("realmodel_wetness", mesh.attributes)
        names = [entry.name for entry in mesh.attributes]
        ops.unwrap()
        self.assertEqual([entry.name for entry in mesh.attributes], names)

    def test_without_any_rock(self):
        self.refused(ops.unwrap, "there is no model yet")
        self.refused(ops.bake_looks, "there is no model yet")


class Bake(Rock):
    def test_pictures_of_each_bed_with_all_maps(self):
        beds = self.filled(ball("A", 2.0), beds=2, dip=0.0, preset="NONE")
        maps = {"COLOR", "ROUGHNESS", "NORMAL", "OCCLUSION", "DISPLACEMENT"}
        before, settings = inventory(), self.settings()
        folder = self.folder / "textures"
        ops.bake_looks(directory=str(folder), maps=maps, picture_size=SIZE)
        self.assertEqual(inventory(), before)
        self.assertEqual(self.settings(), settings)
        names = sorted(path.name for path in folder.iterdir())
        self.assertEqual(len(names), 10)
        self.assertIn("A_Bed_1_color.png", names)
        self.assertIn("A_Bed_2_displacement.exr", names)
        for bed in beds:
            stem = bed.name.replace(" ", "_")
            shown = {}
            for kind in maps:
                ending = "exr" if kind == "DISPLACEMENT" else "png"
                shown[kind], size = pixels(folder / f"{stem}_{kind.lower()}.{ending}")
                self.assertEqual(size, (SIZE, SIZE))
            inside = shown["ROUGHNESS"][:, 0] > 0.0
            self.assertTrue(0.3 < inside.mean() < 1.0)
            self.assertGreater(shown["NORMAL"][inside, 2].min(), 0.3)  # outward
            color = shown["COLOR"][inside, :3].mean(axis=0)
            self.assertGreater(color.min(), 0.02)
            self.assertGreater(shown["NORMAL"][inside, :2].std(), 0.003)
            self.assertGreater(shown["ROUGHNESS"][inside, 0].mean(), 0.5)
            dark = shown["OCCLUSION"][:, 0] < 0.4
            self.assertLess(dark.mean(), 0.02, "a ball without a hollow; what lies between beds is left out")
            self.assertEqual(shown["OCCLUSION"][~inside, 0].min(), 1.0)
            self.assertTrue(0.2 < shown["DISPLACEMENT"][inside, 0].mean() < 0.8)
            uv = uv_of(bed.data, "Baked")
            self.assertTrue(uv.min() >= 0.0 and uv.max() <= 1.0)
            self.assertEqual(bed.data.uv_layers.active.name, "UVMap")

    def test_one_atlas_with_a_plain_material_for_all(self):
        beds = self.filled(ball("A", 2.0), beds=3, dip=0.0)
        select(*beds[:2])
        ops.bake_looks(
            directory=str(self.folder),
            maps={"COLOR", "NORMAL"},
            layout="ATLAS",
            picture_size=SIZE,
            plain_materials=True,
        )
        names = sorted(path.name for path in self.folder.iterdir())
        self.assertEqual(names, ["Rock_Atlas_color.png", "Rock_Atlas_normal.png"])
        used = {bed.material_slots[0].material for bed in beds[:2]}
        self.assertEqual(len(used), 1)
        tree = used.pop().node_tree
        kinds = sorted(node.type for node in tree.nodes)
        self.assertEqual(
            kinds, ["BSDF_PRINCIPLED", "NORMAL_MAP", "OUTPUT_MATERIAL", "TEX_IMAGE", "TEX_IMAGE"]
        )
        spaces = {node.image.colorspace_settings.name for node in tree.nodes if node.type == "TEX_IMAGE"}
        self.assertEqual(spaces, {"sRGB", "Non-Color"})
        self.assertIn("realmodel_look", beds[2].material_slots[0].material)
        self.assertEqual([bed.data.name for bed in beds], [bed.name for bed in beds])
        for bed in beds[:2]:
            self.assertEqual(bed.data.uv_layers[0].name, "Baked")
            self.assertTrue(bed.data.uv_layers["Baked"].active_render)
            self.assertIn("UVMap", bed.data.uv_layers)

    def test_faces_between_beds_have_a_quarter_of_the_density(self):
        beds = self.filled(cube("A"), beds=3, dip=0.0)
        ops.bake_looks(directory=str(self.folder), maps={"COLOR"}, layout="ATLAS", picture_size=SIZE)
        for bed in beds:
            space, flat = areas(bed.data, coordinates(bed.data), uv_of(bed.data, "Baked"))
            density = np.sqrt(flat / space)
            hidden = attribute(bed.data, "realmodel_surface", np.int32) >= 0
            np.testing.assert_allclose(density[hidden], 0.25 * density[~hidden].mean(), rtol=1e-3)
            np.testing.assert_allclose(density[~hidden], density[~hidden].mean(), rtol=1e-3)

    def test_weathered_beds_are_applied(self):
        beds = self.filled(cube("A"), beds=2, dip=0.0)
        select(*beds)
        ops.weathering(detail=1)
        count = len(beds[0].data.polygons)
        arguments = {"directory": str(self.folder), "maps": {"COLOR"}, "picture_size": SIZE}
        self.refused(ops.bake_looks, "it has modifiers", **arguments)
        ops.bake_looks(plain_materials=True, **arguments)
        self.assertFalse(beds[0].modifiers)
        self.assertGreater(len(beds[0].data.polygons), count)
        self.assertEqual(len(beds[0].material_slots), 1)

    def test_cancelled_and_failed_work_leaves_the_scene_as_it_was(self):
        beds = self.filled(cube("A"), beds=2, dip=0.0)
        before, settings = inventory(), self.settings()
        arguments = (self.folder, {"COLOR", "NORMAL"}, "OBJECT", SIZE, True)
        job = BakeJob(bpy.context, beds, *arguments)
        job.start()
        for _ in range(2):
            self.assertFalse(job.hand_over(0.1))
            self.assertEqual(inventory(), before)
            self.assertEqual(self.settings(), settings)
        self.assertIn("baking", job.state()[1])
        job.cancel()
        self.assertTrue(job.hand_over(0.1))
        with self.assertRaises(Cancelled):
            job.finish()
        with unittest.mock.patch.object(looks, "show_pictures", side_effect=BuildFailed("no")):
            self.refused(
                ops.bake_looks,
                "no",
                directory=str(self.folder / "t"),
                maps={"COLOR"},
                picture_size=SIZE,
                plain_materials=True,
            )
        self.assertEqual(inventory(), before)
        self.assertEqual(self.settings(), settings)
        job = BakeJob(bpy.context, beds, *arguments)
        job.hand_over(0.1)
        bpy.data.objects.remove(beds[1])
        with self.assertRaisesRegex(BuildFailed, "is gone"):
            job.hand_over(0.1)

    def test_where_no_folder_is(self):
        self.filled(cube("A"), beds=2)
        self.refused(ops.bake_looks, "was not saved", picture_size=SIZE)
        self.refused(ops.bake_looks, "no picture is chosen", maps=set(), directory=str(self.folder))
