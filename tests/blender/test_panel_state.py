# SPDX-License-Identifier: GPL-3.0-or-later
"""The model outlives whatever is done to its scene: saving, undo, deleting, renaming, copies, other
scenes."""

import random
from unittest import mock

import bpy
import numpy as np
from blender_state import empty_file, inventory, open_edges, volume
from panel_case import PanelCase, ops, raise_by, select, sheet, stack
from realmodel.bl.display import colors
from realmodel.bl.objects import built_models
from realmodel.bl.scene import data_objects, live


def block(name):
    return bpy.data.objects[f"{name} block"]


class Persistence(PanelCase):
    def test_save_open_edit_build(self):
        ops.open_sample(sample="two_layers", build=False)
        ops.build()
        before, settings = self.volumes(), self.all_settings()
        self.save_and_open()
        self.assertEqual(self.all_settings(), settings)
        self.assertEqual(self.volumes(), before)
        ops.build()
        self.assertEqual(self.volumes(), before)
        raise_by(self.model.rocks[0].surfaces[1].interface, 1.0)
        ops.build()
        area = 6000.0
        self.assertAlmostEqual(sum(self.volumes().values()), sum(before.values()) + area, delta=1e-6 * area)

    def test_what_changed_since_the_build_is_said(self):
        stack(0.0, 10.0, 30.0)
        self.assertFalse(self.model.is_outdated)
        ops.build()
        self.assertFalse(self.model.is_outdated)
        self.model.rocks[0].surfaces[1].rule = "conformable"
        self.assertTrue(self.model.is_outdated)
        ops.build()
        self.assertFalse(self.model.is_outdated)
        for look in ("show_axes", "use_section"):
            setattr(self.model.view, look, True)
        self.model.stage = 1
        bpy.context.view_layer.update()
        self.assertFalse(self.model.is_outdated)
        ops.surface_remove()
        self.assertTrue(self.model.is_outdated)
        ops.clear()
        self.assertFalse(self.model.is_outdated)

    def test_the_legend_names_a_block_whose_surface_was_removed(self):
        stack(0.0, 10.0, 30.0)
        ops.build()
        ops.surface_remove()
        self.assertEqual([name for name, _ in colors.key(self.scene).entries], ["S2", "S1"])

    def all_settings(self):
        """Every property, by its path, but pointers; of arrays their digest."""
        found = {}

        def walk(group, path):
            for key in set(group.keys()) - set(group.bl_rna.properties.keys()):
                found[f"{path}.{key}"] = getattr(group, key).digest
            for prop in group.bl_rna.properties:
                key, value = prop.identifier, getattr(group, prop.identifier)
                if prop.type == "COLLECTION":
                    for number, row in enumerate(value):
                        walk(row, f"{path}.{key}[{number}]")
                elif prop.type == "POINTER":
                    found[f"{path}.{key}"] = getattr(value, "name", None)
                else:
                    is_array = getattr(prop, "is_array", False)
                    found[f"{path}.{key}"] = tuple(value) if is_array else value

        walk(self.model, "")
        self.assertGreater(len(found), 100)
        return found

    def test_an_interface_that_moves_between_coordinates_of_utm(self):
        """A vertex never loses a millimetre over 10 km."""
        items = [sheet(f"S{n}", 1e2 * n, n=3, size=1e4) for n in range(2)]
        self.scene["realmodel_origin"] = [377400.123, 5397900.456, 0.0]
        select(*items)
        ops.from_selected()
        ops.build()
        at = built_models.current(self.scene).vertices
        for low, high, axis in ((377400.123, 387400.123, 0), (5397900.456, 5407900.456, 1)):
            self.assertAlmostEqual(at[:, axis].min(), low, delta=1e-3)
            self.assertAlmostEqual(at[:, axis].max(), high, delta=1e-3)


