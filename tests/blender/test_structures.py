# SPDX-License-Identifier: GPL-3.0-or-later
"""Faults and bodies: their lists and settings, builds with them, live updates."""

import blender_state
import bpy
from panel_case import ops, raise_by, select, sheet
from realmodel.bl.objects import model_tree, viewports
from realmodel.bl.project import choices, compartments, project_settings, surface_statistics
from realmodel.core import load_project
from recording_layout import draw_tab
from structure_case import THROW, StructureCase, box, mesh_object, wall


class Lists(StructureCase):
    def test_closed_meshes_become_bodies_open_ones_faults(self):
        self.faulted(box("tunnel", (20, -10, 2), (30, 110, 6)), build=False)
        self.assertEqual([row.name for row in self.model.faults], ["F1"])
        self.assertEqual([row.name for row in self.model.bodies], ["tunnel"])
        self.assertEqual(self.model.faults[0].object.name, "F1")
        self.refused(ops.fault_body_from_selected, "in the model already")
        select(sheet("other", 3.0))
        ops.fault_body_from_selected(kind="BODY")
        self.assertEqual([row.name for row in self.model.bodies], ["tunnel", "other"])
        self.refused(ops.build, "body 'other'.*not closed.*edge must belong to two triangles")

    def test_rows_are_moved_and_removed(self):
        self.faulted(wall("F2", 80.0), build=False)
        self.assertEqual({row.name for row in self.model.faults}, {"F1", "F2"})
        first, second = self.model.faults
        first.ends_at.add().name = second.name
        names = [row.name for row in self.model.faults]
        self.assertEqual(self.model.active_fault, 1)
        ops.fault_body_move(direction="UP")
        self.assertEqual([row.name for row in self.model.faults], names[::-1])
        self.assertEqual(self.model.active_fault, 0)
        self.assertEqual(ops.fault_body_move(direction="UP"), {"CANCELLED"})
        ops.fault_body_remove()
        self.assertEqual([row.name for row in self.model.faults], names[:1])
        self.assertEqual(len(self.model.faults[0].ends_at), 0)  # that fault is gone
        self.assertIn(names[1], bpy.data.objects)

    def test_a_copy(self):
        self.faulted(box("ore", (60, 20, -2), (70, 30, 2)))
        self.model.structure_kind = "FAULT"
        self.model.faults[0].youngest = "S2"
        ops.fault_body_copy()
        first, second = self.model.faults
        self.assertEqual((second.name, second.youngest, second.object), ("F1 2", "S2", first.object))
        self.assertEqual((second.interface, self.model.active_fault), (None, 1))
        second.object = wall("F2", 80.0)
        self.model.structure_kind = "BODY"
        ops.fault_body_copy()
        self.assertEqual([row.name for row in self.model.bodies], ["ore", "ore 2"])
        self.model.bodies[1].object = box("more", (20, 20, -2), (30, 30, 2))
        ops.build()
        self.assertEqual(len(compartments.names(self.scene)), 3)
        self.assertAlmostEqual(self.volumes()["ore 2"], 400.0, places=6)

    def test_hidden_and_edited(self):
        self.faulted(box("ore", (60, 20, -2), (70, 30, 2)))
        self.model.display = "SURFACES"
        self.model.structure_kind = "FAULT"
        ops.fault_body_hide()
        self.assertTrue(self.model.faults[0].hide and bpy.data.objects["F1"].hide_get())
        ops.fault_body_hide()
        self.assertFalse(bpy.data.objects["F1"].hide_get())
        ops.fault_body_edit()
        self.assertEqual((bpy.context.mode, bpy.context.object.name), ("EDIT_MESH", "F1"))
        ops.edit_done()
        self.assertEqual((bpy.context.mode, self.model.display), ("OBJECT", "SURFACES"))
        ops.fault_body_add(empty=True)
        self.refused(ops.fault_body_edit, "no surface in the scene yet")

    def test_what_refers_to_a_name_follows_it(self):
        self.faulted(wall("F2", 80.0), box("ore", (60, 20, -2), (70, 30, 2)))
        first, second = self.model.faults
        ore, rock = self.model.bodies[0], self.model.rocks[0]
        first.ends_at.add().name = second.name
        first.youngest = ore.after = "S1"
        first.rocks.add().name = ore.rock = rock.name
        second.name, rock.surfaces[1].name, rock.name = "other", "top", "basin"
        self.assertEqual((first.ends_at[0].name, first.youngest, ore.after), ("other", "top", "top"))
        self.assertEqual((first.rocks[0].name, ore.rock), ("basin", "basin"))
        first.ends_at.clear()
        ops.build()
        rock.surfaces[2].name = "top"  # two of one name: nobody knows which is meant
        rock.surfaces[2].name = "young"
        self.assertEqual(first.youngest, "top")
        self.save_and_open()
        self.model.rocks[0].surfaces[1].name = "middle"
        self.assertEqual(self.model.faults[0].youngest, "middle")

    def test_figures(self):
        self.faulted(box("ore", (60, 20, -2), (70, 30, 2)))
        for row, count in ((self.model.faults[0], 2), (self.model.bodies[0], 12)):
            self.assertEqual(surface_statistics.read(row)["triangles"], count)
        self.assertEqual(surface_statistics.read(self.model.bodies[0])["high"], 2.0)

    def test_dropped_files_become_faults_where_blender_takes_files(self):
        handler = getattr(bpy.types, "REALMODEL_FH_faults_and_bodies", None)
        self.assertEqual(handler is not None, hasattr(bpy.types, "FileHandler"))
        if handler is not None:
            self.assertEqual(handler.bl_import_operator, "realmodel.fault_body_add")
            self.assertLessEqual({".pol", ".ts", ".off"}, set(handler.bl_file_extensions.split(";")))
        for name in ("a", "b"):
            text = "OFF\n4 2 0\n50 -9 -60\n50 109 -60\n50 109 60\n50 -9 60\n3 0 1 2\n3 0 2 3\n"
            (self.folder / f"{name}.off").write_text(text)
        files = [{"name": "a.off"}, {"name": "b.off"}]
        ops.fault_body_add("INVOKE_DEFAULT", directory=str(self.folder), files=files)
        self.assertEqual([row.name for row in self.model.faults], ["a", "b"])

    def test_lists_of_a_fault(self):
        self.faulted(build=False)
        ops.fault_list_add(of="ENDS_AT")
        ops.fault_list_add(of="ROCKS")
        fault = self.model.faults[0]
        self.assertEqual((len(fault.ends_at), len(fault.rocks)), (1, 1))
        ops.fault_list_remove(of="ROCKS", index=0)
        self.refused(ops.fault_list_remove, "there is no row 3", of="ENDS_AT", index=3)
        self.assertEqual((len(fault.ends_at), len(fault.rocks)), (1, 0))
        self.refused(ops.body_property, "no body is active", property_id="0")

    def test_search(self):
        self.faulted(wall("F2", 80.0), box("salt", (1, 1, 1), (2, 2, 2)), build=False)
        first, second = self.model.faults
        end = first.ends_at.add()
        self.assertEqual(choices.faults(end, None, ""), [second.name])
        self.assertEqual(choices.all_surfaces(first, None, ""), ["S2", "S1", "S0"])
        self.assertEqual(choices.rocks(self.model.bodies[0], None, ""), ["rock mass"])

    def test_files(self):
        off = self.folder / "wall.off"
        off.write_text("OFF\n4 2 0\n50 -9 -60\n50 109 -60\n50 109 60\n50 -9 60\n3 0 1 2\n3 0 2 3\n")
        ts = self.folder / "salt.ts"
        ts.write_text(
            "GOCAD TSurf 1\nHEADER {\nname: salt\n}\nTFACE\nVRTX 1 10 10 2\nVRTX 2 20 10 2\nVRTX 3 10 20 2\n"
            "VRTX 4 10 10 8\nTRGL 1 3 2\nTRGL 1 2 4\nTRGL 2 3 4\nTRGL 3 1 4\nEND\n"
        )
        pol = self.folder / "sticks.pol"
        sticks = [[(75 + h / 60, y, h) for h in (60, 0, -60)] for y in (-10, 50, 110)]
        pol.write_text("".join("".join(f"{x} {y} {z}\n" for x, y, z in s) + "999 999 999\n" for s in sticks))
        items = [sheet(f"S{n}", 10.0 * n) for n in range(2)]
        select(*items)
        ops.from_selected()
        for path in (off, ts, pol):
            ops.fault_body_add(filepath=str(path))
        self.assertEqual([row.name for row in self.model.faults], ["wall", "sticks"])
        self.assertEqual([row.source for row in self.model.faults], ["MESH_FILE", "POINTS_FILE"])
        self.assertEqual([row.name for row in self.model.bodies], ["salt"])
        self.refused(ops.fault_body_add, "no triangles", filepath=str(pol), kind="BODY")
        self.refused(ops.fault_body_add, "file not found", filepath="/none.off")
        ops.build()
        self.assertAlmostEqual(self.volumes()["salt"], 100.0, places=9)
        self.assertEqual(len(compartments.names(self.scene)), 3)
        self.assertEqual({item.name for item in self.objects("fault")}, {"wall", "sticks"})
        off.unlink(), ts.unlink(), pol.unlink()
        before = self.volumes()
        self.save_and_open()
        ops.build()
        self.assertEqual(self.volumes(), before)
        self.model.structure_kind, self.model.active_fault = "FAULT", 1
        self.model.faults[1].extend = 5.0  # another surface through points whose file is gone
        self.refused(ops.build, "file not found")

    def test_reading_of_a_file(self):
        table = self.folder / "points.csv"
        rows = [(75, y, h) for y in (-10, 50, 110) for h in (-60, 0, 60)]
        table.write_text("a,b,c,s\n" + "\n".join(f"{x},{y},{-h},{y}" for x, y, h in rows))
        select(*(sheet(f"S{n}", 10.0 * n) for n in range(2)))
        ops.from_selected()
        ops.fault_body_add(filepath=str(table))
        fault = self.model.faults[0]
        fault.stick, fault.z_axis, fault.plan_unit = "s", "down", "m"
        ops.filter_add(of_fault=True)
        fault.filters[0].column, fault.filters[0].value = "a", "75"
        composed = project_settings.compose(self.scene, viewports.updated_layer(self.scene).depsgraph)
        entry = composed.project.faults[0]
        self.assertEqual((entry.stick, entry.point_file.z_axis), ("s", "down"))
        self.assertEqual(entry.point_file.where, {"a": 75})
        ops.filter_remove(of_fault=True, index=0)
        self.assertEqual(len(fault.filters), 0)
        ops.build()
        self.assertEqual(len(compartments.names(self.scene)), 2)


