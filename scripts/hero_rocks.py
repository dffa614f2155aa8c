# SPDX-License-Identifier: GPL-3.0-or-later
"""The rocks of the hero scenes: base meshes as an artist would sculpt them, strata in them by the add-on's
own tools, and fewer faces where the camera does not look. Needs Blender."""

import heapq
import math

import bmesh
import bpy
import numpy as np
from mathutils import Vector
from mathutils.bvhtree import BVHTree
from realmodel.bl.host import versions
from realmodel.bl.objects import meshes, placing
from realmodel.bl.objects.materials import set_color
from realmodel.bl.shading import strata_modifier, strata_values
from realmodel.core.base.work import Work
from realmodel.core.filling import divided_at_beds, hardness_of_beds
from realmodel.core.filling.erosion import cubic_lattice, meshed

_LOOK_SLOTS = 5  # rocks of a palette
_BASE_FACES = 26_000  # triangles of a base mesh at most, so that the files stay small
_SCREE = "scree"  # the attribute of the faces of scree, while a mesh is thinned
_UNDIVIDED = 0.9  # triangles of a thinned mesh, of the polygons that it has once it is divided at its beds
_SHARP = math.radians(48.0)  # the angle between faces from which an edge is sharp


def solid(low, high, spacing, inside):
    """A closed mesh of where a function of x, y, z, each broadcast, is above 0, within a box."""
    low, high = np.array(low, float), np.array(high, float)
    counts = np.round((high - low) / spacing).astype(int) + 5
    origin = low - 2.0 * spacing
    x, y, z = np.ix_(*(origin[axis] + spacing * np.arange(counts[axis]) for axis in range(3)))
    field = inside(x, y, z)
    for axis, each in enumerate((x, y, z)):
        field = np.minimum(field, np.minimum(each - low[axis], high[axis] - each))
    lattice = cubic_lattice(origin, spacing, counts)
    field = np.clip(field, -2.0 * spacing, 2.0 * spacing)
    return meshed(Work(), lattice, -field)


def strata(name, mesh, preset, *, is_compact=True, **values):
    """An object with the modifier Strata. mesh: vertices and triangles. is_compact: whether it may
    have fewer faces and another order of vertices. values: of its strata."""
    made = meshes.triangle_mesh(name, *mesh)
    if is_compact and len(mesh[1]) > _BASE_FACES:
        made = _collapsed(made, _BASE_FACES / len(mesh[1]))
    item = bpy.data.objects.new(name, compact(made, name) if is_compact else made)
    bpy.context.scene.collection.objects.link(item)
    placing.select([item])
    bpy.ops.realmodel.strata_preset(preset=preset)
    strata_modifier.set_values(item, values)
    return item


def rock_slots(item):
    """{number: material} of the rocks of an object's strata, and "Scree"."""
    modifier = strata_modifier.modifier_of(item)
    slots = {n: versions.group_input(modifier, f"Rock {n}") for n in range(1, _LOOK_SLOTS + 1)}
    return slots | {"Scree": versions.group_input(modifier, "Scree")}


def set_rock(item, slot, material):
    """Replaces a material of an object's strata, as an artist does in the modifier."""
    name = slot if slot == "Scree" else f"Rock {slot}"
    versions.set_group_input(strata_modifier.modifier_of(item), name, material)


def erode(item, faces, strength=1.0, joints=1.0, roughness=1.0, scree=0.0, stones=1.0):
    """Erodes an object with the add-on's operator."""
    given = {"faces": faces, "strength": strength, "joints": joints, "roughness": roughness}
    strata_modifier.set_values(item, given | {"scree": scree})
    item.realmodel_strata.stones = stones
    placing.select([item])
    bpy.ops.realmodel.strata_erode()


def reshape(item, vertices):
    """Moves the vertices of an object, as sculpting does: its beds stay where they are."""
    item.data.vertices.foreach_set("co", np.asarray(vertices, np.float32).ravel())
    item.data.update()
    bpy.context.view_layer.update()


def make_solid(item):
    """The beds of an object as closed solids, by the add-on's operator: objects."""
    placing.select([item])
    bpy.ops.realmodel.fill_with_strata(use_dialog=False)
    return list(item.realmodel_strata.beds_in.objects)


