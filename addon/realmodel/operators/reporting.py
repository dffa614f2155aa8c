# SPDX-License-Identifier: GPL-3.0-or-later
"""What every operator of the panel shares: errors become reports, and files are looked for."""

from bpy.props import FloatVectorProperty

from ..bl import build_job, settings
from ..core import InputRefused, RealModelError


class Reporting:
    """An operator whose `act(context)` may raise RealModelError: it is reported, which is a RuntimeError in a
    script, and nothing was done."""

    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        try:
            return self.act(context) or {"FINISHED"}
        except RealModelError as error:
            self.report({"ERROR"}, build_job.message(error))
            return {"CANCELLED"}


def place_property(description):
    """A property of an operator: a place in the coordinates of the scene."""
    return FloatVectorProperty(name="Location", description=description, subtype="TRANSLATION")


def needed_rock(context):
    """The active rock mass's row. Raises InputRefused."""
    row = settings.active_rock(context.scene)
    if row is None:
        raise InputRefused("there is no rock mass", advice="add one first (Rock masses, +)")
    return row


def needed_surface(context):
    """The active surface's row. Raises InputRefused."""
    row = settings.active_surface(context.scene)
    if row is None:
        raise InputRefused("there is no surface", advice="add one first (Surfaces, +)")
    return row


def needed_model(context):
    """Raises InputRefused where nothing was built yet."""
    if not len(context.scene.realmodel.results):
        raise InputRefused("there is no model yet", advice="press Build first")


def needed_path(path, what):
    """Raises InputRefused where no file was named."""
    if not path.strip():
        raise InputRefused(f"no file for {what} was given", advice="choose a file name")
    return path
