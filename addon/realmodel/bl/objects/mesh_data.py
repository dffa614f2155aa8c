# SPDX-License-Identifier: GPL-3.0-or-later
"""All data of a mesh but its shape, as arrays: attributes, UV maps, vertex groups, materials, marks of edges
and polygons; for meshes that are made of parts of others."""

from dataclasses import dataclass, field

import bpy
import numpy as np

from ...core.display.polygon_mesh import interpolated
from ..host import versions

# Of each type of attribute: the name of the value, its number of components, and their type.
_VALUES = {
    "FLOAT": ("value", 1, np.float32),
    "INT": ("value", 1, np.int32),
    "INT8": ("value", 1, np.int32),
    "BOOLEAN": ("value", 1, bool),
    "FLOAT_VECTOR": ("vector", 3, np.float32),
    "FLOAT2": ("vector", 2, np.float32),
    "FLOAT_COLOR": ("color", 4, np.float32),
    "BYTE_COLOR": ("color", 4, np.float32),
    "INT16_2D": ("value", 2, np.int32),
    "INT32_2D": ("value", 2, np.int32),
    "QUATERNION": ("value", 4, np.float32),
    "FLOAT4X4": ("value", 16, np.float32),
    "STRING": ("value", 1, object),
}
# Attributes that are handled separately, or belong to the shape.
_OTHERWISE = {"position", "material_index", "sharp_face", "sharp_edge", "custom_normal"}
_DOMAINS = {"POINT": "vertices", "EDGE": "edges", "FACE": "polygons", "CORNER": "loops"}


@dataclass(eq=False)
class Layers:
    """The data of a mesh but its shape.

    attributes: {name: (domain, type, values (N, K))}. uv_maps: {name: (C, 2)}. marks: {(domain, name): (N,)},
    properties of vertices, edges and polygons. groups: {name: (weights (V,), is_member (V,))}. materials: of
    each slot (name, file of the library or None), or None. material_index: (F,). active: the names of the UV
    maps and color attributes that are active and rendered.
    """

    attributes: dict = field(default_factory=dict)
    uv_maps: dict = field(default_factory=dict)
    marks: dict = field(default_factory=dict)
    groups: dict = field(default_factory=dict)
    materials: list = field(default_factory=list)
    material_index: np.ndarray | None = None
    active: dict = field(default_factory=dict)


def read(mesh, item):
    """The layers of a mesh that is the one of an object, evaluated or not."""
    layers = Layers(groups=_groups(mesh, item), materials=_materials(mesh, item))
    layers.material_index = _numbers(mesh.polygons, "material_index", np.int32)
    for uv_map in mesh.uv_layers:
        layers.uv_maps[uv_map.name] = _numbers(uv_map.data, "uv", np.float32, 2)
    for attribute in mesh.attributes:
        name, domain = attribute.name, attribute.domain
        if name.startswith(".") or name in _OTHERWISE or name in layers.uv_maps or domain not in _DOMAINS:
            continue
        if attribute.data_type in _VALUES and len(attribute.data) == len(getattr(mesh, _DOMAINS[domain])):
            layers.attributes[name] = (domain, attribute.data_type, _values(attribute))
    for domain, names in versions.marks().items():
        for name, dtype in names.items():
            values = _numbers(getattr(mesh, _DOMAINS[domain]), name, dtype)
            if values.any():
                layers.marks[domain, name] = values
    layers.active = _active(mesh)
    return layers


