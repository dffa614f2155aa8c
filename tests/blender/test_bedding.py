# SPDX-License-Identifier: GPL-3.0-or-later
"""Where corners lie in their layers, as attributes of the blocks: after builds, edits, stages, cuts."""

import bpy
import numpy as np
from panel_case import PanelCase, ops, raise_by, stack
from realmodel.bl.objects import meshes

NAMES = [meshes.PREFIX + name for name in meshes.BEDDING]


def values(item, name):
    attribute = item.data.attributes[meshes.PREFIX + name]
    found = np.empty(len(attribute.data), np.float32)
    attribute.data.foreach_get("value", found)
    return found


def heights(item):
    """(C,) z of the corners of an object's mesh, in the model."""
    corner = np.empty(len(item.data.loops), np.int32)
    item.data.loops.foreach_get("vertex_index", corner)
    return meshes.mesh_coordinates(item.data)[corner, 2]


class Bedding(PanelCase):
    def setUp(self):
        super().setUp()
        self.items = stack(0.0, 10.0, 20.0)
        ops.build()
        self.lift = self.scene["realmodel_origin"][2]

    def check(self, name, low, high, top):
        item = bpy.data.objects[name]
        z = heights(item) + self.lift
        np.testing.assert_allclose(values(item, "height"), (z - low) / (high - low), atol=1e-5)
        np.testing.assert_allclose(values(item, "thickness"), high - low, atol=1e-4)
        np.testing.assert_allclose(values(item, "depth"), top - z, atol=1e-4)

    def test_kinds_and_values(self):
        mesh = bpy.data.objects["S2 block"].data
        for name, kind in meshes.BEDDING.items():
            attribute = mesh.attributes[meshes.PREFIX + name]
            self.assertEqual((attribute.data_type, attribute.domain), kind)
        self.check("S1 block", 0.0, 10.0, 20.0)
        self.check("S2 block", 10.0, 20.0, 20.0)
        self.assertEqual(set(values(bpy.data.objects["S2 block"], "age")), {2.0})
        self.assertFalse(values(bpy.data.objects["S1 block"], "is_top").any())
        self.assertTrue(values(bpy.data.objects["S2 block"], "is_top").any())

    def test_they_follow_live_edits_also_where_the_shape_stays(self):
        self.model.live = True
        self.live_is_done()
        raise_by(self.items[2], 5.0)
        self.live_is_done()
        self.check("S1 block", 0.0, 10.0, 25.0)  # only its depth has changed
        self.check("S2 block", 10.0, 25.0, 25.0)

    def test_a_stage(self):
        self.model.stage = 1
        self.check("S1 block", 0.0, 10.0, 10.0)
        self.assertTrue(values(bpy.data.objects["S1 block"], "is_top").any())
        self.model.stage = 2
        self.check("S1 block", 0.0, 10.0, 20.0)

    def test_interfaces_have_none(self):
        self.assertFalse(set(NAMES) & set(bpy.data.objects["S1"].data.attributes.keys()))
