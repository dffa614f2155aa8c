# SPDX-License-Identifier: GPL-3.0-or-later
"""Logs of boreholes in the viewport: their curves color the tubes, and stand beside them."""

import sys
from pathlib import Path

import bpy
import numpy as np
from blender_state import coordinates
from panel_case import PanelCase, ops, outline
from realmodel.bl.field import boreholes, shown_log
from realmodel.bl.overlay import View, drawing_for
from realmodel.bl.project import interval_values, project_settings

sys.path.append(str(Path(__file__).parents[1] / "core"))  # behind the tests of this folder
from las_files import las_text

COLLARS = "hole,x,y,z,eoh\nB-0,20,50,60,40\nB-1,80,51,60,40\n"
LOGS = "hole,from,to,lith\nB-0,0,10,Sand\nB-0,10,30,Clay\nB-1,0,12,Sand\nB-1,12,30,Clay\n"
DEPTHS = [0.0, 2.0, 4.0, 6.0, 8.0]
GAMMA = {"GR.GAPI": [10.0, 20.0, np.nan, 40.0, 50.0], "RHOB.G/C3": [2.0, 2.5, 2.0, 2.5, 3.0]}


class HoleLogs(PanelCase):
    def read(self, **tables):
        names = []
        for name, text in tables.items():
            names.append(name if name.endswith(".las") else f"{name}.csv")
            (self.folder / names[-1]).write_text(text)
        files = [{"name": name} for name in names]
        ops.boreholes_read(filepath=str(self.folder / names[0]), directory=str(self.folder), files=files)

    def read_all(self):
        logs = {f"{n}.las": las_text(f"b_{n}", DEPTHS, GAMMA) for n in range(2)}
        self.read(collars=COLLARS, logs=LOGS, **logs)

    @property
    def rock(self):
        return self.model.rocks[0]

    def bodies(self, kind):
        return [item for item in self.scene.objects if item.get("realmodel_view") == kind]

    def bars(self):
        """(N, 4, 3) the corners of the curves in model coordinates, and the names of their materials."""
        (item,) = self.bodies("hole_curves")
        places = coordinates(item.data).astype(float) + project_settings.model_origin(self.scene)
        names = [item.data.materials[polygon.material_index].name for polygon in item.data.polygons]
        return places.reshape(-1, 4, 3), names

    def test_curves_color_the_tubes_and_stand_beside_them(self):
        self.read_all()
        self.assertEqual(boreholes.columns(self.scene), ["lith", "GR (GAPI)", "RHOB (G/C3)"])
        view = self.model.view
        self.assertTrue(view.show_boreholes and view.show_hole_curves)
        self.assertEqual(view.boreholes_by, "GR (GAPI)")
        bars, colors = self.bars()
        self.assertEqual(len(bars), 8, "a sample without a value is a gap")
        key = boreholes.key(self.scene)
        self.assertEqual((key.title, key.limits), ("GR (GAPI)", (10.0, 50.0)))
        widths = (bars[:, 2, 0] - bars[:, 1, 0])[:4]
        self.assertTrue(np.allclose(widths / widths[-1], [0.0, 0.25, 0.75, 1.0], atol=1e-4))
        heights = 60 - np.array([[0, 1], [1, 3], [5, 7], [7, 8]])
        self.assertTrue(np.allclose(bars[:4, :2, 2], heights, atol=1e-4))
        self.assertTrue((bars[:4, :, 0] > 20).all() and np.allclose(bars[:4, :, 1], 50, atol=1e-4))
        (tubes,) = self.bodies("boreholes")
        of_tubes = [tubes.data.materials[p.material_index].name for p in tubes.data.polygons][::8]
        self.assertEqual(of_tubes, colors, "both have the same colors")
        view.boreholes_by = "lith"
        self.assertEqual(self.bodies("hole_curves"), [], "words have no curve")
        view.boreholes_by = "RHOB (G/C3)"
        self.assertEqual(len(self.bars()[0]), 10)
        view.show_hole_curves = False
        self.assertEqual(self.bodies("hole_curves"), [])

    def test_undo_takes_logs_away_and_files_keep_them(self):
        self.read(collars=COLLARS, logs=LOGS)
        bpy.ops.ed.undo_push(message="before")
        self.read_all()
        bpy.ops.ed.undo_push(message="logs")
        bpy.ops.ed.undo()
        self.assertEqual(boreholes.columns(self.scene), ["lith"])
        self.assertEqual(self.bodies("hole_curves"), [])
        bpy.ops.ed.redo()
        self.save_and_open()
        self.assertEqual(len(self.bars()[0]), 8)
        values = interval_values.of_rock(self.rock)
        self.assertEqual(int(values.has("GR (GAPI)").sum()), 8)

    def test_logs_of_no_hole_are_refused(self):
        logs = {"0.las": las_text("Smith 7", DEPTHS, GAMMA)}
        self.refused(self.read, "no hole is called 'Smith 7'", collars=COLLARS, logs=LOGS, **logs)

    def test_logs_with_collars_alone(self):
        self.read(collars=COLLARS, **{"0.las": las_text("B-0", DEPTHS, GAMMA)})
        self.assertEqual(len(self.bars()[0]), 4)

    def test_projects_bring_their_logs(self):
        self.read_all()
        (self.folder / "project.toml").write_text(
            'format = 1\nname = "p"\n[[rock]]\nname = "r"\n'
            "region = [[0, 0], [100, 0], [100, 100], [0, 100]]\n"
            "edge_length = 20\nbase_elevation = 0\n"
            'boreholes = { collars = "collars.csv", intervals = "logs.csv", logs = ["0.las", "1.las"] }\n'
            '[[rock.surface]]\nname = "Clay"\nmethod = "plane"\n'
            '[[rock.surface]]\nname = "Sand"\nmethod = "plane"\n'
        )
        ops.open_project(filepath=str(self.folder / "project.toml"))
        self.assertEqual(boreholes.columns(self.scene), ["GR (GAPI)", "RHOB (G/C3)"])

    def test_on_the_cut_and_on_saved_sections(self):
        self.read_all()
        self.rock.region = outline("r", [(0, 0), (100, 0), (100, 100), (0, 100)])
        self.rock.base_elevation, self.rock.edge_length = 0.0, 20.0
        for row in self.rock.surfaces:
            row.method = "plane"
        ops.build()
        ops.section_plane(axis="X")
        view = self.model.view
        view.plane.location.x = 20.0 - project_settings.model_origin(self.scene)[0]
        bpy.context.view_layer.update()
        ops.section_update()
        view.hole_width = 1.0
        bars, _ = self.bars()
        self.assertEqual(len(bars), 4, "of the hole that is near")
        self.assertTrue((np.ptp(bars[:, :, 0]) < 1e-4) and 20.0 < bars[0, 0, 0] < 21.0, "before the plane")
        self.assertTrue((bars[:, :, 1] > 50.0).all(), "right of the hole, seen from the east")
        path = self.folder / "s.svg"
        ops.save_section(filepath=str(path), hole_width=1.0, hole_column="GR")
        self.assertIn("GR (GAPI)", path.read_text())
        ops.save_section(filepath=str(path), hole_width=1.0)
        self.assertNotIn("GR (GAPI)", path.read_text())
        self.refused(ops.save_section, "no column 'XX'", filepath=str(path), hole_width=1.0, hole_column="XX")

    def overlay(self):
        picture = View(np.eye(4), np.eye(4), False, (900.0, 600.0))
        return drawing_for(self.scene, picture)

    def test_the_log_of_a_hole_stands_beside_the_model(self):
        self.read_all()
        self.refused(ops.hole_log, "no borehole 'B-7'", hole="B-7")
        self.assertNotIn("B-0 (m)", [getattr(item, "text", "") for item in self.overlay().items])
        bpy.ops.ed.undo_push(message="before")
        ops.hole_log(hole="B-0")
        bpy.ops.ed.undo_push(message="log")
        texts = [getattr(item, "text", "") for item in self.overlay().items]
        for text in ("B-0 (m)", "Sand", "Clay", "GR (GAPI)", "RHOB (G/C3)", "40"):
            self.assertIn(text, texts)
        log = shown_log.of_scene(self.scene)
        self.assertEqual([(part.top, part.bottom) for part in log.parts], [(0.0, 10.0), (10.0, 30.0)])
        bpy.ops.ed.undo()
        self.assertEqual(self.model.view.log_hole, "")
        bpy.ops.ed.redo()
        self.assertEqual(self.model.view.log_hole, "B-0")
        self.save_and_open()
        self.assertIn("B-0 (m)", [getattr(item, "text", "") for item in self.overlay().items])
        self.model.view.log_hole = "gone"
        self.assertIsNone(shown_log.of_scene(self.scene))
        ops.hole_log()
        self.assertEqual(self.model.view.log_hole, "")