def write(mesh, parts, given):
    """Writes to a new mesh the data that its parts (core.display.mesh_parts.MeshParts) have from two meshes
    with given layers. On common edges and vertices the first mesh counts. Returns the names of layers of the
    second that are left out because the first has another kind of that name, or Blender's limit is
    reached."""
    left_out = []
    given = _of_parts(parts, given)
    _write_materials(mesh, parts, given)
    for name in _names(given, "uv_maps"):
        uv_map = mesh.uv_layers.new(name=name, do_init=False)
        if uv_map is None:  # there may be eight
            left_out.append(name)
            continue
        layer_values = [layers.uv_maps.get(name) for layers in given]
        uv_map.data.foreach_set("uv", _together(mesh, "CORNER", parts, layer_values).ravel())
    for name in _names(given, "attributes"):
        kinds = [layers.attributes[name][:2] if name in layers.attributes else None for layers in given]
        kind = kinds[0] or kinds[1]
        if kinds[1] not in (None, kind):
            left_out.append(name)
        domain, data_type = kind
        layer_values = [
            layers.attributes[name][2] if layer_kind == kind else None
            for layers, layer_kind in zip(given, kinds, strict=True)
        ]
        made = mesh.attributes.new(name, data_type, domain)
        _set_values(made, _together(mesh, domain, parts, layer_values))
    for domain, names in versions.marks().items():
        for name in names:
            layer_values = [layers.marks.get((domain, name)) for layers in given]
            if any(values is not None for values in layer_values):
                values = _together(mesh, domain, parts, layer_values)
                getattr(mesh, _DOMAINS[domain]).foreach_set(name, values)
    _mark_meeting(mesh, parts, given)
    _write_active(mesh, given)
    return left_out


def _mark_meeting(mesh, parts, operand_layers):
    """Marks the edges where smooth surfaces meet as sharp."""
    if len(parts.meeting) and any(("FACE", "use_smooth") in layers.marks for layers in operand_layers):
        sharp = _numbers(mesh.edges, "use_edge_sharp", bool)
        sharp[parts.meeting] = True
        mesh.edges.foreach_set("use_edge_sharp", sharp)


def write_groups(item, parts, given):
    """Writes the vertex groups of an object whose mesh consists of parts of two others."""
    item.vertex_groups.clear()
    given = _of_parts(parts, given)
    for name in _names(given, "groups"):
        group_values = [layers.groups.get(name, (None, None)) for layers in given]
        weights = _together(item.data, "POINT", parts, [weights for weights, _ in group_values])
        is_member = np.zeros(len(weights), bool)
        for source, (_, members) in zip(parts.sources, group_values, strict=True):
            if members is not None:  # one of the vertices that it is between is enough
                near = members[source.vertex_of] & (source.vertex_weights > 0.0)
                is_member[source.vertices] |= near.any(axis=1)
        group = item.vertex_groups.new(name=name)
        members = np.flatnonzero(is_member)
        for weight in np.unique(weights[members]).tolist():
            group.add(members[weights[members] == weight].tolist(), weight, "REPLACE")


def _of_parts(parts, operand_layers):
    """The layers of those of which there are parts; nothing of the others."""
    return [
        layers if len(source.polygons) else Layers()
        for source, layers in zip(parts.sources, operand_layers, strict=True)
    ]


def _together(mesh, domain, parts, operand_values):
    """(N, ...) values of a new mesh: of each operand those that it keeps, which may be None."""
    example = next(values for values in operand_values if values is not None)
    shape = (len(getattr(mesh, _DOMAINS[domain])), *example.shape[1:])
    nothing = type(example[0])() if example.dtype == object else 0  # text is str or bytes, by version
    result = np.full(shape, nothing, example.dtype)
    for source, values in reversed(list(zip(parts.sources, operand_values, strict=True))):
        if values is None:
            continue
        if domain == "POINT":
            result[source.vertices] = interpolated(values, source.vertex_of, source.vertex_weights)
        elif domain == "CORNER":
            result[source.corners] = interpolated(values, source.corner_of, source.corner_weights)
        elif domain == "EDGE":
            result[source.edges] = values[source.edge_of]
        else:
            result[source.polygons] = values[source.polygon_of]
    return result


def _names(operand_layers, kind):
    """The names of both, those of the first before the others."""
    return list(dict.fromkeys(name for layers in operand_layers for name in getattr(layers, kind)))


