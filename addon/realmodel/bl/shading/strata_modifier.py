# SPDX-License-Identifier: GPL-3.0-or-later
"""The modifier Strata: the beds of a mesh, shown while it is sculpted.

The modifier is of geometry nodes and gives each vertex its bed, and each face the material of its rock. Beds
are laid through the mesh once (core.filling.Beds) and then stay where they are, in the object's coordinates,
until a value changes. The nodes read them from a table, a mesh in no collection: its attributes are the
numbers of the beds, and its points are pairs on both sides of each boundary, so that the nearest one says
which bed a height is in. Text on the table's object has the same numbers with all digits.
"""

import json
import math
import zlib
from contextlib import contextmanager

import bpy
import numpy as np

from ...core import RealModelError
from ...core.filling import PALETTES, Beds, hardness_of_beds, lay_beds, rocks_of_beds
from ...core.project.looks import look_of
from ..host import versions
from ..host.geometry_nodes import GeometryNodes
from ..host.nodes import group_once, modifier_with
from ..objects import filled_beds, materials, meshes, viewports
from ..objects.filled_beds import SCREE
from ..objects.filled_beds import STRATA as KEY
from . import looks, scatter, strata_values

NAME = "Strata"
ROCK = "realmodel_rock"  # on faces: the number of the rock in its palette, from 0
_BEDS = "realmodel_beds"  # on the table's object: the beds, and the frame that they are in, as text
_ROW = "realmodel_table_row"  # on vertices, while the nodes work
_MATERIAL = "realmodel_strata_rock"  # on a material: its palette and rock
_VERSION = 2
ROCKS = max(map(len, PALETTES.values()))
_TABLE, _ERODED, _SHOW_ERODED, SHOW_ROCKS = "Beds", "Eroded Mesh", "Show Erosion", "Show Rocks"
_SCREE, _STONES, _SIZE = "Scree", "Plants and Stones", "Scatter Size"
_STONES_APART, _STONE_SCALE = 0.55, 2.0  # a unit of scattered stones, of the thickness of beds; their scale
_NODES = 32  # of a fold to a wavelength, as core.filling.beds has it
_FAR = 1e30  # the elevation of an unconformity where there is none
# attributes of the table: of all points the same, and of each point
_WHOLE = ("x", "y", "z", "shift", "lean", "middle", "slope", "across", "wave", "fault_across", "levels")
_OF_POINTS = ("bed", "rock", "base", "top", "hardness", "throw")

MODES = ("EDIT", "SCULPT", "VERTEX_PAINT", "WEIGHT_PAINT", "TEXTURE_PAINT")  # that change the mesh
# values that lay the beds anew; the others say what Erode and Make Solid do
LAYING = frozenset(
    (
        *("palette", "rock_looks", "seed", "beds", "thickness", "variation", "dip", "dip_direction"),
        *("fold_amplitude", "fold_wavelength", "fold_axis", "axial_dip", "faults", "throw", "fault_strike"),
        *("unconformity", "base_depth", "close_holes"),
    )
)
_is_changing = False  # values are being set in turn: the last one updates


def modifier_of(item):
    """The modifier Strata of an object, or None."""
    return modifier_with(item, KEY)


def put_on(item):
    """Adds the modifier to an object that has none. Returns it."""
    modifier = modifier_of(item)
    if modifier is None:
        modifier = item.modifiers.new(NAME, "NODES")
        modifier.node_group = group_once("GeometryNodeTree", NAME, KEY, _fill, _VERSION)
        versions.set_group_input(modifier, SHOW_ROCKS, True)
    return modifier


def take_off(item):
    """Removes the modifier, its table, its eroded mesh, and its stones where no other object has them."""
    modifier = modifier_of(item)
    if modifier is None:
        return
    made = [versions.group_input(modifier, name) for name in (_TABLE, _ERODED)]
    stones = versions.group_input(modifier, scatter.STONE)
    item.modifiers.remove(modifier)
    scatter.remove(stones)
    for obj in made:
        if obj is not None and obj.users == 0:
            bpy.data.meshes.remove(obj.data)  # and its object with it


def changed(values, _context):
    """A value of LAYING was changed: by hand or by a script."""
    item = values.id_data
    if _is_changing or modifier_of(item) is None:
        return
    try:
        update(item)
        problem = ""
    except RealModelError as error:
        problem = str(error)
    if values.problem != problem:
        values.problem = problem


