# SPDX-License-Identifier: GPL-3.0-or-later
"""From files as people have them to colored blocks: several at once, columns of horizons, origin, data in the
viewport, a region around them."""

import bpy
import numpy as np
from panel_case import PanelCase, ops, outline, select, sheet, stack
from realmodel.bl.display import shown_models
from realmodel.bl.host import notices
from realmodel.bl.objects import origin
from realmodel.bl.project import library_rows, project_settings
from realmodel.bl.scene import data_objects
from realmodel.core.base.errors import BuildWarning
from realmodel.core.project.looks import hex_color
from realmodel.core.results.automatic_library import PALETTE, palette
from realmodel.core.settings.series_kinds import THICKNESSES
from realmodel.core.settings.variogram import RANGE_BEYOND

EAST, NORTH = 3_430_000.0, 5_390_000.0


def grid(height, n=12, step=50.0):
    x, y = (a.ravel() * step for a in np.meshgrid(np.arange(n), np.arange(n)))
    return np.column_stack([EAST + x, NORTH + y, height + 0.01 * x])


class Imported(PanelCase):
    def table(self, name, points, header="x,y,z"):
        path = self.folder / name
        rows = "\n".join(",".join(f"{value:.3f}" for value in row) for row in points)
        path.write_text(f"{header}\n{rows}\n")
        return path

    def horizons(self):
        path = self.folder / "horizons.txt"
        lines = ["Horizon;Easting;Northing;Elevation"]
        for name, height in (("Top sand", 220.0), ("Clay", 200.0), ("Base", 150.0)):
            lines += [f"{name};{x:.2f};{y:.2f};{z:.2f}".replace(".", ",") for x, y, z in grid(height)]
        path.write_text("\n".join(lines) + "\n", encoding="latin-1")
        return path

    def clouds(self):
        return {item.name: item for item in data_objects.objects(self.scene)}

    def place(self, item):
        """Model coordinates of an object's vertices."""
        bpy.context.view_layer.update()
        local = np.array([item.matrix_world @ v.co for v in item.data.vertices])
        return local + project_settings.model_origin(self.scene)