class Undo(PanelCase):
    def push(self, name):
        bpy.ops.ed.undo_push(message=name)

    def test_across_builds_and_edits(self):
        self.push("start")
        stack(0.0, 10.0, 20.0)
        self.push("begin")
        ops.build()
        self.push("build")
        raise_by(bpy.data.objects["S2"], 5.0)
        self.push("edit")
        ops.build()
        self.push("build")
        self.assertAlmostEqual(volume(block("S2").data), 15e4, delta=1.0)
        bpy.ops.ed.undo()
        bpy.ops.ed.undo()
        self.assertAlmostEqual(volume(block("S2").data), 10e4, delta=1.0)
        self.assertAlmostEqual(self.volumes()["S2 block"], 10e4, delta=1.0)
        bpy.ops.ed.undo()
        self.assertNotIn("S2 block", bpy.data.objects)
        self.assertEqual(len(self.model.rocks[0].surfaces), 3)
        bpy.ops.ed.redo()
        bpy.ops.ed.redo()
        ops.build()
        self.assertAlmostEqual(self.volumes()["S2 block"], 15e4, delta=1.0)

    def test_live_with_blocks_that_come_and_go(self):
        items = stack(0.0, 10.0, 20.0, 30.0)
        ops.build()
        self.model.live = True
        self.live_is_done()
        self.push("start")
        names, generator = [item.name for item in items], random.Random(3)
        for _ in range(25):
            what = generator.choice(("edit", "edit", "undo", "redo"))
            if what == "edit":
                item = bpy.data.objects[generator.choice(names)]
                raise_by(item, generator.choice((-40.0, -15.0, 15.0, 40.0)))
                self.push("edit")
            elif getattr(bpy.ops.ed, what).poll():
                getattr(bpy.ops.ed, what)()
            if not self.model.live:  # before it was switched on
                bpy.ops.ed.redo()
            self.live_is_done()
            self.assert_blocks_are_those_of_the_interfaces(names)

    def assert_blocks_are_those_of_the_interfaces(self, names):
        heights = [bpy.data.objects[name].data.vertices[0].co.z for name in names]
        for k in range(1, len(names)):
            thickness = max(0.0, min(heights[k:]) - min(heights[k - 1 :]))
            expected = 1e4 * (thickness if heights[k - 1] <= heights[k] or thickness else 0.0)
            row = next(row for row in self.model.results if row.name == f"{names[k]} block")
            self.assertAlmostEqual(row.volume, expected, delta=1.0)
            self.assertEqual(row.object is not None, expected > 0.0)
            if row.object is not None:
                self.assertAlmostEqual(volume(row.object.data), expected, delta=1.0)
                self.assertEqual(open_edges(row.object.data), 0)


