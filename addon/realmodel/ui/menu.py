# SPDX-License-Identifier: GPL-3.0-or-later
"""RealModel in Blender's own menus, where F3 finds it: Add, Object, View, File > Import and Export."""

import bpy

from ..bl.objects.boolean_job import OPERATIONS
from ..bl.scene import samples
from ..bl.shading.strata_presets import SHAPES

# (operator without "realmodel.", text or None for its label, properties); None: a line
_SURFACE_OF_OBJECT = ("surface_add", "Surface from Active Object", {"use_object": True})
_EXPORT = (
    ("save_project", "RealModel Project (.toml)", {}),
    ("export", "RealModel Model (cells, shapes, grids, maps)", {}),
    ("export_mesh", "RealModel Simulation Mesh (prisms, tetrahedra)", {}),
    ("export_scene", "RealModel Scene with Looks (glTF, USD, OBJ)", {}),
    ("report", "RealModel Report (.json/.csv)", {}),
)
_IMPORT = (
    ("open_project", "RealModel Project or Model (.toml/.npz)", {}),
    ("surface_add", "RealModel Surfaces (points, meshes, grids, maps)", {}),
    ("fault_body_add", "RealModel Faults and Bodies (meshes, fault sticks)", {}),
    ("boreholes_read", "RealModel Boreholes (.csv/.txt/.omf/.geoh5)", {}),
    ("tiles_read", "RealModel Tiles (tiles.toml)", {}),
)


class _Menu:
    """A submenu "RealModel" of one of Blender's menus."""

    bl_label = "RealModel"

    def draw(self, context):
        self.layout.operator_context = "INVOKE_DEFAULT"
        _draw(self.layout, self.entries(context))


class REALMODEL_MT_add(_Menu, bpy.types.Menu):
    """Begin a model, or add to it"""

    def entries(self, context):
        yield "new", None, {}
        for sample, name, *_ in samples.enum_items(None, context):
            yield "open_sample", f"Example: {name}", {"sample": sample}
        yield None
        yield "rock_add", "Rock Mass", {}
        yield "surface_add", "Surfaces from Files...", {}
        yield _SURFACE_OF_OBJECT
        yield "fault_body_add", "Faults and Bodies from Files...", {}
        yield "boreholes_read", "Boreholes from File...", {}
        yield "region_around", None, {}
        yield None
        for axis, name in (("Y", "South"), ("X", "East"), ("Z", "Above")):
            yield "section_plane", f"Section Plane: {name}", {"axis": axis}
        yield "section", "Section", {}


class REALMODEL_MT_add_rock(_Menu, bpy.types.Menu):
    """Rocks with strata, to sculpt and to render"""

    bl_label = "Strata"

    def entries(self, _context):
        for kind, (name, *_) in SHAPES.items():
            yield "strata_rock_add", f"Strata {name}", {"kind": kind}


class REALMODEL_MT_object(_Menu, bpy.types.Menu):
    """Build the model; what can be done with the selected objects"""

    def entries(self, _context):
        yield "build", None, {}
        yield "show_problem", None, {}
        yield "clear", None, {}
        yield None
        yield "from_selected", None, {}
        yield _SURFACE_OF_OBJECT
        yield "fault_body_from_selected", "Faults and Bodies from Selected", {}
        yield "constraint_add", "Constraint from Active Object", {}
        yield "size_add", "Refinement at Active Object", {}
        yield None
        yield "edit_surface", "Edit Active Surface", {}
        yield "fault_body_edit", "Edit Active Fault or Body", {}
        yield "assign_property", "Assign Active Property", {}
        yield "weathering", None, {}
        yield "weathering_remove", None, {}
        yield "unwrap", None, {}
        yield "bake_looks", "Bake Looks...", {}
        yield "install_looks", None, {}
        yield None
        for operation, name, *_ in OPERATIONS:
            yield "boolean", f"Boolean: {name}", {"operation": operation}
        yield "fill_with_strata", "Fill with Strata...", {}


class REALMODEL_MT_view(_Menu, bpy.types.Menu):
    """How the model is looked at"""

    def entries(self, _context):
        yield "view_all", None, {}
        for direction in ("FRONT", "BACK", "LEFT", "RIGHT", "TOP", "BOTTOM"):
            yield "view", f"Model from {direction.capitalize()}", {"direction": direction}
        yield "view_previous", None, {}
        yield "view_next", None, {}
        yield None
        yield "section_flip", None, {}
        yield "section_remove", None, {}
        yield "surface_hide", "Hide or Show Active Surface", {}
        yield "fault_body_hide", "Hide or Show Active Fault or Body", {}
        yield "hide_property", "Show Blocks of All Properties", {"action": "ALL"}
        yield None
        yield "coordinates", None, {}
        yield "capture", None, {}
        yield None
        yield "set_up_picture", None, {}
        yield "turntable", None, {}
        yield "animate_stages", None, {}
        yield "render_picture", None, {}


def _draw(layout, entries):
    for entry in entries:
        if entry is None:
            layout.separator()
            continue
        name, text, properties = entry
        made = layout.operator(f"realmodel.{name}", **({} if text is None else {"text": text}))
        for key, value in properties.items():
            setattr(made, key, value)


def _submenu(cls):
    def draw(self, _context):
        self.layout.separator()
        self.layout.menu(cls.__name__)

    return draw


def _flat(entries):
    def draw(self, _context):
        _draw(self.layout, entries)

    return draw


_IN_BLENDER = (  # its menu, what is drawn at the end of it
    ("VIEW3D_MT_add", _submenu(REALMODEL_MT_add)),
    ("VIEW3D_MT_add", _submenu(REALMODEL_MT_add_rock)),
    ("VIEW3D_MT_object", _submenu(REALMODEL_MT_object)),
    ("VIEW3D_MT_edit_mesh", _submenu(REALMODEL_MT_object)),
    ("VIEW3D_MT_view", _submenu(REALMODEL_MT_view)),
    ("TOPBAR_MT_file_import", _flat(_IMPORT)),
    ("TOPBAR_MT_file_export", _flat(_EXPORT)),
)


def register():
    for menu, draw in _IN_BLENDER:
        getattr(bpy.types, menu).append(draw)


def unregister():
    for menu, draw in _IN_BLENDER:
        getattr(bpy.types, menu).remove(draw)
