# SPDX-License-Identifier: GPL-3.0-or-later
"""Faults that are read from sticks and extended."""

import bpy
import numpy as np
from panel_case import ops, select, sheet
from realmodel.bl.objects import viewports
from realmodel.bl.project import compartments, project_settings, settings
from realmodel.bl.scene import data_objects
from realmodel.core import load_project, read_points
from structure_case import StructureCase, wall


class Sticks(StructureCase):
    """A fault from a file of sticks that end within the rock, so that it has to be extended."""

    def setUp(self):
        super().setUp()
        self.pol = self.folder / "sticks.pol"
        sticks = [[(60.0, y, h) for h in (20, 0, -20)] for y in (20, 50, 80)]
        self.pol.write_text(
            "".join("".join(f"{x} {y} {z}\n" for x, y, z in s) + "999 999 999\n" for s in sticks)
        )
        select(*(sheet(f"S{n}", 10.0 * n) for n in range(2)))
        ops.from_selected()
        ops.fault_body_add(filepath=str(self.pol))
        self.fault = self.model.faults[0]

    def extent(self):
        """The lowest and the highest corner of the fault in the scene."""
        return np.array(self.fault.interface.bound_box)[[0, 6]].round(3).tolist()

    def test_extended_once_however_often_it_is_built(self):
        self.fault.extend = 40.0
        ops.build()
        before, volumes = self.extent(), self.volumes()
        self.assertEqual(before, [[60.0, -20.0, -60.0], [60.0, 120.0, 60.0]])
        for _ in range(2):
            ops.build()
            self.assertEqual((self.extent(), self.volumes()), (before, volumes))
        self.pol.write_text(self.pol.read_text() + "\n")  # it is read again
        ops.build()
        self.assertEqual(self.extent(), before)
        saved = self.folder / "p.toml"
        ops.save_project(filepath=str(saved))
        model = load_project(saved)
        self.assertEqual((model.faults[0].extend, model.faults[0].stick), (0.0, None))
        self.pol.unlink()
        self.save_and_open()
        self.fault = self.model.faults[0]
        ops.build()
        self.assertEqual((self.extent(), self.fault.extend), (before, 40.0))

    def test_an_edit_is_followed_live_and_extended_no_more(self):
        self.fault.extend = 40.0
        ops.build()
        self.model.live = True
        self.live_is_done()
        before = self.extent()
        for vertex in self.fault.interface.data.vertices:
            vertex.co.x -= 10.0
        self.fault.interface.data.update()
        bpy.context.view_layer.update()
        self.live_is_done()
        self.assertEqual(bpy.context.window_manager.realmodel.problem, "")
        self.assertEqual(self.fault.source, "MESH_OBJECT")
        self.assertEqual(self.fault.extend, 0.0, "the mesh has it already")
        found = compartments.read(self.scene)["volumes"]["S1 block"]
        self.assertEqual([round(volume, 3) for volume in found], [5e4, 5e4])
        ops.build()
        self.assertEqual(self.extent(), [[50.0, *low[1:]] for low in before])

    def test_the_surface_as_a_mesh_object_is_extended_no_more(self):
        self.fault.extend = 40.0
        ops.build()
        before = self.extent()
        self.fault.source = "MESH_OBJECT"
        self.assertEqual(self.fault.extend, 0.0)
        ops.build()
        self.assertEqual(self.extent(), before)

    def test_another_extension_reads_the_file_again(self):
        self.fault.extend = 40.0
        ops.build()
        self.fault.extend = 60.0
        ops.build()
        self.assertEqual(self.extent(), [[60.0, -40.0, -80.0], [60.0, 140.0, 80.0]])

    def test_a_mesh_that_was_made_from_its_file_is_extended_no_more(self):
        off = self.folder / "wall.off"
        off.write_text("OFF\n4 2 0\n50 -9 -60\n50 109 -60\n50 109 60\n50 -9 60\n3 0 1 2\n3 0 2 3\n")
        ops.fault_body_remove()
        ops.fault_body_add(filepath=str(off))
        fault = self.model.faults[0]

        def composed():
            depsgraph = viewports.updated_layer(self.scene).depsgraph
            return project_settings.compose(self.scene, depsgraph).project.faults[0]

        fault.extend = 5.0
        self.assertEqual((composed().extend, composed().vertices), (5.0, None), "the file is to be read")
        fault.extend = 0.0
        ops.build()
        with settings.filling():
            fault.extend = 5.0  # as it was when the stored mesh was made
        self.assertEqual((composed().extend, len(composed().vertices)), (0.0, 4))
        fault.filepath = ""
        self.assertEqual((fault.extend, len(composed().vertices)), (0.0, 4), "the .blend keeps the mesh")
        fault.source, fault.object = "MESH_OBJECT", wall("own", 50.0)
        fault.extend = 5.0
        self.assertEqual(composed().extend, 5.0)

    def shown(self):
        """The data of the fault in the viewport."""
        return {item.name: item for item in data_objects.objects(self.scene)}

    def test_the_place_of_a_refusal_before_there_is_a_surface(self):
        self.refused(ops.build, "fault 'sticks'.*ends inside the rock")
        self.assertFalse(ops.show_problem.poll())  # a script gets the error itself
        self.model.live = True
        self.live_is_done()
        activity = bpy.context.window_manager.realmodel
        self.assertIn("set Dies Out or Ends At, or choose an older Youngest", activity.problem)
        self.assertNotIn("_", activity.problem)
        ops.show_problem()
        x, y, z = self.scene.cursor.location
        self.assertAlmostEqual(x, 60.0, delta=0.1)
        self.assertTrue(0.0 <= y <= 20.0 or 80.0 <= y <= 100.0, "beyond the sticks, in the rock")
        self.assertTrue(0.0 <= z <= 10.0, z)
        self.model.live = False
        self.fault.extend = 40.0
        ops.build()
        self.assertEqual(len(compartments.names(self.scene)), 2)

    def test_sticks_are_shown_as_lines_when_their_file_is_chosen(self):
        item = self.shown()["sticks sticks"]
        places = np.array([item.matrix_world @ vertex.co for vertex in item.data.vertices])
        self.assertEqual(places.round(3).tolist()[:3], [[60, 20, 20], [60, 20, 0], [60, 20, -20]])
        self.assertEqual(
            [tuple(edge.vertices) for edge in item.data.edges],
            [(0, 1), (1, 2), (3, 4), (4, 5), (6, 7), (7, 8)],
        )
        self.assertTrue(all(edge.is_loose for edge in item.data.edges))
        table = self.folder / "picks.csv"
        table.write_text("x,y,z,s\n" + "".join(f"{x},{x % 3},{x % 5},{x % 2}\n" for x in range(8)))
        self.model.show_data = False
        self.fault.filepath = str(table)
        self.assertEqual(len(self.shown()["sticks sticks"].data.edges), 0, "they are scattered")
        self.fault.stick = "s"
        self.assertEqual(len(self.shown()["sticks sticks"].data.edges), 6)
        ops.fault_body_remove()
        self.assertEqual(self.shown(), {})

    def test_the_column_of_sticks(self):
        table = self.folder / "sticks.csv"
        rows = [(30, y, h) for y in (-10, 50, 110) for h in (-60, 0, 60)]
        table.write_text("x,y,z,s\n" + "\n".join(f"{x},{y},{h},{y}" for x, y, h in rows))
        ops.fault_body_remove()
        ops.fault_body_add(filepath=str(table))
        self.fault = self.model.faults[0]
        self.fault.stick = "s"
        ops.build()
        before = self.volumes()
        ops.build()
        self.assertEqual(self.volumes(), before)


