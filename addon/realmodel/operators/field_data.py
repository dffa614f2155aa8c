# SPDX-License-Identifier: GPL-3.0-or-later
"""One datum at a time: picked in the viewport, shown, switched off or on."""

import bpy
import numpy as np

from ..bl.field import data, edits, handle, heights, shown_net
from ..bl.objects import viewports
from ..bl.overlay import viewport as overlay
from ..bl.pictures import capture
from ..bl.project import project_settings
from ..bl.scene import data_objects, live
from ..core import InputRefused
from .drawing import Pointing
from .reporting import Reporting, place_property

NEAR = 24  # pixels between the mouse and a datum, at most


def any_data(context):
    return None if data.are_there(context.scene) else "there are no field data; import some first"


def a_datum(context):
    has_datum = handle.active(context.scene) is not None
    return None if has_datum else "no datum is active; pick one first"


def any_switched_off(context):
    return None if data.switched_off(context.scene) else "no datum is switched off"


def shown_places(scene, kinds=data.KINDS):
    """(groups, numbers, places): of each datum of these kinds its Group, its number in that, and where it is
    shown, (N, 3)."""
    groups, numbers, places = [], [], [np.empty((0, 3))]
    for group in data.groups(scene, kinds):
        at = group.places.copy()
        if group.kind in data.DIPS:
            at[:, 2] = heights.of_dips(scene, group.rock, group.names, at)
        groups += [group] * len(at)
        numbers += range(len(at))
        places.append(at)
    return groups, numbers, project_settings.in_world(scene, np.concatenate(places))


def _changed(scene):
    """The settings of a datum were changed: all that shows it, and the model, follow."""
    handle.follow(scene)
    data_objects.update(scene)
    live.touch(scene)


class REALMODEL_OT_datum_pick(Pointing, bpy.types.Operator):
    """Pick a datum in the viewport to move it or to switch it off: a point, a dip, an outcrop, an interval,
    or a pole in the stereonet. Move its sphere like any object (G)"""

    bl_label = "Pick Datum"
    needs = (any_data,)

    location: place_property("Where the datum is, in the coordinates of the scene: the nearest is picked")

    def act(self, context):
        has_location = self.properties.is_property_set("location")
        at = np.array(self.location if has_location else context.scene.cursor.location)
        groups, numbers, places = shown_places(context.scene)
        if not groups:
            raise InputRefused("there are no data with a place", advice="import points, boreholes or dips")
        best = int(np.linalg.norm(places - at, axis=1).argmin())
        self._activate(context, groups[best].datum(numbers[best]))

    def invoke(self, context, _event):
        if bpy.app.background or capture.viewport(context) is None:
            return self.execute(context)
        return self.wait(context, "EYEDROPPER", "Pick Datum: click at a datum     Esc: leave")

    def modal(self, context, event):
        if event.type in {"ESC", "RIGHTMOUSE"}:
            return self.leave(context, {"CANCELLED"})
        if event.type == "LEFTMOUSE" and event.value == "PRESS":
            datum = _under_mouse(context, event)
            if datum is None:
                self.report({"INFO"}, "no datum is here; click nearer to one")
                return {"RUNNING_MODAL"}
            self._activate(context, datum)
            return self.leave(context, {"FINISHED"})
        return {"PASS_THROUGH"}

    def _activate(self, context, datum):
        handle.activate(context, datum)
        self.report({"INFO"}, handle.text_of(context.scene, datum))


def _under_mouse(context, event):
    """The datum nearest to the mouse in whatever 3D viewport that is, in its stereonet the nearest pole; None
    where none is near."""
    viewport = viewports.under_mouse(context, event)
    if viewport is None:
        return None
    area, mouse = viewport
    in_net = overlay.at_net(context.scene, area, mouse)
    if in_net is not None:
        return shown_net.datum_at(context.scene, in_net)
    groups, numbers, places = shown_places(context.scene)
    away = np.linalg.norm(viewports.pixels(area, places) - mouse, axis=1)
    if not (len(away) and away.min() <= NEAR):
        return None
    best = int(away.argmin())
    return groups[best].datum(numbers[best])


class REALMODEL_OT_datum_switch(Reporting, bpy.types.Operator):
    """Switch the active datum off, or on. A datum that is switched off stays in the file, but builds do not
    use it"""

    bl_label = "Switch Datum Off or On"
    needs = (a_datum,)

    def act(self, context):
        scene = context.scene
        datum = edits.switch(scene, handle.active(scene), not handle.active(scene).used)
        scene.realmodel.view.datum = datum.text()
        _changed(scene)
        self.report({"INFO"}, f"{handle.text_of(scene, datum)}: {'used' if datum.used else 'switched off'}")


class REALMODEL_OT_data_switch_on(Reporting, bpy.types.Operator):
    """Switch on all data that are switched off"""

    bl_label = "Switch All On"
    needs = (any_switched_off,)

    def act(self, context):
        count = edits.switch_all_on(context.scene)
        datum = handle.active(context.scene)
        if datum is not None:
            context.scene.realmodel.view.datum = datum._replace(used=True).text()
        _changed(context.scene)
        self.report({"INFO"}, f"Data used again: {count}")


class REALMODEL_OT_datum_show(Reporting, bpy.types.Operator):
    """Turn the viewport to the active datum, and select it"""

    bl_label = "Show Datum"
    needs = (a_datum,)

    def act(self, context):
        handle.activate(context, handle.active(context.scene), jumps=True)


class REALMODEL_OT_datum_leave(Reporting, bpy.types.Operator):
    """Deselect the active datum and remove its sphere"""

    bl_label = "Leave Datum"
    needs = (a_datum,)

    def act(self, context):
        handle.clear(context.scene)


class REALMODEL_OT_misfit_show(Reporting, bpy.types.Operator):
    """Turn the viewport to the active misfit, and pick its datum"""

    bl_label = "Show Misfit"
    needs = (any_data,)

    def act(self, context):
        group = context.scene.realmodel
        if not 0 <= group.active_misfit < len(group.misfits):
            raise InputRefused("no row of the list is active", advice="switch Misfits on, and choose a row")
        handle.show_misfit(context)
