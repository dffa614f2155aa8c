# SPDX-License-Identifier: GPL-3.0-or-later
"""Every panel and menu is drawn in every state of a scene. Drawing changes nothing and reads no file."""

import sys
import unittest
from unittest import mock

import bpy
import numpy as np
from blender_state import empty_file, inventory
from boolean_case import ball
from panel_case import PanelCase, ops, select, sheet, stack
from realmodel import preferences
from realmodel.bl.display import ensembles
from realmodel.bl.field import profiles
from realmodel.bl.project import settings
from realmodel.bl.scene import quality, samples
from realmodel.core.settings.methods import METHODS
from realmodel.core.settings.series_kinds import FIELD
from recording_layout import Drawing, Layout, Refused, draw, draw_tab

_opened = None  # files that are opened while a panel is drawn; None: none is


def _hook(event, arguments):
    if event == "open" and _opened is not None:
        _opened.append(str(arguments[0]))


sys.addaudithook(_hook)
BLENDERS_MENUS = (
    "VIEW3D_MT_add",
    "VIEW3D_MT_object",
    "VIEW3D_MT_edit_mesh",
    "VIEW3D_MT_view",
    "TOPBAR_MT_file_import",
    "TOPBAR_MT_file_export",
    "TOPBAR_MT_help",
)
COARSER = 4.0
OF_MORE_CELLS = ("castle_hill", "fault_blocks", "rift_basin")  # where the mesh is coarser
BY_SCRIPT = {"realmodel.section_update", "realmodel.propose_project"}  # operators that no button is for


def settings_of(group):
    """All values of a property group, those within it too."""
    found = {}
    for prop in group.bl_rna.properties:
        value = None if prop.identifier == "rna_type" else getattr(group, prop.identifier)
        if isinstance(value, bpy.types.PropertyGroup):
            value = settings_of(value)
        elif prop.type == "COLLECTION":
            value = [settings_of(row) for row in value]
        elif getattr(prop, "is_array", False):
            value = tuple(value)
        found[prop.identifier] = value
    return found