class Built(StructureCase):
    def test_faults_are_continued_beyond_their_objects_and_files(self):
        """By Extend, and where a gap is less than a quarter of an edge: the same blocks, however often it is
        built. An object stays as it was drawn; what is made of a file is shown as it was used."""
        text = "OFF\n4 2 0\n50 0.5 -60\n50 120 -60\n50 120 60\n50 0.5 60\n3 0 1 2\n3 0 2 3\n"
        path = self.folder / "F1.off"
        path.write_text(text)
        self.faulted(build=False)
        fault, found = self.model.faults[0], []
        drawn = fault.object.data.vertices
        for low, by in ((-20.0, 0.0), (0.5, 0.0), (15.0, 40.0)):
            for vertex in drawn:
                vertex.co.y = low if vertex.co.y < 60 else 120.0
            fault.extend = by
            for _ in range(2):
                ops.build()
                found.append(self.volumes())
            self.assertEqual((len(drawn), fault.extend), (4, by))
        fault.extend = 0.0
        fault.source, fault.filepath = "MESH_FILE", str(path)
        for _ in range(2):
            ops.build()
            found.append(self.volumes())
        self.assertEqual([len(item.data.vertices) for item in self.objects("fault")], [6])
        for volumes in found:
            self.assertEqual(set(volumes), set(found[0]))
            for name, volume in volumes.items():
                self.assertAlmostEqual(volume, found[0][name], delta=1e-6 * volume)

    def test_volumes_and_objects(self):
        self.faulted(box("tunnel", (20, -10, 2), (30, 110, 6)), box("ore", (60, 20, -2), (70, 30, 2)))
        tunnel, ore = (next(b for b in self.model.bodies if b.name == n) for n in ("tunnel", "ore"))
        tunnel.void, ore.property_id = True, 0
        ops.build()
        volumes = self.volumes()
        self.assertEqual(set(volumes), {"base block", "S1 block", "S2 block", "ore"})
        ores = 10 * 10 * 4.0
        self.assertAlmostEqual(volumes["ore"], ores, places=6)
        self.assertAlmostEqual(volumes["S1 block"], 1e5 - 100 * 10 * 4 - ores, places=6)
        for name, kind in (("F1", "fault"), ("tunnel", "body"), ("ore", "body")):
            item = bpy.data.objects[name]
            self.assertEqual((item["realmodel"], item["realmodel_surface"]), (kind, name))
            self.assertEqual([c.get("realmodel") for c in item.users_collection], ["structures"])
        self.assertEqual([o.name for o in model_tree.model_objects(self.scene, "fault")], ["F1"])
        block = bpy.data.objects["ore"] if "ore.001" not in bpy.data.objects else bpy.data.objects["ore.001"]
        blocks = {item["realmodel_block"]: item for item in self.objects("block")}
        self.assertEqual(set(blocks), set(volumes))
        self.assertEqual(block["realmodel"], "block")
        for name, item in blocks.items():
            self.assertEqual(blender_state.open_edges(item.data), 0)
            self.assertAlmostEqual(blender_state.volume(item.data), volumes[name], delta=1e-5 * volumes[name])

    def test_the_compartment_of_faces(self):
        self.faulted()
        names = compartments.names(self.scene)
        self.assertEqual(len(names), 2)
        item = next(row.object for row in self.model.results if row.name == "S1 block")
        attribute = item.data.attributes["realmodel_compartment"]
        self.assertEqual((attribute.domain, attribute.data_type), ("FACE", "INT"))
        west = {attribute.data[p.index].value for p in item.data.polygons if p.center.x < 49.0}
        east = {attribute.data[p.index].value for p in item.data.polygons if p.center.x > 51.0}
        self.assertEqual((len(west), len(east), len(west | east)), (1, 1, 2))
        found = compartments.read(self.scene)
        self.assertEqual([round(v, 6) for v in found["volumes"]["S1 block"]], [5e4, 5e4])
        for fault, _, throw, heave in found["faults"]:
            self.assertEqual(fault, "F1")
            self.assertAlmostEqual(abs(throw), THROW, places=9)
            self.assertAlmostEqual(heave, 0.0, places=9)
        labels = [text for text in draw_tab(bpy.context).labels if text]
        heading = labels.index("Mean (m)")
        self.assertEqual(labels[heading + 1 : heading + 3], ["Throw", "Heave"])
        self.assertEqual(float(labels[heading + 4]), round(throw, 6))

    def test_without_faults_nothing_is_added(self):
        select(*(sheet(f"S{n}", 10.0 * n) for n in range(2)))
        ops.from_selected()
        ops.build()
        mesh = self.model.results[0].object.data
        self.assertNotIn("realmodel_compartment", mesh.attributes)
        self.assertEqual(compartments.names(self.scene), [])

    def test_a_mesh_is_continued_by_its_method(self):
        """Sheets that end before the fault: level beyond, or as a method says."""
        parts = [(0.0, 45.0, 10.0), (55.0, 100.0, 6.0)]
        corners = [(x, y, z) for a, b, z in parts for x, y in ((a, 0), (b, 0), (b, 100), (a, 100))]
        base = sheet("S0", 0.0)
        top = mesh_object("S1", corners, [[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]])
        select(base, top)
        ops.from_selected()
        select(wall())
        ops.fault_body_from_selected()
        ops.build()
        self.assertAlmostEqual(self.volumes()["S1 block"], 8e4, delta=1.0)
        row = self.model.rocks[0].surfaces[1]
        row.use_continuation, row.method, row.value = True, "constant", 0.0
        ops.build()
        less = self.volumes()["S1 block"]
        # from the border of each part it goes down to the nearest vertex of the other part
        self.assertAlmostEqual(less, 8e4 - 100 * (10 + 6) * 5 / 4, delta=1.0)
        ops.save_project(filepath=str(self.folder / "p.toml"))
        self.assertIn('method = "constant"', (self.folder / "p.toml").read_text())
        ops.open_project(filepath=str(self.folder / "p.toml"))
        self.assertTrue(self.model.rocks[0].surfaces[1].use_continuation)
        ops.build()
        self.assertAlmostEqual(self.volumes()["S1 block"], less, places=3)
        self.model.structure_kind = "FAULT"
        ops.fault_body_remove()
        ops.build()  # without faults it counts for nothing

    def test_properties_of_bodies(self):
        self.faulted(box("ore", (60, 20, -2), (70, 30, 2)))
        row = next(row for row in self.model.results if row.name == "ore")
        self.assertEqual(self.model.library.get("ore").id, row.property_id)
        self.model.structure_kind = "BODY"
        other = self.model.library[0].id
        ops.body_property(property_id=str(other))
        self.assertEqual(self.model.bodies[0].property_id, other)
        self.model.active_property = list(self.model.library.keys()).index("ore")
        select(row.object)
        ops.assign_property()
        self.assertEqual(self.model.bodies[0].property_id, self.model.library["ore"].id)
        ops.fault_body_remove()
        ops.build()
        self.assertNotIn("ore", self.volumes())
        self.assertNotIn("ore", self.model.library)

    def test_refusals_leave_all_and_show_the_place(self):
        self.faulted()
        before, volumes = blender_state.inventory(), self.volumes()
        short = bpy.data.objects["F1"]
        for vertex in short.data.vertices:
            vertex.co.y = min(vertex.co.y, 60.0)
        self.refused(ops.build, "fault 'F1'.*ends inside the rock.*dies_out")
        self.assertEqual(self.volumes(), volumes)
        after = blender_state.inventory()
        for state in (before, after):
            state.pop(("mesh", short.data.name))
        self.assertEqual(after, before)
        self.model.live = True
        self.live_is_done()
        ops.show_problem()
        self.model.live = False
        self.assertEqual(bpy.context.view_layer.objects.active, short)
        x, y, _ = self.scene.cursor.location
        self.assertAlmostEqual(x, 50.0, delta=0.1)
        self.assertTrue(0.0 <= y <= 100.0, y)
        for vertex in short.data.vertices:
            vertex.co.y = 120.0 if vertex.co.y > 0.0 else vertex.co.y
        ops.build()
        self.assertEqual(self.volumes(), volumes)

    def test_a_fault_that_dies_out(self):
        self.faulted(throw=0.0, build=False)
        for vertex in bpy.data.objects["F1"].data.vertices:
            vertex.co.y = min(vertex.co.y, 60.0)
        self.model.faults[0].dies_out = True
        ops.build()
        self.assertEqual(compartments.names(self.scene), ["rock mass"])

    def test_saved_reopened_undone(self):
        self.faulted(box("ore", (60, 20, -2), (70, 30, 2)))
        before, stored = self.volumes(), self.model.view.compartments
        self.save_and_open()
        self.assertEqual((self.volumes(), self.model.view.compartments), (before, stored))
        ops.build()
        self.assertEqual((self.volumes(), self.model.view.compartments), (before, stored))
        ops.new()
        self.assertEqual((len(self.model.faults), len(self.model.bodies)), (0, 0))
        self.assertIn("F1", bpy.data.objects)
        self.assertNotIn("realmodel", bpy.data.objects["F1"])
        self.assertIsNone(self.model.structures)

    def test_project_file(self):
        self.faulted(wall("F2", 80.0, z=(-60, 12.0)), box("ore", (60, 20, -2), (70, 30, 2)), build=False)
        first, second = sorted(self.model.faults, key=lambda row: row.name)
        second.youngest = "S0"
        first.rocks.add().name = "rock mass"
        body = self.model.bodies[0]
        body.after, body.rock = "S1", "rock mass"
        ops.build()
        path = self.folder / "p.toml"
        ops.save_project(filepath=str(path))
        project, volumes = load_project(path), self.volumes()
        again = {fault.name: fault for fault in project.faults}
        self.assertEqual((again["F2"].youngest, tuple(again["F1"].rocks)), ("S0", ("rock mass",)))
        self.assertEqual((project.bodies[0].after, project.bodies[0].rock), ("S1", "rock mass"))
        ops.open_project(filepath=str(path))
        self.assertEqual(self.model.faults[0].source, "MESH_FILE")
        ops.build()
        for name, volume in self.volumes().items():
            self.assertAlmostEqual(volume, volumes[name], delta=1e-9 * max(volume, 1.0))
        made = self.model.faults[0].interface
        self.assertEqual(made["realmodel"], "fault")
        name, self.model.structure_kind, self.model.active_fault = made.name, "FAULT", 0
        ops.fault_body_remove()
        self.assertNotIn(name, bpy.data.objects)  # which was made for it

    def test_interfaces_of_files_count_when_edited(self):
        self.faulted(build=True)
        path = self.folder / "p.toml"
        ops.save_project(filepath=str(path))
        ops.open_project(filepath=str(path))
        ops.build()
        fault = self.model.faults[0].interface
        self.assertEqual((fault["realmodel"], self.model.faults[0].source), ("fault", "MESH_FILE"))
        for vertex in fault.data.vertices:
            vertex.co.x += 10.0
        fault.data.update()
        ops.build()
        self.assertEqual(self.model.faults[0].source, "MESH_OBJECT")
        found = compartments.read(self.scene)["volumes"]["S2 block"]
        self.assertNotAlmostEqual(found[0], found[1], places=3)


