# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels and menus drawn without a window: a layout that takes what Blender's UILayout takes, and no more.

Every call is checked against Blender's own description of UILayout (its RNA): names and kinds of arguments,
icons, settings of the layout. What a button stands for must be there: the property on its data, the operator
with the values that are set on it, the menu, the list, whose rows are drawn too.
"""

import inspect
import types

import bpy

_LAYOUT = bpy.types.UILayout.bl_rna
_WITHIN = {"row", "column", "column_flow", "grid_flow", "box", "split", "menu_pie"}
_KINDS = {"STRING": str, "BOOLEAN": (bool, int), "INT": int, "FLOAT": (int, float)}


class Refused(AssertionError):
    """Blender would not draw this."""


class Drawing:
    """What was drawn. labels: texts; operators, properties: names; open_menus: those drawn to their end."""

    def __init__(self):
        self.labels, self.operators, self.properties, self.menus = [], set(), set(), set()


class Layout:
    def __init__(self, drawing, context):
        object.__setattr__(self, "_drawing", drawing)
        object.__setattr__(self, "_context", context)
        object.__setattr__(self, "_set", {})

    def __setattr__(self, name, value):
        if name not in _LAYOUT.properties:
            raise Refused(f"UILayout has no {name}")
        _check_value(_LAYOUT.properties[name], value, f"UILayout.{name}")
        self._set[name] = value

    def __getattr__(self, name):
        if name in _LAYOUT.functions:
            return lambda *given, **named: self._call(_LAYOUT.functions[name], given, named)
        if name in _LAYOUT.properties:
            prop = _LAYOUT.properties[name]
            return self._set.get(name, getattr(prop, "default", None))
        raise Refused(f"UILayout has no {name}")

    def _call(self, function, given, named):
        name = function.identifier
        if name not in _WITHIN and not hasattr(self, f"_draw_{name}"):
            raise Refused(f"UILayout.{name}: the tests cannot draw it yet")
        arguments = _arguments(function, given, named)
        self._drawing.labels.append(arguments.get("text", ""))
        if name in _WITHIN:
            return Layout(self._drawing, self._context)
        return getattr(self, f"_draw_{name}")(**arguments)

    def _draw_label(self, **_rest):
        pass

    def _draw_separator(self, **_rest):
        pass

    def _draw_separator_spacer(self, **_rest):
        pass

    def _draw_template_icon(self, **_rest):
        pass

    def _draw_prop(self, data, property, **_rest):
        self._property(data, property)

    def _draw_prop_enum(self, data, property, value, **_rest):
        prop = self._property(data, property, "ENUM")
        if prop.enum_items and value not in prop.enum_items:
            raise Refused(f"{_where(data, property)}: there is no '{value}'")

    def _draw_props_enum(self, data, property, **_rest):
        self._property(data, property, "ENUM")

    _draw_prop_menu_enum = _draw_props_enum

    def _draw_prop_search(self, data, property, search_data, search_property, **_rest):
        self._property(data, property)
        self._property(search_data, search_property, "COLLECTION")

    def _draw_template_ID(self, data, property, new="", open="", unlink="", **_rest):
        self._property(data, property, "POINTER")
        for name in (new, open, unlink):
            if name:
                _operator(name)

    def _draw_operator(self, operator, **_rest):
        self._drawing.operators.add(operator)
        kind = _operator(operator)
        kind.poll()  # as Blender asks before it draws
        return _Properties(operator, kind.get_rna_type(), self._context)

    def _draw_operator_menu_enum(self, operator, property, **rest):
        made = self._draw_operator(operator, **rest)
        if made.rna(property).type != "ENUM":
            raise Refused(f"{operator}.{property} is no menu")
        made.items(property)
        return made

    def _draw_operator_enum(self, operator, property, **rest):
        self._draw_operator_menu_enum(operator, property, **rest)

    def _draw_menu(self, menu, **_rest):
        cls = getattr(bpy.types, menu, None)
        if cls is None or not issubclass(cls, bpy.types.Menu):
            raise Refused(f"there is no menu {menu}")
        self._drawing.menus.add(menu)
        if cls.__module__.startswith("realmodel"):
            draw(cls, self._context, self._drawing)

    def _draw_popover(self, panel, **_rest):
        if not hasattr(bpy.types, panel):
            raise Refused(f"there is no panel {panel}")

    def _draw_template_list(
        self, listtype_name, list_id, dataptr, propname, active_dataptr, active_propname, **_rest
    ):
        cls = getattr(bpy.types, listtype_name, None)
        if cls is None or not issubclass(cls, bpy.types.UIList):
            raise Refused(f"there is no list {listtype_name}")
        self._property(dataptr, propname, "COLLECTION")
        self._property(active_dataptr, active_propname, "INT")
        me = _Self(cls, layout_type="DEFAULT", bitflag_filter_item=1 << 30, filter_name="", list_id=list_id)
        rows = getattr(dataptr, propname)
        if hasattr(cls, "filter_items"):
            flags, order = me.filter_items(self._context, dataptr, propname)
            if len(flags) not in (0, len(rows)) or sorted(order) not in ([], list(range(len(rows)))):
                raise Refused(f"{listtype_name} does not filter and sort {len(rows)} rows")
        for number, row in enumerate(rows):
            layout = Layout(self._drawing, self._context)
            given = (self._context, layout, dataptr, row, 0, active_dataptr, active_propname, number, 0)
            me.draw_item(*given[: cls.draw_item.__code__.co_argcount - 1])  # Blender leaves out the last two

    def _property(self, data, name, kind=None):
        if data is None:
            raise Refused(f"None has no property {name}")
        if name.startswith('["'):
            if name[2:-2] not in data:
                raise Refused(f"{data!r} has no {name}")
            return None
        prop = data.bl_rna.properties.get(name)
        if prop is None:
            raise Refused(f"{_where(data, name)} is not there")
        if kind is not None and prop.type != kind:
            raise Refused(f"{_where(data, name)} is of kind {prop.type}, not {kind}")
        getattr(data, name)
        self._drawing.properties.add(_where(data, name))
        return prop


def draw(cls, context, drawing):
    """Draws a registered panel or menu, and its header."""
    for name in ("draw_header", "draw"):
        if hasattr(cls, name):
            getattr(_Self(cls, layout=Layout(drawing, context)), name)(context)


def draw_tab(context, tab=None):
    """Draws all panels of a tab of the sidebar, or of all tabs, that are shown now, unfolded. Returns the
    Drawing."""
    drawing, shown = Drawing(), set()
    panels = [cls for cls in bpy.types.Panel.__subclasses__() if cls.__module__.startswith("realmodel")]
    panels = [cls for cls in panels if cls.is_registered and tab in (None, getattr(cls, "bl_category", None))]
    panels.sort(key=lambda cls: hasattr(cls, "bl_parent_id"))
    for cls in panels:
        parent = getattr(cls, "bl_parent_id", None)
        if (parent is None or parent in shown) and (not hasattr(cls, "poll") or cls.poll(context)):
            shown.add(cls.__name__)
            draw(cls, context, drawing)
    return drawing


class _Self:
    """Stands for an instance of a class of Blender's, which Blender alone can make."""

    def __init__(self, cls, **attributes):
        self._cls = cls
        vars(self).update(attributes)

    def __getattr__(self, name):
        found = getattr(self._cls, name)
        return types.MethodType(found, self) if isinstance(found, types.FunctionType) else found


