# SPDX-License-Identifier: GPL-3.0-or-later
"""How models begin in Blender, and how they go to project files."""

import shutil
from pathlib import Path
from types import SimpleNamespace

import bpy
import numpy as np
from blender_state import inventory
from panel_case import SAMPLES, PanelCase, ops, outline, raise_by, select, sheet, stack
from realmodel.bl.display import shown_models
from realmodel.core import build, load_project

ARRAYS = ("vertices", "face_offsets", "face_vertices", "face_cells", "face_surface", "cell_block")


class Start(PanelCase):
    def test_new_is_empty(self):
        self.assertEqual(ops.new(), {"FINISHED"})
        self.assertTrue(self.model.exists)
        self.assertEqual((len(self.model.rocks), len(self.model.library)), (0, 0))

    def test_new_keeps_the_users_meshes(self):
        items = stack(0.0, 10.0)
        ops.build()
        self.assertIn("S1 block", bpy.data.objects)
        ops.new()
        self.assertEqual(sorted(o.name for o in self.scene.objects), ["S0", "S1"])
        self.assertEqual([c.name for c in self.scene.collection.children], [])
        self.assertNotIn("realmodel", items[0])
        self.assertNotIn("realmodel_origin", self.scene)

    def test_open_and_build_as_in_batch(self):
        path = SAMPLES / "two_layers" / "project.toml"
        ops.open_project(filepath=str(path))
        rock = self.model.rocks[0]
        self.assertEqual((rock.name, rock.mesher, len(rock.surfaces)), ("field", "delaunay", 2))
        ops.build()
        model = build(load_project(path))
        self.assertEqual(self.volumes(), {b.name: b.volume for b in model.blocks})
        mine = shown_models.whole(bpy.context.scene)
        for name in ARRAYS:
            self.assertEqual(getattr(mine, name).tobytes(), getattr(model, name).tobytes(), name)

    def test_dropped_files_become_surfaces_where_blender_takes_files(self):
        handler = getattr(bpy.types, "REALMODEL_FH_surfaces", None)
        self.assertEqual(handler is not None, hasattr(bpy.types, "FileHandler"))
        if handler is None:
            return
        areas = [area for screen in bpy.data.screens for area in screen.areas]
        self.assertGreater(len(areas), 1)
        for area in areas:
            self.assertEqual(handler.poll_drop(SimpleNamespace(area=area)), area.type == "VIEW_3D")
        files = [SAMPLES / "gravel_plain" / "ground.asc", SAMPLES / "castle_hill" / "ground.off"]
        for number, file in enumerate(files):
            self.assertIn(file.suffix, handler.bl_file_extensions.split(";"))
            shutil.copy(file, self.folder / f"{number}{file.suffix}")
        group, name = handler.bl_import_operator.split(".")
        dropped = getattr(getattr(bpy.ops, group), name)
        names = [f"{number}{file.suffix}" for number, file in enumerate(files)]
        dropped(
            "INVOKE_DEFAULT",
            filepath=str(self.folder / names[0]),
            directory=str(self.folder),
            files=[{"name": name} for name in names],
        )
        sources = {s.name: (s.source, Path(s.filepath).name) for s in self.model.rocks[0].surfaces}
        self.assertEqual(sources, {"0": ("POINTS_FILE", names[0]), "1": ("MESH_FILE", names[1])})

    def test_dropped_project_files_are_opened_where_blender_takes_files(self):
        handler = getattr(bpy.types, "REALMODEL_FH_project", None)
        self.assertEqual(handler is not None, hasattr(bpy.types, "FileHandler"))
        if handler is None:
            return
        self.assertEqual(handler.bl_file_extensions, ".toml;.npz")
        for area, wanted in (("VIEW_3D", True), ("TEXT_EDITOR", False)):
            here = SimpleNamespace(area=SimpleNamespace(type=area))
            self.assertEqual(handler.poll_drop(here), wanted)
        self.assertFalse(handler.poll_drop(SimpleNamespace(area=None)))
        # what Blender does with a dropped file: it calls the operator of this name with its path
        group, name = handler.bl_import_operator.split(".")
        dropped = getattr(getattr(bpy.ops, group), name)
        dropped(filepath=str(SAMPLES / "two_layers" / "project.toml"))
        self.assertEqual(self.model.rocks[0].name, "field")

    def test_a_project_is_asked_for_each_time(self):
        """A path that is kept would be opened from the menu at once, as a dropped file is."""
        self.assertTrue(ops.open_project.get_rna_type().properties["filepath"].is_skip_save)

    def test_bad_projects_are_refused_and_change_nothing(self):
        stack(0.0, 10.0)
        ops.build()
        bad = self.folder / "p.toml"
        bad.write_text('format = 1\nname = "x"\ncolour = "red"\n')
        before = inventory()
        self.refused(ops.open_project, r"p\.toml:3.*colour", filepath=str(bad))
        self.refused(ops.open_project, "cannot be read", filepath=str(self.folder / "none.toml"))
        self.refused(ops.open_project, "no file for the project", filepath="")
        self.assertEqual(inventory(), before)
        self.assertEqual(len(self.model.rocks[0].surfaces), 2)

    def test_examples(self):
        for name in ("two_layers", "haut_barr"):
            self.assertEqual(ops.open_sample(sample=name), {"FINISHED"})
            self.assertTrue(len(self.model.library))

    def test_from_selected_orders_by_height(self):
        items = [sheet("high", 30.0), sheet("low", 2.0), sheet("middle", 10.0)]
        select(*items)
        ops.from_selected()
        self.assertEqual([s.name for s in self.model.rocks[0].surfaces], ["low", "middle", "high"])
        ops.build()
        volumes = self.volumes()
        self.assertAlmostEqual(volumes["middle block"], 8e4, places=6)
        self.assertAlmostEqual(volumes["high block"], 2e5, places=6)
        self.assertEqual(items[0]["realmodel"], "interface")
        select()
        self.refused(ops.from_selected, "no mesh object is selected")

    def test_from_selected_interfaces_of_the_model(self):
        ops.open_sample(sample="two_layers")
        surfaces = [row.interface for row in self.model.rocks[0].surfaces]
        heights = [[vertex.co.z for vertex in item.data.vertices] for item in surfaces]
        ops.section(location=(50.0, 30.0, 0.0), normal=(1.0, 0.0, 0.0))
        select(bpy.data.objects["Section"], self.model.results[0].object)
        before = inventory()
        self.refused(ops.from_selected, "no mesh object is selected")
        self.assertEqual(inventory(), before)
        for item in surfaces:
            item.hide_set(False)
        select(*surfaces, bpy.data.objects["Section"])
        ops.from_selected()
        self.assertEqual([row.object for row in self.model.rocks[0].surfaces], surfaces)
        self.assertEqual([[vertex.co.z for vertex in item.data.vertices] for item in surfaces], heights)
        self.assertNotIn("Section", bpy.data.objects)
        ops.build()
        self.assertEqual(len(self.volumes()), 1)


