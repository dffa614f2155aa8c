# SPDX-License-Identifier: GPL-3.0-or-later
"""Models that were built elsewhere, opened from their .npz."""

from pathlib import Path

import bpy
import numpy as np
from blender_state import inventory
from panel_case import SAMPLES, PanelCase, ops, stack
from realmodel.bl.display import shown_models
from realmodel.bl.objects import built_models
from realmodel.core import build, load_project

OLD = Path(__file__).resolve().parents[1] / "data" / "models" / "0.1.npz"
ARRAYS = ("vertices", "face_offsets", "face_vertices", "face_cells", "face_surface", "cell_block")


class Opened(PanelCase):
    def saved(self, sample):
        """The model of a sample, and its file."""
        model = build(load_project(SAMPLES / sample / "project.toml"))
        file = self.folder / f"{sample}.npz"
        model.save(file)
        return model, file

    def meshes(self):
        """{name: coordinates} of the blocks' meshes, in the model's order."""
        found = {}
        for row in (row for row in self.model.results if row.object):
            flat = np.empty(3 * len(row.object.data.vertices), np.float32)
            row.object.data.vertices.foreach_get("co", flat)
            found[row.name] = flat.tobytes()
        return found

    def test_the_scene_is_as_after_a_build(self):
        for sample in ("two_layers", "fault_blocks", "tunnel"):
            with self.subTest(sample):
                model, file = self.saved(sample)
                ops.open_project(filepath=str(SAMPLES / sample / "project.toml"))
                ops.build()
                wanted = (self.volumes(), self.meshes(), self.settings(), self.tree(), self.materials())
                self.assertEqual(ops.open_project(filepath=str(file)), {"FINISHED"})
                found = (self.volumes(), self.meshes(), self.settings(), self.tree(), self.materials())
                for mine, theirs in zip(found, wanted, strict=True):
                    self.assertTrue(mine)
                    self.assertEqual(mine, theirs)
                self.assertFalse(self.model.is_outdated)
                self.assertEqual(self.model.project_file, "")
                shown = shown_models.whole(self.scene)
                self.assertIs(shown, built_models.current(self.scene))
                self.assertEqual(shown.face_vertices.tobytes(), model.face_vertices.tobytes())

    def settings(self):
        return [
            (
                *(rock.name, rock.edge_length, rock.mesher, rock.use_base, rock.base_elevation),
                [(s.name, s.rule, s.method, s.property_id, s.source) for s in rock.surfaces],
            )
            for rock in self.model.rocks
        ] + [(f.name, f.dies_out) for f in self.model.faults]

    def tree(self):
        return sorted((item.name, item.users_collection[0].name) for item in self.scene.objects)

    def materials(self):
        return [(row.name, row.object.active_material.name) for row in self.model.results if row.object]

    def test_a_stage_a_section_and_a_build_follow(self):
        model, file = self.saved("two_layers")
        ops.open_project(filepath=str(file))
        self.assertEqual(shown_models.at_stage(self.scene, 0, "columns").volume, model.stage(0).volume)
        self.assertEqual(ops.section(location=(50, 30, 10), normal=(1, 0, 0)), {"FINISHED"})
        ops.build()
        mine = shown_models.whole(self.scene)
        for name in ARRAYS:
            self.assertEqual(getattr(mine, name).tobytes(), getattr(model, name).tobytes(), name)

    def test_one_undo_takes_it_back(self):
        stack(0.0, 10.0)
        ops.from_selected()
        ops.build()
        bpy.ops.ed.undo_push(message="built")
        before = (self.volumes(), self.tree())
        _, file = self.saved("two_layers")
        ops.open_project("EXEC_DEFAULT", True, filepath=str(file))
        self.assertEqual(set(self.volumes()), {"Clay", "Sand"})
        bpy.ops.ed.undo()
        self.assertEqual((self.volumes(), self.tree()), before)

    def test_a_model_without_its_project_is_shown_with_a_warning(self):
        ops.open_project(filepath=str(OLD))
        self.assertEqual([row.name for row in self.model.results][:2], ["layer 0", "layer 1"])
        self.assertIn("lacks the project: regions, rules", self.model.warnings)
        self.refused(ops.report, "build it from its project and save", filepath=str(self.folder / "r.json"))
        self.assertEqual(ops.section(location=(5, 5, 1), normal=(1, 0, 0)), {"FINISHED"})

    def test_damaged_files_change_nothing(self):
        stack(0.0, 10.0)
        ops.build()
        bad = self.folder / "m.npz"
        bad.write_bytes(OLD.read_bytes()[:-100])
        before = inventory()
        self.refused(ops.open_project, r"m\.npz: not an \.npz file", filepath=str(bad))
        self.assertEqual(inventory(), before)

    def test_a_page_is_shared_in_the_colors_that_are_seen(self):
        stack(0.0, 20.0, 40.0)
        ops.library_add(name="Sand")
        row = self.model.library[-1]
        row.has_color, row.color = True, (0.1, 0.2, 0.3)
        self.model.rocks[0].surfaces[1].property_id = row.id
        ops.build()
        row.color = (0.25, 0.5, 1.0)
        page = self.folder / "model.html"
        self.assertEqual(ops.share(filepath=str(page)), {"FINISHED"})
        self.assertTrue('"material":"Sand"' in page.read_text() and '"color":"#4080ff"' in page.read_text())
        self.refused(ops.share, "must end in .html", filepath=str(self.folder / "model.txt"))