def set_values(item, values):
    """Sets several values, given by their names, at once. Raises RealModelError: then they stay as they
    are."""
    before = {name: getattr(item.realmodel_strata, name) for name in values}
    _assign(item, values)
    if modifier_of(item) is not None and not LAYING.isdisjoint(values):
        try:
            update(item)
        except RealModelError:
            _assign(item, before)
            raise


def stones_changed(values, _context):
    """The density of stones was changed."""
    modifier = modifier_of(values.id_data)
    if modifier is not None:
        versions.set_group_input(modifier, _STONES, values.stones)


def _assign(item, values):
    global _is_changing
    _is_changing = True
    try:
        for name, value in values.items():
            setattr(item.realmodel_strata, name, value)
    finally:
        _is_changing = False


def beds_of(item):
    """The beds of an object, core.filling.Beds, and the matrix (4, 4) from its coordinates to theirs; None
    where it has none."""
    modifier = modifier_of(item)
    table = None if modifier is None else versions.group_input(modifier, _TABLE)
    if table is None:
        return None
    record = json.loads(table[_BEDS])
    return Beds.from_json(record["beds"]), np.array(record["matrix"])


def base_shape(item, matrix=None):
    """The shape of an object without erosion, filled_beds.FilledShape. Raises InputRefused."""
    with without_erosion(item) as depsgraph:
        return filled_beds.FilledShape.of(item, depsgraph, matrix)


def base_mesh(item):
    """A new mesh datablock of an object without erosion, with all attributes."""
    with without_erosion(item) as depsgraph:
        return bpy.data.meshes.new_from_object(item.evaluated_get(depsgraph))


@contextmanager
def without_erosion(item, *others):
    """For a while an object is evaluated without erosion, and without others of what it shows; yields the
    dependency graph."""
    modifier = modifier_of(item)
    names = [name for name in (_SHOW_ERODED, *others) if modifier and versions.group_input(modifier, name)]
    for name in names:
        versions.set_group_input(modifier, name, False)
    try:
        yield bpy.context.evaluated_depsgraph_get()
    finally:
        for name in names:
            versions.set_group_input(modifier, name, True)


def update(item):
    """Lays the beds through the mesh anew, as it is now. Raises RealModelError: then they stay as they
    are."""
    values = item.realmodel_strata
    shape = base_shape(item)
    places, _ = shape.closed(values.base_depth, values.close_holes)
    strata = strata_values.strata_of(values, np.ptp(places, axis=0))
    beds = lay_beds(strata, places)
    modifier = put_on(item)
    table = versions.group_input(modifier, _TABLE)
    if table is None or table.users > 1:  # a copy of an object has the table of the first one
        name = f"{item.name} Strata Table"
        table = bpy.data.objects.new(name, bpy.data.meshes.new(name))
        versions.set_group_input(modifier, _TABLE, table)
    _write(table, beds, shape.matrix, strata)
    diagonal = float(np.linalg.norm(np.ptp(shape.local, axis=0)))
    size = diagonal if values.rock_looks else 0.0
    rocks = PALETTES[strata.palette]
    for number, (name, color) in enumerate(rocks, 1):
        versions.set_group_input(modifier, f"Rock {number}", _rock_material(name, color, look_of(name), size))
    color = "#" + "".join(f"{round(part):02x}" for part in np.mean([_bytes(c) for _, c in rocks], axis=0))
    versions.set_group_input(modifier, _SCREE, _rock_material("Scree", color, "GRAVEL", size))
    versions.set_group_input(modifier, _STONES, values.stones)
    versions.set_group_input(modifier, "Seed", values.seed)
    show_eroded(item, None)


def _bytes(color):
    return [int(color[begin : begin + 2], 16) for begin in (1, 3, 5)]


def set_rubble(item, pieces, thickness):
    """Sets the stones of an object's scree. pieces: (number of a rock in the palette, (vertices, triangles))
    each, in its coordinates. thickness: of beds on average, there."""
    modifier = modifier_of(item)
    before = versions.group_input(modifier, scatter.STONE)
    stones = [(*piece, material_of(item, rock)) for rock, piece in pieces]
    versions.set_group_input(modifier, scatter.STONE, scatter.collection(f"{item.name} Rubble", stones))
    versions.set_group_input(modifier, _SIZE, _STONES_APART * thickness)
    scatter.remove(before)