class Files(Imported):
    def test_several_files_the_lowest_first(self):
        for name, height in (("high", 30.0), ("low", 10.0), ("middle", 20.0)):
            self.table(f"{name}.csv", grid(height))
        ops.surface_add(
            directory=str(self.folder), files=[{"name": f"{n}.csv"} for n in ("high", "low", "middle")]
        )
        rock = self.model.rocks[0]
        self.assertEqual([s.name for s in rock.surfaces], ["low", "middle", "high"])
        self.assertEqual([e.name for e in self.model.library], ["low", "middle", "high"])
        self.assertEqual([s.property_id for s in rock.surfaces], [1, 2, 3])
        self.assertEqual([hex_color(e.color) for e in self.model.library], list(PALETTE[:3]))
        self.assertEqual(set(self.clouds()), {"low points", "middle points", "high points"})

    def wells(self):
        """Files of tops in wells, s0 the youngest. They dip, and the older one is, the farther up dip it is
        known: the mean heights are in the other order than the tops."""
        x, y = np.random.default_rng(3).random((2, 40)).round(4) * 1000.0
        for number in range(12):
            met = x > 60.0 * number
            z = 0.3 * x - 4.0 * number
            self.table(f"s{number}.csv", np.column_stack([EAST + x, NORTH + y, z])[met])
        return [f"s{number}" for number in range(12)]

    def add(self, names):
        ops.surface_add(directory=str(self.folder), files=[{"name": f"{name}.csv"} for name in names])
        return self.order()

    def order(self):
        return [surface.name for surface in self.model.rocks[0].surfaces]

    def test_shared_wells_decide_which_is_older(self):
        names = self.wells()
        self.assertEqual(self.add(names), names[::-1])

    def test_surfaces_are_sorted(self):
        self.wells()
        ops.rock_add()
        rock = self.model.rocks[0]
        for name in ("s3", "s11", "s0", "s7"):
            self.add([name])
        flat = rock.surfaces.add()
        flat.name, flat.source = "flat", "NONE"
        rock.surfaces.move(4, 1)
        rock.active_surface = 3  # s0
        ops.surface_sort()
        self.assertEqual(self.order(), ["s11", "flat", "s7", "s3", "s0"])
        self.assertEqual(rock.surfaces[rock.active_surface].name, "s0")
        ops.surface_sort()
        self.assertEqual(self.order(), ["s11", "flat", "s7", "s3", "s0"])
        ops.surface_remove()
        ops.surface_move(direction="DOWN")
        self.assertEqual(self.order(), ["s11", "flat", "s3", "s7"])
        ops.region_around()
        for row in rock.surfaces:
            row.method = "tin"
        flat = rock.surfaces["flat"]
        flat.method, flat.value = "constant", -200.0
        ops.build()
        (text,) = [t for t in notices.read(self.model.warnings) if "at the same place" in t]
        self.assertTrue(text.startswith("s3: "), text)
        self.assertIn("points lie above those of 's7'", text)
        ops.surface_sort()
        ops.build()
        self.assertNotIn("at the same place", self.model.warnings)

    def test_one_of_several_is_bad_and_nothing_is_added(self):
        self.table("good.csv", grid(1.0))
        (self.folder / "bad.csv").write_text("x,y,z\n1,2,three\n")
        files = [{"name": "good.csv"}, {"name": "bad.csv"}]
        self.refused(ops.surface_add, r"bad\.csv:2", directory=str(self.folder), files=files)
        self.assertEqual((len(self.model.rocks), len(self.model.library)), (0, 0))
        self.assertEqual(self.clouds(), {})

    def test_a_mesh_is_one_whatever_its_name(self):
        head = "GOCAD TSurf 1\nHEADER {\nname:a\n}\nTFACE\n"
        for name, height in (("low.txt", 0), ("high.dat", 5)):
            corners = enumerate([(0, 0), (9, 0), (9, 9), (0, 9)], 1)
            rows = "".join(f"VRTX {k} {x} {y} {height}\n" for k, (x, y) in corners)
            (self.folder / name).write_text(f"{head}{rows}TRGL 1 2 3\nTRGL 1 3 4\nEND\n")
        files = [{"name": "low.txt"}, {"name": "high.dat"}]
        ops.surface_add(directory=str(self.folder), files=files)
        self.assertEqual([s.source for s in self.model.rocks[0].surfaces], ["MESH_FILE", "MESH_FILE"])
        ops.build()
        self.assertAlmostEqual(shown_models.whole(self.scene).blocks[0].volume, 9 * 9 * 5)

    def test_one_surface_for_each_horizon(self):
        path = self.horizons()
        ops.surface_add(filepath=str(path))
        self.assertEqual([s.name for s in self.model.rocks[0].surfaces], ["horizons"], "scripts ask for it")
        ops.surface_remove()
        ops.surface_add(filepath=str(path), split=True)
        rock = self.model.rocks[0]
        self.assertEqual([s.name for s in rock.surfaces], ["Base", "Clay", "Top sand"])
        self.assertEqual([(f.column, f.value) for f in rock.surfaces[1].filters], [("Horizon", "Clay")])
        ops.region_around()
        for surface in rock.surfaces:
            surface.method = "plane"
        ops.build()
        volumes = self.volumes()
        self.assertAlmostEqual(volumes["Clay block"] / volumes["Top sand block"], 2.5, places=4)
        colors = {
            item.data.materials[0].name for item in bpy.data.objects if item.get("realmodel") == "block"
        }
        self.assertEqual(colors, {"Clay", "Top sand"})

    def test_columns_and_numbers_as_names(self):
        path = self.folder / "v.csv"
        rows = [f"{n},{n % 7},{n % 3},{60 * (n % 2)},{n}" for n in range(40)]
        path.write_text("\n".join(["no,up,north,val,east", *rows]) + "\n")
        ops.surface_add(filepath=str(path), split_column="val", columns="east, north, up")
        surfaces = self.model.rocks[0].surfaces
        self.assertEqual(sorted(s.name for s in surfaces), ["v 0", "v 60"])
        self.assertEqual({(s.column_x, s.column_y, s.column_z) for s in surfaces}, {("east", "north", "up")})
        self.assertEqual(len(self.clouds()["v 60 points"].data.vertices), 20)

    def test_columns_that_are_not_three(self):
        path = self.table("a.csv", grid(1.0))
        self.refused(ops.surface_add, "three columns", filepath=str(path), columns="x, y")
        ops.surface_add(filepath=str(path))
        self.model.rocks[0].surfaces[0].column_x = "x"  # two are to follow
        self.assertEqual(self.clouds(), {})

    def test_what_is_imported_goes_with_its_surface(self):
        ops.surface_add(filepath=str(self.table("a.csv", grid(1.0))))
        ops.surface_add(filepath=str(self.table("b.csv", grid(2.0))))
        self.model.library[0].rock = "limestone"
        self.model.rocks[0].active_surface = 1
        ops.surface_remove()
        self.assertEqual(set(self.clouds()), {"a points"})
        self.assertEqual([e.name for e in self.model.library], ["a"])
        ops.surface_remove()
        self.assertEqual([e.name for e in self.model.library], ["a"], "somebody wrote in it")
        self.assertFalse([c for c in bpy.data.collections if "Data" in c.name])

    def test_an_entry_of_the_name_is_taken(self):
        ops.library_add(name="Clay")
        ops.surface_add(name="clay", filepath=str(self.table("a.csv", grid(1.0))))
        self.assertEqual((self.model.rocks[0].surfaces[0].property_id, len(self.model.library)), (1, 1))

    def test_many_points(self):
        rng = np.random.default_rng(2)
        points = np.round(rng.random((100_000, 3)) * (1000, 1000, 10), 2)
        path = self.folder / "many.xyz"
        np.savetxt(path, points, fmt="%.2f")
        ops.surface_add(filepath=str(path))
        self.assertEqual(len(self.clouds()["many points"].data.vertices), 100_000)


