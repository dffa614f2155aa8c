# SPDX-License-Identifier: GPL-3.0-or-later
"""The terrain in the panel: a row of its own, from a file or an object, above all other surfaces."""

import bpy
from panel_case import PanelCase, ops, sheet
from realmodel.bl.project import project_settings
from realmodel.core import build, load_project

DEM = "ncols 12\nnrows 12\nxllcorner -10\nyllcorner -10\ncellsize 10\n"


class Terrain(PanelCase):
    def dem(self, z, name="dem.asc"):
        path = self.folder / name
        path.write_text(DEM + "\n".join([" ".join([str(z)] * 12)] * 12) + "\n")
        return str(path)

    def bed(self, name, z):
        rows = "".join(f"{x},{y},{z}\n" for x in range(0, 101, 20) for y in range(0, 101, 20))
        (self.folder / f"{name}.csv").write_text(f"x,y,z\n{rows}")

    def begun(self):
        """A rock mass with one surface at 2."""
        self.bed("bed", 2.0)
        ops.surface_add(filepath=str(self.folder / "bed.csv"))
        ops.region_around()
        self.rock.use_base, self.rock.base_elevation = True, 0.0
        return self.rock

    @property
    def rock(self):
        return self.model.rocks[0]

    def order(self):
        return [row.name for row in self.rock.surfaces]

    def built(self):
        ops.build()
        return self.volumes()

    def composed(self):
        return project_settings.compose(self.scene, bpy.context.evaluated_depsgraph_get()).project

    def test_a_file_is_the_boundary_above_all_surfaces(self):
        rock = self.begun()
        ops.surface_add(filepath=self.dem(6), as_terrain=True)
        self.assertEqual(self.order(), ["bed", "terrain"])
        self.assertEqual((rock.surfaces[1].method, rock.surfaces[1].extrapolate), ("grid", "none"))
        self.bed("later", 9.0)
        ops.surface_add(filepath=str(self.folder / "later.csv"))
        self.assertEqual(self.order(), ["bed", "later", "terrain"])
        self.assertEqual(rock.surfaces[rock.active_surface].name, "later")
        ops.surface_move(direction="UP")
        self.assertEqual(self.order(), ["bed", "later", "terrain"])
        rock.active_surface = 2
        ops.surface_copy()
        self.assertEqual(self.order(), ["bed", "later", "terrain 2", "terrain"])
        rock.active_surface = 2
        ops.surface_remove()
        volumes = self.built()
        self.assertAlmostEqual(
            volumes["later block"], 2.0 * volumes["base block"], delta=1e-3 * volumes["base block"]
        )
        self.assertEqual(self.composed().rocks[0].terrain, "terrain")

    def test_another_one_takes_its_place_and_it_can_be_removed(self):
        self.begun()
        ops.surface_add(filepath=self.dem(6), as_terrain=True)
        before = self.built()["terrain block"]
        ops.surface_add(filepath=self.dem(4, "other.asc"), as_terrain=True)
        self.assertEqual(self.order(), ["bed", "terrain"])
        self.assertAlmostEqual(self.built()["terrain block"] / before, 0.5, places=3)
        ops.surface_remove(terrain=True)
        self.assertEqual(self.order(), ["bed"])
        self.refused(ops.surface_remove, "no terrain", terrain=True)

    def test_an_object_may_be_it(self):
        self.begun()
        item = sheet("hill", 6.0, size=300.0, at=(-100.0, -100.0))
        bpy.context.view_layer.objects.active = item
        ops.surface_add(use_object=True, as_terrain=True)
        self.assertEqual(self.order(), ["bed", "terrain"])
        self.assertEqual(self.rock.surfaces[1].object, item)

    def test_a_youngest_surface_without_data_becomes_it(self):
        self.begun()
        ops.surface_add(empty=True, name="loam")
        ops.surface_add(filepath=self.dem(6), as_terrain=True)
        self.assertEqual(self.order(), ["bed", "loam"])
        self.assertIn("loam block", self.built())

    def test_a_project_with_one_comes_and_goes(self):
        self.begun()
        ops.surface_add(filepath=self.dem(6), as_terrain=True)
        ops.build()
        ops.save_project(filepath=str(self.folder / "saved.toml"))
        project = load_project(self.folder / "saved.toml")
        self.assertEqual(project.rocks[0].terrain, "terrain")
        volume = build(project).volume
        ops.open_project(filepath=str(self.folder / "saved.toml"))
        self.assertTrue(self.rock.surfaces[-1].is_terrain)
        ops.build()
        self.assertAlmostEqual(sum(row.volume for row in self.model.results) / volume, 1.0, places=6)


class Vein(PanelCase):
    def test_a_body_may_be_made_of_intervals(self):
        """It is in the panel what it is in the project file, and is stored with its holes."""
        collars, rows = "hole,x,y,z\n", "hole,from,to,block\n"
        for number, (x, y) in enumerate((x, y) for x in (20, 50, 80) for y in (20, 50, 80)):
            collars += f"H{number},{x},{y},0\n"
            rows += f"H{number},0,10,Host\nH{number},10,14,Vein\nH{number},14,40,Host\n"
        (self.folder / "collars.csv").write_text(collars)
        (self.folder / "intervals.csv").write_text(rows)
        (self.folder / "project.toml").write_text(
            'format = 1\nname = "p"\n[[rock]]\nname = "r"\n'
            "region = [[0, 0], [100, 0], [100, 100], [0, 100]]\n"
            "edge_length = 10\nbase_elevation = -50\n"
            'boreholes = { collars = "collars.csv", intervals = "intervals.csv" }\n'
            '[[rock.surface]]\nname = "top"\nblock = "Host"\nmethod = "constant"\nvalue = 0\n'
            '[[body]]\nname = "Vein"\nreach = 12\n'
        )
        volume = {b.name: b.volume for b in build(load_project(self.folder / "project.toml")).blocks}["Vein"]
        ops.open_project(filepath=str(self.folder / "project.toml"))
        (body,) = self.model.bodies
        self.assertEqual((body.source, body.reach), ("INTERVALS", 12.0))
        ops.build()
        self.assertAlmostEqual(self.volumes()["Vein"] / volume, 1.0, places=9)
        body.reach = 6.0
        ops.build()
        self.assertLess(self.volumes()["Vein"], 0.95 * volume)