def _numbers(data, name, dtype, columns=1):
    numbers = np.empty(len(data) * columns, dtype)
    data.foreach_get(name, numbers)
    return numbers if columns == 1 else numbers.reshape(-1, columns)


def _values(attribute):
    name, columns, dtype = _VALUES[attribute.data_type]
    if dtype is object:
        return np.array([entry.value for entry in attribute.data], object)
    return _numbers(attribute.data, name, dtype, columns)


def _set_values(attribute, values):
    name, _, dtype = _VALUES[attribute.data_type]
    if dtype is object:
        for entry, value in zip(attribute.data, values, strict=True):
            entry.value = value
        return
    attribute.data.foreach_set(name, values.ravel())


def _groups(mesh, obj):
    names = [group.name for group in obj.vertex_groups]
    groups = {
        name: (np.zeros(len(mesh.vertices), np.float32), np.zeros(len(mesh.vertices), bool)) for name in names
    }
    if names:
        for number, vertex in enumerate(mesh.vertices):
            for entry in vertex.groups:
                if entry.group < len(names):
                    weights, is_member = groups[names[entry.group]]
                    weights[number], is_member[number] = entry.weight, True
    return groups


def _materials(mesh, obj):
    """The materials of the object's slots; where geometry nodes added slots, those of the mesh."""
    slot_materials = list(mesh.materials)
    for number, slot in enumerate(obj.material_slots):
        if slot.link == "OBJECT" and number < len(slot_materials):
            slot_materials[number] = slot.material
    slot_materials = [material.original if material is not None else None for material in slot_materials]
    return [
        None if m is None else (m.name, m.library.filepath if m.library else None) for m in slot_materials
    ]


def _write_materials(mesh, parts, operand_layers):
    """Writes the material of each face. Faces of the second mesh without one take the slot of their number,
    as in Blender's own Boolean; those of the first without one keep none."""
    first, second = (list(layers.materials) for layers in operand_layers)
    are_both = all(len(source.polygons) for source in parts.sources)
    if are_both and any(second):
        slots = first or [None]
        slots += [key for key in dict.fromkeys(second) if key is not None and key not in slots]
        second = [slots.index(key) if key else min(n, len(slots) - 1) for n, key in enumerate(second)]
    else:
        slots = first or ([] if are_both else second)
        second = [min(n, max(len(slots) - 1, 0)) for n in range(max(len(second), 1))]
    for key in slots:
        mesh.materials.append(None if key is None else bpy.data.materials.get(key))
    index = np.zeros(len(mesh.polygons), np.int32)
    numbers = (np.arange(max(len(first), 1)), np.array(second))
    for source, layers, new in zip(parts.sources, operand_layers, numbers, strict=True):
        if len(source.polygons):
            indices = layers.material_index[source.polygon_of]
            index[source.polygons] = new[np.clip(indices, 0, len(new) - 1)]
    if index.any():
        mesh.polygons.foreach_set("material_index", index)


def _active(mesh):
    """The names of the maps that are active, and that are rendered."""
    active = {"uv": mesh.uv_layers.active, "color": mesh.color_attributes.active_color}
    active = {key: entry.name for key, entry in active.items() if entry is not None}
    shown = [uv_map.name for uv_map in mesh.uv_layers if uv_map.active_render]
    colors, number = mesh.color_attributes, mesh.color_attributes.render_color_index
    if 0 <= number < len(colors):
        active["color_render"] = colors[number].name
    return active | ({"uv_render": shown[0]} if shown else {})


def _write_active(mesh, operand_layers):
    wanted = operand_layers[1].active | operand_layers[0].active
    for uv_map in mesh.uv_layers:
        if uv_map.name == wanted.get("uv"):
            uv_map.active = True
        if uv_map.name == wanted.get("uv_render"):
            uv_map.active_render = True
    colors = mesh.color_attributes
    names = [color.name for color in colors]
    if wanted.get("color") in names:
        colors.active_color_index = names.index(wanted["color"])
    if wanted.get("color_render") in names:
        colors.render_color_index = names.index(wanted["color_render"])
