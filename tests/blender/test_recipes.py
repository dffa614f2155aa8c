# SPDX-License-Identifier: GPL-3.0-or-later
"""The recipes of the guide, step by step, each from Blender's usual new file."""

import math
from pathlib import Path

import bpy
import numpy as np
from blender_state import open_edges, volume
from panel_case import SAMPLES, PanelCase, ops, select
from realmodel.bl import notices, quality, weathering


class Recipe(PanelCase):
    def setUp(self):
        super().setUp()
        bpy.ops.wm.read_homefile(use_factory_startup=True)

    def no_warnings(self):
        self.assertEqual(notices.read(self.model.warnings), [])

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

    def cliff(self):
        bpy.data.objects.remove(bpy.data.objects["Cube"])
        bpy.ops.mesh.primitive_cube_add(size=30.0)
        item = bpy.context.object
        item.scale = 1.5, 0.7, 0.6
        subdivision = item.modifiers.new("Subdivision", "SUBSURF")
        subdivision.subdivision_type, subdivision.levels = "SIMPLE", 5
        displace = item.modifiers.new("Displace", "DISPLACE")
        displace.texture = bpy.data.textures.new("Clouds", "CLOUDS")
        displace.texture.noise_scale, displace.strength = 6.0, 5.0
        select(item)
        ops.fill_with_strata(preset="CLIFF")
        return list(bpy.data.collections["Cube Strata"].objects)

    def test_a_cliff(self):
        beds = self.cliff()
        self.assertEqual(len(beds), 14)
        ops.weathering(strength=3.0, detail=2, plants=1.0)
        self.assertTrue(all(weathering.modifier_of(bed) is not None for bed in beds))
        ops.set_up_picture(sun_elevation=math.radians(20.0))
        picture = self.rendered()
        self.assertGreater(np.ptp(picture.mean(axis=2)), 0.3)

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
        ops.open_sample(sample="castle_hill")
        ops.animate_stages(frames=12)
        ops.turntable(frames=132)
        self.assertEqual((self.scene.frame_start, self.scene.frame_end), (1, 132))

    def test_a_print_in_parts(self):
        item = bpy.data.objects["Cube"]
        select(item)
        ops.fill_with_strata(beds=3, dip=0.0, rock_looks=False)
        beds = sorted(bpy.data.collections["Cube Strata"].objects, key=lambda bed: bed.name)
        boundary = max((bed.matrix_world @ v.co).z for bed in beds[:1] for v in bed.data.vertices)
        pegs = []
        for radius, depth in ((0.2, 0.3), (0.21, 0.315)):
            bpy.ops.mesh.primitive_cylinder_add(radius=radius, depth=depth, location=(0.0, 0.0, boundary))
            pegs.append(bpy.context.object)
        before = [volume(bed.data) for bed in beds]
        for peg, bed, operation in zip(pegs, beds, ("UNION", "DIFFERENCE"), strict=False):
            select(peg, bed)
            ops.boolean(operation=operation)
        halves = [volume(peg.data) / 2 for peg in pegs]
        self.assertAlmostEqual(volume(beds[0].data), before[0] + halves[0], places=4)
        self.assertAlmostEqual(volume(beds[1].data), before[1] - halves[1], places=4)
        self.assertEqual([open_edges(bed.data) for bed in beds], [0, 0, 0])
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
        (remark,) = found.remarks
        self.assertIn("far exceeds the extent of the points", remark)
        self.assertIn("far exceeds", " ".join(quality.lines(found, "VARIOGRAM", "m")))

    def test_logged_boreholes(self):
        """docs/guide/boreholes.md"""
        collars = (
            "hole,x,y,z,end\nB1,5,5,60,30\nB2,95,5,61,26\nB3,95,95,62,42\nB4,5,95,60,15\nB5,50,50,58,30\n"
        )
        intervals = (
            "hole,from,to,block\nB1,0,8,Gravel\nB1,8,20,CLY\nB1,20,30,Sandstone\nB2,0,11,Gravel\n"
            "B2,11,19,CLY\nB2,19,26,Sandstone\nB3,0,17,Gravel\nB3,17,42,Sandstone\nB4,0,9,Gravel\n"
            "B4,9,15,CLY\nB5,0,10,Gravel\nB5,10,17,CLY\nB5,17,18,LC\nB5,18,30,Sandstone\n"
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
        rock.use_base, rock.base_elevation = True, 0.0
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

    def test_a_simulation(self):
        """docs/guide/simulation.md"""
        ops.open_sample(sample="two_layers")
        if not len(self.model.results):
            ops.build()
        path = self.folder / "two_layers.vtu"
        ops.export_mesh(filepath=str(path), edge_length=4.0, minimum_thickness=0.7, layer_thickness=2.0)
        self.assertGreater(path.stat().st_size, 100_000)
