# SPDX-License-Identifier: GPL-3.0-or-later
"""Whatever is typed into a field for text, or given to an operator: no traceback, a typed message where it
cannot be, and then the scene is as it was."""

import contextlib
import io
import os

import bpy
from panel_case import SAMPLES, PanelCase, ops

NONSENSE = ("no such thing", "//../\u20ac\u0000 [[{", "NaN", "1e999", "=", '"', "/dev/null", "x" * 3000)
_MADE = "realmodel."


def _classes(base):
    """The classes of the add-on that are registered below one of Blender's."""
    found = [cls for cls in base.__subclasses__() if cls.__module__.startswith(_MADE)]
    return [each for cls in found for each in (cls, *_classes(cls)) if getattr(each, "is_registered", True)]


def _texts(group, seen):
    """(group, key) of each field for text that a person can type into, in a group and those within."""
    for key, prop in group.bl_rna.properties.items():
        if prop.type == "STRING" and not (prop.is_hidden or prop.is_readonly):
            yield group, key
        elif prop.type == "POINTER" and isinstance(prop.fixed_type, bpy.types.PropertyGroup):
            yield from _texts(getattr(group, key), seen)
        elif prop.type == "COLLECTION" and isinstance(prop.fixed_type, bpy.types.PropertyGroup):
            for row in list(getattr(group, key))[:1]:
                yield from _texts(row, seen)


class Nonsense(PanelCase):
    @contextlib.contextmanager
    def quiet(self, what):
        """Nothing within prints a traceback."""
        said = io.StringIO()
        with contextlib.redirect_stderr(said), contextlib.redirect_stdout(said):
            yield
        self.assertNotIn("Traceback", said.getvalue(), what)

    def refused_or_done(self, operator, what, **given):
        with self.quiet(what):
            before = self.volumes()
            try:
                operator(**given)
            except RuntimeError as error:
                self.assertEqual(self.volumes(), before, what)
                self.assertNotIn("Traceback", str(error), what)
                self.assertNotIn("Python:", str(error), what)
            except TypeError as error:  # of Blender: the value is not of the property's type
                self.assertIn("keyword", str(error), what)

    def opened(self):
        ops.open_project(filepath=str(SAMPLES / "two_layers" / "project.toml"), build=False)
        ops.build()
        ops.planned_hole_add()
        ops.series_add()
        self.model.rocks[0].surfaces[0].filters.add()
        for rows in (self.model.faults, self.model.bodies):
            rows.add().name = "there"
        self.model.faults[0].ends_at.add()
        self.model.rocks[0].constraints.add()

    def test_fields_for_text(self):
        self.opened()
        fields = [(group.path_from_id(), key) for group, key in _texts(self.model, set())]
        self.assertGreater(len(fields), 25)
        for path, key in fields:
            for text in NONSENSE[:4]:
                what = f"{path}.{key} = {text!r}"
                group = self.group_at(path)
                if group is None:
                    continue  # the field before it was of its list
                before = getattr(group, key)
                with self.quiet(what):
                    setattr(group, key, text.replace("\0", ""))
                self.refused_or_done(ops.build, what)
                with self.quiet(what):
                    setattr(self.group_at(path), key, before)

    def group_at(self, path):
        try:
            return self.scene.path_resolve(path)
        except ValueError:
            return None

    def test_what_fields_propose(self):
        """Blender calls it with the properties of an operator, and not with the operator."""
        self.opened()
        count = 0
        for cls in _classes(bpy.types.Operator):
            for base in cls.__mro__:
                for key, made in base.__dict__.get("__annotations__", {}).items():
                    search = getattr(made, "keywords", {}).get("search")
                    if search is None:
                        continue
                    properties = bpy.context.window_manager.operator_properties_last(cls.bl_idname)
                    for text in ("", *NONSENSE[:4], str(SAMPLES / "mapped_valley" / "map.geojson")):
                        if hasattr(properties, "filepath"):
                            properties.filepath = text.replace("\0", "")
                        found = list(search(properties, bpy.context, ""))
                        self.assertTrue(all(isinstance(each, (str, tuple)) for each in found), key)
                    count += 1
        self.assertGreaterEqual(count, 5)

    def test_operators_with_nonsense(self):
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(self.folder)
        self.opened()
        skipped = {"documentation", "quit", "render_picture"}
        for number, cls in enumerate(_classes(bpy.types.Operator)):
            name = cls.bl_idname.partition(".")[2]
            keys = [
                key
                for key, prop in getattr(ops, name).get_rna_type().properties.items()
                if prop.type == "STRING" and not prop.is_hidden
            ]
            if name in skipped or not keys:
                continue
            for text in (NONSENSE * 2)[number % len(NONSENSE) :][:3]:  # each meets many operators
                text = text.replace("\0", "")
                self.refused_or_done(getattr(ops, name), f"{name} {text!r}", **dict.fromkeys(keys, text))
