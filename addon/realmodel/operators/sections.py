# SPDX-License-Identifier: GPL-3.0-or-later
"""Sections: the movable plane that shows the model cut open, and exact sections as mesh objects."""

import bpy
import numpy as np
from bpy.props import BoolProperty, EnumProperty, FloatProperty, FloatVectorProperty, StringProperty
from mathutils import Quaternion, Vector

from ..bl import display
from ..bl.display import cuts, sections
from ..bl.field import boreholes, hole_curves
from ..bl.objects import exaggeration, viewports, visible
from ..bl.project import interval_values, project_settings, settings
from ..bl.scene import section_holes
from ..core import InputRefused, UsageError
from ..core.exporters import SECTION, SHEETS
from ..core.results.sections.section_drawing import MOST_EXAGGERATION
from ..core.results.sheets import DEFAULT_SIZE, SHEET_SIZES
from .drawing import InViewport
from .files import Exporting, format_filter, format_menu
from .reporting import (
    Reporting,
    a_model,
    a_section_plane,
    an_outline_object,
    place_property,
    some_holes,
)

_UPRIGHT = {"X": (1.0, 0.0, 0.0), "Y": (0.0, -1.0, 0.0), "Z": (0.0, 0.0, 1.0)}


_ON_LINE = 1e-3  # of the length of a section through boreholes: what is so near is on it
_PIXELS = 20.0  # a borehole that is farther from the mouse is not meant
_FLAT = "Unroll the section beside the model instead of leaving it in its place"


def _show(operator, context, made):
    """Selects a new section alone, and reports its collection."""
    display.exaggeration_changed(context.scene)
    visible.select_alone(context, made)
    hidden = "" if operator.flat or cuts.is_on(context.scene) else "; blocks are in front of it"
    operator.report({"INFO"}, f"Section made: see {made.name}{hidden}")


def _is_given(operator):
    return any(operator.properties.is_property_set(key) for key in ("location", "normal"))


def _plane_of(operator, context):
    """The point and the normal given to an operator, else those of the section plane."""
    scene = context.scene
    if _is_given(operator):
        if not any(operator.normal):
            raise UsageError("the normal is zero: give the direction that is normal to the plane")
        return tuple(operator.location), tuple(operator.normal)
    if cuts.plane_of(scene) is None:
        raise InputRefused("there is no section plane", advice="add one first (Section Plane)")
    context.view_layer.update()
    point, normal = cuts.plane_in_model(scene)
    return tuple(point - project_settings.model_origin(scene)), normal


def _draw_plane(operator, context):
    """The point and the normal that an operator was given, or where the section plane is."""
    layout, scene = operator.layout, context.scene
    layout.use_property_split = True
    if _is_given(operator):
        is_near = not project_settings.model_origin(scene).any()
        layout.prop(operator, "location", text="Location" if is_near else "From Origin")
        layout.prop(operator, "normal")
    elif cuts.plane_of(scene) is not None:
        point, normal = cuts.plane_in_model(scene)
        column = layout.column(align=True)
        column.label(text="Section plane at")
        for name, value in zip(("East (x)", "North (y)", "Elevation (z)"), point, strict=True):
            column.label(text=f"{name}  {value:.3f}")
        column.label(text="Normal  {:.3f}  {:.3f}  {:.3f}".format(*normal.round(3) + 0.0))


_PLACE = place_property(
    "A point of the plane, in the coordinates of the scene: those of the model less its origin"
)
_NORMAL = FloatVectorProperty(
    name="Normal",
    description="Normal of the plane",
    subtype="XYZ",
    default=(0.0, -1.0, 0.0),
)


class REALMODEL_OT_section(Reporting, bpy.types.Operator):
    """Make an exact section of the model as a mesh object with the materials of its layers, at the section
    plane or at a given location"""

    bl_label = "Make Section"
    needs = (a_model,)

    location: _PLACE
    normal: _NORMAL
    flat: BoolProperty(name="Flat", description=_FLAT)

    def draw(self, context):
        self.layout.prop(self, "flat")
        _draw_plane(self, context)

    def act(self, context):
        section = sections.by_plane(context.scene, *_plane_of(self, context))
        _show(self, context, sections.add(context.scene, section, "Section", self.flat))