class Data(Imported):
    def test_points_stand_where_they_are_and_are_no_input(self):
        points = grid(200.0)
        ops.surface_add(filepath=str(self.table("a.csv", points)))
        item = self.clouds()["a points"]
        self.assertLess(np.abs(self.place(item) - points).max(), 1e-3)
        self.assertTrue(item.hide_select and item.hide_render)
        self.assertEqual(item.users_collection[0].name, "Model Data")
        select(item)
        self.refused(ops.from_selected, "no mesh object is selected")
        self.model.rocks[0].surfaces[0].source = "MESH_OBJECT"
        self.assertFalse(self.model.rocks[0].surfaces[0].object)
        self.assertEqual(self.clouds(), {}, "it is another surface now")

    def test_switched_off_and_on(self):
        path = self.folder / "region.geojson"
        path.write_text('{"type": "Polygon", "coordinates": [[[0, 0], [9, 0], [9, 9], [0, 9], [0, 0]]]}')
        ops.rock_add()
        self.model.show_data = True
        self.model.rocks[0].region_file = str(path)
        self.assertEqual([len(i.data.edges) for i in self.clouds().values()], [4])
        self.model.show_data = False
        self.assertEqual(self.clouds(), {})
        self.model.show_data = True
        self.assertEqual(len(self.clouds()), 1)

    def test_built_saved_and_opened_they_are_the_same(self):
        ops.surface_add(filepath=str(self.table("a.csv", grid(20.0))))
        ops.surface_add(filepath=str(self.table("b.csv", grid(30.0))))
        ops.region_around()
        ops.build()
        before = {name: item.data.name for name, item in self.clouds().items()}
        self.assertEqual(len(before), 2)
        self.save_and_open()
        data_objects.update(self.scene)
        self.assertEqual({name: item.data.name for name, item in self.clouds().items()}, before)
        self.assertEqual(
            len([o for o in self.scene.objects if o.get("realmodel")]), 3, "two interfaces and a block"
        )

    def test_boreholes(self):
        (self.folder / "picks.csv").write_text(
            "hole,x,y,z,surface,depth\n"
            + "".join(
                f"B{n},{EAST + 90 * n},{NORTH + 50 * (n % 3)},200,{name},{depth + n}\n"
                for n in range(5)
                for name, depth in (("sand", 5), ("clay", 20))
            )
        )
        ops.boreholes_read(filepath=str(self.folder / "picks.csv"))
        rock = self.model.rocks[0]
        self.assertEqual([s.name for s in rock.surfaces], ["clay", "sand"])
        self.assertEqual([e.name for e in self.model.library], ["clay", "sand"])
        self.assertEqual(set(self.clouds()), {"clay points", "rock mass boreholes", "sand points"})
        paths = self.clouds()["rock mass boreholes"]
        places = self.place(paths).reshape(5, 3, 3)  # collar and two picks of each hole
        expected = [
            [(EAST + 90 * n, NORTH + 50 * (n % 3), 200 - d) for d in (0, 5 + n, 20 + n)] for n in range(5)
        ]
        self.assertLess(np.abs(places - np.array(expected)).max(), 1e-3)
        edges = {tuple(edge.vertices) for edge in paths.data.edges}
        self.assertEqual(edges, {(3 * n + k, 3 * n + k + 1) for n in range(5) for k in range(2)})
        self.assertTrue(all(edge.is_loose for edge in paths.data.edges), "others are not drawn")
        self.assertGreater(rock.edge_length, 0.0)
        self.assertGreater(self.model.origin[0], 3e6)

    def test_picks_that_contradict_the_order_are_said_by_hole(self):
        """The clay is met in the holes up dip alone, so that its mean height is the larger one."""
        rows = [(f"B{n}", "sand", 200.0 + 30.0 * n) for n in range(6)]
        rows += [(f"B{n}", "clay", 190.0 + 30.0 * n) for n in range(3, 6)]
        (self.folder / "picks.csv").write_text(
            "hole,x,y,surface,elevation\n"
            + "".join(
                f"{h},{EAST + 90 * int(h[1])},{NORTH + 50 * (int(h[1]) % 3)},{s},{z}\n" for h, s, z in rows
            )
        )
        ops.boreholes_read(filepath=str(self.folder / "picks.csv"))
        rock = self.model.rocks[0]
        self.assertEqual([s.name for s in rock.surfaces], ["clay", "sand"])
        ops.surface_move(direction="DOWN")
        ops.region_around()
        for row in rock.surfaces:
            row.method = "plane"
        for name in ("clay", "marl"):
            rock.surfaces[1].name = name
            ops.build()
            (text,) = [t for t in notices.read(self.model.warnings) if "at the same place" in t]
            self.assertIn(f"sand: 3 of its 6 points lie above those of '{name}'", text)
            self.assertIn("; holes B3, B4 and B5;", text)