def recolor(item, solids, colors, change):
    """Gives solids copies of the rocks of an object in other colors. colors: {number of a rock: "#rrggbb"}.
    change: a function of a material."""
    for number, material in rock_slots(item).items():
        if number not in colors:
            continue
        copy = material.copy()
        set_color(copy, colors[number])
        change(copy)
        set_rock(item, number, copy)
        for solid_ in solids:
            for slot in solid_.material_slots:
                if slot.material == material:
                    slot.material = copy


def eroded_mesh(item):
    """The mesh datablock that the modifier shows after erosion."""
    return versions.group_input(strata_modifier.modifier_of(item), "Eroded Mesh").data


def thinned(item, faces, views):
    """Leaves about so many polygons of an eroded mesh, small ones where cameras see it from nearby: fewer
    triangles, divided at the beds so that these have sharp edges, and joined to quads. views: where the
    cameras are."""
    mesh = eroded_mesh(item)
    count = len(mesh.polygons)
    values = np.zeros(count, bool)
    mesh.attributes[strata_modifier.SCREE].data.foreach_get("value", values)
    numbers = mesh.attributes.new(_SCREE, "INT", "FACE")  # bmesh of Blender 3.4 has no layers of booleans
    numbers.data.foreach_set("value", values.astype(np.int32))
    if count > faces:
        mesh = _collapsed(mesh, _UNDIVIDED * faces / count, np.round(_coarse(mesh, views), 1))
    made = compact(_divided(mesh, strata_modifier.beds_of(item)[0]), f"{item.name} Eroded", is_smooth=True)
    strata_modifier.show_eroded(item, made)
    made.name = f"{item.name} Eroded"  # the one before had this name
    print(f"{item.name}: {count:,} triangles, {len(made.polygons):,} polygons are left", flush=True)


def _divided(mesh, beds):
    """A mesh of triangles whose rock is divided at the beds, its faces with the number of their bed as that
    of their material."""
    places, triangles = np.empty(3 * len(mesh.vertices)), np.empty(3 * len(mesh.polygons), np.int32)
    scree = np.zeros(len(mesh.polygons), np.int32)
    mesh.vertices.foreach_get("co", places)
    mesh.polygons.foreach_get("vertices", triangles)
    mesh.attributes[_SCREE].data.foreach_get("value", scree)
    triangles = triangles.reshape(-1, 3)
    places, rock = divided_at_beds(places.reshape(-1, 3), triangles[scree == 0], beds)
    triangles = np.concatenate([rock, triangles[scree != 0]])
    made = meshes.triangle_mesh("divided", places, triangles)
    of_bed = 1 + beds.numbers(places[triangles].mean(axis=1))
    of_bed[len(rock) :] = 0
    made.polygons.foreach_set("material_index", of_bed.astype(np.int32))
    is_scree = (np.arange(len(triangles)) >= len(rock)).astype(np.int32)
    made.attributes.new(_SCREE, "INT", "FACE").data.foreach_set("value", is_scree)
    return made


def _collapsed(mesh, ratio, weights=None):
    """A new mesh with this share of the triangles of a mesh. weights: (V,) how coarse it may
    be, from 0 to 1."""
    holder = bpy.data.objects.new("collapsed", mesh)
    bpy.context.scene.collection.objects.link(holder)
    modifier = holder.modifiers.new("Decimate", "DECIMATE")
    modifier.ratio = ratio
    if weights is not None:
        group = holder.vertex_groups.new(name="coarse")
        for weight in np.unique(weights):
            group.add(np.flatnonzero(weights == weight).tolist(), float(weight), "REPLACE")
        modifier.vertex_group, modifier.vertex_group_factor = group.name, 60.0
    fewer = bpy.data.meshes.new_from_object(holder.evaluated_get(bpy.context.evaluated_depsgraph_get()))
    bpy.data.objects.remove(holder)
    return fewer


