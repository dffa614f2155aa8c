# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of surfaces of the active rock mass."""

import bpy
from bpy.props import EnumProperty

from ..bl.project import borehole_picks, library_rows, settings
from ..bl.scene import built_scene, data_objects, live
from ..core.surfaces.age_order import age_order
from .reporting import Reporting, a_surface


class REALMODEL_OT_surface_remove(Reporting, bpy.types.Operator):
    """Remove the active surface; a mesh that you brought stays in the scene"""

    bl_label = "Remove Surface"
    needs = (a_surface,)

    def act(self, context):
        scene = context.scene
        row, rock = settings.active_surface(context.scene), settings.active_rock(scene)
        number = list(rock.surfaces).index(row)
        with settings.filling():
            library_rows.remove_made(scene, row)
            built_scene.release_surface(scene, row)
            rock.surfaces.remove(number)
            rock.active_surface = max(0, min(number, len(rock.surfaces) - 1))
        data_objects.update(scene)
        live.touch(scene)


class REALMODEL_OT_surface_copy(Reporting, bpy.types.Operator):
    """Add a copy of the active surface just above it, from the same source"""

    bl_label = "Copy Surface"
    needs = (a_surface,)

    def act(self, context):
        rock, chosen = settings.active_rock(context.scene), settings.active_surface(context.scene)
        number = list(rock.surfaces).index(chosen)
        row = rock.surfaces.add()
        source = rock.surfaces[number]
        settings.copy_row(source, row)
        with settings.filling():
            row.name = settings.free_name(rock.surfaces, source.name, own=row)
            row.interface, row.interface_digest, row.figures, row.block = None, "", "", ""
            if row.source in ("POINTS_FILE", "MESH_FILE"):
                row.object = None
            rock.surfaces.move(len(rock.surfaces) - 1, number + 1)
            rock.active_surface = number + 1
        live.touch(context.scene)


class REALMODEL_OT_surface_move(Reporting, bpy.types.Operator):
    """Make the active surface younger (up) or older (down)"""

    bl_label = "Move Surface"
    needs = (a_surface,)

    direction: EnumProperty(
        name="Direction",
        description="Which way it moves in the list",
        items=(
            ("UP", "Up", "Make it younger: up in the list, as in the field"),
            ("DOWN", "Down", "Make it older: down in the list"),
        ),
    )

    def act(self, context):
        rock = settings.active_rock(context.scene)
        number = rock.active_surface
        target = number + (1 if self.direction == "UP" else -1)
        if not 0 <= target < len(rock.surfaces):
            return {"CANCELLED"}
        rock.surfaces.move(number, target)
        rock.active_surface = target
        live.touch(context.scene)
        return {"FINISHED"}


class REALMODEL_OT_surface_sort(Reporting, bpy.types.Operator):
    """Sort the surfaces of the rock mass by age, as their points show it: the older one is the lower one at
    the same places. Where points do not decide, by name"""

    bl_label = "Sort Surfaces"
    needs = (a_surface,)

    def act(self, context):
        scene, rock = context.scene, settings.active_rock(context.scene)
        depsgraph = context.evaluated_depsgraph_get()
        names = [row.name for row in rock.surfaces]
        points = [data_objects.row_points(scene, row, depsgraph) for row in rock.surfaces]
        order = age_order(names, points, borehole_picks.of_rock(rock))
        now, active = list(range(len(names))), rock.active_surface
        for target, number in enumerate(order.order):
            rock.surfaces.move(now.index(number), target)
            now.insert(target, now.pop(now.index(number)))
        rock.active_surface = now.index(active) if active in now else 0
        live.touch(scene)
        if (text := order.warning(names)) is not None:
            self.report({"WARNING"}, text)
        if list(order.order) == sorted(order.order):
            self.report({"INFO"}, "The surfaces were in this order already")
            return
        self.report({"INFO"}, f"Oldest first: {', '.join(names[number] for number in order.order)}")


class REALMODEL_OT_surface_hide(Reporting, bpy.types.Operator):
    """Hide the active surface's interface in the viewport, or show it again; it is built all the same"""

    bl_label = "Hide or Show Surface"
    needs = (a_surface,)

    def act(self, context):
        row = settings.active_surface(context.scene)
        row.hide = not row.hide


_property_items = []  # Blender does not keep the texts of dynamic enums itself


def library_items(_operator, context):
    """The entries of the library as items of an enum, and that there is none."""
    rows = context.scene.realmodel.library if context else ()
    _property_items[:] = [("0", "None", "No property", 0)]
    _property_items.extend(
        (str(row.id), f"{row.name} ({row.id})", row.description, number) for number, row in enumerate(rows, 1)
    )
    return _property_items


class REALMODEL_OT_surface_property(Reporting, bpy.types.Operator):
    """Choose the property of the rock beneath the active surface from the library"""

    bl_label = "Property of the Surface"
    needs = (a_surface,)

    property_id: EnumProperty(name="Property", description="The entry of the library", items=library_items)

    def act(self, context):
        settings.active_surface(context.scene).property_id = int(self.property_id)
