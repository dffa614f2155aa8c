# SPDX-License-Identifier: GPL-3.0-or-later
"""The recipes of the guide, step by step, each from Blender's usual new file."""

import math
import re
import sys
from pathlib import Path

import bpy
import numpy as np
from blender_state import coordinates, open_edges, volume
from panel_case import SAMPLES, PanelCase, ops, outline, select, sheet
from realmodel.bl.host import notices
from realmodel.bl.project import compartments, project_settings, surface_statistics
from realmodel.bl.scene import quality
from realmodel.bl.shading import looks, strata_modifier, weathering
from recording_layout import draw_tab

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))
import gallery_picture


class Recipe(PanelCase):
    def setUp(self):
        super().setUp()
        bpy.ops.wm.read_homefile(use_factory_startup=True)

    def no_warnings(self):
        found = [each for each in notices.read(self.model.warnings) if "it erodes" not in str(each)]
        self.assertEqual(found, [], "but for the contacts that the ground erodes, as it should")

    def rendered(self):
        """The brightness of a small picture, as F12 makes it."""
        render = self.scene.render
        render.resolution_x, render.resolution_y = 48, 27
        self.scene.cycles.samples = 4
        render.filepath = str(self.folder / "picture.png")
        bpy.ops.render.render(write_still=True)
        image = bpy.data.images.load(render.filepath)
        return np.array(image.pixels[:]).reshape(27, 48, -1)[:, :, :3]


class ForArtists(Recipe):
    """docs/guide/artists.md"""

    def test_a_cliff(self):
        bpy.data.objects.remove(bpy.data.objects["Cube"])
        ops.strata_rock_add(kind="CLIFF", faces=20_000)
        item = bpy.context.active_object
        item.realmodel_strata.beds = 10
        ops.strata_erode()
        self.assertTrue(strata_modifier.shows_erosion(item))
        ops.set_up_picture(sun_elevation=math.radians(20.0))
        picture = self.rendered()
        self.assertGreater(np.ptp(picture.mean(axis=2)), 0.3)
        ops.fill_with_strata(use_dialog=False)
        beds = [bed for bed in item.realmodel_strata.beds_in.objects if "realmodel_bed" in bed]
        self.assertTrue(8 <= len(beds) <= 10)
        self.assertTrue(all(not open_edges(bed.data) for bed in beds))
        self.assertIn("Strata Cliff Scree", item.realmodel_strata.beds_in.objects)

    def test_a_cliff_of_a_mesh_of_ones_own(self):
        bpy.data.objects.remove(bpy.data.objects["Cube"])
        item = gallery_picture.cliff(levels=4)
        select(item)
        ops.strata_preset(preset="CLIFF")
        ops.fill_with_strata(use_dialog=False)
        beds = list(bpy.data.collections["Cube Strata"].objects)
        self.assertEqual(len(beds), 14)
        ops.weathering(plants=1.0)
        self.assertTrue(all(weathering.modifier_of(bed) is not None for bed in beds))
        ops.set_up_picture(sun_elevation=math.radians(20.0))
        picture = self.rendered()
        self.assertGreater(np.ptp(picture.mean(axis=2)), 0.3)

    def test_a_canyon(self):
        ops.open_sample(sample="canyon", build=False)
        self.model.rocks[0].edge_length *= 2.5
        ops.build()
        ops.rock_looks(look="AUTO")
        self.no_warnings()
        self.assertEqual(len(self.model.results), 43)
        self.assertIn("realmodel.export", draw_tab(bpy.context).operators)
        for row in self.model.results:
            self.assertIn(looks.KEY, row.object.data.materials[0])
        ops.set_up_picture(sun_elevation=math.radians(30.0))
        self.assertIsNotNone(self.scene.camera)

    def test_a_canyon_of_a_terrain(self):
        terrain = sheet("Terrain", lambda x, y: 30.0 - 25.0 * math.exp(-(((x - 50.0) / 15.0) ** 2)), n=16)
        select(terrain)
        ops.fill_with_strata(preset="CANYON", base_depth=0.2)
        beds = list(bpy.data.collections["Terrain Strata"].objects)
        self.assertEqual(len(beds), 24)
        height = np.ptp(coordinates(terrain.data)[:, 2])
        floor = min(coordinates(bed.data)[:, 2].min() for bed in beds)
        self.assertAlmostEqual(floor, coordinates(terrain.data)[:, 2].min() - 0.2 * height, places=3)

    def test_a_cutaway_diagram(self):
        ops.open_sample(sample="block_diagram")
        ops.rock_looks(look="AUTO")
        self.no_warnings()
        view = self.model.view
        view.exaggeration = 2.0
        view.show_legend = view.show_north = view.show_scale = view.show_axes = True
        ops.section_plane(axis="Y")
        ops.section_update()
        ops.set_up_picture()
        self.assertGreater(np.ptp(self.rendered().mean(axis=2)), 0.3)

    def test_an_animation_of_deposition_and_erosion(self):
        self.assertEqual(ops.open_sample(sample="castle_hill"), {"FINISHED"})
        self.assertTrue(len(self.model.library))
        ops.animate_stages(frames=12)
        ops.turntable(frames=132)
        self.assertEqual((self.scene.frame_start, self.scene.frame_end), (1, 132))

    def test_a_print_in_parts(self):
        item = bpy.data.objects["Cube"]
        select(item)
        ops.fill_with_strata(preset="PRINT", rock_looks=False)
        beds = list(bpy.data.collections["Cube Strata"].objects)
        self.assertEqual([open_edges(bed.data) for bed in beds], [0, 0, 0, 0])
        self.assertLess(sum(volume(bed.data) for bed in beds), 8.0)
        select(beds[0])
        path = str(self.folder / "bed.stl")
        if bpy.app.version >= (4, 2, 0):
            bpy.ops.wm.stl_export(filepath=path, export_selected_objects=True)
        else:
            bpy.ops.export_mesh.stl(filepath=path, use_selection=True)
        self.assertGreater(Path(path).stat().st_size, 84)