def mark_scree(mesh, is_scree, down):
    """is_scree: (F,) bool, of faces. down: (V,) how far down the scree each vertex is."""
    mesh.attributes.new(SCREE, "BOOLEAN", "FACE").data.foreach_set("value", is_scree)
    mesh.attributes.new(scatter.DOWN, "FLOAT", "POINT").data.foreach_set("value", down)


def put_scree_on(heap, item, down):
    """Makes a new object the scree of another: its material, and its stones."""
    heap[SCREE] = True
    mark_scree(heap.data, np.ones(len(heap.data.polygons), bool), down)
    heap.modifiers.new(NAME, "NODES").node_group = modifier_of(item).node_group
    for name in (_TABLE, _SCREE, scatter.STONE, _STONES, _SIZE, "Seed"):
        versions.set_group_input(modifier_of(heap), name, versions.group_input(modifier_of(item), name))


def is_made(item):
    """Whether an object was made by filling another."""
    if item.type != "MESH":
        return False
    return filled_beds.BED in item or SCREE in item or filled_beds.BED in item.data.attributes


def material_of(item, rock):
    """The material of a rock of an object's strata, by its number in the palette."""
    return versions.group_input(modifier_of(item), f"Rock {rock + 1}")


def show_eroded(item, mesh):
    """Shows an eroded mesh, a datablock in the object's coordinates, in place of its own; None: its own."""
    modifier = put_on(item)
    shown = versions.group_input(modifier, _ERODED)
    if mesh is not None:
        if shown is None or shown.users > 1:
            shown = bpy.data.objects.new(mesh.name, mesh)
            versions.set_group_input(modifier, _ERODED, shown)
        else:
            before, shown.data = shown.data, mesh
            bpy.data.meshes.remove(before)
    versions.set_group_input(modifier, _SHOW_ERODED, mesh is not None)
    item.update_tag()
    viewports.redraw()


def show_edited(name):
    """Shows the mesh of an object that is being edited, without erosion: it is what strokes change."""
    item = bpy.data.objects.get(name)
    if item is not None and shows_erosion(item):
        show_eroded(item, None)


def shows_erosion(item):
    """Whether the eroded mesh is shown."""
    modifier = modifier_of(item)
    return modifier is not None and bool(versions.group_input(modifier, _SHOW_ERODED))


def _rock_material(name, color, look, size):
    """The material of a rock, one for all objects of about a size. size: of the diagonal, 0: without a
    look."""
    size = 2.0 ** round(math.log2(size)) if size else 0.0
    key = f"{name} {color} {size:g}"
    made = next((m for m in bpy.data.materials if m.get(_MATERIAL) == key and m.library is None), None)
    if made is None:
        made = materials.new_material(name, materials.NO_PROPERTY, color)
        del made[materials.KEY]
        made[_MATERIAL] = key
        if size:
            looks.apply(made, look, 1.0, zlib.crc32(name.encode()) % 1000, size)
    return made


def _write(table, beds, matrix, strata):
    """Fills a table."""
    low, high = beds.bounds()
    _, rocks = rocks_of_beds(beds.count, strata.palette, strata.seed)
    hardness = hardness_of_beds(beds.count, strata)
    has_cover = np.isfinite(beds.floor)
    along, distances, shifts = beds.fault
    tilted = np.arange(len(beds.levels) + 1)
    covering = np.arange(len(tilted), beds.count)
    rows = [(beds.levels, tilted), (distances, np.arange(len(shifts))), (beds.covers, covering)]
    if not has_cover:
        rows.pop()
    places, numbers = zip(*(_pairs(*row) for row in rows), strict=True)
    apart = 8.0 * (1.0 + max(float(np.abs(values).max(initial=0.0)) for values in places))
    points = np.concatenate(
        [np.column_stack([x, np.full(len(x), apart * row), 0 * x]) for row, x in enumerate(places)]
    )
    is_fault = np.repeat(np.arange(len(rows)) == 1, [len(x) for x in places])
    number = np.concatenate(numbers)
    bed = np.where(is_fault, 0, number)
    of_points = {
        "bed": bed + 1,
        "rock": np.array(rocks)[bed] - 1,
        "base": low[bed],
        "top": high[bed],
        "hardness": hardness[bed],
        "throw": np.where(is_fault, shifts[np.where(is_fault, number, 0)], 0.0),
    }
    whole = {
        **dict(zip("xyz", matrix[:3, :3], strict=True)),
        "shift": matrix[:3, 3],
        "lean": (*beds.lean, 0.0),
        "middle": (*beds.middle, 0.0),
        "slope": (*beds.slope, 0.0),
        "across": (*beds.across, 0.0),
        "wave": beds.wave,
        "fault_across": (*along, 0.0),
        "levels": (apart, beds.floor if has_cover else _FAR, 0.0),
    }
    mesh = table.data
    mesh.clear_geometry()
    mesh.vertices.add(len(points))
    mesh.vertices.foreach_set("co", points.astype(np.float32).ravel())
    for name, values in of_points.items():
        attribute = mesh.attributes.new(name, "FLOAT", "POINT")
        attribute.data.foreach_set("value", np.asarray(values, np.float32))
    for name, values in whole.items():
        attribute = mesh.attributes.new(name, "FLOAT_VECTOR", "POINT")
        attribute.data.foreach_set("vector", np.tile(np.asarray(values, np.float32), len(points)))
    mesh.update()
    table[_BEDS] = json.dumps({"beds": beds.to_json(), "matrix": matrix.tolist()})
    table.update_tag()


