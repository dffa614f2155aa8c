# SPDX-License-Identifier: GPL-3.0-or-later
"""A project file opened in the panel and saved again says the same: nothing that it can say is lost."""

import bpy
from every_key import BODIES, EVERY_KEY, FAULTS, write_files
from panel_case import SAMPLES, PanelCase, ops
from realmodel.bl.project import plan_mesh, project_settings
from realmodel.core import load_project
from realmodel.core.base.work import run
from realmodel.core.project.project import ROCK, SURFACE
from realmodel.core.project.structure_entries import BODY, FAULT
from realmodel.core.settings.data_files import READING
from realmodel.core.structures.shapes.reading import read_structures
from realmodel.core.surfaces.prepare import read_rocks


def said(project):
    """All that a project says, with arrays in the place of files, and equal where it means the same."""
    inputs = run(lambda work: read_rocks(work, project))
    rocks = [entry.rock for entry in inputs]
    faults, bodies, _ = run(lambda work: read_structures(work, project, inputs=inputs))
    return {
        "name": project.name,
        "units": project.units,
        "crs": project.crs,
        "library": [vars(entry) for entry in project.library or ()],
        "rocks": [_rock(rock) for rock in rocks],
        "structures": [_structure(entry) for entry in (*faults, *bodies)],
    }


def _structure(entry):
    shape = {key: getattr(entry, key).tolist() for key in ("vertices", "triangles")}
    keys = ("youngest", "dies_out", "ends_at", "rocks", "after", "property", "void", "rock")
    said = {key: getattr(entry, key) for key in keys if hasattr(entry, key)}
    return {"name": entry.name, **shape, **said}


def _rock(rock):
    return {
        "rings": [ring.tolist() for ring in rock.rings()] if rock.region is not None else None,
        "size": [{**entry, "at": _plain(entry["at"])} for entry in rock.size],
        "constraints": [line.tolist() for line in rock.constraints],
        "surfaces": [_surface(surface) for surface in rock.surfaces],
        "series": [_series(series) for series in rock.series],
        "observations": rock.observed
        and [array.tolist() for array in (rock.observed.places, rock.observed.blocks, rock.observed.holes)],
        **{
            key: getattr(rock, key)
            for key in ("name", "edge_length", "triangles", "mesher", "base_elevation")
        },
    }


def _series(series):
    dips = series.space_dips()
    arrays = dips and [dips.positions.tolist(), dips.normals.tolist()]
    return [series.name, series.kind, series.resolution, arrays]


def _surface(surface):
    return {
        "shape": [
            None if array is None else array.tolist()
            for array in (surface.points, surface.vertices, surface.triangles)
        ],
        "left_out": None if surface.left_out is None else [tuple(place) for place in surface.left_out],
        "dips": surface.dips and [surface.dips.positions.tolist(), surface.dips.gradients.tolist()],
        "method": surface.method_options() if surface.has_points else None,
        **{
            key: getattr(surface, key)
            for key in (
                "name",
                "series",
                "rule",
                "property",
                "block",
                "minimum_thickness",
                "true_thickness",
                "tie",
                "observed",
                "correlation",
            )
        },
    }


def _plain(at):
    return (
        at
        if isinstance(at, str)
        else [list(map(float, p)) if isinstance(p, (list, tuple)) else float(p) for p in at]
    )


class RoundTrip(PanelCase):
    def opened_and_saved(self, path):
        ops.open_project(filepath=str(path))
        saved = self.folder / "saved" / "p.toml"
        saved.parent.mkdir(exist_ok=True)
        ops.save_project(filepath=str(saved))
        return load_project(saved)

    def assert_says_the_same(self, path):
        self.maxDiff = 4000
        before, after = said(load_project(path)), said(self.opened_and_saved(path))
        for one, other in zip(before["rocks"], after["rocks"], strict=True):
            for surface, again in zip(one["surfaces"], other["surfaces"], strict=True):
                self.assertEqual(again, surface)
        self.assertEqual(after, before)

    def test_examples(self):
        for path in sorted(SAMPLES.glob("*/project.toml")):
            with self.subTest(path.parent.name):
                self.assert_says_the_same(path)

    def test_every_key(self):
        absent = [key for key in (*ROCK, *SURFACE) if f"\n{key} =" not in EVERY_KEY]
        self.assertEqual(
            [key for key in absent if f"[[rock.{key}]]" not in EVERY_KEY], [], "not in EVERY_KEY"
        )
        for table, text in ((FAULT, FAULTS), (BODY, BODIES)):
            self.assertEqual([key for key in table if key not in READING and f"\n{key} =" not in text], [])
        write_files(self.folder)
        self.assert_says_the_same(self.folder / "project.toml")

    def test_the_panel_shows_what_the_file_says(self):
        write_files(self.folder)
        ops.open_project(filepath=str(self.folder / "project.toml"))
        first, number, _ = self.model.rocks
        self.assertEqual([rock.edges_by for rock in self.model.rocks], ["LENGTH", "TRIANGLES", "AUTO"])
        self.assertEqual(number.triangles, 300)
        self.assertEqual([entry.at for entry in first.sizes], ["OUTLINE", "STORED", "STORED", "CONSTRAINTS"])
        self.assertEqual(plan_mesh.stored_constraints(first), (2, 1))
        surface = first.surfaces[0]
        self.assertEqual((surface.column_x, surface.column_y, surface.column_z), ("east", "north", "level"))
        self.assertEqual(
            [(entry.column, entry.value) for entry in surface.filters],
            [("bed", "A"), ("year", "2019"), ("year", "2020")],
        )
        self.assertEqual((surface.separator, surface.decimal, surface.nodata), (";", ",", "-999, none"))
        self.assertEqual((surface.plan_unit, surface.height_unit), ("ft", "m"))
        self.assertEqual([part.model for part in surface.structures], ["spherical", "gaussian"])
        self.assertTrue(surface.structures[1].use_anisotropy)

    def test_the_dips_of_a_fault_are_removed(self):
        write_files(self.folder)
        ops.open_project(filepath=str(self.folder / "project.toml"))
        self.model.active_fault = self.model.faults.find("F6")
        self.assertEqual(self.model.faults["F6"].dips.count("positions"), 2)
        ops.fault_dips_remove()
        self.assertFalse(self.model.faults["F6"].dips)
        self.refused(ops.fault_dips_remove, "has no dips")

    def test_copies_say_the_same(self):
        write_files(self.folder)
        ops.open_project(filepath=str(self.folder / "project.toml"))
        for number in range(3):
            self.model.active_rock = number
            ops.rock_copy()
        depsgraph = bpy.context.evaluated_depsgraph_get()
        composed = project_settings.compose(self.scene, depsgraph)
        rocks = said(project_settings.read_project(composed))["rocks"]
        self.assertEqual(len(rocks), 6)
        for rock, copy in zip(rocks[:3], rocks[3:], strict=True):
            self.assertEqual({**copy, "name": rock["name"]}, rock)
