# SPDX-License-Identifier: GPL-3.0-or-later
"""A built model comes into the scene in slices; whatever happens in between, the scene stays as it was or has
the whole model."""

from unittest import mock

import bpy
import numpy as np
from blender_state import inventory, volume
from panel_case import PanelCase, ops, raise_by, select, stack
from realmodel.bl.objects import meshes
from realmodel.bl.scene.build_job import BuildJob
from realmodel.core import Cancelled
from realmodel.core.display.polygon_mesh import of_triangles


class HandOver(PanelCase):
    def setUp(self):
        super().setUp()
        stack(0.0, 10.0, 20.0)
        ops.build()
        raise_by(bpy.data.objects["S2"], 3.0)
        self.before = inventory()
        self.job = BuildJob(self.scene, bpy.context.evaluated_depsgraph_get())
        self.job.start()
        self.job.wait()

    def assert_built(self):
        self.assertAlmostEqual(self.volumes()["S2 block"], 13e4, delta=1.0)
        self.assertAlmostEqual(volume(bpy.data.objects["S2 block"].data), 13e4, delta=1.0)
        self.assertEqual(bpy.data.objects["S2 block"].data.name, "S2 block")
        self.assertFalse([mesh.name for mesh in bpy.data.meshes if not mesh.users])

    def test_done(self):
        self.assertFalse(self.job.hand_over(0.0), "there is a second block")
        self.assertTrue(self.job.hand_over(60.0))
        self.assertAlmostEqual(volume(bpy.data.objects["S2 block"].data), 1e5, delta=1.0)
        self.job.finish()
        self.assert_built()

    def test_cancelled(self):
        self.job.hand_over(0.0)
        self.job.cancel()
        self.assertTrue(self.job.hand_over(0.0), "there is nothing to wait for")
        with self.assertRaises(Cancelled):
            self.job.finish()
        self.assertEqual(inventory(), self.before)

    def test_undone(self):
        if bpy.app.background and not bpy.ops.ed.undo_push.poll():
            self.skipTest("this Blender has no undo in background")
        bpy.ops.ed.undo_push(message="one")
        select(bpy.data.objects["S1"])
        bpy.ops.ed.undo_push(message="two")
        self.job.hand_over(60.0)
        bpy.ops.ed.undo()
        self.job.finish()
        self.assert_built()


class BeingEdited(PanelCase):
    """Blender does not take another mesh for an object that is in edit mode, and does not say so."""

    def edit(self, item):
        item.hide_set(False)
        select(item)
        bpy.ops.object.mode_set(mode="EDIT")

    def test_a_block(self):
        stack(0.0, 10.0, 20.0)
        ops.build()
        raise_by(bpy.data.objects["S2"], 3.0)
        self.edit(bpy.data.objects["S2 block"])
        before = inventory()
        self.refused(ops.build, "block 'S2 block' is in edit mode.*leave the mode")
        self.assertEqual(inventory(), before)
        bpy.ops.object.mode_set(mode="OBJECT")
        ops.build()
        self.assertAlmostEqual(volume(bpy.data.objects["S2 block"].data), 13e4, delta=1.0)

    def test_an_interface_whose_heights_become_others(self):
        ops.open_sample(sample="two_layers", build=False)
        ops.build()
        row = self.model.rocks[0].surfaces[1]
        item, digest = row.interface, row.interface_digest
        self.edit(item)
        ops.build()  # it stays as it is, so nothing is in the way
        row.method = "idw"
        self.refused(ops.build, f"interface '{item.name}' is in edit mode")
        self.assertEqual((row.source, row.interface_digest), ("POINTS_FILE", digest))
        bpy.ops.object.mode_set(mode="OBJECT")
        ops.build()
        self.assertNotEqual(row.interface_digest, digest)
        ops.build()
        self.assertEqual(row.source, "POINTS_FILE", "nobody has edited it")


class Arrays(PanelCase):
    def test_a_mesh_is_the_same_however_it_is_filled(self):
        """With edges that are given and with those that Blender finds, in one piece and number by number."""
        x, y = (part.ravel() for part in np.meshgrid(np.arange(5.0), np.arange(4.0)))
        at = np.column_stack([x, y, np.sin(x + y)]).astype(np.float32)
        corner = (np.arange(3)[:, None] * 5 + np.arange(4)).ravel()
        triangles = np.concatenate(
            [
                np.stack([corner, corner + 1, corner + 6], axis=1),
                np.stack([corner, corner + 6, corner + 5], axis=1),
            ]
        ).astype(np.int32)
        shape = of_triangles(at, triangles, smooth=True)
        given = meshes.new_mesh("given", shape)
        found = meshes.triangle_mesh("found", at, triangles, smooth=True)
        with mock.patch("realmodel.bl.host.mesh_memory.is_known", lambda: False):
            slow = meshes.new_mesh("slow", shape)
            self.assertTrue(meshes.holds(given, shape))
        for mesh in (given, found, slow):
            self.assertFalse(mesh.validate(), "Blender has nothing to mend")
            self.assertTrue(meshes.holds(mesh, shape))
            self.assertEqual(
                [tuple(p.vertices) for p in mesh.polygons], [tuple(t) for t in triangles.tolist()]
            )
            self.assertTrue(all(p.use_smooth for p in mesh.polygons))
            edges = {tuple(sorted(edge.vertices)) for edge in mesh.edges}
            self.assertEqual(edges, {tuple(edge) for edge in shape.edges.tolist()})
            ends = [set(mesh.edges[loop.edge_index].vertices) for loop in mesh.loops]
            self.assertEqual(ends, [set(edge) for edge in shape.edges[shape.corner_edges].tolist()])
            self.assertFalse(any(edge.is_loose for edge in mesh.edges))
