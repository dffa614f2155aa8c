# SPDX-License-Identifier: GPL-3.0-or-later
"""A built model of which each test looks at the view: five level surfaces, four blocks in the end."""

import tempfile
import unittest
from pathlib import Path

import blender_state
import bpy
import numpy as np
from made_projects import LIBRARY, surface
from realmodel.bl.host import versions
from realmodel.core import Project, Rock, build
from realmodel.core.project.project_writer import save_project

# The block "Gone" is there after S2 only: S3 erodes all of it, and "Cap" comes to lie on "Sand".
GRID = {"east": 0.0, "north": 0.0, "x0": 0.0, "y0": 0.0, "width": 100.0, "depth": 80.0}


def _rock():
    return Rock(
        "hill",
        [
            surface("S0", lambda x, y: 10.0, property=1, grid=GRID),
            surface("S1", lambda x, y: 20.0 + 0.05 * x, property=2, grid=GRID, block="Sand"),
            surface("S2", lambda x, y: 32.0, property=3, block="Gone", grid=GRID),
            surface("S3", lambda x, y: 19.0 - 0.02 * x, property=4, grid=GRID),
            surface("S4", lambda x, y: 24.0 + 0.01 * y, property=3, grid=GRID, block="Cap"),
        ],
        base_elevation=0.0,
    )


class Case(unittest.TestCase):
    def setUp(self):
        self.scene = blender_state.empty_file()
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.project = Project("Hill", [_rock()], LIBRARY)
        save_project(self.project, self.folder / "project.toml")
        bpy.ops.realmodel.open_project(filepath=str(self.folder / "project.toml"))
        bpy.ops.realmodel.build()
        self.settings = self.scene.realmodel
        self.model = build(self.project, cells="blocks")

    def blocks(self):
        return {row.name: row.object for row in self.settings.results if row.object is not None}

    def contents(self):
        """Every block's and interface's mesh, and where the objects are."""
        found = {}
        for item in self.scene.objects:
            if item.get("realmodel") in ("block", "interface"):
                at = tuple(map(tuple, item.matrix_basis)), tuple(item.delta_location)
                found[item.name] = blender_state.coordinates(item.data).tobytes(), at
        return found

    def in_sight(self, kind=None):
        return {
            item.name
            for item in self.scene.objects
            if item.visible_get() and (kind is None or item.get("realmodel") == kind)
        }

    def look_from_the_south(self, pixels):
        """Renders of the scene show the front of the model, by Cycles, on nothing."""
        if not versions.cycles_available(self.scene):
            self.skipTest("this Blender has no Cycles, and its other renderers need a display")
        camera = bpy.data.cameras.new("camera")
        camera.type, camera.ortho_scale = "ORTHO", 110.0
        item = bpy.data.objects.new("camera", camera)
        item.location, item.rotation_euler = (50.0, -100.0, 20.0), (np.pi / 2, 0.0, 0.0)
        self.scene.collection.objects.link(item)
        self.scene.camera = item
        render = self.scene.render
        render.engine, render.film_transparent = "CYCLES", True
        render.resolution_x = render.resolution_y = pixels
        render.image_settings.color_mode = "RGBA"
        self.scene.cycles.samples, self.scene.cycles.use_denoising = 1, False
