# SPDX-License-Identifier: GPL-3.0-or-later
"""The .blend is enough to build the model again after the project's files are gone."""

import shutil
import tempfile
import unittest
from pathlib import Path

import bpy
import numpy as np
from blender_state import empty_file
from made_projects import interpolated, two_rocks
from realmodel.bl import batch, scene, stored_project
from realmodel.core import InputRefused, build, load_project

SAMPLE = Path(__file__).resolve().parents[2] / "blend_samples" / "two_layers"
ARRAYS = (
    *("vertices", "face_offsets", "face_vertices", "face_cells", "face_surface", "cell_block"),
    *("surface_vertices", "surface_triangles", "surface_vertex_offsets", "surface_triangle_offsets"),
)


class StoredProject(unittest.TestCase):
    def assert_same_model(self, model, again):
        for name in ARRAYS:
            first, second = getattr(model, name), getattr(again, name)
            self.assertEqual(first.dtype, second.dtype, name)
            self.assertEqual(first.tobytes(), second.tobytes(), name)
        self.assertEqual(model.blocks, again.blocks)
        self.assertEqual(model.surface_names, again.surface_names)

    def there_and_back(self, model):
        """The project read from a .blend that was saved and opened."""
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "m.blend"
            empty_file()
            batch.write_scene(model)
            batch.save_blend(path)
            empty_file()
            bpy.ops.wm.open_mainfile(filepath=str(path))
        return stored_project.project_from_scene(bpy.context.scene)

    def test_from_arrays(self):
        model = build(two_rocks())
        self.assert_same_model(model, build(self.there_and_back(model)))

    def test_interpolated(self):
        model = build(interpolated())
        self.assert_same_model(model, build(self.there_and_back(model)))

    def test_files_gone(self):
        with tempfile.TemporaryDirectory() as folder:
            copy = Path(shutil.copytree(SAMPLE, Path(folder) / "sample"))
            model = build(load_project(copy / "project.toml"))
            shutil.rmtree(copy)
        self.assert_same_model(model, build(self.there_and_back(model)))

    def test_settings_are_equal(self):
        project = build(interpolated()).project
        again = stored_project.unpack(stored_project.pack(project))
        self.assertEqual(again.name, project.name)
        self.assertEqual(list(again.library), list(project.library))
        for rock, other in zip(project.rocks, again.rocks, strict=True):
            np.testing.assert_array_equal(other.region, rock.region)
            self.assertEqual(len(other.holes), len(rock.holes))
            for key in ("name", "edge_length", "mesher", "base_elevation"):
                self.assertEqual(getattr(other, key), getattr(rock, key), key)
            for surface, copy in zip(rock.surfaces, other.surfaces, strict=True):
                for key in ("name", "method", "options", "rule", "property", "block"):
                    self.assertEqual(getattr(copy, key), getattr(surface, key), key)
                np.testing.assert_array_equal(copy.points, surface.points)

    def test_same_project_same_text(self):
        first, second = (stored_project.pack(build(two_rocks()).project) for _ in range(2))
        self.assertEqual(first, second)

    def test_written_again_over_an_earlier_one(self):
        current = empty_file()
        scene.write_model(current, build(two_rocks()))
        model = build(interpolated())
        scene.write_model(current, model)
        self.assert_same_model(model, build(stored_project.project_from_scene(current)))

    def test_a_scene_without_a_model(self):
        self.assertIsNone(stored_project.project_from_scene(empty_file()))

    def test_damage_is_refused(self):
        text = stored_project.pack(build(two_rocks()).project)
        middle = len(text) // 2
        damaged = (text[:middle], text[:middle] + "!" + text[middle:], "", "UEsDBA==", 5)
        for value in (*damaged, text[:middle] + "AAAA" * 50 + text[middle + 200 :]):
            with self.assertRaises(InputRefused):
                stored_project.unpack(value)

    def test_files_are_not_stored_as_names(self):
        with self.assertRaises(TypeError):
            stored_project.pack(load_project(SAMPLE / "project.toml"))