def compact(mesh, name, is_smooth=False):
    """A mesh that takes little space in a compressed file: quads where two triangles of one material are
    nearly flat, vertices in the order of their places, coordinates rounded to a 20,000th of its size.
    is_smooth: with smooth faces between sharp edges."""
    work = bmesh.new()
    work.from_mesh(mesh)
    bmesh.ops.join_triangles(
        work,
        faces=work.faces,
        cmp_materials=True,
        angle_face_threshold=math.radians(35),
        angle_shape_threshold=math.radians(70),
    )
    layer = work.faces.layers.int.get(_SCREE)
    places = np.array([tuple(vertex.co) for vertex in work.verts])
    work.verts.index_update()
    polygons = [[vertex.index for vertex in face.verts] for face in work.faces]
    is_scree = np.array([bool(face[layer]) if layer is not None else False for face in work.faces])
    sharp = [[vertex.index for vertex in edge.verts] for edge in work.edges if _is_sharp(edge)]
    work.free()
    step = 2.0 ** math.floor(math.log2(np.ptp(places, axis=0).max() / 20_000.0))
    cells = np.floor((places - places.min(axis=0)) / (np.ptp(places, axis=0).max() / 1023.0)).astype(np.int64)
    order = np.argsort(_morton(cells), kind="stable")
    number = np.empty(len(order), np.int64)
    number[order] = np.arange(len(order))
    polygons = [number[polygon].tolist() for polygon in polygons]
    by_place = sorted(range(len(polygons)), key=lambda n: min(polygons[n]))
    made, edges = _sorted_mesh(name, np.round(places[order] / step) * step, [polygons[n] for n in by_place])
    if is_smooth:
        made.polygons.foreach_set("use_smooth", np.ones(len(polygons), bool))
        keys = _keys(number[np.array(sharp, np.int64).reshape(-1, 2)])
        made.edges.foreach_set("use_edge_sharp", np.isin(_keys(edges), keys))
        made.use_auto_smooth, made.auto_smooth_angle = True, math.pi  # edges that are sharp, and no others
    if layer is not None:
        values = made.attributes.new(strata_modifier.SCREE, "BOOLEAN", "FACE")
        values.data.foreach_set("value", is_scree[by_place])
    return made


def _is_sharp(edge):
    return len(edge.link_faces) != 2 or edge.calc_face_angle() > _SHARP


def _keys(pairs):
    """(E,) int64 a number of each pair of vertices (E, 2), in any order."""
    pairs = np.sort(np.asarray(pairs, np.int64), axis=1)
    return pairs[:, 0] << 32 | pairs[:, 1]


def _sorted_mesh(name, vertices, polygons):
    """A mesh whose edges are in the order of their vertices, which compresses to less than Blender's order;
    and its edges (E, 2)."""
    corners = np.concatenate(polygons).astype(np.int32)
    sizes = np.array([len(polygon) for polygon in polygons])
    starts = np.concatenate([[0], np.cumsum(sizes)[:-1]])
    after = np.arange(len(corners)) + 1
    after[starts + sizes - 1] = starts
    keys, of_corners = np.unique(_keys(np.stack([corners, corners[after]], 1)), return_inverse=True)
    edges = np.stack([keys >> 32, keys & 0xFFFFFFFF], 1).astype(np.int32)
    made = bpy.data.meshes.new(name)
    made.vertices.add(len(vertices))
    made.vertices.foreach_set("co", vertices.astype(np.float32).ravel())
    made.edges.add(len(edges))
    made.edges.foreach_set("vertices", edges.ravel())
    made.loops.add(len(corners))
    made.loops.foreach_set("vertex_index", corners)
    made.loops.foreach_set("edge_index", of_corners.astype(np.int32))
    made.polygons.add(len(polygons))
    made.polygons.foreach_set("loop_start", starts.astype(np.int32))
    made.polygons.foreach_set("loop_total", sizes.astype(np.int32))
    made.update()
    return made, edges


def _morton(cells):
    """(N,) int64 the bits of whole numbers (N, 3), interleaved: near places have near numbers."""
    code = np.zeros(len(cells), np.int64)
    for bit in range(10):
        for axis in range(3):
            code |= ((cells[:, axis] >> bit) & 1) << (3 * bit + axis)
    return code