class Origin(Imported):
    def built_far_away(self):
        """Points of UTM whose scene has its origin at zero, as one that was built of other data."""
        ops.surface_add(filepath=str(self.table("a.csv", grid(20.0))))
        self.model.origin = (0.0, 0.0, 0.0)
        path = self.folder / "region.geojson"
        ring = [[EAST, NORTH], [EAST + 500, NORTH], [EAST + 500, NORTH + 500], [EAST, NORTH + 500]]
        path.write_text(f'{{"type": "Polygon", "coordinates": [{[*ring, ring[0]]}]}}')
        rock = self.model.rocks[0]
        rock.region_file, rock.base_elevation = str(path), 0.0
        rock.surfaces[0].method = "plane"
        ops.build()

    def test_it_is_chosen_from_the_first_data(self):
        ops.surface_add(filepath=str(self.table("a.csv", grid(20.0))))
        self.assertEqual(tuple(self.scene["realmodel_origin"]), (EAST + 300, NORTH + 300, 0.0))
        self.assertEqual(tuple(self.model.origin), (EAST + 300, NORTH + 300, 0.0))
        self.assertEqual(self.model.rocks[0].edge_length, 10.0)

    def test_objects_of_the_user_stand_in_the_scene(self):
        stack(0.0, 10.0)
        ops.surface_add(filepath=str(self.table("a.csv", grid(20.0) - (EAST, NORTH, 0))))
        self.assertEqual(tuple(self.model.origin), (0.0, 0.0, 0.0))

    def test_typed_before_a_build_the_data_go_there(self):
        points = grid(20.0)
        ops.surface_add(filepath=str(self.table("a.csv", points)))
        self.model.origin = (EAST, NORTH, 10.0)
        item = self.clouds()["a points"]
        self.assertLess(np.abs(self.place(item) - points).max(), 1e-3)
        self.assertAlmostEqual(item.location.x, 300.0)

    def test_a_model_far_from_it_gets_another(self):
        self.built_far_away()
        self.assertEqual(tuple(self.scene["realmodel_origin"]), (EAST + 200, NORTH + 200, 0.0))
        self.assertIn("its origin was moved", self.model.warnings)
        item = bpy.data.objects["base block"]
        self.assertLess(max(abs(v) for corner in item.bound_box for v in corner), 500.0)
        ops.build()
        self.assertNotIn("origin", self.model.warnings)

    def test_with_objects_of_the_user_it_stays_until_it_is_moved(self):
        corners = [(EAST, NORTH), (EAST + 500, NORTH), (EAST + 500, NORTH + 500), (EAST, NORTH + 500)]
        region = outline("far", corners)
        ops.rock_add()
        rock = self.model.rocks[0]
        rock.region, rock.base_elevation = region, 0.0
        ops.surface_add(filepath=str(self.table("a.csv", grid(20.0))))
        rock.surfaces[0].method = "plane"
        ops.build()
        self.assertIn("Move Model to Scene's Zero", self.model.warnings)
        before = self.volumes()["base block"]
        interface = rock.surfaces[0].interface
        ops.move_to_zero()
        self.assertAlmostEqual(self.volumes()["base block"], before, delta=1e-3 * before)
        self.assertEqual(self.model.warnings, "")
        bpy.context.view_layer.update()
        self.assertLess(region.matrix_world.translation.x, -3e6)
        self.assertEqual(rock.surfaces[0].interface, interface)
        self.assertEqual(rock.surfaces[0].source, "POINTS_FILE", "it was not edited")
        self.assertLess(abs(interface.data.vertices[0].co.x), 1000.0)
        self.refused(ops.move_to_zero, "stands near the zero")

    def test_far(self):
        box = np.array([(0.0, 0.0, 0.0), (10.0, 10.0, 1.0)])
        self.assertIsNone(origin.far_from(np.array((900.0, 0.0, 0.0)), box))
        self.assertAlmostEqual(origin.far_from(np.array((0.0, -2000.0, 0.0)), box), 2000.0)