class FaultOfPoints(StructureCase):
    """A fault from points with dips."""

    def test_its_points_and_dips_are_saved(self):
        """And opened again, the same, before it is built and afterward."""
        along = np.arange(-10.0, 111.0, 20.0)
        y, z = (part.ravel() for part in np.meshgrid(along, np.arange(-40.0, 41.0, 20.0)))
        points = np.column_stack([50.0 + 0.5 * z, y, z])
        points_text = "\n".join(["x,y,z", *(",".join(map(str, row)) for row in points)])
        (self.folder / "f.csv").write_text(points_text + "\n")
        (self.folder / "d.csv").write_text("x,y,z,dip,dip_direction\n50,50,0,63.4,270\n")
        select(*(sheet(f"S{n}", 10.0 * n) for n in range(2)))
        ops.from_selected()
        project_file = self.folder / "p.toml"
        ops.save_project(filepath=str(project_file))
        with project_file.open("a") as text:
            text.write('\n[[fault]]\nname = "F"\npoints = "f.csv"\ndips = "d.csv"\n')
        ops.open_project(filepath=str(project_file), build=False)
        given = self.model.faults[0].dips["normals"].tolist()
        for number in range(2):
            saved = self.folder / f"saved{number}.toml"
            ops.save_project(filepath=str(saved))
            fault = load_project(saved).faults[0]
            self.assertIsNotNone(fault.dip_file)
            ops.open_project(filepath=str(saved), build=False)
            np.testing.assert_allclose(self.model.faults[0].dips["normals"], given, atol=1e-12)
            np.testing.assert_array_equal(read_points(self.model.faults[0].filepath).xyz, points)
            ops.build()