class Deleted(PanelCase):
    """What the user does in the outliner."""

    def test_a_block_comes_back(self):
        stack(0.0, 10.0, 20.0)
        ops.build()
        volumes = self.volumes()
        for name in ("S1 block", "S2 block"):
            bpy.data.objects.remove(bpy.data.objects[name])
        ops.build()
        self.assertEqual(self.volumes(), volumes)
        select(block("S1"))
        bpy.ops.object.delete()
        ops.build()
        self.assertIn(block("S1"), list(self.scene.objects))

    def test_an_interface_made_from_a_file_comes_back(self):
        ops.open_sample(sample="two_layers", build=False)
        ops.build()
        volumes = self.volumes()
        bpy.data.objects.remove(self.model.rocks[0].surfaces[0].interface)
        ops.build()
        self.assertEqual(self.volumes(), volumes)
        item = self.model.rocks[0].surfaces[0].interface
        self.assertIn(item, list(self.scene.objects))

    def test_an_interface_that_was_an_object(self):
        items = stack(0.0, 10.0)
        ops.build()
        volumes = self.volumes()
        items[0].hide_set(False)
        select(items[0])
        bpy.ops.object.delete()
        ops.build()
        self.assertEqual(self.volumes(), volumes)
        bpy.data.objects.remove(bpy.data.objects["S0"])
        before = inventory()
        self.refused(ops.build, "surface 'S0'.*it has no object")
        self.assertEqual(inventory(), before)

    def test_collections(self):
        stack(0.0, 10.0, 20.0)
        ops.build()
        volumes = self.volumes()
        for name in ("rock mass blocks", "Model"):
            bpy.data.collections.remove(bpy.data.collections[name])
            ops.build()
            self.assertEqual(self.volumes(), volumes)
            self.assertIn(block("S1"), list(self.scene.objects))

    def test_a_moved_collection_of_data_stays_the_only_one(self):
        ops.rock_add()
        rock = self.model.rocks[0]
        rock.region_stored = {"ring0": np.array([[0.0, 0.0], [9.0, 0.0], [9.0, 9.0]])}
        self.model.show_data = True
        (data,) = (c for c in bpy.data.collections if data_objects.KEY in c)
        mine = bpy.data.collections.new("mine")
        self.scene.collection.children.link(mine)
        self.scene.collection.children.unlink(data)
        mine.children.link(data)
        rock.region_stored = {"ring0": np.array([[0.0, 0.0], [8.0, 0.0], [8.0, 8.0]])}
        data_objects.update(self.scene)
        self.assertEqual([c for c in bpy.data.collections if data_objects.KEY in c], [data])
        self.assertEqual(len(data.objects), 1)

    def test_a_mesh_with_the_name_of_an_interface_is_not_taken_for_it(self):
        ops.rock_add()
        ops.surface_add(name="top", empty=True)
        row = self.model.rocks[0].surfaces[0]
        row.interface, row.interface_digest = sheet("Top", 0.0), "made"
        row.interface.data.name = "of Top"
        with mock.patch.object(live, "_edited") as edited:
            live.changed(self.scene, {(False, "Top")})
            edited.assert_not_called()
            live.changed(self.scene, {(True, "Top")})
            edited.assert_called_once()

    def test_renamed_moved_and_linked_twice(self):
        stack(0.0, 10.0, 20.0)
        ops.build()
        mine = bpy.data.collections.new("mine")
        self.scene.collection.children.link(mine)
        moved = block("S1")
        moved.name = "my favourite"
        for collection in list(moved.users_collection):
            collection.objects.unlink(moved)
        mine.objects.link(moved)
        mine.objects.link(block("S2"))
        bpy.data.objects["S0"].name = "renamed"
        raise_by(bpy.data.objects["S2"], 1.0)
        ops.build()
        self.assertEqual(moved.name, "my favourite")
        self.assertEqual([c.name for c in moved.users_collection], ["mine"])
        self.assertEqual(len(block("S2").users_collection), 2)
        self.assertAlmostEqual(volume(block("S2").data), 11e4, delta=1.0)
        self.assertEqual(len([o for o in self.scene.objects if o.get("realmodel") == "block"]), 2)

    def test_what_the_user_gave_a_block_stays(self):
        stack(0.0, 10.0, 20.0)
        ops.build()
        mine = bpy.data.materials.new("mine")
        block("S1").data.materials[0] = mine
        copy = block("S2").copy()
        copy.data = copy.data.copy()
        self.scene.collection.objects.link(copy)
        select(block("S2"))
        raise_by(bpy.data.objects["S1"], 25.0)  # above S2, which then cuts it away
        ops.build()
        self.assertIn(copy, list(self.scene.objects), "a copy is the user's")
        raise_by(bpy.data.objects["S1"], -25.0)
        ops.build()
        self.assertEqual(block("S1").data.materials[0], mine)