class Region(Imported):
    def test_around_points(self):
        ops.surface_add(filepath=str(self.table("a.csv", grid(20.0))))
        ops.region_around(margin=10.0)
        rings = project_settings.region_rings(
            self.model.rocks[0],
            bpy.context.evaluated_depsgraph_get(),
            project_settings.model_origin(self.scene),
        )
        margin = 0.1 * 550 * 2**0.5
        low, high = rings[0].min(axis=0), rings[0].max(axis=0)
        for got, wanted in zip((*low, *high), (EAST, NORTH, EAST + 550, NORTH + 550), strict=True):
            self.assertAlmostEqual(abs(got - wanted), margin, places=1)

    def test_it_is_over_the_points(self):
        """On the walls of blocks it would flicker."""
        points = grid(20.0)
        points[0, 2] += 30.0
        ops.surface_add(filepath=str(self.table("a.csv", points)))
        ops.region_around()
        height = self.model.rocks[0].region.data.splines[0].points[0].co[2]
        height += project_settings.model_origin(self.scene)[2]
        self.assertAlmostEqual(height, points[:, 2].max() + 0.1 * np.ptp(points[:, 2]), places=2)

    def test_a_base_by_hand_begins_below_the_points(self):
        ops.surface_add(filepath=str(self.table("a.csv", grid(20.0))))
        rock = self.model.rocks[0]
        rock.use_base = True
        low = grid(20.0)[:, 2].min()
        self.assertLess(rock.base_elevation, low)
        self.assertGreater(rock.base_elevation, low - 20.0)
        rock.base_elevation = 7.0
        rock.use_base = False
        rock.use_base = True
        self.assertEqual(rock.base_elevation, 7.0, "that of the user stays")

    def test_hull(self):
        points = grid(20.0)
        corner = points[:, 0] + points[:, 1] - EAST - NORTH <= 300.0
        ops.surface_add(filepath=str(self.table("a.csv", points[corner])))
        ops.region_around(shape="HULL", margin=0.0)
        self.assertEqual(len(self.model.rocks[0].region.data.splines[0].points), 3)

    def test_refusals(self):
        self.assertFalse(ops.region_around.poll())
        ops.rock_add()
        self.refused(ops.region_around, "no surface of rock mass has points yet")
        ops.surface_add(filepath=str(self.table("a.csv", grid(20.0)[:12])))
        self.refused(ops.region_around, "in one line")

    def test_a_region_elsewhere_is_refused(self):
        ops.surface_add(filepath=str(self.table("a.csv", grid(20.0))))
        self.model.origin = (0.0, 0.0, 0.0)
        self.model.rocks[0].region = outline("here", [(0, 0), (500, 0), (500, 500), (0, 500)])
        self.refused(ops.build, r"its points lie 6,38\d km northeast of the region")


