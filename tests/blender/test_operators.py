# SPDX-License-Identifier: GPL-3.0-or-later
"""All operators: each says why it cannot be used now."""

import bpy
from panel_case import PanelCase, stack

ALWAYS = {  # operators that can be used in every scene of one's own, and why
    "rock_add": "begins a model where there is none",
    "surface_add": "adds a rock mass where there is none",
    "boreholes_read": "as surface_add",
    "tiles_read": "a model in tiles comes beside the one of the scene",
    "fault_body_add": "faults and bodies may be there before the surfaces",
    "library_add": "the library may be there before the model",
    "library_import": "as library_add",
    "set_origin": "its action is known only when it is used",
    "capture": "any viewport can be captured, in background mode the scene",
    "documentation": "has a poll of its own",
    "file_choose": "of whatever setting has a file",
    "install_looks": "writes an asset library, of no scene",
    "profiles_import": "profiles are of the user, of no scene",
}
CHANGES_NOTHING = {  # operators without a step of undo: files, the view of a viewport, the clipboard, jobs
    *(
        "export",
        "export_mesh",
        "share",
        "estimate",
        "report",
        "save_section",
        *("save_juxtaposition", "view_juxtaposition", "save_stereonet"),
        "save_sheets",
        "save_chart",
        "planned_hole_save",
        "library_export",
        "capture",
    ),
    *("view", "view_all", "view_previous", "view_next", "cancel", "stop_check", "check_quality"),
    *("profile_rename", "profile_remove", "profiles_export", "profiles_import"),
    *("dismiss", "documentation", "copy_table", "export_scene", "install_looks"),
}


def operators():
    """(name, class) of each operator of the package, those that are not in its menus too."""
    for cls in bpy.types.Operator.__subclasses__():
        if cls.__module__.startswith("realmodel.") and cls.is_registered:
            yield cls.bl_idname.removeprefix("realmodel."), cls


def refusal(name):
    """What a script reads where the operator's poll refuses; None where it does not."""
    operator = getattr(bpy.ops.realmodel, name)
    if operator.poll():
        return None
    try:
        operator()
    except RuntimeError as error:
        return str(error).split(".poll() ", 1)[1].strip()
    raise AssertionError(f"{name} ran although its poll refuses")


class Poll(PanelCase):
    def refusals(self):
        return {name: reason for name, _ in operators() if (reason := refusal(name)) is not None}

    def check_reasons(self, refused):
        for name, reason in refused.items():
            self.assertNotIn("failed", reason, f"{name} refuses without a reason")
            self.assertGreater(len(reason), 15, name)

    def test_every_operator_has_needs(self):
        without = {name for name, cls in operators() if not getattr(cls, "needs", ())}
        self.assertEqual(without - set(ALWAYS), set())

    def test_what_changes_data_can_be_undone(self):
        without = {name for name, cls in operators() if "UNDO" not in cls.bl_options}
        self.assertEqual(without - CHANGES_NOTHING, set())
        self.assertEqual({name for name in CHANGES_NOTHING - without if name in dict(operators())}, set())

    def test_an_empty_scene(self):
        refused = self.refusals()
        self.check_reasons(refused)
        self.assertEqual(refused["export"], "there is no model yet; press Build first")
        self.assertEqual(refused["surface_move"], "there is no surface; add one first (Surfaces, +)")
        self.assertEqual(refused["cancel"], "nothing is being built")
        self.assertFalse(set(refused) & set(ALWAYS) - {"documentation"})

    def test_a_built_model(self):
        before = set(self.refusals())
        stack(0.0, 10.0, 30.0)
        bpy.ops.realmodel.build()
        refused = self.refusals()
        self.check_reasons(refused)
        self.assertLess(set(refused), before)
        self.assertNotIn("export", refused)
        self.assertIn("section_flip", refused)
        bpy.ops.realmodel.section_plane()
        self.assertNotIn("section_flip", self.refusals())

    def test_while_building(self):
        stack(0.0, 10.0)
        activity = bpy.context.window_manager.realmodel
        activity.running = True
        try:
            self.assertIn("build", self.refusals())
            self.assertNotIn("cancel", self.refusals())
        finally:
            activity.running = False

    def test_a_scene_of_another_file_is_not_changed(self):
        stack(0.0, 10.0)
        path = self.save_and_open()
        bpy.ops.wm.read_factory_settings(use_empty=True)
        with bpy.data.libraries.load(str(path), link=True) as (_source, wanted):
            wanted.scenes = ["Scene"]
        linked = next(scene for scene in bpy.data.scenes if scene.library is not None)
        bpy.context.window.scene = linked
        refused = self.refusals()
        for name, cls in operators():
            if "UNDO" in cls.bl_options:
                self.assertIn("is linked from another file", refused.get(name, ""), name)
