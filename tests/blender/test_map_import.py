# SPDX-License-Identifier: GPL-3.0-or-later
"""Geological maps in the dialog of field data, and draped on the ground."""

import bpy
import numpy as np
from blender_state import coordinates
from panel_case import SAMPLES, PanelCase, ops
from realmodel.bl.field import map_settings
from realmodel.bl.objects import built_models
from realmodel.bl.project import observed_blocks, project_settings
from realmodel.bl.scene import data_objects
from realmodel.core import load_project
from realmodel.core.base.work import run
from realmodel.core.results.layer_values import at_places
from realmodel.core.surfaces.prepare import read_rocks
from realmodel.operators import boreholes

VALLEY = SAMPLES / "mapped_valley"
NAMES = "Ss = Sandstone; Sh = Shale; Ls = Limestone; Ml = Marl; Bas = Basalt"
ORDER = ["Sandstone", "Shale", "Limestone", "Marl", "Basalt"]


class MapImport(PanelCase):
    def read(self, **options):
        given = {"map_block": "FORMATION", "map_ground": str(VALLEY / "ground.asc"), "names": NAMES}
        ops.boreholes_read(filepath=str(VALLEY / "map.geojson"), **given | options)

    def order(self, names):
        rows = self.rock.surfaces
        for at, name in enumerate(names):
            self.rock.active_surface = rows.find(name)
            while rows.find(name) > at:
                ops.surface_move(direction="DOWN")
                self.rock.active_surface = rows.find(name)

    def made_of_ground(self):
        """The names of the surfaces of the project that have points or a mesh of their own."""
        depsgraph = bpy.context.evaluated_depsgraph_get()
        made = project_settings.read_project(project_settings.compose(self.scene, depsgraph)).rocks[0]
        return [each.name for each in made.surfaces if each.method == "grid" or not each.has_points], made

    @property
    def rock(self):
        return self.model.rocks[0]

    def draped(self):
        (item,) = [item for item in self.scene.objects if item.get("realmodel_view") == "map"]
        return item

    def test_its_lines_may_be_off(self):
        """The errors of contacts are kept in the scene, by the accuracy that the dialog gives."""
        self.read(map_accuracy=2.0)
        near = observed_blocks.of_rock(self.rock).errors
        self.read(map_accuracy=20.0)
        far = observed_blocks.of_rock(self.rock).errors
        self.assertGreater(near.max(), 0.0)
        self.assertLess(3.0 * np.median(near[near > 0.0]), np.median(far[far > 0.0]))

    def test_a_map_gives_surfaces_observations_and_a_ground(self):
        self.read()
        self.assertEqual(sorted(s.name for s in self.rock.surfaces), sorted(ORDER))
        seen = observed_blocks.of_rock(self.rock)
        self.assertGreater(len(seen), 500)
        self.assertEqual(set(seen.blocks), set(ORDER))
        self.assertTrue((seen.holes == "").all())
        self.assertTrue(self.rock.ground.endswith("ground.asc"))
        self.assertEqual([row.filepath for row in self.rock.surfaces], [""] * 5)
        self.assertEqual(data_objects.objects(self.scene), [], "no dots that would hide the map")
        ops.region_around()
        x = [point.co[0] for point in self.rock.region.data.splines[0].points]
        self.assertAlmostEqual(max(x) - min(x), 3100.0, delta=1.0, msg="as wide as the ground, and no wider")
        item = self.draped()
        names = [m.name for m in item.data.materials]
        self.assertTrue(all(any(block in name for name in names) for block in ORDER), names)
        self.assertGreater(len(item.data.polygons), 1000)

    def test_it_lies_on_the_ground_in_the_colors_of_the_blocks(self):
        self.read()
        item = self.draped()
        found = coordinates(item.data).astype(float) + project_settings.model_origin(self.scene)
        draped = map_settings.of_rock(self.rock)
        self.assertTrue(np.allclose(found[:, :2], draped.vertices[:, :2], atol=0.01))
        lift = found[:, 2] - draped.vertices[:, 2]
        self.assertTrue((lift > 0).all() and lift.max() < 10)
        normals = np.array([polygon.normal[2] for polygon in item.data.polygons])
        self.assertTrue((normals > 0).all(), "they look up")
        seen = observed_blocks.of_rock(self.rock)
        middles = draped.vertices[draped.triangles].mean(axis=1)[:, :2]
        _, first, count = np.unique(seen.places, axis=0, return_index=True, return_counts=True)
        for number in first[count == 1][::23].tolist():  # others are on borders
            away = np.linalg.norm(middles - seen.places[number, :2], axis=1)
            near = {draped.names[draped.unit[k]] for k in np.argsort(away)[:6]}
            self.assertIn(seen.blocks[number], near)
        self.model.view.show_map = False
        self.assertFalse([item for item in self.scene.objects if item.get("realmodel_view") == "map"])
        self.save_and_open()
        self.assertEqual(len(map_settings.of_rock(self.rock).triangles), len(draped.triangles))

    def test_several_files_at_once(self):
        (self.folder / "map.geojson").write_text((VALLEY / "map.geojson").read_text())
        (self.folder / "logs.csv").write_text(
            "hole,x,y,z,from,to,block\nB1,1500,1000,400,0,50,Limestone\nB1,1500,1000,400,50,80,Shale\n"
        )
        files = [{"name": "map.geojson"}, {"name": "logs.csv"}]
        given = {"map_ground": str(VALLEY / "ground.asc"), "names": NAMES}  # its only attribute
        first = str(self.folder / "map.geojson")
        ops.boreholes_read(filepath=first, directory=str(self.folder), files=files, **given)
        seen = observed_blocks.of_rock(self.rock)
        self.assertEqual(int((seen.holes == "B1").sum()), 4)
        self.assertGreater(int((seen.holes == "").sum()), 500)
        kind, icon, contained = boreholes.shown_kind(self.folder / "map.geojson", "")
        self.assertEqual((kind, icon), ("map", "CHECKMARK"))
        self.assertEqual(contained, ["block\u00a0=\u00a0FORMATION", "codes Bas, Ls, Ml, Sh, Ss"])

    def test_a_base_lies_below_the_map(self):
        self.read()
        self.assertTrue(self.rock.use_base)
        self.assertLess(self.rock.base_elevation, 300 - 0.1 * 3600, "a tenth of the extent below the ground")
        self.rock.base_elevation = 12.0
        self.read()
        self.assertEqual(self.rock.base_elevation, 12.0, "what is given stays")

    def test_the_ground_may_be_a_surface_of_the_list(self):
        ops.surface_add(filepath=str(VALLEY / "ground.asc"), name="hills")
        count = len(self.rock.surfaces)
        self.read(map_ground="hills", add_surfaces=False, names="")
        self.assertEqual(len(self.rock.surfaces), count)
        self.assertIsNone(observed_blocks.of_rock(self.rock), "no unit is known")
        self.assertGreater(len(self.draped().data.polygons), 1000, "it is shown all the same")
        self.read(map_ground="", add_surfaces=False, names="Ss = hills; Sh =")
        seen = observed_blocks.of_rock(self.rock)
        self.assertEqual(set(seen.blocks), {"hills"})

    def test_what_is_lacking_is_said(self):
        two = (VALLEY / "map.geojson").read_text().replace("FORMATION", 'A": "1", "B')
        (self.folder / "two.geojson").write_text(two)
        path = str(self.folder / "two.geojson")
        self.refused(ops.boreholes_read, "no attribute is known to name the blocks.*A, B", filepath=path)
        self.refused(self.read, "no attribute 'ROCK'", map_block="ROCK")
        self.refused(self.read, "the ground of the map is not known", map_ground="")
        self.refused(self.read, "file not found", map_ground="none.asc")
        self.refused(self.read, "no layer 'units'", map_layer="units")
        self.assertEqual(len(self.model.rocks), 0)

    def test_the_map_of_a_project_is_shown(self):
        ops.open_project(filepath=str(VALLEY / "project.toml"), build=False)
        self.model.view.show_map = True
        item = self.draped()
        self.assertGreater(len(item.data.polygons), 1000)
        names = {item.data.materials[p.material_index].name for p in item.data.polygons}
        self.assertEqual(len(names), 5, names)
        self.assertNotIn("Switched Off", names)

    def test_a_map_makes_a_model_without_a_borehole(self):
        self.read()
        rows = self.rock.surfaces
        self.order(ORDER)
        for row in rows:
            row.method = "natural_neighbour"
        ops.region_around()
        self.rock.base_elevation, self.rock.edge_length = -100.0, 150.0
        self.model.view.show_misfits = True
        ops.build()
        self.assertEqual(len(self.model.results), 5)
        places = coordinates(self.draped().data).astype(float) + project_settings.model_origin(self.scene)
        ground = at_places(*built_models.current(self.scene).surface(4), places[:, :2])
        lift = (places[:, 2] - ground)[~np.isnan(ground)]
        self.assertGreater(lift.min(), 1.0, "not within the coarse triangles of the ground")
        self.assertEqual(len(bpy.context.scene.realmodel.misfits) > 0, self.model.view.misfit_count > 0)

    def test_the_ground_stays_on_top_in_any_order(self):
        """It is of the rock mass, and never of a place in the list; also after a build, and saved."""
        self.read()
        ops.region_around()
        for order in (ORDER, ["Marl", *ORDER[:3], "Basalt"][::-1], ORDER):
            self.order(order)
            made, rock = self.made_of_ground()
            self.assertEqual(made, [order[-1]])
            self.assertGreater(len(rock.surfaces[-1].points), 1000)
            self.assertTrue(all(each.points is None for each in rock.surfaces[:-1]))
            self.assertEqual([row.source for row in self.rock.surfaces], ["NONE"] * 5)
        ops.surface_add(empty=True, name="Soil")
        self.assertEqual(self.made_of_ground()[0], ["Soil"])
        ops.surface_remove()
        for row in self.rock.surfaces:
            row.method = "natural_neighbour"
        self.rock.base_elevation, self.rock.edge_length = -100.0, 200.0
        ops.build()
        self.save_and_open()
        self.rock.ground = str(self.folder / "gone.asc")  # a file that is not there is read when it is built
        self.refused(ops.build, "gone.asc")
        self.rock.ground = str(VALLEY / "ground.asc")
        self.order(["Basalt", *ORDER[:-1]])
        self.assertEqual(self.made_of_ground()[0], ["Marl"])

    def test_the_ground_of_a_project_is_that_of_its_rock_mass(self):
        ops.open_project(filepath=str(VALLEY / "project.toml"), build=False)
        self.assertTrue(self.rock.ground.endswith("ground.asc"))
        youngest = self.rock.surfaces[-1].name
        made, rock = self.made_of_ground()
        self.assertIn(youngest, made)
        given = load_project(VALLEY / "project.toml")
        expected = run(lambda work: read_rocks(work, given))[0].rock
        for own, other in zip(rock.surfaces, expected.surfaces, strict=True):
            self.assertEqual((own.name, own.method, own.options), (other.name, other.method, other.options))
            self.assertTrue(np.array_equal(own.points, other.points), own.name)
        self.assertTrue(np.array_equal(rock.observations.seen_on, expected.observations.seen_on))
        ops.surface_move(direction="DOWN")
        self.assertNotIn(youngest, self.made_of_ground()[0])
        moved = self.made_of_ground()[1]
        self.assertEqual(set(moved.observations.seen_on) - {""}, {self.rock.surfaces[-1].name})