class ForGeologists(Recipe):
    def written(self, name, text):
        path = self.folder / name
        path.write_text(text)
        return str(path)

    def test_csv_files(self):
        """docs/guide/csv_to_model.md: nothing alarms where a few points show that a surface dips."""
        for name in ("clay", "ground"):
            ops.surface_add(filepath=str(SAMPLES / "two_layers" / f"{name}.csv"))
        self.model.view.show_contacts = True
        ops.region_around()
        rock = self.model.rocks[0]
        rock.edge_length, rock.use_base, rock.base_elevation = 4.0, True, 0.0
        ops.build()
        self.no_warnings()
        self.assertEqual(len(self.model.results), 2)
        rock.active_surface = 0
        ops.check_quality()
        found = quality.found(self.scene)
        self.assertEqual(
            found.remarks, (), "the default method takes a plane off, so that the range is that of the rest"
        )
        self.assertTrue(quality.lines(found, "VARIOGRAM", "m"))

    def test_logged_boreholes(self):
        """docs/guide/boreholes.md"""
        page = (SAMPLES.parent / "docs" / "guide" / "boreholes.md").read_text(encoding="utf-8")
        collars, intervals = (
            table.replace("    ", "") for table in re.findall(r"(?:^    \w+,.*\n)+", page, re.MULTILINE)
        )
        files = [self.written("collars.csv", collars), self.written("intervals.csv", intervals)]
        ops.boreholes_read(
            directory=str(self.folder),
            files=[{"name": Path(file).name} for file in files],
            names="CLY = Clay; LC =",
            add_surfaces=True,
        )
        rock = self.model.rocks[0]
        self.assertEqual([row.name for row in rock.surfaces], ["Sandstone", "Clay", "Gravel"])
        rock.surfaces[1].rule = "conformable"
        ops.region_around()
        rock.use_base, rock.base_elevation = True, 0.0
        ops.build()
        self.assertEqual(set(self.volumes()), {"Sandstone", "Clay", "Gravel"})
        self.model.view.show_boreholes = self.model.view.show_misfits = True
        self.assertEqual(len(self.model.misfits), 0)

    def test_a_map(self):
        """docs/guide/map.md"""
        valley = SAMPLES / "mapped_valley"
        ops.boreholes_read(
            filepath=str(valley / "map.geojson"),
            map_block="FORMATION",
            map_ground=str(valley / "ground.asc"),
            names="Ss = Sandstone; Sh = Shale; Ls = Limestone; Ml = Marl; Bas = Basalt",
            add_surfaces=True,
        )
        rock = self.model.rocks[0]
        order = ["Sandstone", "Shale", "Limestone", "Marl", "Basalt"]
        for place, name in enumerate(order):
            rock.active_surface = rock.surfaces.find(name)
            while rock.active_surface > place:
                ops.surface_move(direction="DOWN")
        self.assertEqual([row.name for row in rock.surfaces], order)
        ops.region_around()
        ops.build()
        self.assertGreaterEqual(len(self.volumes()), 4)

    def test_a_fold(self):
        """docs/guide/fold.md"""
        fold = SAMPLES / "recumbent_fold"
        for name in ("lower_bed", "middle_bed", "upper_bed", "unconformity", "ground"):
            ops.surface_add(filepath=str(fold / f"{name}.csv"))
        rock = self.model.rocks[0]
        rock.active_surface = 0
        ops.series_add(kind="field")
        rock.series[0].youngest = "upper_bed"
        ops.boreholes_read(filepath=str(fold / "dips.csv"))
        ops.region_around()
        rock.use_base, rock.base_elevation = True, -600.0
        rock.edge_length, rock.series[0].resolution = 60.0, 40.0
        ops.build()
        self.assertEqual(len(self.volumes()), 5)

    def test_a_section_for_a_report(self):
        """docs/guide/report_section.md"""
        ops.open_sample(sample="gravel_plain")
        ops.section_plane(axis="Y")
        plane = self.model.view.plane
        plane.location.y += 30.0
        ops.section_update()
        ops.section()
        made = bpy.context.active_object
        y = plane.matrix_world.translation.y
        self.assertLess(np.abs(coordinates(made.data)[:, 1] - y).max(), 0.01)
        ops.section(flat=True)
        self.assertIsNot(bpy.context.active_object, made)
        low, high = np.ptp(coordinates(made.data), axis=0), coordinates(made.data).max(axis=0)
        path = outline("Line", [(high[0] - low[0] * share, y) for share in (0.8, 0.5, 0.3)], cyclic=False)
        select(path)
        ops.fence()
        self.assertTrue(bpy.context.active_object.name.startswith("Fence"))
        self.model.view.section_holes = "GP02, GP20, GP09"
        ops.fence_holes()
        self.assertTrue(bpy.context.active_object.name.startswith("Holes"))
        for ending in ("svg", "dxf", "png"):
            file = self.folder / f"section.{ending}"
            ops.save_section(filepath=str(file), exaggeration=5.0)
            self.assertGreater(file.stat().st_size, 1_000)

    def test_a_quarry(self):
        """docs/guide/quarry_volumes.md: your own pit"""
        ops.open_sample(sample="two_layers")
        if not len(self.model.results):
            ops.build()
        before = self.volumes()
        ops.copy_table()
        top = max(coordinates(row.object.data)[:, 2].max() for row in self.model.results)
        middle = -project_settings.model_origin(self.scene) + (50.0, 50.0, 0.0)
        bpy.ops.mesh.primitive_cube_add(size=20.0, location=(middle[0], middle[1], top))
        ops.fault_body_from_selected()
        self.model.bodies[0].void = True
        ops.build()
        taken = sum(before.values()) - sum(self.volumes().values())
        self.assertGreater(taken, 0.0)
        self.assertLess(taken, 20.0**3 / 2)
        ops.copy_table()

    def test_a_fault(self):
        """docs/guide/structures.md"""
        places = [(x, y) for x in range(5, 100, 10) for y in range(5, 100, 10)]
        for n, z in enumerate((0.0, 20.0, 40.0)):
            rows = [f"{x},{y},{z - (4.0 if x > 52.0 else 0.0)}" for x, y in places]
            ops.surface_add(filepath=self.written(f"s{n}.csv", "\n".join(["x,y,z", *rows])))
        ops.region_around()
        fault = sheet("Fault", 0.0, n=1, size=200.0)
        fault.data.vertices.foreach_set(
            "co", np.array([(52.0, y, z) for z in (-90.0, 110.0) for y in (-50.0, 150.0)], np.float32).ravel()
        )
        select(fault)
        ops.fault_body_from_selected()
        self.assertEqual(len(self.model.faults), 1)
        ops.build()
        self.assertEqual(len(compartments.names(self.scene)), 2)
        throws = [abs(throw) for _, _, throw, _ in compartments.read(self.scene)["faults"]]
        self.assertTrue(all(abs(throw - 4.0) < 0.1 for throw in throws), throws)
        shares = [surface_statistics.read(row)["share"] for row in self.model.rocks[0].surfaces]
        self.assertTrue(all(share > 0.99 for share in shares), "each has a sheet on either side")
        labels = draw_tab(bpy.context).labels
        for name in (*compartments.names(self.scene), "Fault", "s0", "s1", "s2"):
            self.assertIn(name, labels, "names of the panel Compartments stand by themselves")
        self.model.view.color_by = "COMPARTMENT"

    def test_a_simulation(self):
        """docs/guide/simulation.md"""
        ops.open_sample(sample="two_layers")
        if not len(self.model.results):
            ops.build()
        path = self.folder / "two_layers.vtu"
        ops.export_mesh(filepath=str(path), edge_length=4.0, minimum_thickness=0.7, layer_thickness=2.0)
        self.assertGreater(path.stat().st_size, 100_000)