class Selected(Imported):
    def test_the_base_lies_a_fifth_below(self):
        stack(10.0, 20.0)
        rock = self.model.rocks[0]
        self.assertEqual((rock.base_elevation, rock.use_base), (8.0, False))
        ops.from_selected(add_base=True)
        self.assertTrue(self.model.rocks[0].use_base)

    def test_a_solid_is_called_one(self):
        bpy.ops.mesh.primitive_cube_add()
        cube = bpy.context.active_object
        self.refused(ops.from_selected, "Cube is a closed solid; RealModel takes open sheets, such as a grid")
        self.refused(ops.surface_add, "Cube is a closed solid", use_object=True)
        select(sheet("a", 5.0))
        ops.from_selected()
        self.model.rocks[0].surfaces[0].object = cube
        self.refused(ops.build, "surface 'a': Cube is a closed solid")
        self.assertEqual(bpy.context.mode, "OBJECT")


class Opened(Imported):
    def test_examples_are_built_without_warnings(self):
        for name in ("two_layers", "gravel_plain"):
            ops.open_sample(sample=name)
            self.assertGreaterEqual(len(self.model.results), 2)
            found = [each for each in notices.read(self.model.warnings) if "it erodes" not in str(each)]
            self.assertEqual(found, [], name)

    def test_sections_and_planes_of_an_earlier_model_go(self):
        stack(0.0, 10.0)
        ops.build()
        ops.section_plane(axis="Y")
        ops.section()
        ops.new()
        self.assertEqual(sorted(item.name for item in self.scene.objects), ["S0", "S1"])
        self.assertIsNone(self.model.view.plane)

    def test_messages_are_merged_and_in_words_of_the_panel(self):
        stack(0.0, 10.0)
        ops.build()
        model = type("Model", (), {})()
        model.project = type("Project", (), {"rocks": [1]})()
        text = 'the range, {}, is large; give method = "universal_kriging", or say nodata = -9999'
        model.warnings = [BuildWarning(text.format(n), "points", "r", f"S{n}") for n in (1, 2)]
        model.warnings.append(BuildWarning("/data/of mine/picks.csv: 2 picks", "points", "r"))
        model.warnings.append(BuildWarning("corners merged: 2; no action is needed", "joined"))
        kept = notices.of_model(model)
        first, second = notices.read(kept)
        self.assertTrue(first.startswith("S1 and S2: the range, 1, is large; set Method to "), first)
        self.assertNotIn("=", first)
        self.assertIn("-9999", first)
        self.assertTrue(second.startswith("r: "), second)
        self.model.warnings = kept
        ops.dismiss()
        self.assertEqual(self.model.warnings, "")
        self.assertFalse(ops.dismiss.poll())

    def test_settings_are_called_as_in_the_panel(self):
        for text, wanted in (
            (
                "fault 'F': it ends inside the rock; extend it beyond the rock, set 'dies_out' or 'ends_at', "
                "or choose an older 'youngest'",
                "fault 'F': it ends inside the rock; extend it beyond the rock, set Dies Out or Ends At, or "
                "choose an older Youngest",
            ),
            ("a closed surface is a body: write [[body]]", "a closed surface is a body: add it as a body"),
            ("use a shorter edge_length", "use a shorter Edge Length"),
            ("one and a base_elevation", "one and a Base Elevation"),
            ('or give extrapolate = "nearest"', "or set Extrapolation to Nearest Point"),
            (
                'write thickness = "free"',
                f"set Thickness to {THICKNESSES['free'][0]}",
            ),  # surfaces have one, too
            (
                "surface 'after': 'to' names 'name', which depends on this surface",
                "surface 'after': Parallel To names 'name', which depends on this surface",
            ),
            (
                "'ends_at' names fault 'extend', which does not exist",
                "Ends At names fault 'extend', which does not exist",
            ),
        ):
            self.assertEqual(notices.in_panel_words(text), wanted)

    def test_a_key_of_several_tables_has_one_label(self):
        labels = {}
        for key, setting in notices._SETTINGS:
            if setting.label:
                self.assertEqual(labels.setdefault(key, setting.label), setting.label, key)

    def test_what_concerns_variances_alone_is_not_told_in_a_compartment_either(self):
        model = type("Model", (), {})()
        texts = (f"in compartment 'A': {RANGE_BEYOND}, 9, far exceeds", f"{RANGE_BEYOND}, 9", "other")
        model.warnings = [BuildWarning(text, "points") for text in texts]
        self.assertEqual([warning.text for warning in notices.shown(model)], ["other"])