class _Properties:
    """The values that an operator's button is given."""

    def __init__(self, name, rna, context):
        vars(self).update(_name=name, _rna=rna, _context=context)

    def rna(self, key):
        prop = self._rna.properties.get(key)
        if prop is None:
            raise Refused(f"{self._name} has no property {key}")
        return prop

    def items(self, key):
        """Identifiers of a menu; of one made by a function, what it makes."""
        cls = bpy.types.Operator.bl_rna_get_subclass_py(self._rna.identifier)
        for base in cls.__mro__ if cls is not None else ():
            made = inspect.get_annotations(base).get(key)
            if made is not None and callable(made.keywords.get("items")):
                return [item[0] for item in made.keywords["items"](None, self._context)]
        return [item.identifier for item in self.rna(key).enum_items]

    def __setattr__(self, key, value):
        prop = self.rna(key)
        if prop.type == "ENUM" and not prop.is_enum_flag:
            if value not in self.items(key):
                raise Refused(f"{self._name}.{key}: there is no {value!r}")
        else:
            _check_value(prop, value, f"{self._name}.{key}")


def _arguments(function, given, named):
    """The arguments of a call by their names, as Blender takes them: only the required without a name."""
    where = f"UILayout.{function.identifier}"
    known = {p.identifier: p for p in function.parameters if not p.is_output}
    required = [key for key, parameter in known.items() if parameter.is_required]
    if len(given) > len(required):
        raise Refused(f"{where}: only {required} may be given without their names")
    arguments = {**dict(zip(required, given, strict=False)), **named}
    if missing := [key for key in required if key not in arguments]:
        raise Refused(f"{where}: {missing} are missing")
    for key, value in arguments.items():
        if key not in known:
            raise Refused(f"{where} has no argument {key}")
        _check_value(known[key], value, f"{where}: {key}")
    return arguments


def _check_value(prop, value, where):
    if prop.type == "ENUM" and not prop.is_enum_flag:
        if value not in prop.enum_items:
            raise Refused(f"{where}: there is no {value!r}")
    elif not isinstance(value, _KINDS.get(prop.type, object)) and not getattr(prop, "is_array", False):
        raise Refused(f"{where}: {value!r} is not of kind {prop.type}")


def _operator(name):
    module, _, function = name.partition(".")
    kind = getattr(getattr(bpy.ops, module), function)
    try:
        kind.get_rna_type()
    except (KeyError, AttributeError) as error:
        raise Refused(f"there is no operator {name}") from error
    return kind


def _where(data, name):
    return f"{data.bl_rna.identifier}.{name}"
