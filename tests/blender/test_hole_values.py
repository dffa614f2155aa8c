# SPDX-License-Identifier: GPL-3.0-or-later
"""Boreholes before a build: by columns of their tables, to their ends, with names, and on the cut."""

import bpy
import numpy as np
from blender_state import coordinates
from panel_case import PanelCase, ops, outline
from realmodel.bl.field import boreholes
from realmodel.bl.project import borehole_picks, interval_values, project_settings

COLLARS = "hole,x,y,z,eoh\n" + "".join(f"B{n},{20 + 30 * n},{50 + n},60,40\n" for n in range(3))
LOGS = "hole,from,to,lith,note\n" + "".join(f"B{n},0,10,Sand,wet\nB{n},10,30,Clay,\n" for n in range(3))
ASSAYS = "hole,from,to,Au ppm\n" + "".join(f"B{n},0,5,{n}.5\nB{n},5,20,\n" for n in range(3))
PICKS = "hole,surface,depth\n" + "".join(f"B{n},top,5\nB{n},low,20\n" for n in range(3))


class HoleValues(PanelCase):
    def read(self, **tables):
        for name, text in tables.items():
            (self.folder / f"{name}.csv").write_text(text)
        files = [{"name": f"{name}.csv"} for name in tables]
        ops.boreholes_read(
            filepath=str(self.folder / files[0]["name"]), directory=str(self.folder), files=files
        )

    @property
    def rock(self):
        return self.model.rocks[0]

    def tubes(self):
        """The object, the heights of its tubes' middles and the names of their materials."""
        (item,) = [item for item in self.scene.objects if item.get("realmodel_view") == "boreholes"]
        places = coordinates(item.data).astype(float).reshape(-1, 16, 3)
        used = [item.data.materials[p.material_index].name for p in item.data.polygons][::8]
        return item, places.mean(axis=1) + project_settings.model_origin(self.scene), used

    def test_grades_have_colors_and_a_color_bar(self):
        self.read(collars=COLLARS, logs=LOGS, assays=ASSAYS)
        self.assertEqual(boreholes.columns(self.scene), ["Au ppm", "lith", "note"])
        view = self.model.view
        view.show_boreholes, view.boreholes_by = True, "Au ppm"
        _, middles, used = self.tubes()
        self.assertEqual(len(middles), 3, "those that have a value")
        self.assertEqual(len(set(used)), 3)
        self.assertTrue(np.allclose(middles[:, 2], 57.5, atol=1e-4))
        key = boreholes.key(self.scene)
        self.assertEqual((key.title, key.limits), ("Au ppm", (0.5, 2.5)))
        view.boreholes_by = "lith"
        self.assertEqual([name for name, _ in boreholes.key(self.scene).entries], ["Clay", "Sand"])
        self.assertEqual(len(self.tubes()[2]), 6)
        view.boreholes_by = ""
        self.assertIsNone(boreholes.key(self.scene))
        self.save_and_open()
        values = interval_values.of_rock(self.rock)
        self.assertEqual(values.columns["Au ppm"][:1].tolist(), [0.5])
        self.assertEqual(values.depths[0].tolist(), [0.0, 5.0])

    def test_tables_that_are_read_again_take_the_place(self):
        self.read(collars=COLLARS, logs=LOGS, assays=ASSAYS)
        for _ in range(2):
            values = interval_values.of_rock(self.rock)
            self.assertEqual([int(values.has(name).sum()) for name in ("Au ppm", "lith")], [3, 6])
            self.read(collars=COLLARS, logs=LOGS, assays=ASSAYS)
        self.read(collars=COLLARS, assays=ASSAYS.replace("0.5", "7"))
        values = interval_values.of_rock(self.rock)
        self.assertEqual([int(values.has(name).sum()) for name in ("Au ppm", "lith")], [3, 6])
        self.assertEqual(np.nanmax(values.columns["Au ppm"]), 7.0)

    def test_holes_with_picks_go_to_their_ends(self):
        self.read(collars=COLLARS, picks=PICKS)
        self.assertEqual(borehole_picks.ends_of(self.rock)["B0"], [20.0, 50.0, 20.0])
        self.model.view.show_boreholes = True
        _, middles, _ = self.tubes()
        self.assertEqual(len(middles), 9, "above the top, between, and to the end")
        self.assertAlmostEqual(middles[:, 2].min(), 30.0, places=4)

    def test_names_stand_at_the_collars(self):
        self.read(collars=COLLARS, logs=LOGS)
        self.assertEqual(boreholes.labels(self.scene), [])
        self.model.view.show_hole_names = True
        self.assertEqual(boreholes.labels(self.scene)[1], ("B1", (50.0, 51.0, 60.0)))

    def test_on_the_cut_are_the_holes_near_it(self):
        self.read(collars=COLLARS, logs=LOGS)
        self.rock.region = outline("r", [(0, 0), (100, 0), (100, 100), (0, 100)])
        self.rock.base_elevation, self.rock.edge_length = 0.0, 20.0
        for row in self.rock.surfaces:
            row.method = "plane"
        view = self.model.view
        view.show_boreholes = view.show_hole_names = True
        ops.build()
        self.assertEqual(len(self.tubes()[1]), 6)
        ops.section_plane(axis="Y")
        view.plane.location.y = 50.5 - project_settings.model_origin(self.scene)[1]
        bpy.context.view_layer.update()
        ops.section_update()
        self.assertEqual(len(self.tubes()[1]), 6, "with no width all are shown")
        view.hole_width = 0.75
        _, middles, _ = self.tubes()
        self.assertEqual(len(middles), 4)
        self.assertTrue(np.allclose(middles[:, 1], 50.5, atol=1e-4), "on the plane")
        self.assertEqual([name for name, _ in boreholes.labels(self.scene)], ["B0", "B1"])
        view.show_contacts = True
        (contacts,) = [o for o in self.scene.objects if o.get("realmodel_view") == "contacts"]
        plan = coordinates(contacts.data).astype(float) + project_settings.model_origin(self.scene)
        self.assertTrue((np.abs(plan[:, 1] - 50.5) < 0.5 * np.ptp(plan[:, 1]) + 1e-3).all(), "on it, too")
        view.plane.location.y += 30.0
        bpy.context.view_layer.update()
        ops.section_update()
        gone = ("boreholes", "contacts")
        self.assertFalse([o for o in self.scene.objects if o.get("realmodel_view") in gone])
        view.plane.location.y -= 28.5
        bpy.context.view_layer.update()
        ops.section_update()
        _, middles, _ = self.tubes()
        self.assertEqual({round(float(x)) for x in middles[:, 0]}, {80})
        path = self.folder / "s.svg"
        ops.save_section(filepath=str(path), hole_width=0.75)
        self.assertIn("B2", path.read_text())
        ops.save_section(filepath=str(path), hole_width=0.0)
        self.assertNotIn("B2", path.read_text())