class REALMODEL_OT_fence(Reporting, bpy.types.Operator):
    """Make a mesh object of vertical sections along the active curve, mesh of edges, or fence"""

    bl_label = "Make Fence"
    needs = (a_model, an_outline_object)

    flat: BoolProperty(name="Flat", description=_FLAT)

    def act(self, context):
        line = sections.line_of(context.active_object)
        fence = sections.along(context.scene, line, context.evaluated_depsgraph_get())
        made = sections.add(context.scene, fence, "Fence", self.flat)
        made[sections.LINE] = line
        _show(self, context, made)


def chosen_holes(context):
    holes = context.scene.realmodel.view.section_holes.strip()
    return None if holes else "no boreholes are chosen; pick them first (Pick Holes)"


class REALMODEL_OT_pick_holes(InViewport, bpy.types.Operator):
    """Click boreholes in the viewport, in the order of the section"""

    bl_label = "Pick Holes"
    bl_options = {"UNDO"}
    needs = (some_holes,)
    keys = "Click a borehole"

    _names = ()
    _lines = None

    def begin(self, context):
        self._names, self._lines = [], section_holes.paths(context.scene)
        view = context.scene.realmodel.view
        view.show_boreholes = view.show_hole_names = True

    def clicked(self, context, area, at, is_held):
        if is_held:
            return None
        name = _nearest(context, self._lines, area, at)
        if name is None:
            return "There is no borehole here"
        if name not in self._names[-1:]:
            self._names.append(name)
        return ", ".join(self._names)

    def remove_last(self):
        del self._names[-1:]

    def marks(self, context):
        tops = [self._lines[name][0] for name in self._names]
        return project_settings.in_world(context.scene, tops)

    def act(self, context):
        if not self._names:
            raise InputRefused("no borehole was picked", advice="click boreholes, then press Enter")
        section_holes.choose(context.scene, self._names)


class REALMODEL_OT_hole_log(InViewport, bpy.types.Operator):
    """Click a borehole in the viewport to show its log beside the model, with intervals, picks and curves"""

    bl_label = "Hole Log"
    bl_options = {"UNDO"}
    needs = (some_holes,)
    keys = "Click a borehole"

    hole: StringProperty(
        name="Hole", description="Name of the borehole; empty: no log is shown", options={"SKIP_SAVE"}
    )

    def clicked(self, context, area, at, _is_held):
        self.hole = _nearest(context, section_holes.paths(context.scene), area, at) or ""
        return None if self.hole else "There is no borehole here"

    def _take(self, context, event):
        result = super()._take(context, event)
        if not self.hole:
            return result
        self.leave(context, {})
        return self.execute(context)

    def marks(self, _context):
        return np.empty((0, 3))

    def act(self, context):
        if self.hole and self.hole not in section_holes.paths(context.scene):
            raise InputRefused(f"there is no borehole '{self.hole}'")
        context.scene.realmodel.view.log_hole = self.hole


def _nearest(context, lines, area, at):
    """The name of the borehole at a position in a viewport, or None. lines: {name: its line}."""
    best = _PIXELS, None
    for name, line in lines.items():
        seen = viewports.pixels(area, project_settings.in_world(context.scene, line))
        seen = seen[np.isfinite(seen).all(axis=1)]
        best = min(best, (_distance(np.array(at, float), seen), name), key=lambda pair: pair[0])
    return best[1]


def _distance(at, line):
    """How far a position is from a line (N, 2)."""
    if not len(line):
        return np.inf
    begin, way = line[:-1], np.diff(line, axis=0)
    share = ((at - begin) * way).sum(axis=1) / np.maximum((way**2).sum(axis=1), 1e-12)
    feet = np.vstack([line[:1], begin + np.clip(share, 0.0, 1.0)[:, None] * way])
    return float(np.linalg.norm(feet - at, axis=1).min())