class Live(StructureCase):
    def test_a_moved_fault_and_body(self):
        self.faulted(box("ore", (60, 20, -2), (70, 30, 2)))
        ore, fault = (bpy.data.objects[name] for name in ("ore", "F1"))
        ore = next(item for item in self.objects("body"))
        self.model.live = True
        self.live_is_done()
        before = self.volumes()
        ore.location.z += 1.0  # 3 of 4 of its height come to lie above S0 (-4)
        bpy.context.view_layer.update()
        self.live_is_done()
        self.assertEqual(bpy.context.window_manager.realmodel.problem, "")
        self.assertAlmostEqual(self.volumes()["ore"], before["ore"], places=6)
        ore.scale = (1.0, 1.0, 0.5)
        bpy.context.view_layer.update()
        self.live_is_done()
        self.assertNotAlmostEqual(self.volumes()["ore"], before["ore"], places=3)
        raise_by(fault, -65.0)  # it ends within the rock, farther from its top than a quarter of an edge
        self.live_is_done()
        self.assertIn("F1", bpy.context.window_manager.realmodel.problem)
        raise_by(fault, 65.0)
        self.live_is_done()
        self.assertEqual(bpy.context.window_manager.realmodel.problem, "")
        self.model.bodies[0].void = True
        self.live_is_done()
        self.assertNotIn("ore", self.volumes())

    def test_stages(self):
        self.faulted(box("ore", (60, 20, -2), (70, 30, 2)))
        self.model.bodies[0].after = "S1"
        ops.build()
        ore = next(row.object for row in self.model.results if row.name == "ore")
        whole = len(ore.data.polygons)
        self.model.stage = 0
        self.assertEqual(len(ore.data.polygons), 0)
        self.model.stage = 1
        self.assertGreater(len(ore.data.polygons), 0)
        base = next(row.object for row in self.model.results if row.name == "base block")
        self.assertIn("realmodel_compartment", base.data.attributes)
        self.model.stage = 2
        self.assertEqual(len(ore.data.polygons), whole)
