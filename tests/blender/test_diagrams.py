# SPDX-License-Identifier: GPL-3.0-or-later
"""Juxtaposition diagrams and stereonets: as files and images, and linked to the dips of a scene."""

import json

import bpy
import numpy as np
from panel_case import SAMPLES, PanelCase, ops
from realmodel.bl.display import bodies
from realmodel.bl.field import data, handle, shown_net
from realmodel.bl.overlay import View, drawing_for, place_in_net
from realmodel.core import load_project
from realmodel.core.drawing.drawing import Dots
from realmodel.core.results.orientations.axes import projected
from realmodel.core.results.orientations.stereonet import small_net

SIZE = (900.0, 600.0)


class DiagramsTest(PanelCase):
    def opened(self):
        ops.open_project(filepath=str(SAMPLES / "faulted_dome" / "project.toml"))
        self.model.view.show_stereonet = True

    def overlay(self):
        drawing = drawing_for(self.scene, View(np.eye(4), np.eye(4), False, SIZE))
        return [] if drawing is None else drawing.items

    def poles(self):
        """(N, 2) the poles that the overlay has, in a net of radius 1."""
        (dots,) = [item for item in self.overlay() if isinstance(item, Dots) and item.layer == "Poles"]
        middle, radius = small_net((SIZE[0] - 12.0, 95.0))
        return (dots.points - middle) / radius

    def dips(self):
        return [g.datum(n) for g in data.groups(self.scene, data.DIPS) for n in range(len(g.places))]

    def test_files_and_the_image_of_a_fault(self):
        self.refused(ops.save_stereonet, "there are no dips", filepath=str(self.folder / "never.svg"))
        self.refused(ops.view_juxtaposition, "no model yet")
        ops.open_sample(sample="faulted_dome")
        path = self.folder / "dips.svg"
        self.assertEqual(ops.save_stereonet(filepath=str(path), of="beds", net="EQUAL_ANGLE"), {"FINISHED"})
        self.assertIn("60 poles", path.read_text())
        self.assertIn("Wulff", path.read_text())
        self.refused(ops.save_stereonet, "no dips of 'x'", filepath=str(self.folder / "x.svg"), of="x")
        if not len(self.model.results):
            ops.build()
        self.model.structure_kind = "FAULT"
        path = self.folder / "fault.svg"
        self.assertEqual(ops.save_juxtaposition(filepath=str(path)), {"FINISHED"})
        text = path.read_text()
        self.assertIn("<title>footwall Salt</title>", text)
        self.assertIn("eastern fault", text)
        ops.view_juxtaposition()
        image = bpy.data.images["Juxtaposition eastern fault"]
        first = tuple(image.size)
        colors = np.array(image.pixels[:]).reshape(-1, 4)
        self.assertTrue((colors[:, 3] == 1.0).all() and np.ptp(colors[:, 0]) > 0.9)
        ops.view_juxtaposition(exaggeration=3.0)
        self.assertEqual([i.name for i in bpy.data.images if "Juxta" in i.name], [image.name])
        self.assertGreater(image.size[1], first[1])

    def test_the_stereonet_beside_the_model_is_that_of_the_core(self):
        self.opened()
        project = load_project(SAMPLES / "faulted_dome" / "project.toml")
        self.assertEqual(shown_net.names(self.scene)[:2], ["dome", "beds"])
        for of in ("", "beds"):
            self.model.view.stereonet_of = of
            wanted = project.stereonet(of or None)
            self.assertEqual(len(self.poles()), len(wanted))
            self.assertEqual(
                [round(share, 9) for share in shown_net.shown_dips(self.scene, of).axes.shares],
                [round(share, 9) for share in wanted.axes.shares],
            )
        self.model.view.stereonet_of = "x"
        self.assertEqual([item for item in self.overlay() if getattr(item, "layer", "") == "Poles"], [])
        self.model.view.show_stereonet = False
        self.assertIsNone(place_in_net(self.scene, SIZE[0], (0, 0, 0), (780.0, 200.0)))

    def test_picked_dips_alone_are_shown(self):
        self.opened()
        self.model.view.show_dips = True
        some = self.dips()[5:12]
        self.refused(ops.dips_pick, "no dip was picked")
        bpy.ops.ed.undo_push(message="before")
        ops.dips_pick(dips=json.dumps([datum.text() for datum in some]))
        bpy.ops.ed.undo_push(message="picked")
        self.assertEqual(len(self.poles()), 7)
        (body,) = bodies.listed(self.scene, "dips")
        names = {slot.name.split(".")[0] for slot in body.material_slots}
        self.assertIn("Not Picked", names)
        path = self.folder / "some.svg"
        ops.save_stereonet(filepath=str(path))
        self.assertIn("7 poles", path.read_text())
        handle.activate(bpy.context, some[0])
        ops.datum_switch()
        self.assertEqual(len(self.poles()), 6)
        ops.data_switch_on()
        ops.dips_pick(dips="[]")
        self.assertEqual(len(self.poles()), 60)
        gone = some[0]._replace(place=(0.0, 0.0, 0.0)).text()
        self.refused(ops.dips_pick, "not there any more", dips=json.dumps([gone]))

    def test_a_pole_leads_to_its_dip(self):
        self.opened()
        middle, radius = small_net((SIZE[0] - 12.0, 95.0))
        for datum in self.dips()[::13]:
            pole = shown_net.normal_of(self.scene, datum)
            (place,) = projected(pole[None])
            at = place_in_net(self.scene, SIZE[0], (0.0, 0.0, 0.0), np.array(middle) + radius * place)
            nearest = shown_net.normal_of(self.scene, shown_net.datum_at(self.scene, at))
            self.assertLess(np.abs(nearest - pole).max(), 1e-6)
        self.assertIsNone(shown_net.datum_at(self.scene, np.array([0.0, 0.99])))
        before = len([item for item in self.overlay() if isinstance(item, Dots)])
        handle.activate(bpy.context, datum)
        self.assertEqual(len([item for item in self.overlay() if isinstance(item, Dots)]), before + 1)