def _pairs(boundaries, numbers):
    """Points on both sides of boundaries (N,), equally far from each, and the numbers (N + 1,) of what lies
    between these. Without a boundary one point."""
    if not len(boundaries):
        return np.zeros(1), numbers
    sizes = np.diff(boundaries, prepend=-np.inf, append=np.inf)
    away = np.minimum(sizes[:-1], sizes[1:]) / 4.0
    away[~np.isfinite(away)] = 1.0
    places = np.stack([boundaries - away, boundaries + away], axis=1).ravel()
    return places, np.stack([numbers[:-1], numbers[1:]], axis=1).ravel()


def _fill(group):
    versions.add_group_socket(group, "Geometry", "NodeSocketGeometry", is_output=True)
    versions.add_group_socket(group, "Geometry", "NodeSocketGeometry")
    for name in (_TABLE, _ERODED):
        versions.add_group_socket(group, name, "NodeSocketObject")
    versions.add_group_socket(group, _SHOW_ERODED, "NodeSocketBool")
    versions.add_group_socket(group, SHOW_ROCKS, "NodeSocketBool")
    for number in range(ROCKS):
        versions.add_group_socket(group, f"Rock {number + 1}", "NodeSocketMaterial")
    versions.add_group_socket(group, _SCREE, "NodeSocketMaterial")
    versions.add_group_socket(group, scatter.STONE, "NodeSocketCollection")
    versions.add_group_socket(group, _STONES, "NodeSocketFloat", (0.0, 0.0))
    versions.add_group_socket(group, _SIZE, "NodeSocketFloatDistance", (1.0, 1e-6))
    versions.add_group_socket(group, "Seed", "NodeSocketInt", (0, 0))
    nodes = GeometryNodes(group)
    inputs = nodes.new("NodeGroupInput").outputs
    geometry = nodes.either(inputs["Geometry"], nodes.mesh_of(inputs[_ERODED]), inputs[_SHOW_ERODED])
    beds = _Beds(nodes, nodes.mesh_of(inputs[_TABLE]))
    geometry = beds.stored(geometry)
    geometry = nodes.stored(geometry, ROCK, beds.of_row("rock", beds.row(beds.height())), "FACE", "INT")
    rock = nodes.named(ROCK, "INT")
    for number in range(ROCKS):
        here = nodes.math("MULTIPLY", nodes.math("COMPARE", rock, float(number), 0.5), inputs[SHOW_ROCKS])
        geometry = nodes.to(
            "GeometryNodeSetMaterial", geometry, Selection=here, Material=inputs[f"Rock {number + 1}"]
        )
    is_scree = nodes.named(SCREE, "BOOLEAN")
    geometry = nodes.to("GeometryNodeSetMaterial", geometry, Selection=is_scree, Material=inputs[_SCREE])
    joined = nodes.new("GeometryNodeJoinGeometry")
    down = nodes.named(scatter.DOWN, "FLOAT")
    stones = scatter.on(nodes, inputs, geometry, scatter.STONE, is_scree, _STONE_SCALE, down)
    nodes.link(stones, joined.inputs[0])
    nodes.link(geometry, joined.inputs[0])
    nodes.link(joined.outputs[0], nodes.new("NodeGroupOutput").inputs["Geometry"])