class States(PanelCase):
    def draw(self):
        """The Drawing of the whole tab and all menus."""
        global _opened
        before = settings_of(self.model), inventory()
        _opened = []
        try:
            drawing = draw_tab(bpy.context)
            for name in BLENDERS_MENUS:
                for function in getattr(bpy.types, name)._dyn_ui_initialize():
                    if function.__module__.startswith("realmodel"):
                        owner = type("Menu", (), {"layout": Layout(drawing, bpy.context)})()
                        function(owner, bpy.context)
            opened, _opened = _opened, None
        finally:
            _opened = None
        self.assertEqual(opened, [], "files were read to draw")
        self.assertEqual((settings_of(self.model), inventory()), before)
        return drawing

    def test_empty(self):
        self.assertIn("realmodel.open_sample", self.draw().operators)

    def test_a_new_model(self):
        ops.new()
        self.draw()
        ops.rock_add()
        self.draw()
        ops.surface_add(empty=True)
        self.draw()

    def test_examples_before_and_after_the_build(self):
        for sample, *_ in samples.enum_items(None, None):
            with self.subTest(sample):
                empty_file()
                ops.open_sample(sample=sample, build=False)
                self.draw()
                for rock in self.model.rocks:  # what is drawn does not depend on how fine the meshes are
                    if sample not in OF_MORE_CELLS:
                        rock.edge_length *= COARSER
                    for series in rock.series:
                        series.resolution *= COARSER
                ops.build()
                self.assertIn("realmodel.export", self.draw().operators)

    def test_each_way_to_show_a_model(self):
        stack(0.0, 10.0, 30.0)
        ops.library_add(name="Sand")
        ops.build()
        rna = self.model.bl_rna.properties
        for name in ("display", "color_by", "explode_direction"):
            for item in rna[name].enum_items:
                with self.subTest(name, value=item.identifier):
                    setattr(self.model, name, item.identifier)
                    self.model.explode = 0.5
                    self.draw()
        self.model.stage = 0
        self.draw()

    def test_section_coordinates_and_hidden_blocks(self):
        stack(0.0, 10.0, 30.0)
        ops.build()
        ops.section_plane()
        ops.coordinates(location=(50.0, 50.0, 5.0))
        ops.set_origin(action="PLACE")
        ops.hide_property(property_id=self.model.results[0].property_id, action="HIDE")
        drawing = self.draw()
        self.assertIn("realmodel.section_flip", drawing.operators)
        self.assertIn("x", " ".join(drawing.labels))

    def test_an_ensemble(self):
        ops.open_sample(sample="two_layers")
        if not len(self.model.results):
            ops.build()
        ops.ensemble(realizations=2)
        for color_by, *_ in ensembles.COLORS:
            self.model.ensemble.color_by = color_by
            labels = " ".join(self.draw().labels)
            self.assertIn("2 realizations, seed 0", labels)
            self.assertIn("P90", labels)
        ops.build()
        self.assertIn("make the ensemble again", " ".join(self.draw().labels))

    def test_each_method_and_its_options(self):
        ops.open_sample(sample="two_layers")
        rock = settings.active_rock(self.scene)
        surface = settings.active_surface(self.scene)
        for method in METHODS:
            for fit in (True, False):
                with self.subTest(method, fit=fit):
                    surface.method, surface.fit_variogram = method, fit
                    draw_tab(bpy.context)
        ops.structure_add()
        ops.structure_add()
        draw_tab(bpy.context)
        for prop in (*rock.bl_rna.properties, *surface.bl_rna.properties):
            row = rock if prop.identifier in rock.bl_rna.properties else surface
            if prop.type == "ENUM" and not prop.is_hidden:
                for item in prop.enum_items:
                    with self.subTest(prop.identifier, value=item.identifier):
                        setattr(row, prop.identifier, item.identifier)
                        draw_tab(bpy.context)

    def test_region_mesh_and_boreholes(self):
        ops.open_sample(sample="gravel_plain")
        select(sheet("field", 0.0))
        ops.size_add()
        ops.constraint_add()
        self.assertIn("realmodel.size_remove", self.draw().operators)

    def test_refused(self):
        stack(0.0, 10.0)
        settings.active_surface(self.scene).object = None
        self.refused(ops.build, "")
        activity = bpy.context.window_manager.realmodel
        activity.problem = "surface 'S1': a problem that takes more than one line of the sidebar to be shown"
        activity.problem_object = "S0"
        drawing = self.draw()
        self.assertIn("problem", " ".join(drawing.labels))

    def test_warnings(self):
        stack(0.0, 10.0)
        ops.build()
        self.model.warnings = "\n".join(f"surface S{n}: something to know of it" for n in range(9))
        self.assertIn("something", " ".join(self.draw().labels))

    def test_building(self):
        stack(0.0, 10.0)
        activity = bpy.context.window_manager.realmodel
        activity.running, activity.progress, activity.text = True, 40.0, "interpolating"
        try:
            drawing = self.draw()
        finally:
            activity.running = False
        self.assertIn("realmodel.cancel", drawing.operators)
        self.assertIn("interpolating", drawing.labels)

    def test_in_edit_mode(self):
        stack(0.0, 10.0)
        ops.build()
        bpy.context.view_layer.objects.active = bpy.data.objects["S1"]
        bpy.ops.object.mode_set(mode="EDIT")
        self.draw()

    def test_a_linked_scene_and_linked_objects(self):
        stack(0.0, 10.0)
        ops.build()
        path = self.save_and_open()
        empty_file()
        with bpy.data.libraries.load(str(path), link=True) as (_source, wanted):
            wanted.scenes = ["Scene"]
        bpy.context.window.scene = next(scene for scene in bpy.data.scenes if scene.library is not None)
        self.assertEqual(len(self.model.results), 1)
        self.draw()

    def test_several_scenes(self):
        stack(0.0, 10.0)
        ops.build()
        first = self.scene
        bpy.context.window.scene = bpy.data.scenes.new("other")
        self.assertNotIn("S1 block", " ".join(self.draw().labels))
        ops.rock_add()
        self.draw()
        bpy.context.window.scene = first
        self.assertIn("S1 block", " ".join(self.draw().labels))

    def test_in_each_sidebar(self):
        """What depends on a region's width."""
        ops.open_sample(sample="two_layers")
        window = bpy.context.window
        for area in (area for area in window.screen.areas if area.type == "VIEW_3D"):
            region = next(region for region in area.regions if region.type == "UI")
            with bpy.context.temp_override(window=window, area=area, region=region):
                self.draw()

    def field_data(self):
        """A surface with dips, of a rock mass with observations and dips."""
        tables = (
            ("seen", "x,y,z,block\n1,2,3,Sand\n"),
            ("dips", "x,y,z,dip,strike\n1,2,3,5,0\n"),
            ("dips_of_rock", "x,y,z,dip,strike,block\n1,2,3,5,0,Sand\n"),
        )
        for name, text in tables:
            path = self.folder / f"{name}.csv"
            path.write_text(text)
            ops.boreholes_read(filepath=str(path))

    def series_of_fields(self):
        """Operators of a series, one of whose surfaces has dips of its own as before it was grouped."""
        self.field_data()
        ops.series_add(kind=FIELD)
        drawn = self.draw().operators
        ops.series_take_dips()
        return drawn | self.draw().operators

    def test_every_operator_has_a_button(self):
        drawn = self.draw().operators | self.series_of_fields()
        activity = bpy.context.window_manager.realmodel
        ops.series_remove()
        self.field_data()
        self.model.view.show_stereonet = True
        drawn |= self.draw().operators
        ops.datum_pick(location=(1, 2, 3))
        drawn |= self.draw().operators
        ops.datum_switch()
        drawn |= self.draw().operators
        ops.open_sample(sample="gravel_plain")
        self.model.view.show_misfits = True
        self.model.active_misfit = 0
        self.model.left_out_holes.add().refused = "the data were too few"
        with settings.filling():
            self.model.active_left_out_hole = 0
        activity.running = True
        drawn |= self.draw().operators
        activity.running = False
        select(sheet("field", 0.0))
        ops.size_add()
        ops.constraint_add()
        settings.active_surface(self.scene).method = "kriging"
        ops.structure_add()
        ops.structure_add()
        ops.filter_add()
        if not len(self.model.results):
            ops.build()
        ops.section_plane()
        ops.ensemble(realizations=2)
        ops.planned_hole_add()
        ops.fault_body_add(empty=True, kind="FAULT")
        ops.fault_list_add(of="ENDS_AT")
        drawn |= self.draw().operators
        fault = self.model.faults[-1]
        with settings.filling():
            source, fault.source = fault.source, "POINTS_FILE"
            fault.dips = {"positions": np.zeros((1, 3)), "normals": np.ones((1, 3))}
        drawn |= self.draw().operators
        with settings.filling():
            fault.source, fault.dips = source, {}
        ops.fault_body_add(empty=True, kind="BODY")
        activity.problem, activity.problem_object = "a problem", "field"
        drawn |= self.draw().operators
        quality.start(self.scene)
        drawn |= self.draw().operators
        quality.stop()
        ops.check_quality()
        for chart, *_ in quality.CHARTS:
            activity.chart = chart
            drawn |= self.draw().operators
        self.model.display = "SURFACES"
        drawn |= self.draw().operators
        ops.edit_surface()
        drawn |= self.draw().operators
        ops.edit_done()
        problem = settings.active_rock(self.scene).hole_problems.add()
        problem.kind, problem.hole, problem.action = "gap", "B1", "repaired"
        self.model.proposal.add().hole = "B1"
        self.model.active_reason = 0
        drawn |= self.draw().operators
        select(ball("Rock", n=8))
        ops.strata_preset(preset="CLIFF")
        drawn |= self.draw().operators
        drawn |= drawn_preferences().operators
        known = {
            cls.bl_idname
            for cls in bpy.types.Operator.__subclasses__()
            if cls.__module__.startswith("realmodel.") and cls.is_registered
        }
        self.assertEqual(known - drawn, BY_SCRIPT)