class Palette(PanelCase):
    def test_colors_differ_for_everybody(self):
        """In ordinary sight and in three simulated kinds of color blindness (Machado et al., 2009)."""
        sights = (
            np.eye(3),
            [
                [0.152286, 1.052583, -0.204868],
                [0.114503, 0.786281, 0.099216],
                [-0.003882, -0.048116, 1.051998],
            ],
            [
                [0.367322, 0.860646, -0.227968],
                [0.280085, 0.672501, 0.047413],
                [-0.011820, 0.042940, 0.968881],
            ],
            [
                [1.255528, -0.076749, -0.178779],
                [-0.078411, 0.930809, 0.147602],
                [0.004733, 0.691367, 0.303900],
            ],
        )
        to_xyz = np.array(
            [
                [0.4124564, 0.3575761, 0.1804375],
                [0.2126729, 0.7151522, 0.0721750],
                [0.0193339, 0.1191920, 0.9503041],
            ]
        )
        colors = np.array([[int(c[i : i + 2], 16) / 255 for i in (1, 3, 5)] for c in PALETTE])
        linear = np.where(colors <= 0.04045, colors / 12.92, ((colors + 0.055) / 1.055) ** 2.4)
        for sight in sights:
            xyz = np.clip(linear @ np.transpose(sight), 0, 1) @ to_xyz.T / (0.95047, 1.0, 1.08883)
            f = np.where(xyz > 0.008856, np.cbrt(xyz), 7.787 * xyz + 16 / 116)
            lab = np.stack([116 * f[:, 1] - 16, 500 * (f[:, 0] - f[:, 1]), 200 * (f[:, 1] - f[:, 2])], 1)
            apart = np.linalg.norm(lab[:, None] - lab[None], axis=2)
            self.assertGreater(apart[~np.eye(len(lab), dtype=bool)].min(), 21.0)
            self.assertGreater(np.diag(np.roll(apart, -1, axis=1)).min(), 42.0)

    def test_more_surfaces_than_the_palette_has_colors_get_others(self):
        for number in range(len(PALETTE) + 3):
            library_rows.for_surface(self.scene, f"S{number}")
        colors = [hex_color(row.color) for row in self.model.library]
        self.assertEqual(len(set(colors)), len(colors))
        self.assertEqual(len(set(palette())), 3 * len(PALETTE))