class REALMODEL_OT_fence_holes(Reporting, bpy.types.Operator):
    """Make vertical sections of the model through the chosen boreholes, as a mesh object"""

    bl_label = "Section through Holes"
    needs = (a_model, chosen_holes)

    flat: BoolProperty(name="Flat", description=_FLAT)

    def act(self, context):
        section = sections.through(context.scene, section_holes.line(context.scene))
        _show(self, context, sections.add(context.scene, section, "Holes", self.flat))


class _DrawsSections(Exporting):
    """Writes drawings of sections; it begins with what is set for the viewport."""

    exaggeration: FloatProperty(
        name="Vertical Exaggeration",
        description="Factor by which heights are exaggerated",
        default=1.0,
        min=0.01,
        max=MOST_EXAGGERATION,
        soft_max=20.0,
    )
    hole_width: FloatProperty(
        name="Holes Within",
        description="Draw the boreholes within this distance of the section; 0: none, but those that it goes "
        "through",
        min=0.0,
        subtype="DISTANCE",
    )
    hole_column: StringProperty(
        name="Curve Beside",
        description="Column of numbers of the intervals, or curve of the logs, that is drawn beside the "
        "boreholes; empty: none",
        search=lambda _properties, context, _text: boreholes.columns(context.scene),
    )

    def invoke(self, context, event):
        if not self.properties.is_property_set("exaggeration"):
            self.exaggeration = exaggeration.factor(context.scene)
        if not self.properties.is_property_set("hole_width"):
            self.hole_width = context.scene.realmodel.view.hole_width
        shows = self.hole_width > 0.0 and hole_curves.is_wanted(context.scene)
        if shows and not self.properties.is_property_set("hole_column"):
            self.hole_column = boreholes.column(context.scene)
        return super().invoke(context, event)

    def draw_options(self):
        for name in ("exaggeration", "hole_width", "hole_column"):
            self.layout.prop(self, name)

    def of_sections(self, width=0.0):
        """How sections are drawn. width: boreholes within this distance are drawn anyway."""
        width = max(width, settings.plain(self.hole_width))
        return settings.plain(self.exaggeration), width, self.hole_column.strip() or None


class REALMODEL_OT_save_section(_DrawsSections, bpy.types.Operator):
    """Save a section as a drawing with axes, legend, and scale, or as polygons"""

    bl_label = "Save Section"
    needs = (a_model,)

    format: format_menu(SECTION.formats(), "SVG")
    filter_glob: format_filter(SECTION.formats())
    location: _PLACE
    normal: _NORMAL
    along: EnumProperty(
        name="Along",
        description="Where the model is cut",
        items=(
            ("PLANE", "Section Plane", "The section plane, or the location and normal that are given"),
            ("LINE", "Active Curve", "Vertical sections along the active curve or mesh of edges"),
            ("HOLES", "Boreholes", "Vertical sections through the chosen boreholes"),
        ),
    )

    def of_what(self, _context):
        return ("section",)

    def draw(self, context):
        for name in ("format", "along"):
            self.layout.prop(self, name)
        if self.along == "PLANE":
            _draw_plane(self, context)
        self.draw_options()

    def write(self, context, path):
        width = 0.0
        if self.along == "PLANE":
            section = sections.by_plane(context.scene, *_plane_of(self, context))
        elif self.along == "HOLES":
            if reason := chosen_holes(context):
                raise InputRefused(reason)
            section = sections.through(context.scene, section_holes.line(context.scene))
            width = _ON_LINE * section.length
        else:
            reason = an_outline_object(context)
            if reason:
                raise InputRefused(reason)
            line = sections.line_of(context.active_object)
            section = sections.along(context.scene, line, context.evaluated_depsgraph_get())
        section.hole_values = interval_values.of_scene(context.scene)
        section.save(path, *self.of_sections(width))


