# SPDX-License-Identifier: GPL-3.0-or-later
"""Field data shown, picked, moved and switched off, and the list of those that do not fit."""

import bpy
import numpy as np
from blender_state import coordinates
from panel_case import PanelCase, ops, outline
from realmodel.bl.field import data, edits, handle
from realmodel.bl.objects import exaggeration
from realmodel.bl.project import observed_blocks, project_settings, surface_dips
from realmodel.bl.scene import borehole_points

POINTS = [(10, 10, 20), (90, 10, 20), (90, 90, 20), (10, 90, 20), (50, 50, 40)]
LOGS = "hole,x,y,z,from,to,block\n" + "".join(
    f"B{n},{x},{y},60,0,{10 + n},Gravel\nB{n},{x},{y},60,{10 + n},30,Clay\n"
    for n, (x, y) in enumerate([(20, 20), (80, 20), (50, 80)])
)
OUTCROPS = "x,y,z,unit\n20,30,55,Gravel\n60,60,25,Clay\n"
DIPS = "x,y,z,dip,dip_direction\n30,30,22,20,90\n70,30,22,0,0\n"


class FieldData(PanelCase):
    def given(self, **tables):
        """A model of one rock mass with these tables read, and a region."""
        for name, text in tables.items():
            (self.folder / f"{name}.csv").write_text(text)
            ops.boreholes_read(filepath=str(self.folder / f"{name}.csv"))

    def surface(self):
        """A surface from five points in a file, one above all others, below a level top; built."""
        (self.folder / "tops.csv").write_text("x,y,z\n" + "".join(f"{x},{y},{z}\n" for x, y, z in POINTS))
        ops.surface_add(filepath=str(self.folder / "tops.csv"))
        ops.surface_add(empty=True, name="top")
        low, top = self.model.rocks[0].surfaces
        low.method, top.source, top.method, top.value = "dsi", "NONE", "constant", 80.0
        self.region()
        return low

    def region(self):
        rock = self.model.rocks[0]
        rock.region = outline("r", [(0, 0), (100, 0), (100, 100), (0, 100)])
        rock.base_elevation, rock.edge_length = 0.0, 20.0

    def group(self, kind):
        return next(group for group in data.groups(self.scene) if group.kind == kind)

    def moved_to(self, place):
        """The object of the active datum is put elsewhere, as G does."""
        item = handle.item_of(self.scene)
        item.location = np.array(place) - project_settings.model_origin(self.scene)
        bpy.context.view_layer.update()
        while handle._work.look() is not None:
            pass

    def body(self, kind):
        return [item for item in self.scene.objects if item.get("realmodel_view") == kind]

    def test_a_point_of_a_file_is_switched_off_and_on(self):
        row = self.surface()
        ops.build()
        self.assertGreater(np.array(row.interface.bound_box)[:, 2].max(), 35)
        ops.datum_pick(location=(50, 50, 41))
        self.assertEqual(handle.active(self.scene).place, (50.0, 50.0, 40.0))
        self.assertEqual(bpy.context.view_layer.objects.active, handle.item_of(self.scene))
        ops.datum_switch()
        self.assertFalse(handle.active(self.scene).used)
        self.assertIn("tops.csv", row.filepath, "the file stays")
        self.assertTrue(self.model.is_outdated)
        ops.build()
        self.assertLess(np.array(row.interface.bound_box)[:, 2].max(), 21)
        self.save_and_open()
        row = self.model.rocks[0].surfaces[0]
        self.assertEqual(borehole_points.left_out(row).tolist(), [[50, 50, 40]])
        ops.data_switch_on()
        ops.build()
        self.assertGreater(np.array(row.interface.bound_box)[:, 2].max(), 35)
        self.refused(ops.data_switch_on, "no datum is switched off")

    def test_what_is_switched_off_goes_with_the_project(self):
        self.surface()
        self.given(outcrops=OUTCROPS.replace("Gravel", "top").replace("Clay", "tops"))
        self.model.rocks[0].active_surface = 0
        self.given(dips=DIPS)
        for kind in (data.POINT, data.PLACE, data.DIP):
            edits.switch(self.scene, self.group(kind).datum(1), False)
        ops.build()
        before = [(g.kind, g.places.tolist(), g.used.tolist()) for g in data.groups(self.scene)]
        ops.save_project(filepath=str(self.folder / "p.toml"))
        ops.open_project(filepath=str(self.folder / "p.toml"))
        after = [(g.kind, g.places.tolist(), g.used.tolist()) for g in data.groups(self.scene)]
        self.assertEqual(after, before)
        self.assertEqual(sum(not used for _, _, all_used in after for used in all_used), 3)

    def test_a_moved_point_moves_the_live_model(self):
        row = self.surface()
        ops.build()
        self.model.live = True
        ops.datum_pick(location=(50, 50, 40))
        self.moved_to((55, 45, 50))
        self.live_is_done()
        self.assertEqual(handle.active(self.scene).place, (55.0, 45.0, 50.0))
        self.assertEqual((row.filepath, row.source), ("", "POINTS_FILE"), "they are not those of the file")
        self.assertIn([55, 45, 50], data.own_points(self.scene, row).tolist())
        self.assertEqual(len(data.own_points(self.scene, row)), 5)
        self.assertGreater(np.array(row.interface.bound_box)[:, 2].max(), 43)

    def test_an_interval_keeps_to_its_hole(self):
        self.given(logs=LOGS)
        self.region()
        group = self.group(data.INTERVAL)
        clay = next(
            n for n in range(len(group.places)) if group.names[n] == "Clay" and group.holes[n] == "B1"
        )
        handle.activate(bpy.context, group.datum(clay))
        self.moved_to((0, 0, 45))
        self.assertEqual(handle.active(self.scene).place, (80.0, 20.0, 45.0))
        self.assertEqual(handle.item_of(self.scene).location.x, 0.0, "it is dragged on")
        seen = observed_blocks.of_rock(self.model.rocks[0])
        own = seen.holes == "B1"
        self.assertEqual(seen.depths[own].tolist(), [0, 15, 15, 30])
        self.assertEqual(seen.places[own, 2].tolist(), [60, 45, 45, 30])
        self.moved_to((80, 20, 500))
        top = observed_blocks.of_rock(self.model.rocks[0]).places[own, 2]
        self.assertTrue(59 < top[1] < 60, "not above the interval over it")
        ops.datum_switch()
        used = observed_blocks.of_rock(self.model.rocks[0]).in_use
        self.assertEqual(used[own].tolist(), [True, True, False, False])
        self.assertTrue(used[~own].all())

    def test_an_outcrop_and_a_dip_are_moved(self):
        self.surface()
        self.given(outcrops=OUTCROPS.replace("Gravel", "top").replace("Clay", "tops"))
        self.model.rocks[0].active_surface = 0
        self.given(dips=DIPS)
        for kind, to in ((data.PLACE, (21, 31, 56)), (data.DIP, (33, 34, 25))):
            handle.activate(bpy.context, self.group(kind).datum(0))
            self.moved_to(to)
            self.assertEqual(self.group(kind).places[0].tolist(), list(to))
        dips = surface_dips.of_row(self.model.rocks[0].surfaces[0])
        self.assertAlmostEqual(dips.gradients[0, 0], -np.tan(np.radians(20)), places=12)

    def test_moves_can_be_undone(self):
        row = self.surface()
        if not bpy.ops.ed.undo_push.poll():
            self.skipTest("no undo in this Blender")
        ops.datum_pick(location=(50, 50, 40))
        bpy.ops.ed.undo_push(message="picked")
        before = row.filepath
        self.moved_to((55, 45, 50))
        bpy.ops.ed.undo_push(message="moved")
        ops.datum_switch()
        bpy.ops.ed.undo_push(message="off")
        bpy.ops.ed.undo()
        self.assertEqual(handle.active(self.scene).place, (55.0, 45.0, 50.0))
        self.assertTrue(handle.active(self.scene).used)
        bpy.ops.ed.undo()
        self.assertEqual(self.model.rocks[0].surfaces[0].filepath, before)
        self.assertEqual(handle.active(self.scene).place, (50.0, 50.0, 40.0))
        self.assertEqual(tuple(handle.item_of(self.scene).location), (50.0, 50.0, 40.0))
        bpy.context.view_layer.update()
        self.assertEqual(len(data.own_points(self.scene, self.model.rocks[0].surfaces[0])), 5)

    def test_marks_have_the_colors_of_the_surfaces(self):
        self.surface()
        self.model.rocks[0].active_surface = 0
        self.given(dips=DIPS)
        view = self.model.view
        view.show_contacts = view.show_dips = True
        (points,), (discs,) = self.body("contacts"), self.body("dips")
        self.assertEqual(len(points.data.vertices), 6 * len(POINTS))
        edits.switch(self.scene, self.group(data.POINT).datum(4), False)
        edits.switch(self.scene, self.group(data.DIP).datum(1), False)
        ops.build()
        color = self.model.rocks[0].surfaces[0].interface.material_slots[0].material
        (points,), (discs,) = self.body("contacts"), self.body("dips")
        used = [points.data.materials[p.material_index].name for p in points.data.polygons]
        self.assertEqual(set(used[:32]), {color.name})
        self.assertEqual(set(used[32:]), {"Switched Off"})
        upper, lower = discs.data.polygons[:2]
        self.assertEqual(discs.data.materials[upper.material_index].name, color.name)
        self.assertEqual(discs.data.materials[lower.material_index].name, "Edges")
        normal = np.array([np.sin(np.radians(20)), 0, np.cos(np.radians(20))])
        self.assertTrue(np.allclose(upper.normal, normal, atol=1e-5), "it falls to the east")
        self.assertTrue(np.allclose(lower.normal, -normal, atol=1e-5))
        self.assertEqual(discs.data.materials[discs.data.polygons[5].material_index].name, "Switched Off")
        view.exaggeration = 4.0
        bpy.context.view_layer.update()
        (discs,) = self.body("dips")
        shown = np.array(discs.matrix_world.to_3x3()) @ coordinates(discs.data)[:16].T
        size = np.linalg.norm(shown - shown.mean(axis=1, keepdims=True), axis=0)
        self.assertLess(np.ptp(size), 1e-3 * size.mean(), "it is round where it is exaggerated")
        view.show_contacts = view.show_dips = False
        self.assertEqual([*self.body("contacts"), *self.body("dips")], [])

    def test_misfits_are_listed_and_red_and_each_leads_to_its_datum(self):
        self.given(logs=LOGS)
        self.region()
        clay, gravel = self.model.rocks[0].surfaces
        clay.method, clay.source, clay.value = "constant", "NONE", 40.0
        gravel.method, gravel.source, gravel.value = "constant", "NONE", 60.0
        clay.tie = gravel.tie = False
        self.model.view.show_misfits = True
        ops.build()
        rows = list(self.model.misfits)
        self.assertGreater(len(rows), 3)
        found = {(row.kind, row.source, row.depth, row.by) for row in rows}
        self.assertIn(("point", "B0", "10", "10"), found)
        self.assertIn(("point", "B2", "12", "8"), found)
        self.assertTrue(self.body("misfits"))
        self.assertEqual(self.body("misfits")[0].data.materials[0].name, "Misfit")
        self.assertTrue(self.body("misfits")[0].show_in_front, "seen within the blocks")
        number = next(n for n, row in enumerate(rows) if (row.kind, row.source) == ("point", "B2"))
        self.model.active_misfit = number
        datum = handle.active(self.scene)
        self.assertEqual((datum.kind, datum.hole, datum.place), ("interval", "B2", (50.0, 80.0, 48.0)))
        self.assertEqual(bpy.context.view_layer.objects.active, handle.item_of(self.scene))
        count = self.model.view.misfit_count
        self.model.view.misfit_tolerance = 9.5
        self.assertLess(self.model.view.misfit_count, count)
        self.model.view.show_misfits = False
        self.assertEqual((len(self.model.misfits), self.body("misfits")), (0, []))

    def test_a_datum_is_shown_where_heights_are_stretched(self):
        self.given(logs=LOGS)
        self.region()
        ops.build()
        self.model.view.exaggeration = 5.0
        kept = self.group(data.INTERVAL).datum(1)
        handle.activate(bpy.context, kept)
        bpy.context.view_layer.update()
        item, top = handle.item_of(self.scene), np.array(exaggeration.matrix(self.scene))
        shown = top @ (*(np.array(kept.place) - project_settings.model_origin(self.scene)), 1.0)
        np.testing.assert_allclose(np.array(item.matrix_world)[:3, 3], shown[:3], rtol=1e-6)
        self.assertEqual(top[2, 2], 5.0)
        handle.take_place(self.scene)
        self.assertEqual(handle.active(self.scene).place, kept.place, "it was not moved")

    def test_a_datum_that_is_gone_is_said(self):
        self.surface()
        ops.datum_pick(location=(50, 50, 40))
        self.model.rocks[0].surfaces[0].name = "other"
        self.refused(ops.datum_switch, "is not there any more")
        self.refused(ops.datum_show, "is not there any more")
        ops.datum_leave()
        self.assertIsNone(handle.item_of(self.scene))
        self.refused(ops.datum_leave, "no datum is active")

    def test_without_data_there_is_nothing_to_pick(self):
        self.refused(ops.datum_pick, "no field data")
