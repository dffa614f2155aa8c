# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of surfaces of the active rock mass."""

import bpy
from bpy.props import BoolProperty, EnumProperty

from ..bl import changes
from ..bl.project import borehole_picks, library_rows, settings
from ..bl.scene import built_scene, data_objects, live
from ..core import InputRefused
from ..core.surfaces.age_order import age_order
from .reporting import Reporting, a_fault, a_surface, remove_row, row_number


class REALMODEL_OT_surface_remove(Reporting, bpy.types.Operator):
    """Remove the active surface. Your own mesh stays in the scene"""

    bl_label = "Remove Surface"
    needs = (a_surface,)

    terrain: BoolProperty(
        name="Terrain",
        description="Remove the terrain of the rock mass in the place of the active surface",
        options={"SKIP_SAVE", "HIDDEN"},
    )

    def act(self, context):
        scene = context.scene
        rock = settings.active_rock(scene)
        row = settings.terrain_of(rock) if self.terrain else settings.active_surface(scene)
        if row is None:
            raise InputRefused("the rock mass has no terrain")
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
            row.is_terrain = False
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
    """Sort the surfaces of the rock mass by age: at the same position the older surface is the lower one. If
    points do not decide, sort by name"""

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
    """Hide the interface of the active surface in the viewport, or show it again. Builds still use it"""

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


class REALMODEL_OT_structure_add(Reporting, bpy.types.Operator):
    """Add a structure to the variogram of the active surface, which becomes nested"""

    bl_label = "Add Structure"
    needs = (a_surface,)

    def act(self, context):
        surface = settings.active_surface(context.scene)
        with settings.filling():
            surface.fit_variogram = False
            if not len(surface.structures):
                _take_single(surface)
            else:
                last = surface.structures[-1]
                values = last.model, 2.0 * last.range, last.sill
                part = surface.structures.add()
                part.model, part.range, part.sill = values
        live.touch(context.scene)


def _take_single(surface):
    """The variogram that was there is the first part; its sill includes the nugget, a part's does not."""
    part = surface.structures.add()
    part.model, part.range = surface.variogram_model, surface.variogram_range
    part.sill = max(surface.variogram_sill - surface.variogram_nugget, 0.0)


class REALMODEL_OT_structure_remove(Reporting, bpy.types.Operator):
    """Remove a structure from the variogram of the active surface"""

    bl_label = "Remove Structure"
    needs = (a_surface,)

    index: row_number()

    def act(self, context):
        remove_row(settings.active_surface(context.scene).structures, self.index, "structure")
        live.touch(context.scene)


_OF_FAULT = BoolProperty(name="Of Fault", description="Of the active fault", options={"SKIP_SAVE"})


def _a_file(context):
    return a_surface(context) and a_fault(context)


def _filtered(context, of_fault):
    """The row whose file the filters are of. Raises InputRefused where there is none."""
    reason = (a_fault if of_fault else a_surface)(context)
    if reason:
        raise InputRefused(reason)
    return (settings.active_structure if of_fault else settings.active_surface)(context.scene)


class REALMODEL_OT_filter_add(Reporting, bpy.types.Operator):
    """Read only rows of the file with a certain value in a column. Values of one column are alternatives"""

    bl_label = "Add Filter"
    needs = (_a_file,)

    of_fault: _OF_FAULT

    def act(self, context):
        _filtered(context, self.of_fault).filters.add()


class REALMODEL_OT_filter_remove(Reporting, bpy.types.Operator):
    """Remove a filter from the active surface, or fault"""

    bl_label = "Remove Filter"
    needs = (_a_file,)

    index: row_number()
    of_fault: _OF_FAULT

    def act(self, context):
        surface = _filtered(context, self.of_fault)
        remove_row(surface.filters, self.index, "filter")
        changes.reading(surface, context)