def _coarse(mesh, views):
    """(V,) how coarse a mesh may be at each vertex, 0 to 1: 1 where no camera sees it."""
    places = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", places)
    places = places.reshape(-1, 3)
    seen = _seen(mesh, views)
    away = np.sqrt(((places - np.array(views[0], np.float32)) ** 2).sum(axis=1))
    near = float(np.quantile(away[seen], 0.1)) if seen.any() else 1.0
    return np.where(seen, 1.0 - np.minimum(1.0, near / np.maximum(away, near)) ** 0.5, 1.0) * 0.9 + 0.1


def _seen(mesh, views):
    """(V,) bool: the vertices that a camera at one of these places may see."""
    tree = BVHTree.FromPolygons([v.co for v in mesh.vertices], [tuple(p.vertices) for p in mesh.polygons])
    seen = np.zeros(len(mesh.vertices), bool)
    for view in map(Vector, views):
        for number, vertex in enumerate(mesh.vertices):
            if seen[number]:
                continue
            way = view - vertex.co
            if way.dot(vertex.normal) <= 0.0:
                continue
            away = way.length
            start = vertex.co + vertex.normal * (2e-4 * away) + way * 2e-4
            seen[number] = tree.ray_cast(start, way / away, away)[0] is None
    return _wider(mesh, seen)


def _wider(mesh, chosen):
    """With the neighbors of what is chosen, twice."""
    edges = np.empty(2 * len(mesh.edges), np.int32)
    mesh.edges.foreach_get("vertices", edges)
    edges = edges.reshape(-1, 2)
    for _ in range(2):
        touched = edges[chosen[edges].any(axis=1)]
        chosen = chosen.copy()
        chosen[touched.ravel()] = True
    return chosen


def is_closed(mesh):
    """Whether each edge of a mesh has two faces."""
    made = bmesh.new()
    made.from_mesh(mesh)
    closed = all(len(edge.link_faces) == 2 for edge in made.edges)
    made.free()
    return closed


# -- land that water has shaped


def drained(
    height, spacing, erodibility, steps, time, uplift=0.0, fixed=None, smooth=0.0, power=0.45, steepest=None
):
    """Heights (nx, ny) that rivers cut down: the stream power law, solved implicitly (Braun & Willett 2013,
    "A very efficient O(n), implicit and parallel method to solve the stream power equation").

    erodibility: of heights (N,), what it is there. time: of a step. fixed: (nx, ny) bool, where the elevation
    stays. smooth: of hillslopes, the share of the mean of neighbors in each step. steepest: the slope that
    hillslopes have at most, a number or (N,) of heights (N,)."""
    nx, ny = height.shape
    z = height.astype(float).ravel().copy()
    index = np.arange(nx * ny).reshape(nx, ny)
    if fixed is None:
        fixed = np.zeros((nx, ny), bool)
        fixed[0] = fixed[-1] = fixed[:, 0] = fixed[:, -1] = True
    stay = fixed.ravel()
    steps_around = [(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1) if i or j]
    for _ in range(steps):
        filled = _filled(z.reshape(nx, ny), fixed)
        receiver, slope = index.ravel().copy(), np.zeros(nx * ny)
        away = np.full(nx * ny, spacing)
        for i, j in steps_around:
            here = (slice(max(0, -i), nx - max(0, i)), slice(max(0, -j), ny - max(0, j)))
            there = (slice(max(0, i), nx - max(0, -i)), slice(max(0, j), ny - max(0, -j)))
            length = spacing * math.hypot(i, j)
            fall = np.full((nx, ny), -1.0)
            fall[here] = (filled[here] - filled[there]) / length
            better = fall.ravel() > slope
            other = index.copy()
            other[here] = index[there]
            receiver[better] = other.ravel()[better]
            slope[better] = fall.ravel()[better]
            away[better] = length
        flat = filled.ravel()
        order = np.argsort(flat, kind="stable")
        area = np.full(nx * ny, spacing * spacing).tolist()
        down = receiver.tolist()
        for node in order[::-1].tolist():
            if down[node] != node:
                area[down[node]] += area[node]
        factor = (erodibility(flat) * time * np.array(area) ** power / away).tolist()
        level = (z + np.where(stay, 0.0, uplift * time)).tolist()
        for node in order.tolist():
            to = down[node]
            if to != node and not stay[node] and level[node] > level[to]:
                level[node] = (level[node] + factor[node] * level[to]) / (1.0 + factor[node])
        z = np.array(level)
        if smooth:
            field = z.reshape(nx, ny)
            mean = np.pad(field, 1, mode="edge")
            mean = (mean[:-2, 1:-1] + mean[2:, 1:-1] + mean[1:-1, :-2] + mean[1:-1, 2:]) / 4.0
            z = np.where(stay, z, ((1.0 - smooth) * field + smooth * mean).ravel())
        if steepest is not None:
            z = _repose(z.reshape(nx, ny), spacing, steepest, stay).ravel()
    return z.reshape(nx, ny)