class _Beds:
    """Fields of what a table says of positions: see core.filling.Beds, whose formulas these are."""

    def __init__(self, nodes, table):
        self._nodes, self._table = nodes, table
        vectors = {name: nodes.named(name, "FLOAT_VECTOR") for name in _WHOLE}
        self._whole = whole = {
            name: nodes.at(table, 0, vector, "FLOAT_VECTOR") for name, vector in vectors.items()
        }
        position = nodes.of("GeometryNodeInputPosition", "Position")
        place = nodes.new("ShaderNodeCombineXYZ")
        for axis, name in enumerate("xyz"):
            turned = nodes.vector("DOT_PRODUCT", position, whole[name])
            nodes.link(nodes.math("ADD", turned, nodes.part(whole["shift"], axis)), place.inputs[axis])
        self._z = nodes.part(place.outputs[0], 2)
        away = nodes.vector("SUBTRACT", place.outputs[0], whole["middle"])
        self._away = nodes.vector("SUBTRACT", away, nodes.vector("SCALE", whole["lean"], self._z))
        self._apart, floor = (nodes.part(whole["levels"], axis) for axis in (0, 1))
        self._covers = nodes.math("GREATER_THAN", self._z, floor)

    def stored(self, geometry):
        """The geometry with the attributes of beds. The height is stored first, then the row of the table, as
        each attribute would follow all of its nodes anew."""
        nodes = self._nodes
        name = meshes.PREFIX + "height"
        geometry = nodes.stored(geometry, name, self.height())
        height = nodes.named(name, "FLOAT")
        geometry = nodes.stored(geometry, _ROW, self.row(height), kind="INT")
        found = {key: self.of_row(key, nodes.named(_ROW, "INT")) for key in _OF_POINTS}
        thickness = nodes.math("SUBTRACT", found["top"], found["base"])
        share = nodes.math("DIVIDE", nodes.math("SUBTRACT", height, found["base"]), thickness)
        share = nodes.math("MAXIMUM", nodes.math("MINIMUM", share, 1.0), 0.0)
        geometry = nodes.stored(geometry, filled_beds.BED, found["bed"], kind="INT")
        for key, value in (
            ("height", share),
            ("thickness", thickness),
            ("age", nodes.math("SUBTRACT", found["bed"], 1.0)),
            ("hardness", found["hardness"]),
        ):
            geometry = nodes.stored(geometry, meshes.PREFIX + key, value)
        return nodes.to("GeometryNodeRemoveAttribute", geometry, Name=_ROW)

    def height(self):
        """Above the datum, or above the unconformity the elevation."""
        nodes, whole = self._nodes, self._whole
        strip = self._nearest(nodes.vector("DOT_PRODUCT", self._away, whole["fault_across"]), 1)
        throw = self.of_row("throw", strip)
        plane = nodes.vector("DOT_PRODUCT", self._away, whole["slope"])
        fold = _fold(nodes, nodes.vector("DOT_PRODUCT", self._away, whole["across"]), whole["wave"])
        height = nodes.math("SUBTRACT", self._z, nodes.total([plane, fold, throw]))
        return nodes.mixed(height, self._z, self._covers)

    def row(self, height):
        """The number of the point of the table that says which bed a height is in."""
        return self._nearest(height, self._nodes.math("MULTIPLY", self._covers, 2.0))

    def of_row(self, name, row):
        """What the table says in a point."""
        return self._nodes.at(self._table, row, self._nodes.named(name, "FLOAT"), "FLOAT")

    def _nearest(self, value, line):
        """The number of the point in a line of the table that is nearest to a value."""
        place = self._nodes.new("ShaderNodeCombineXYZ")
        self._nodes.link(value, place.inputs[0])
        self._nodes.link(self._nodes.math("MULTIPLY", self._apart, line), place.inputs[1])
        return self._nodes.nearest(self._table, place.outputs[0])


def _fold(nodes, away, wave):
    """The height of the fold's polyline."""
    step, offset, amplitude = (nodes.part(wave, axis) for axis in range(3))
    along = nodes.math("SUBTRACT", nodes.math("DIVIDE", away, step), offset)
    node = nodes.math("FLOOR", along)
    ends = [
        nodes.math("SINE", nodes.math("MULTIPLY", end, 2.0 * np.pi / _NODES))
        for end in (node, nodes.math("ADD", node, 1.0))
    ]
    return nodes.math("MULTIPLY", nodes.mixed(*ends, nodes.math("SUBTRACT", along, node)), amplitude)
