# SPDX-License-Identifier: GPL-3.0-or-later
"""Diagrams of structures: what lies on both sides of a fault, and stereonets of dips."""

import bpy
from bpy.props import EnumProperty, FloatProperty, StringProperty

from ..bl.display import sections
from ..bl.objects import exaggeration
from ..bl.project import settings
from ..core.exporters import JUXTAPOSITION, STEREONET
from ..core.results.orientations.stereonet import NETS
from ..core.results.sections.section_drawing import MOST_EXAGGERATION
from .files import Exporting, format_filter, format_menu
from .reporting import a_fault, a_model


class REALMODEL_OT_save_juxtaposition(Exporting, bpy.types.Operator):
    """Save a drawing of what lies on both sides of the active fault, along its strike, with its throw"""

    bl_label = "Save Juxtaposition"
    needs = (a_model, a_fault)

    format: format_menu(JUXTAPOSITION.formats(), "SVG")
    filter_glob: format_filter(JUXTAPOSITION.formats())
    exaggeration: FloatProperty(
        name="Vertical Exaggeration",
        description="Factor by which elevations are exaggerated",
        default=1.0,
        min=0.01,
        max=MOST_EXAGGERATION,
        soft_max=20.0,
    )

    def of_what(self, context):
        return (settings.active_structure(context.scene).name,)

    def invoke(self, context, event):
        if not self.properties.is_property_set("exaggeration"):
            self.exaggeration = exaggeration.factor(context.scene)
        return super().invoke(context, event)

    def write(self, context, path):
        sides = self.model(context).juxtaposition(settings.active_structure(context.scene).name)
        sections.colored(context.scene, sides).save(path, settings.plain(self.exaggeration))


class REALMODEL_OT_save_stereonet(Exporting, bpy.types.Operator):
    """Save a stereonet of the dips that the model was built from, with their mean plane and fold axis"""

    bl_label = "Save Stereonet"
    needs = (a_model,)

    format: format_menu(STEREONET.formats(), "SVG")
    filter_glob: format_filter(STEREONET.formats())
    net: EnumProperty(
        name="Net",
        description="How the lower hemisphere is projected",
        items=tuple((name.upper(), label.capitalize(), "") for name, label in NETS.items()),
    )
    of: StringProperty(
        name="Dips Of",
        description="Surface, block, series, rock mass or fault whose dips are drawn; empty: all but those "
        "of faults",
    )

    def of_what(self, _context):
        return (self.of or "dips",)

    def write(self, context, path):
        self.model(context).stereonet(self.of.strip() or None).save(path, self.net.lower())
