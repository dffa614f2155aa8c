# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tests of the panel share: the add-on enabled in an empty file, and meshes to build from."""

import tempfile
import time
import unittest
from pathlib import Path

import bpy
import numpy as np
import realmodel
from blender_state import empty_file
from realmodel.bl.objects import meshes
from realmodel.bl.scene import live

SAMPLES = Path(__file__).resolve().parents[2] / "blend_samples"
ops = bpy.ops.realmodel


class PanelCase(unittest.TestCase):
    """The add-on is enabled, the file is empty, `self.folder` is a folder of the test's own."""

    def setUp(self):
        empty_file()
        realmodel.register()
        self.addCleanup(realmodel.unregister)
        place = tempfile.TemporaryDirectory()
        self.addCleanup(place.cleanup)
        self.folder = Path(place.name)

    @property
    def scene(self):
        return bpy.context.scene

    @property
    def model(self):
        return bpy.context.scene.realmodel

    def volumes(self):
        """By block, in full."""
        return {row.name: float(row.volume_exact) for row in self.model.results}

    def refused(self, operator, expected, **arguments):
        """The operator refuses, saying what is expected (a regular expression), and the scene is as it
        was."""
        with self.assertRaisesRegex(RuntimeError, expected):
            operator(**arguments)

    def save_and_open(self, name="m.blend"):
        path = self.folder / name
        bpy.ops.wm.save_as_mainfile(filepath=str(path))
        empty_file()
        bpy.ops.wm.open_mainfile(filepath=str(path))
        return path

    def live_is_done(self, patience=600.0):
        """Does what Blender's timer does, until nothing is left to do."""
        until = time.monotonic() + patience
        while (wait := live._work.look()) is not None:
            self.assertLess(time.monotonic(), until, "the live build does not end")
            time.sleep(wait)


def sheet(name, height, n=4, size=100.0, at=(0.0, 0.0)):
    """A flat or bent square of 2 n^2 triangles as a mesh object of the scene. height: a number or f(x, y)."""
    along = np.linspace(0.0, size, n + 1)
    x, y = (a.ravel() for a in np.meshgrid(along + at[0], along + at[1]))
    z = (
        np.array([height(a, b) for a, b in zip(x, y, strict=True)])
        if callable(height)
        else np.full_like(x, height)
    )
    column, row = (a.ravel() for a in np.meshgrid(np.arange(n), np.arange(n)))
    a = row * (n + 1) + column
    triangles = np.concatenate([np.stack([a, a + 1, a + n + 2], 1), np.stack([a, a + n + 2, a + n + 1], 1)])
    mesh = meshes.triangle_mesh(name, np.column_stack([x, y, z]), triangles)
    item = bpy.data.objects.new(name, mesh)
    bpy.context.collection.objects.link(item)
    return item


def raise_by(item, height):
    """Moves all vertices of a mesh object, as an edit does."""
    for vertex in item.data.vertices:
        vertex.co.z += height
    item.data.update()
    bpy.context.view_layer.update()


def select(*items):
    bpy.context.view_layer.update()
    for item in bpy.context.view_layer.objects:
        item.select_set(item in items)
    bpy.context.view_layer.objects.active = items[-1] if items else None


def outline(name, ring, hole=None, cyclic=True):
    """A curve object of straight lines."""
    curve = bpy.data.curves.new(name, "CURVE")
    curve.dimensions = "3D"
    for corners in (ring, hole):
        if corners is None:
            continue
        spline = curve.splines.new("POLY")
        spline.points.add(len(corners) - 1)
        spline.use_cyclic_u = cyclic
        for point, (x, y) in zip(spline.points, corners, strict=True):
            point.co = (x, y, 0.0, 1.0)
    item = bpy.data.objects.new(name, curve)
    bpy.context.collection.objects.link(item)
    return item


def stack(*heights):
    """A model of flat sheets from selected objects, not yet built; returns the objects, oldest first."""
    items = [sheet(f"S{n}", height) for n, height in enumerate(heights)]
    select(*items)
    ops.from_selected()
    return items