class Saved(PanelCase):
    """A project file written from the scene gives the same model in batch, byte for byte."""

    def assert_same_in_batch(self, folder=None):
        path = (folder or self.folder) / "saved" / "p.toml"
        path.parent.mkdir()
        self.assertEqual(ops.save_project(filepath=str(path)), {"FINISHED"})
        batch = build(load_project(path))
        mine = shown_models.whole(bpy.context.scene)
        for name in ARRAYS:
            self.assertEqual(getattr(mine, name).tobytes(), getattr(batch, name).tobytes(), name)
        self.assertEqual(mine.blocks, batch.blocks)
        self.assertEqual(list(mine.project.library or ()), list(batch.project.library or ()))
        return path.parent

    def test_example_after_its_files_are_gone(self):
        for sample, meshes in (("uncertain_valley", 1), ("gravel_plain", 0)):  # a region of its own file
            with self.subTest(sample):
                copy = shutil.copytree(SAMPLES / sample, self.folder / sample / "copy")
                ops.open_project(filepath=str(copy / "project.toml"))
                ops.build()
                shutil.rmtree(copy)
                written = self.assert_same_in_batch(self.folder / sample)
                self.assertEqual(len(list(written.glob("*.off"))), meshes)
                self.assertEqual(len(list(written.glob("*.csv"))), 3)

    def test_before_it_was_built(self):
        ops.open_sample(sample="two_layers", build=False)
        self.assert_same_in_batch()

    def test_objects_region_and_rules(self):
        stack(0.0, lambda x, y: 4.0 + x / 20.0, 7.0)
        rock = self.model.rocks[0]
        rock.region = outline("region", [(5, 5), (90, 8), (80, 95), (8, 70)], [(30, 30), (30, 50), (50, 50)])
        rock.base_elevation = -3.1
        rock.surfaces[2].rule = "conformable"
        rock.surfaces[1].block = 'Quoted "name" \\ ü'
        ops.library_add(name="Marl")
        rock.surfaces[1].property_id = 1
        ops.build()
        self.assertEqual(len(self.model.results), 3)
        self.assert_same_in_batch()

    def test_an_edited_interface(self):
        ops.open_sample(sample="two_layers", build=False)
        ops.build()
        raise_by(self.model.rocks[0].surfaces[1].interface, 2.0)
        ops.build()
        self.assertEqual(self.model.rocks[0].surfaces[1].source, "MESH_OBJECT")
        self.assert_same_in_batch()

    def test_refusals(self):
        self.assertFalse(ops.save_project.poll())
        stack(0.0, 10.0)
        self.refused(ops.save_project, r"ends in \.toml", filepath=str(self.folder / "p.txt"))
        self.refused(ops.save_project, "no folder", filepath=str(self.folder / "none" / "p.toml"))
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_numbers_keep_their_digits(self):
        ops.rock_add()
        rock = self.model.rocks[0]
        from realmodel.bl.project import settings

        for value in (0.1, 400.1, 1 / 3, 5397900.123456789):
            settings.set_number(rock, "edge_length", value)
            self.assertEqual(settings.number(rock, "edge_length"), value)
        rock.edge_length = 0.7  # typed: the shortest decimal
        self.assertEqual(settings.number(rock, "edge_length"), 0.7)
        self.assertNotEqual(np.float64(np.float32(0.7)), 0.7)