def drawn_preferences():
    """What the preferences of the add-on draw, with a profile of imports."""
    addons = bpy.context.preferences.addons
    addons.new().module = "realmodel"
    try:
        drawing = Drawing()
        owner = addons["realmodel"].preferences
        me = type("Me", (), {"layout": Layout(drawing, bpy.context)})()
        me.bl_rna = owner.bl_rna
        for name in preferences.RealModelPreferences.__annotations__:
            setattr(me, name, getattr(owner, name))
        profile = profiles.ImportProfile("tops", "points", ("E", "N"), {"x": "E"})
        with mock.patch.object(profiles, "all_of_user", lambda: [profile]):
            preferences.RealModelPreferences.draw(me, bpy.context)
        return drawing
    finally:
        addons.remove(addons["realmodel"])


class Preferences(PanelCase):
    def test_preferences(self):
        drawing = drawn_preferences()
        wanted = {f"RealModelPreferences.{name}" for name in preferences.RealModelPreferences.__annotations__}
        self.assertEqual(drawing.properties, wanted)


class TheLayoutIsStrict(unittest.TestCase):
    """What Blender refuses is refused here."""

    def test_refused(self):
        layout, scene = Layout(Drawing(), bpy.context), bpy.context.scene
        for wrong in (
            lambda: layout.prop(scene, "frame_curent"),
            lambda: layout.prop(None, "frame_current"),
            lambda: layout.prop(scene, "frame_current", txt="x"),
            lambda: layout.prop(scene, "frame_current", "x"),
            lambda: layout.prop(scene),
            lambda: layout.label(text=3),
            lambda: layout.label(text="x", icon="NO_SUCH_ICON"),
            lambda: layout.operator("mesh.no_such_operator"),
            lambda: setattr(layout.operator("mesh.delete"), "kind", "VERT"),
            lambda: setattr(layout.operator("mesh.delete"), "type", "VERTEX"),
            lambda: layout.operator_menu_enum("mesh.subdivide", "number_cuts"),
            lambda: layout.menu("VIEW3D_MT_no_such_menu"),
            lambda: layout.template_list("UI_UL_list", "", scene, "object", scene, "frame_current"),
            lambda: layout.prop_search(scene, "camera", bpy.data, "frame"),
            lambda: layout.no_such_function(),
            lambda: setattr(layout, "alignement", "LEFT"),
            lambda: setattr(layout, "alignment", "MIDDLE"),
        ):
            self.assertRaises(Refused, wrong)

    def test_taken(self):
        drawing = Drawing()
        layout, scene = Layout(drawing, bpy.context), bpy.context.scene
        row = layout.row(align=True)
        row.alignment = "LEFT"
        row.prop(scene, "frame_current", text="Frame")
        row.operator("mesh.delete", icon="X").type = "VERT"
        row.operator_menu_enum("mesh.delete", "type")
        layout.prop_search(scene, "camera", bpy.data, "objects")
        draw(bpy.types.VIEW3D_PT_view3d_cursor, bpy.context, drawing)
        self.assertLess({"Scene.frame_current", "Scene.camera"}, drawing.properties)
        self.assertEqual(drawing.operators, {"mesh.delete"})
