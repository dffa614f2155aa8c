# SPDX-License-Identifier: GPL-3.0-or-later
"""A .blend of batch opened in the panel: the same as if the model had been built there."""

import importlib.util
import shutil
import sys
from pathlib import Path
from types import ModuleType
from unittest import mock

import bpy
import realmodel
from blender_state import coordinates, empty_file
from made_projects import interpolated, one_rock, two_rocks
from panel_case import SAMPLES, PanelCase, ops
from realmodel.bl.display import shown_models
from realmodel.bl.pictures import batch
from realmodel.core import build, load_project
from test_build_model import build_model

ARRAYS = (
    *("vertices", "face_offsets", "face_vertices", "face_cells", "face_surface", "cell_block"),
    *("surface_vertices", "surface_triangles", "surface_vertex_offsets", "surface_triangle_offsets"),
)


class BatchBlend(PanelCase):
    def opened(self, model):
        """Writes a model in batch, and opens the file."""
        path = self.folder / "m.blend"
        batch.write_scene(model)
        batch.save_blend(path)
        empty_file()
        bpy.ops.wm.open_mainfile(filepath=str(path))

    def assert_same_model(self, model, again):
        for name in ARRAYS:
            first, second = getattr(model, name), getattr(again, name)
            self.assertEqual(first.dtype, second.dtype, name)
            self.assertEqual(first.tobytes(), second.tobytes(), name)
        self.assertEqual(model.blocks, again.blocks)
        self.assertEqual(model.surface_names, again.surface_names)

    def test_it_is_enough_to_build_the_model_again(self):
        copy = Path(shutil.copytree(SAMPLES / "two_layers", self.folder / "sample"))
        from_files = build(load_project(copy / "project.toml"))
        shutil.rmtree(copy)
        for model in (from_files, build(two_rocks()), build(interpolated())):
            with self.subTest(model.project.name):
                self.opened(model)
                self.assert_same_model(model, shown_models.whole(bpy.context.scene))

    def test_files_are_named_and_read_again_where_they_have_changed(self):
        copy = Path(shutil.copytree(SAMPLES / "two_layers", self.folder / "sample"))
        done = build_model(copy / "project.toml", "--blend", self.folder / "m.blend")
        self.assertEqual(done.returncode, 0, done.stderr)
        bpy.ops.wm.open_mainfile(filepath=str(self.folder / "m.blend"))
        ground = self.model.rocks[0].surfaces[1]
        self.assertEqual(Path(ground.filepath), copy / "ground.csv")
        before = self.volumes()
        ops.build()
        self.assertEqual(self.volumes(), before)
        ground.method = "constant"
        (copy / "ground.csv").write_text("x,y,z\n50,30,900\n")
        ops.build()
        self.assertEqual(set(coordinates(ground.interface.data)[:, 2]), {900.0})

    def test_results_are_exact(self):
        model = build(two_rocks())
        self.opened(model)
        self.assertTrue(self.model.exists)
        self.assertEqual(self.model.stage, 4)
        for row, block in zip(self.model.results, model.blocks, strict=True):
            self.assertEqual(float(row.volume_exact), block.volume)
            self.assertEqual(
                (row.name, row.cells, row.components), (block.name, block.cells, block.components)
            )
            self.assertEqual(row.object is not None, block.cells > 0)
        self.assertEqual([e.name for e in self.model.library], [p.name for p in model.project.library])

    def test_the_panel_builds_into_the_same_objects(self):
        self.opened(build(one_rock()))
        before = {o.name: o.data.name for o in self.scene.objects}
        self.assertEqual(ops.build(), {"FINISHED"})
        self.assertEqual({o.name: o.data.name for o in self.scene.objects}, before)

    def test_a_model_of_the_panel_is_replaced(self):
        ops.open_sample(sample="two_layers")
        ops.build()
        self.model.explode = 0.5
        batch.write_scene(build(one_rock()))
        self.assertEqual([rock.name for rock in self.model.rocks], ["hill"])
        self.assertNotIn("Clay", bpy.data.objects)
        self.assertNotIn("Clay", bpy.data.materials)


class Registration(PanelCase):
    def enable_other_copy(self):
        """The package under another name, as extensions of Blender have one."""
        patch = mock.patch.dict(sys.modules, {"other_copy": ModuleType("other_copy")})
        patch.start()
        self.addCleanup(patch.stop)  # all that was imported since is forgotten
        spec = importlib.util.spec_from_file_location(
            "other_copy.realmodel", realmodel.__file__, submodule_search_locations=realmodel.__path__
        )
        module = sys.modules[spec.name] = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        module.register()

    def owner(self):
        return type(bpy.types.Scene.bl_rna.properties["realmodel"].fixed_type).__module__

    def test_once_is_enough(self):
        realmodel.register_for_batch()
        self.assertEqual(self.owner(), "realmodel.props")

    def test_where_it_is_not_enabled(self):
        realmodel.unregister()
        realmodel.register_for_batch()
        self.assertEqual(self.owner(), "realmodel.props")

    def test_another_copy_gives_way(self):
        realmodel.unregister()
        self.enable_other_copy()
        self.assertEqual(self.owner(), "other_copy.realmodel.props")
        realmodel.register_for_batch()
        self.assertEqual(self.owner(), "realmodel.props")
        batch.write_scene(build(one_rock()))
        self.assertEqual(len(self.model.results), 5)
