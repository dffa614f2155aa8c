# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes for simulation from the panel: the same as in batch, with progress, Esc and errors."""

import time

from panel_case import SAMPLES, PanelCase, ops
from realmodel.bl.display import shown_models
from realmodel.bl.jobs.export_job import ExportJob
from realmodel.bl.jobs.mesh_job import MeshJob
from realmodel.core import Cancelled, OutputFailed, UsageError, build, load_project
from realmodel.core.exporters import MESH, save_mesh
from realmodel.core.exporters.mesh_request import MeshRequest

PROJECT = SAMPLES / "two_layers" / "project.toml"
OPTIONS = {"edge_length": 8.0, "minimum_thickness": 1.0, "layer_thickness": 4.0}


class MeshExport(PanelCase):
    def open_two_layers(self):
        ops.open_project(filepath=str(PROJECT))
        ops.build()

    def test_every_format_is_what_the_core_writes(self):
        self.open_two_layers()
        mesh = build(load_project(PROJECT)).simulation_mesh(8.0, 1.0, layer_thickness=4.0)
        for known in MESH.formats():
            ending = known.ending
            path, expected = self.folder / f"panel{ending}", self.folder / f"core{ending}"
            self.assertEqual(ops.export_mesh(filepath=str(path), **OPTIONS), {"FINISHED"})
            save_mesh(mesh, expected)
            if not known.folder:
                self.assertEqual(path.read_bytes(), expected.read_bytes(), ending)
            else:
                points = "constant/polyMesh/points"
                self.assertEqual((path / points).read_bytes(), (expected / points).read_bytes())

    def test_layers_and_elements(self):
        self.open_two_layers()
        path = self.folder / "m.msh"
        ops.export_mesh(filepath=str(path), edge_length=8.0, layers=3, elements="TETRAHEDRA")
        expected = self.folder / "e.msh"
        model = build(load_project(PROJECT))
        save_mesh(model.simulation_mesh(8.0, 0.8, layers=3, elements="tetrahedra"), expected)
        self.assertEqual(path.read_bytes(), expected.read_bytes())

    def test_a_model_without_columns(self):
        project = SAMPLES / "fault_blocks" / "project.toml"
        ops.open_project(filepath=str(project))
        ops.build()
        path, expected = self.folder / "m.vtu", self.folder / "e.vtu"
        sizes = {"edge_length": 160.0, "minimum_thickness": 40.0}
        self.refused(ops.export_mesh, "elements .*tetrahedra", filepath=str(path), **sizes)
        self.refused(
            ops.export_mesh, "has none", filepath=str(path), layers=2, elements="TETRAHEDRA", **sizes
        )
        self.assertFalse(path.exists())
        ops.export_mesh(filepath=str(path), elements="TETRAHEDRA", **sizes)
        save_mesh(build(load_project(project)).simulation_mesh(160.0, 40.0, elements="tetrahedra"), expected)
        self.assertEqual(path.read_bytes(), expected.read_bytes())

    def test_what_cannot_be_is_refused(self):
        self.refused(ops.export_mesh, "press Build first", filepath=str(self.folder / "m.vtu"))
        self.open_two_layers()
        self.refused(ops.export_mesh, "the name must end in .vtu or .foam", filepath=str(self.folder / "m.x"))
        self.refused(ops.export_mesh, "no file for the output", filepath="")
        nowhere = str(self.folder / "none" / "m.vtu")
        self.refused(ops.export_mesh, "there is no folder", filepath=nowhere)
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_a_job_reports_progress_and_stops(self):
        self.open_two_layers()
        model = shown_models.whole(self.scene)
        path = self.folder / "m.vtu"
        job = MeshJob(model, MeshRequest(path, 0.25, 0.05, None, 0.1), "m")
        job.start()
        while job.state()[0] == 0 and not job.done:
            time.sleep(0.005)
        self.assertFalse(job.done)
        job.cancel()
        job.wait()
        with self.assertRaises(Cancelled):
            job.finish()
        self.assertEqual(list(self.folder.iterdir()), [])
        job = MeshJob(model, MeshRequest(path, 8.0), "m")
        job.start()
        job.wait()
        while not job.done:
            time.sleep(0.01)
        self.assertGreater(job.finish().cells, 100)
        self.assertTrue(path.is_file())
        with self.assertRaisesRegex(UsageError, "meshes are not written as"):
            MeshJob(model, MeshRequest(self.folder / "m.xyz"), "m")

    def test_a_model_is_exported_in_a_job_that_stops(self):
        self.open_two_layers()
        model = shown_models.whole(self.scene)
        path = self.folder / "m.csv"
        job = ExportJob(model, path, cell_size=0.5)
        job.start()
        while job.state()[0] == 0 and not job.done:
            time.sleep(0.005)
        self.assertFalse(job.done)
        self.assertEqual(job.state()[1], "writing m.csv")
        job.cancel()
        job.wait()
        with self.assertRaises(Cancelled):
            job.finish()
        deadline = time.monotonic() + 20
        while list(self.folder.iterdir()) and time.monotonic() < deadline:
            time.sleep(0.05)
        self.assertEqual(list(self.folder.iterdir()), [])
        job = ExportJob(model, path, cell_size=5.0)
        job.start()
        while not job.done:
            time.sleep(0.01)
        self.assertEqual(job.finish(), path)
        model.save(self.folder / "e.csv", cell_size=5.0)
        self.assertEqual(path.read_bytes(), (self.folder / "e.csv").read_bytes())
        with self.assertRaisesRegex(UsageError, "takes no tolerance"):
            ExportJob(model, path, tolerance=1.0)
        with self.assertRaisesRegex(OutputFailed, "there is no folder"):
            ExportJob(model, self.folder / "none" / "m.vtu")

    def test_cells_are_as_large_as_they_were_typed(self):
        self.open_two_layers()
        path, expected = self.folder / "m.csv", self.folder / "e.csv"
        ops.export(filepath=str(path), cell_size=(2.3, 2.3, 0.7))
        shown_models.whole(self.scene).save(expected, cell_size=(2.3, 2.3, 0.7))
        self.assertEqual(path.read_bytes(), expected.read_bytes())

    def test_maps_and_their_interval(self):
        self.open_two_layers()
        path, expected = self.folder / "m.gpkg", self.folder / "e.gpkg"
        ops.export(filepath=str(path), contour_interval=5.0)
        shown_models.whole(self.scene).save(expected, contour_interval=5.0)
        self.assertEqual(path.read_bytes(), expected.read_bytes())

    def test_surfaces_alone(self):
        self.open_two_layers()
        for ending in (".obj", ".ply", ".stl", ".glb", ".dxf", ".ts", ".vtu", ".npz"):
            path, expected = self.folder / f"m{ending}", self.folder / f"e{ending}"
            ops.export(filepath=str(path), surfaces_only=True)
            shown_models.whole(self.scene).save_surfaces(expected)
            self.assertEqual(path.read_bytes(), expected.read_bytes())
        count = len(shown_models.whole(self.scene).surface_names)
        self.assertEqual((self.folder / "m.ts").read_text().count("GOCAD TSurf"), count)
        self.refused(
            ops.export, "surfaces are written to", filepath=str(self.folder / "m.foam"), surfaces_only=True
        )

    def test_cells_are_cleaned_to_a_tolerance(self):
        self.open_two_layers()
        path, expected = self.folder / "m.vtu", self.folder / "e.vtu"
        ops.export(filepath=str(path), cell_tolerance=0.5)
        shown_models.whole(self.scene).save(expected, tolerance=0.5)
        self.assertEqual(path.read_bytes(), expected.read_bytes())
        ops.export(filepath=str(expected))
        self.assertLess(path.stat().st_size, expected.stat().st_size)
        self.refused(
            ops.export, "takes no tolerance", filepath=str(self.folder / "m.stl"), cell_tolerance=0.5
        )
