# SPDX-License-Identifier: GPL-3.0-or-later
"""Faults given by a line on the ground: drawn in Blender, or from a file."""

import json

import bpy
import numpy as np
from panel_case import ops, outline, select
from realmodel.bl.objects import viewports
from realmodel.bl.project import compartments, project_settings, settings
from realmodel.bl.scene import built_scene, data_objects
from realmodel.core import PointFile, build, load_project
from structure_case import StructureCase, wall

LINE = [(50.0, 10.0), (50.0, 90.0)]


def edges(name, places):
    """A mesh object of edges alone."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(places, [(n, n + 1) for n in range(len(places) - 1)], [])
    item = bpy.data.objects.new(name, mesh)
    bpy.context.collection.objects.link(item)
    return item


class TraceCase(StructureCase):
    def layers(self):
        """Surfaces that a plane at x = 50, z = 20 displaces, before there is a fault."""
        self.faulted(build=False)
        self.model.structure_kind = "FAULT"
        ops.fault_body_remove()

    def of_mesh(self, lean):
        """The volumes with the plane x = 50 - lean (z - 20) as a mesh."""
        self.layers()
        select(wall("plane", 50.0 + 20.0 * lean, lean=lean, y=(-200.0, 300.0)))
        ops.fault_body_from_selected()
        ops.build()
        found = self.parts()
        self.emptied()
        return found

    def emptied(self):
        ops.new()
        for item in list(bpy.data.objects):
            bpy.data.objects.remove(item)

    def parts(self):
        """The volumes of each block in each compartment."""
        return compartments.read(self.scene)["volumes"]

    def same(self, wanted):
        found = self.parts()
        self.assertEqual(found.keys(), wanted.keys())
        for name, volumes in found.items():
            for one, other in zip(volumes, wanted[name], strict=True):
                self.assertAlmostEqual(one, other, delta=1e-6 * other)

    def line_file(self, **properties):
        path = self.folder / "faults.geojson"
        geometry = {"type": "LineString", "coordinates": LINE}
        feature = {"type": "Feature", "properties": properties, "geometry": geometry}
        path.write_text(json.dumps({"type": "FeatureCollection", "features": [feature]}))
        return path


class Drawn(TraceCase):
    def test_a_curve_and_a_mesh_of_edges(self):
        """They become vertical faults; with a dip the volumes are those of the plane."""
        wanted = self.of_mesh(1.0)
        for make in (
            lambda: outline("scarp", LINE, cyclic=False),
            lambda: edges("scarp", [(*place, 0.0) for place in LINE]),
        ):
            with self.subTest():
                item = make()
                self.layers()
                select(item)
                ops.fault_body_from_selected()
                (fault,) = self.model.faults
                self.assertEqual((fault.source, fault.object, fault.dip), ("TRACE_OBJECT", item, 90.0))
                ops.build()
                self.assertEqual(len(compartments.names(self.scene)), 2)
                self.assertNotEqual(self.parts(), wanted)
                fault.dip, fault.dip_direction, fault.elevation = 45.0, "E", "20"
                ops.build()
                self.same(wanted)
                self.assertEqual(fault.object, item)
                self.assertEqual(fault.interface["realmodel"], "fault")
                fault.elevation = ""
                item.location.z = 20.0
                ops.build()
                self.same(wanted)
                self.emptied()

    def test_an_edited_surface_takes_the_place_of_the_line(self):
        self.layers()
        select(outline("scarp", LINE, cyclic=False))
        ops.fault_body_from_selected()
        ops.build()
        fault = self.model.faults[0]
        for vertex in fault.interface.data.vertices:
            vertex.co.x += 10.0
        fault.interface.data.update()
        ops.build()
        self.assertEqual((fault.source, fault.object), ("MESH_OBJECT", fault.interface))

    def test_a_moved_line_is_built_live(self):
        self.layers()
        item = outline("scarp", LINE, cyclic=False)
        select(item)
        ops.fault_body_from_selected()
        ops.build()
        before = self.parts()
        self.model.live = True
        self.live_is_done()
        item.location.x = 20.0
        bpy.context.view_layer.update()
        self.live_is_done()
        self.assertNotEqual(self.parts(), before)
        self.model.faults[0].dip = 45.0
        self.model.faults[0].dip_direction = "90"
        moved = self.parts()
        self.live_is_done()
        self.assertNotEqual(self.parts(), moved)

    def test_saved_and_opened(self):
        self.layers()
        select(edges("scarp", [(50, 10, 20), (50, 60, 20), (50, 90, 20)]))
        ops.fault_body_from_selected()
        fault = self.model.faults[0]
        fault.dip, fault.dip_direction, fault.dies_out, fault.extend = 60.0, "270", False, 500.0
        ops.build()
        before = self.parts()
        self.save_and_open()
        ops.build()
        self.assertEqual(self.parts(), before)
        path = self.folder / "p.toml"
        ops.save_project(filepath=str(path))
        (again,) = load_project(path).faults
        self.assertEqual((again.dip, again.dip_direction, again.extend), (60.0, 270.0, 500.0))
        self.assertTrue(np.array_equal(again.trace, [[50, 10, 20], [50, 60, 20], [50, 90, 20]]))
        ops.open_project(filepath=str(path))
        fault = self.model.faults[0]
        self.assertEqual((fault.source, fault.dip, fault.dip_direction), ("TRACE_FILE", 60.0, "270.0"))
        ops.build()
        self.same(before)
        self.save_and_open("second.blend")
        ops.build()
        self.same(before)

    def test_what_is_no_trace(self):
        self.layers()
        select(outline("ring", [(10, 10), (90, 10), (90, 90)]))
        ops.fault_body_from_selected()
        self.refused(ops.build, "fault 'ring': its trace returns to where it begins")
        ops.fault_body_remove()
        dots = bpy.data.meshes.new("dots")
        dots.from_pydata([(0, 0, 0), (1, 1, 1)], [], [])
        dots = bpy.data.objects.new("dots", dots)
        self.scene.collection.objects.link(dots)
        select(dots)
        self.refused(ops.fault_body_from_selected, "object 'dots' has no faces")
        select(outline("line", LINE, cyclic=False))
        self.refused(ops.fault_body_from_selected, "object 'line' has no faces", kind="BODY")
        ops.fault_body_from_selected()
        fault = self.model.faults[0]
        fault.dip = 60.0
        self.refused(ops.build, "fault 'line': .*dip_direction = 90 or 270")
        fault.dip_direction = "N"
        self.refused(ops.build, "is along its trace")
        fault.dip_direction = "east"
        self.refused(ops.build, "must be a direction, not 'east'")
        fault.dip, fault.dip_direction = 0.0, ""
        self.refused(ops.build, "a trace needs a dip")
        tube = outline("tube", LINE, cyclic=False)
        tube.data.bevel_depth = 1.0
        select(tube)
        self.refused(ops.fault_body_from_selected, "object 'tube': it is not one line")
        fault.object = None
        self.refused(ops.build, "it has no object; choose the curve or mesh with its trace or its sticks")

    def test_search_names_and_sources(self):
        self.layers()
        select(outline("scarp", LINE, cyclic=False))
        ops.fault_body_from_selected()
        fault = self.model.faults[0]
        self.assertFalse(settings.is_mesh_object(fault, fault.object))
        self.assertTrue(settings.is_fault_object(fault, fault.object))
        fault.elevation = "S1"
        settings.active_rock(self.scene).surfaces[1].name = "Top"
        self.assertEqual(fault.elevation, "Top")
        fault.source = "MESH_OBJECT"  # then dip and elevation do not count
        self.assertFalse(settings.is_fault_object(fault, fault.object))
        fault.object = wall("other")
        ops.build()


class OfFiles(TraceCase):
    def test_a_line_of_a_map(self):
        """Dip and direction of its attributes, the elevation of the ground; kept in the .blend."""
        wanted = self.of_mesh(1.0)
        path = self.line_file(DIP=45, DIP_DIR=90)
        self.layers()
        ops.fault_body_add(filepath=str(path))
        (fault,) = self.model.faults
        self.assertEqual((fault.name, fault.source, fault.dip), ("faults", "TRACE_FILE", 0.0))
        shown = [item.name for item in data_objects.objects(self.scene)]
        self.assertIn("faults trace", shown)
        fault.elevation = "20"
        ops.build()
        self.same(wanted)
        path.unlink()
        self.save_and_open()
        ops.build()
        self.same(wanted)
        fault = self.model.faults[0]
        settings.set_number(fault, "dip", 60.0)
        ops.build()
        self.assertNotAlmostEqual(self.parts()["S1 block"][0], wanted["S1 block"][0], places=2)
        self.line_file(DIP=45, DIP_DIR=90)
        fault.dip = 0.0  # as in the file again
        ops.build()
        self.same(wanted)

    def test_options_and_refusals(self):
        path = self.line_file(NAME="F1")
        self.layers()
        ops.fault_body_add(filepath=str(path))
        fault = self.model.faults[0]
        self.refused(ops.build, "it has no dip, and its file has no attribute 'dip'")
        fault.dip = 90.0
        ops.filter_add(of_fault=True)
        fault.filters[0].column, fault.filters[0].value = "NAME", "F2"
        self.refused(ops.build, "no feature has NAME = 'F2'")
        fault.filters[0].value = "F1"
        ops.build()
        composed = project_settings.compose(self.scene, viewports.updated_layer(self.scene).depsgraph)
        self.assertEqual(composed.project.faults[0].dip, 90.0)
        ops.save_project(filepath=str(self.folder / "p.toml"))
        (again,) = load_project(self.folder / "p.toml").faults
        self.assertEqual(again.trace.shape, (2, 3))

    def test_a_model_that_was_built_elsewhere(self):
        """As build_model.py leaves it: the line is kept, with its file or without, not the surface alone."""
        path = self.line_file(DIP=45, DIP_DIR=90)
        self.layers()
        ops.fault_body_add(filepath=str(path))
        ops.build()
        wanted = self.parts()
        project = project_settings.compose(self.scene, viewports.updated_layer(self.scene).depsgraph).project
        project.faults[0].trace = PointFile(path)
        self.emptied()
        model = build(project)
        for given in (None, project):
            built_scene.write_model(self.scene, model, given)
            row = self.model.faults[0]
            self.assertEqual((row.source, bool(row.filepath)), ("TRACE_FILE", given is not None))
            self.assertTrue(row.stored_trace)
            self.same(wanted)
        path.unlink()
        ops.build()
        self.same(wanted)

    def test_a_project_file_with_a_trace(self):
        self.line_file(DIP=45, DIP_DIR=90, NAME="F1")
        self.layers()
        path = self.folder / "p.toml"
        ops.save_project(filepath=str(path))
        fault = (
            '\n[[fault]]\nname = "F1"\ntrace = "faults.geojson"\nwhere = { NAME = "F1" }\nelevation = "S2"\n'
        )
        path.write_text(path.read_text() + fault)
        ops.open_project(filepath=str(path))
        (row,) = self.model.faults
        self.assertEqual((row.source, row.elevation, len(row.filters)), ("TRACE_FILE", "S2", 1))
        ops.build()
        self.assertEqual(len(compartments.names(self.scene)), 2)
