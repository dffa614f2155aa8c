# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of objects in the panel: surfaces, points, faults and bodies by their names, boreholes, export. By
the libraries of the tests' environment, where Blender has its Python."""

import importlib.util
import sys
import unittest
from pathlib import Path

import bpy
import numpy as np
from panel_case import PanelCase, ops, stack
from realmodel.bl.project import choices
from realmodel.core import Project, Rock, Surface, build

VERSION = f"python{sys.version_info.major}.{sys.version_info.minor}"
PACKAGES = Path(__file__).resolve().parents[2] / "build" / "venv" / "lib" / VERSION / "site-packages"
PICKS = {
    "B1": (np.array([20.0, 20, 40]), [("S1", np.array([20.0, 20, 10])), ("S0", np.array([20.0, 20, 0]))])
}


class ObjectFiles(PanelCase):
    def setUp(self):
        super().setUp()
        if importlib.util.find_spec("omf") is None and PACKAGES.is_dir():
            sys.path.append(str(PACKAGES))
            self.addCleanup(sys.path.remove, str(PACKAGES))
        if importlib.util.find_spec("omf") is None:
            raise unittest.SkipTest("omf is not installed: scripts/test.sh installs it")

    def written(self):
        """A block between two surfaces, and a borehole."""
        plan = np.array([[0, 0], [100, 0], [100, 100], [0, 100]], float)
        surfaces = [
            Surface(f"S{k}", np.column_stack([plan, np.full(4, 10.0 * k)]), [[0, 1, 2], [0, 2, 3]])
            for k in range(2)
        ]
        model = build(Project("x", [Rock("r", surfaces, hole_picks=PICKS)]))
        model.save(self.folder / "m.omf")
        return self.folder / "m.omf"

    def remove_points(self):
        rock = self.model.rocks[0]
        rock.active_surface = rock.surfaces.find("picks")
        ops.surface_remove()

    def test_open_surfaces_and_points_are_imported_by_their_names(self):
        ops.surface_add(filepath=str(self.written()))
        rows = self.model.rocks[0].surfaces
        self.assertEqual({row.name: (row.source, row.layer) for row in rows}["S0"], ("MESH_FILE", "S0"))
        self.assertEqual({row.name for row in rows}, {"S0", "S1", "picks"})  # the block is closed
        by_name = {row.name: row for row in rows}
        self.assertEqual(by_name["picks"].source, "POINTS_FILE")
        self.assertIn("boreholes", choices.layers(by_name["S0"], bpy.context, ""))
        self.remove_points()
        ops.build()
        self.assertEqual(list(self.volumes().values()), [1e5])

    def test_a_block_becomes_a_body_and_a_surface_a_fault(self):
        ops.fault_body_add(filepath=str(self.written()))
        self.assertEqual([(row.name, row.layer) for row in self.model.bodies], [("S1 block", "S1 block")])
        self.assertEqual([row.name for row in self.model.faults], ["S0", "S1"])

    def test_boreholes_give_points(self):
        ops.boreholes_read(filepath=str(self.written()))
        rows = self.model.rocks[0].surfaces
        self.assertEqual([row.name for row in rows], ["S0", "S1"])

    def test_the_system_and_the_layer_stay_in_the_project(self):
        ops.surface_add(filepath=str(self.written()))
        self.remove_points()
        self.model.crs = "EPSG:25832"
        ops.save_project(filepath=str(self.folder / "p.toml"))
        self.assertIn('crs = "EPSG:25832"', (self.folder / "p.toml").read_text())
        self.model.crs = "nowhere"
        self.refused(ops.build, "'crs' must be a code")

    def test_a_model_is_exported(self):
        stack(0.0, 10.0)
        ops.build()
        ops.export(filepath=str(self.folder / "m.omf"))
        self.assertEqual((self.folder / "m.omf").read_bytes()[:4], b"\x84\x83\x82\x81")

    def rows(self, path, **sizes):
        kinds = {"file": str(path), "kind": "surface", "chosen": True}
        return [{**kinds, "name": name, "size": size} for name, size in sizes.items()]

    def test_chosen_ones_are_matched_by_name(self):
        """Whatever the capitals and the signs between words; what is not ticked is not imported."""
        path = self.written()
        for name in ("s_1", "other"):
            ops.surface_add(name=name, empty=True)
        chosen = self.rows(path, S0=2, S1=2)
        chosen[0]["chosen"] = False
        ops.surface_add(filepath=str(path), objects=chosen)
        rows = self.model.rocks[0].surfaces
        self.assertEqual([(row.name, row.layer) for row in rows], [("s_1", "S1"), ("other", "")])
        chosen[0]["chosen"] = True
        ops.surface_add(filepath=str(path), objects=chosen)
        self.assertEqual([row.name for row in rows], ["s_1", "other", "S0"])

    def test_filters(self):
        path = self.written()
        chosen = self.rows(path, S0=2, S1=900)
        ops.surface_add(filepath=str(path), objects=chosen, object_size=10)
        self.assertEqual([row.name for row in self.model.rocks[0].surfaces], ["S1"])
        ops.surface_add(filepath=str(path), objects=chosen, object_name="*0")
        self.assertEqual({row.name for row in self.model.rocks[0].surfaces}, {"S0", "S1"})
        self.refused(ops.surface_add, "no object", filepath=str(path), objects=chosen, object_kind="points")
