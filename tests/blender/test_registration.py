# SPDX-License-Identifier: GPL-3.0-or-later
"""Enabling and disabling the add-on: nothing stays behind, as often as it is done."""

import re
import unittest

import bpy
import realmodel


def traces():
    """Everything that an add-on may leave in Blender."""
    handlers = {name: [f.__module__ for f in registered] for name, registered in _handler_lists()}
    classes = sorted(
        cls.__name__
        for base in (
            bpy.types.Operator,
            bpy.types.Panel,
            bpy.types.UIList,
            bpy.types.PropertyGroup,
            bpy.types.Menu,
            bpy.types.AddonPreferences,
        )
        for cls in base.__subclasses__()
        if cls.is_registered and cls.__module__.startswith("realmodel")
    )
    menus = [getattr(f, "__module__", "") for menu in _MENUS for f in menu._dyn_ui_initialize()]
    properties = [hasattr(t, "realmodel") for t in (bpy.types.Scene, bpy.types.WindowManager)]
    return handlers, classes, menus, properties, dir(bpy.ops.realmodel)


def _handler_lists():
    for name in dir(bpy.app.handlers):
        registered = getattr(bpy.app.handlers, name)
        if isinstance(registered, list):
            yield name, registered


_MENUS = tuple(
    getattr(bpy.types, name)
    for name in (
        "TOPBAR_MT_file_import",
        "TOPBAR_MT_file_export",
        "VIEW3D_MT_add",
        "VIEW3D_MT_object",
        "VIEW3D_MT_edit_mesh",
        "VIEW3D_MT_view",
    )
)


class Registration(unittest.TestCase):
    def test_nothing_stays(self):
        before = traces()
        self.assertEqual(before[1], [], "the add-on was registered before this test")
        for _ in range(3):
            realmodel.register()
            during = traces()
            realmodel.unregister()
            self.assertEqual(traces(), before)
        self.assertIn("REALMODEL_OT_build", during[1])
        self.assertIn("build", during[4])
        self.assertEqual(during[3], [True, True])

    def test_a_failure_leaves_nothing(self):
        from realmodel import handlers

        before, register = traces(), handlers.register

        def failing():
            raise RuntimeError("on purpose")

        handlers.register = failing
        try:
            with self.assertRaisesRegex(RuntimeError, "on purpose"):
                realmodel.register()
        finally:
            handlers.register = register
        self.assertEqual(traces(), before)

    def test_every_operator_says_what_it_does(self):
        realmodel.register()
        try:
            for cls in bpy.types.Operator.__subclasses__():
                if cls.__module__.startswith("realmodel."):
                    described = bpy.ops.realmodel.__getattr__(cls.bl_idname.split(".")[1]).get_rna_type()
                    self.assertGreater(len(described.description), 15, cls.bl_idname)
                    self.assertTrue(described.name, cls.bl_idname)
        finally:
            realmodel.unregister()

    def test_the_file_browser_has_room_for_each_filter(self):
        realmodel.register()
        self.addCleanup(realmodel.unregister)
        found = {}
        for name in dir(bpy.ops.realmodel):
            prop = getattr(bpy.ops.realmodel, name).get_rna_type().properties.get("filter_glob")
            if prop is not None:
                found[name] = prop.default
        self.assertIn("*.toml", found["open_project"])
        self.assertEqual({name: text for name, text in found.items() if len(text) > 255}, {})

    def test_every_setting_and_choice_says_what_it_does(self):
        realmodel.register()
        self.addCleanup(realmodel.unregister)
        from realmodel import props_rock, props_view
        from realmodel.registration import classes

        modules = (props_rock, props_view, props_rock, props_rock, props_view)
        found = [(cls.__name__, cls.bl_rna) for cls in classes(modules)]
        found.append(("scene.realmodel", bpy.context.scene.realmodel.bl_rna))
        for cls in bpy.types.Operator.__subclasses__():
            if cls.__module__.startswith("realmodel.") and "INTERNAL" not in cls.bl_options:
                made = getattr(bpy.ops.realmodel, cls.bl_idname.split(".")[1])
                found.append((cls.bl_idname, made.get_rna_type()))
        silent = []
        for owner, rna in found:
            for prop in rna.properties:
                if prop.is_hidden or prop.identifier == "rna_type" or prop.type in ("COLLECTION", "POINTER"):
                    continue
                if not prop.description:
                    silent.append((owner, prop.identifier))
                if prop.type == "ENUM":
                    silent += [
                        (owner, prop.identifier, item.identifier)
                        for item in prop.enum_items
                        if not item.description
                    ]
        self.assertEqual(silent, [])

    def test_only_what_reacts_can_be_animated(self):
        realmodel.register()
        self.addCleanup(realmodel.unregister)
        from realmodel import props
        from realmodel.bl import display
        from realmodel.registration import classes

        groups = [cls for cls in classes(props._MODULES) if cls is not props.RealModelSettings]
        owners = [*((cls.__name__, cls.bl_rna) for cls in groups), ("", props.RealModelSettings.bl_rna)]
        animatable = {
            f"{name}.{prop.identifier}".lstrip(".")
            for name, rna in owners
            for prop in rna.properties
            if prop.is_animatable and prop.type in ("BOOLEAN", "INT", "FLOAT", "ENUM")
        }
        self.assertEqual(animatable, set(display._ANIMATED))

    def test_labels_are_written_as_blender_writes_them(self):
        """Title Case, and American spelling."""
        realmodel.register()
        self.addCleanup(realmodel.unregister)
        from realmodel import props
        from realmodel.registration import classes

        small = re.findall(r"\w+", "a an and as at by for from in of on or per the to")
        british = re.compile(r"colour|centre|neighbour|metre|honour", re.IGNORECASE)
        wrong = []
        for cls in classes(props._MODULES):
            for prop in cls.bl_rna.properties:
                if prop.is_hidden or prop.name == prop.identifier or prop.identifier == "rna_type":
                    continue
                items = getattr(prop, "enum_items", ())
                labels = [prop.name, *(item.name for item in items if item.name != item.identifier)]
                wrong += [
                    label
                    for label in labels
                    if any(word[:1].islower() and word not in small for word in label.split())
                ]
                wrong += [text for text in (*labels, prop.description) if british.search(text)]
        self.assertEqual(wrong, [])
