# SPDX-License-Identifier: GPL-3.0-or-later
"""Diagrams of structures: what lies on both sides of a fault, and stereonets of dips."""

import json

import bpy
import numpy as np
from bpy.props import EnumProperty, FloatProperty, StringProperty

from ..bl.display import sections, shown_models
from ..bl.field import data, edits, shown_net
from ..bl.objects import exaggeration, viewports
from ..bl.pictures import drawn_image
from ..bl.project import settings
from ..core import InputRefused
from ..core.exporters import JUXTAPOSITION, STEREONET
from ..core.results.faults.juxtaposition_drawing import draw_juxtaposition
from ..core.results.sections.section_drawing import MOST_EXAGGERATION
from .drawing import InViewport
from .field_data import NEAR, shown_places
from .files import Exporting, format_filter, format_menu
from .reporting import Reporting, a_fault, a_model

_EXAGGERATION = {
    "name": "Vertical Exaggeration",
    "description": "Factor by which elevations are exaggerated",
    "default": 1.0,
    "min": 0.01,
    "max": MOST_EXAGGERATION,
    "soft_max": 20.0,
}


def any_dips(context):
    return None if shown_net.are_there(context.scene) else "there are no dips; import some first"


def _exaggerate(operator, context):
    """Without a value of its own, an operator takes that of the scene."""
    if not operator.properties.is_property_set("exaggeration"):
        operator.exaggeration = exaggeration.factor(context.scene)


class REALMODEL_OT_save_juxtaposition(Exporting, bpy.types.Operator):
    """Save a drawing of the rocks on both sides of the active fault, along its strike, with its throw"""

    bl_label = "Save Juxtaposition"
    needs = (a_model, a_fault)

    format: format_menu(JUXTAPOSITION.formats(), "SVG")
    filter_glob: format_filter(JUXTAPOSITION.formats())
    exaggeration: FloatProperty(**_EXAGGERATION)

    def of_what(self, context):
        return (settings.active_structure(context.scene).name,)

    def invoke(self, context, event):
        _exaggerate(self, context)
        return super().invoke(context, event)

    def write(self, context, path):
        sides = self.model(context).juxtaposition(settings.active_structure(context.scene).name)
        sides.save(path, settings.plain(self.exaggeration))


class REALMODEL_OT_view_juxtaposition(Reporting, bpy.types.Operator):
    """Show the rocks on both sides of the active fault, along its strike, with its throw, in an image editor.
    Click again after a build"""

    bl_label = "View Juxtaposition"
    bl_options = {"REGISTER"}
    needs = (a_model, a_fault)

    exaggeration: FloatProperty(**_EXAGGERATION)

    def invoke(self, context, _event):
        _exaggerate(self, context)
        return self.execute(context)

    def act(self, context):
        name = settings.active_structure(context.scene).name
        sides = shown_models.whole(context.scene).juxtaposition(name)
        drawing = draw_juxtaposition(
            sections.colored(context.scene, sides), settings.plain(self.exaggeration)
        )
        drawn_image.show(context, drawn_image.image_of(f"Juxtaposition {name}", drawing))


class REALMODEL_OT_save_stereonet(Exporting, bpy.types.Operator):
    """Save a stereonet of dips, with their mean plane and fold axis"""

    bl_label = "Save Stereonet"
    needs = (any_dips,)

    format: format_menu(STEREONET.formats(), "SVG")
    filter_glob: format_filter(STEREONET.formats())
    net: EnumProperty(
        name="Net",
        description="How the lower hemisphere is projected",
        items=shown_net.NET_ITEMS,
    )
    of: StringProperty(
        name="Dips Of",
        description="Surface, block, series, rock mass or fault whose dips are drawn; empty: those that were "
        "picked, else all but those of faults",
    )

    def of_what(self, _context):
        return (self.of or "dips",)

    def invoke(self, context, event):
        view = context.scene.realmodel.view
        self.of, self.net = view.stereonet_of, view.net
        return super().invoke(context, event)

    def write(self, context, path):
        shown_net.shown_dips(context.scene, self.of.strip()).save(path, self.net.lower())


class REALMODEL_OT_dips_pick(InViewport, bpy.types.Operator):
    """Pick dips in the viewport: click them, or brush over them with the button held. The stereonet then
    shows only these"""

    bl_label = "Pick Dips"
    bl_options = {"UNDO"}
    needs = (any_dips,)
    keys = "Click dips, or brush over them"
    has_line = False

    dips: StringProperty(
        name="Dips",
        description="The data as texts, a JSON list; []: all dips again",
        options={"SKIP_SAVE"},
    )

    _shown = ()
    _numbers = ()

    def invoke(self, context, event):
        is_set = self.properties.is_property_set("dips")
        return self.execute(context) if is_set else super().invoke(context, event)

    def begin(self, context):
        self._shown, self._numbers = shown_places(context.scene, data.DIPS), []

    def clicked(self, context, area, at, is_held):
        groups, numbers, places = self._shown
        away = np.linalg.norm(viewports.pixels(area, places) - at, axis=1)
        near = [n for n in np.flatnonzero(away <= NEAR).tolist() if groups[n].used[numbers[n]]]
        self._numbers += [n for n in near if n not in self._numbers]
        self.dips = json.dumps([groups[n].datum(numbers[n]).text() for n in self._numbers])
        return None if near or is_held else "There is no dip here"

    def remove_last(self):
        del self._numbers[-1:]

    def marks(self, _context):
        return self._shown[2][self._numbers]

    def act(self, context):
        if not self.dips:
            raise InputRefused("no dip was picked", advice="click dips, then press Enter")
        dips = [data.Datum.of_text(text) for text in json.loads(self.dips)]
        for datum in dips:
            edits.find(context.scene, datum)
        shown_net.pick(context.scene, dips)
        context.scene.realmodel.view.show_stereonet = True
        context.scene.realmodel.view.stereonet_of = ""