class SeveralScenes(PanelCase):
    def test_two_scenes_each_with_its_model(self):
        stack(0.0, 10.0)
        ops.build()
        first, volumes = self.scene, self.volumes()
        second = bpy.data.scenes.new("second")
        bpy.context.window.scene = second
        stack(0.0, 3.0, 4.0)
        ops.build()
        self.assertEqual(len(second.realmodel.results), 2)
        bpy.context.window.scene = first
        self.assertEqual(self.volumes(), volumes)
        ops.build()
        ops.clear()
        self.assertEqual(len(first.realmodel.results), 0)
        self.assertEqual(len([o for o in second.objects if o.get("realmodel") == "block"]), 2)

    def written(self):
        ops.open_sample(sample="two_layers", build=False)
        ops.build()
        path = self.folder / "library.blend"
        bpy.ops.wm.save_as_mainfile(filepath=str(path))
        empty_file()
        return path

    def test_append_and_link(self):
        path = self.written()
        name = "Two layers"
        for link in (False, True):
            empty_file()
            with bpy.data.libraries.load(str(path), link=link) as (source, target):
                name = next(c for c in source.collections if c in ("Two layers", source.collections[0]))
                top = next(c for c in source.collections if "field" not in c)
                target.collections = [top]
            self.scene.collection.children.link(target.collections[0])
            appended = [o for o in self.scene.objects if o.get("realmodel") == "block"]
            self.assertEqual(len(appended), 2, name)
            stack(0.0, 10.0)
            ops.build()
            ops.build()
            ops.clear()
            self.assertEqual(len([o for o in self.scene.objects if o.get("realmodel") == "block"]), 2)

    def test_append_the_scene(self):
        path = self.written()
        with bpy.data.libraries.load(str(path), link=False) as (source, target):
            target.scenes = source.scenes
        bpy.context.window.scene = target.scenes[0]
        volumes = self.volumes()
        self.assertEqual(len(volumes), 2)
        ops.build()
        self.assertEqual(self.volumes(), volumes)

    def test_a_linked_mesh_can_be_a_surface(self):
        sheet("far", 0.0)
        path = self.folder / "sheets.blend"
        bpy.ops.wm.save_as_mainfile(filepath=str(path))
        empty_file()
        with bpy.data.libraries.load(str(path), link=True) as (_source, target):
            target.objects = ["far"]
        self.scene.collection.objects.link(target.objects[0])
        near = sheet("near", 10.0)
        select(target.objects[0], near)
        ops.from_selected()
        ops.build()
        self.assertAlmostEqual(self.volumes()["near block"], 1e5, places=5)


class Failure(PanelCase):
    """A build that fails leaves the scene exactly as it was."""

    def test_refused(self):
        items = stack(0.0, 10.0, 20.0)
        ops.build()
        items[1].data.vertices[6].co.x += 60.0
        items[1].data.update()
        bpy.context.view_layer.update()
        before = inventory()
        self.refused(ops.build, "surface 'S1'.*overlap in plan")
        self.assertEqual(inventory(), before)

    def test_when_blender_has_no_memory_left(self):
        """At the first and at a later mesh, and at a material: nothing is left of what was made before."""
        from realmodel.bl.objects import materials, meshes
        from realmodel.bl.scene import built_scene
        from realmodel.bl.scene.build_job import BuildJob

        stack(0.0, 10.0, 20.0)
        ops.library_add(name="Marl")
        ops.build()
        self.model.rocks[0].surfaces[1].property_id = 1
        raise_by(bpy.data.objects["S2"], 3.0)
        for module, name, calls in (
            (meshes, "new_mesh", 0),
            (meshes, "new_mesh", 1),
            (materials, "new_material", 0),
            (built_scene, "_new_blocks", 0),
        ):
            before, whole, left = inventory(), getattr(module, name), [calls]

            def failing(*arguments, whole=whole, left=left, **options):
                if not left[0]:
                    raise MemoryError("on purpose")
                left[0] -= 1
                return whole(*arguments, **options)

            setattr(module, name, failing)
            try:
                with self.assertRaisesRegex(MemoryError, "on purpose"):
                    BuildJob(self.scene, bpy.context.evaluated_depsgraph_get()).run()
            finally:
                setattr(module, name, whole)
            self.assertEqual(inventory(), before, name)
        ops.build()
        self.assertAlmostEqual(self.volumes()["S2 block"], 13e4, delta=1.0)