def _repose(z, spacing, steepest, stay):
    """Heights lowered until no slope toward a lower neighbor is steeper than this."""
    for _ in range(3):
        limit = steepest(z.ravel()).reshape(z.shape) if callable(steepest) else steepest
        wide = np.pad(z, 1, mode="edge")
        lowest = np.minimum.reduce([wide[:-2, 1:-1], wide[2:, 1:-1], wide[1:-1, :-2], wide[1:-1, 2:]])
        z = np.where(stay.reshape(z.shape), z, np.minimum(z, lowest + limit * spacing))
    return z


def _filled(z, fixed):
    """Heights with all hollows filled, so that each place drains to a fixed one (Barnes et al. 2014,
    "Priority-flood")."""
    nx, ny = z.shape
    heights = z.ravel().tolist()
    done = fixed.ravel().tolist()
    queue = [(heights[node], node) for node in np.flatnonzero(fixed).tolist()]
    heapq.heapify(queue)
    while queue:
        level, node = heapq.heappop(queue)
        i, j = divmod(node, ny)
        for a in (i - 1, i, i + 1):
            if not 0 <= a < nx:
                continue
            for b in (j - 1, j, j + 1):
                if not 0 <= b < ny:
                    continue
                other = a * ny + b
                if done[other]:
                    continue
                done[other] = True
                if heights[other] <= level:
                    heights[other] = level + 1e-4
                heapq.heappush(queue, (heights[other], other))
    return np.array(heights).reshape(nx, ny)


def finer(field, times):
    """A field (nx, ny) at times as many nodes, by cubic interpolation along each axis (Catmull-Rom)."""
    for _ in range(2):
        count = len(field)
        place = np.linspace(0.0, count - 1.0, (count - 1) * times + 1)
        cell = np.minimum(place.astype(int), count - 2)
        share = (place - cell)[:, None]
        rows = [field[np.clip(cell + k, 0, count - 1)] for k in (-1, 0, 1, 2)]
        field = rows[1] + 0.5 * share * (
            rows[2] - rows[0]
            + share * (2 * rows[0] - 5 * rows[1] + 4 * rows[2] - rows[3]
                       + share * (3 * (rows[1] - rows[2]) + rows[3] - rows[0]))
        )  # fmt: skip
        field = field.T
    return field


def stepped(levels, hardness, low, high, height, cliffs=0.22):
    """Heights made to cliffs in hard beds and slopes in soft ones: an elevation index from `low` to `high` is
    mapped so that a hard bed takes a small share of it. levels: (B - 1,) boundaries of beds."""
    edges = np.concatenate([[low], levels[(levels > low) & (levels < high)], [high]])
    first = int(np.searchsorted(levels, low))
    widths = np.diff(edges)
    hard = hardness[first : first + len(widths)]
    spans = widths * np.where(hard >= 0.55, cliffs, 1.7)
    index = low + (high - low) * np.concatenate([[0.0], np.cumsum(spans)]) / spans.sum()
    return np.where((height > low) & (height < high), np.interp(height, index, edges), height)


def beds_in(item):
    """The boundaries (B - 1,) of an object's level beds, and how hard each is (B,)."""
    beds, _ = strata_modifier.beds_of(item)
    drawn = strata_values.strata_of(item.realmodel_strata, beds.high - beds.low)
    middle = 0.5 * (beds.low + beds.high)
    datum = float(beds.datum(middle[None, :2], beds.strips(middle[None, :2]))[0])
    return beds.levels + datum, hardness_of_beds(beds.count, drawn)