class REALMODEL_OT_save_sheets(_DrawsSections, bpy.types.Operator):
    """Save sheets to print: the geological map, and the sections of the section plane, of each fence, and
    through the chosen boreholes. They have one scale, a frame, a legend and a title block"""

    bl_label = "Save Sheets"
    needs = (a_model,)

    format: format_menu(SHEETS.formats(), "PDF")
    filter_glob: format_filter(SHEETS.formats())
    size: EnumProperty(
        name="Paper",
        description="Size of the sheets",
        items=[
            (size, size.replace("-portrait", ", Portrait"), f"{width} mm wide, {height} mm high")
            for size, (width, height) in SHEET_SIZES.items()
        ],
        default=DEFAULT_SIZE,
    )
    scale: FloatProperty(
        name="Scale 1 :",
        description="Number of the scale of map and sections; 0: the largest round scale at which they fit",
        min=0.0,
    )

    def of_what(self, _context):
        return ("sheets",)

    def draw(self, _context):
        for name in ("format", "size", "scale"):
            self.layout.prop(self, name)
        self.draw_options()

    def write(self, context, path):
        made = list(_of_scene(context))
        for section in made:
            section.hole_values = interval_values.of_scene(context.scene)
        scale = settings.plain(self.scale) or None
        self.model(context).save_sheets(path, made, self.size, scale, *self.of_sections())


def _of_scene(context):
    """The sections of a scene: by the section plane, along the line of each fence, through the chosen
    boreholes."""
    scene = context.scene
    if cuts.plane_of(scene) is not None:
        context.view_layer.update()
        point, normal = cuts.plane_in_model(scene)
        yield sections.by_plane(scene, point - project_settings.model_origin(scene), normal)
    lines = {
        item[sections.LINE].name: item[sections.LINE] for item in scene.objects if item.get(sections.LINE)
    }
    for line in lines.values():
        yield sections.along(scene, line, context.evaluated_depsgraph_get())
    if chosen_holes(context) is None:
        yield sections.through(scene, section_holes.line(scene))


class REALMODEL_OT_section_plane(Reporting, bpy.types.Operator):
    """Cut the model along a plane. Move, rotate and keyframe the plane like any object"""

    bl_label = "Section Plane"
    needs = (a_model,)

    axis: EnumProperty(
        name="Axis",
        description="Normal of the plane",
        items=(
            ("Y", "South", "Upright, seen from the south"),
            ("X", "East", "Upright, seen from the east"),
            ("Z", "Above", "Level, seen from above"),
        ),
    )

    def act(self, context):
        scene = context.scene
        view = scene.realmodel.view
        plane = cuts.plane_of(scene)
        if plane is None:
            plane = cuts.add_plane(scene)
        if self.properties.is_property_set("axis") or view.plane != plane:
            turn = Vector(_UPRIGHT[self.axis]).to_track_quat("Z", "Y")
            plane.rotation_mode = "XYZ"
            plane.rotation_euler = turn.to_euler() if self.axis != "Z" else Quaternion().to_euler()
        with settings.filling():
            view.plane, view.use_section = plane, True
        context.view_layer.update()
        visible.select_alone(context, plane)
        display.section_changed(scene)


class REALMODEL_OT_section_flip(Reporting, bpy.types.Operator):
    """Flip the section plane, so that the cut removes the other side"""

    bl_label = "Flip Section Plane"
    needs = (a_section_plane,)

    def act(self, context):
        plane = cuts.plane_of(context.scene)
        location = plane.location.copy()
        plane.matrix_basis = plane.matrix_basis @ Quaternion((0.0, 1.0, 0.0, 0.0)).to_matrix().to_4x4()
        plane.location = location
        context.view_layer.update()
        display.section_changed(context.scene)


def _a_cut(context):
    is_shown = cuts.is_on(context.scene)
    return None if is_shown else "no cut is shown; add a section plane and switch Show Cut on"


class REALMODEL_OT_section_update(Reporting, bpy.types.Operator):
    """Cut the model along the section plane at once, without the pause. For scripts"""

    bl_label = "Cut at Section Plane"
    needs = (a_model, _a_cut)

    def act(self, context):
        cuts.cut_now(context.scene)
        display.mode_changed(context.scene)


class REALMODEL_OT_section_remove(Reporting, bpy.types.Operator):
    """Remove the section plane and show the whole model"""

    bl_label = "Remove Section Plane"
    needs = (a_section_plane,)

    def act(self, context):
        cuts.remove_plane(context.scene)
        display.section_changed(context.scene)
