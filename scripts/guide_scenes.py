# SPDX-License-Identifier: GPL-3.0-or-later
"""What scenes of the guide have beside examples: tables of points, grids that an artist made, lines of
sections, a graben between two faults. Needs Blender."""

import math
from pathlib import Path

SAMPLES = Path(__file__).resolve().parents[1] / "blend_samples"
BOX = "box of the model"
GRID_COLORS = ("#6f8296", "#d9b070", "#a4603f", "#e0cfa0", "#8c6d8a", "#7d9460")  # as in the library
LAYER_COLORS = ("#7d8fa3", "#e0b56a")  # clay, sand
GRABEN_COLORS = ("#c4aeaa", "#e6b069", "#97c0d6", "#f0e4ab", "#a9cc7a", "#d9b8cf")
_GRIDS = {  # height, strength of the Displace
    "basement": (0.0, 1.2),
    "sandstone": (1.0, 1.2),
    "shale": (1.7, 1.2),
    "limestone": (2.7, 1.2),
    "marl": (3.3, 1.2),
    "ground": (5.0, 0.5),
}
_CLIFF = 3.4  # its height
_FAULTS = {"West fault": (300.0, 0.22, 0.1), "East fault": (720.0, -0.2, -0.06)}
_LAYERS = {"Basement": -420.0, "Sandstone": -300.0, "Marl": -200.0, "Limestone": -110.0}


def import_tables():
    """Two tables of points become surfaces, their points large and in colors."""
    import bpy

    for name in ("clay", "ground"):
        bpy.ops.realmodel.surface_add(filepath=str(SAMPLES / "two_layers" / f"{name}.csv"))
    bpy.context.scene.realmodel.view.show_contacts = True


def drop_lines(scene):
    """Lines from the contacts of two tables to the plane z = 0, and the outline of their region there."""
    import csv

    import bpy
    from realmodel.bl.project import project_settings

    rows = []
    for name in ("clay", "ground"):
        with (SAMPLES / "two_layers" / f"{name}.csv").open(encoding="utf-8") as file:
            rows += [tuple(float(row[key]) for key in "xyz") for row in csv.DictReader(file)]
    tops = {(x, y): max(z for *plan, z in rows if plan == [x, y]) for x, y, _ in rows}
    corners = [(x, y, 0.0) for x, y in ((0.0, 0.0), (100.0, 0.0), (100.0, 60.0), (0.0, 60.0))]
    vertices = [place for (x, y), z in tops.items() for place in ((x, y, z), (x, y, 0.0))]
    edges = [(n, n + 1) for n in range(0, len(vertices), 2)]
    edges += [(len(vertices) + n, len(vertices) + (n + 1) % 4) for n in range(4)]
    mesh = bpy.data.meshes.new("lines")
    mesh.from_pydata(vertices + corners, edges, [])
    item = bpy.data.objects.new("lines", mesh)
    item.location = -project_settings.model_origin(scene)
    scene.collection.objects.link(item)
    return item


def settle_rock():
    """A region around the points, short edges, a base, and the names and colors of the example."""
    import bpy

    scene = bpy.context.scene
    rock = scene.realmodel.rocks[0]
    names = {"clay": "Clay", "ground": "Sand"}
    for row in rock.surfaces:
        row.block = names[row.name]
    for row in scene.realmodel.library:
        row.name = names[row.name]
    paint(scene.realmodel.library, LAYER_COLORS)
    bpy.ops.realmodel.region_around()
    rock.edge_length = 4.0
    rock.use_base, rock.base_elevation = True, 0.0


def grid(name, height, size, strength, seed):
    """A grid with a Displace modifier, as an artist makes it."""
    import bpy

    bpy.ops.mesh.primitive_grid_add(x_subdivisions=90, y_subdivisions=90, size=size, location=(0, 0, height))
    item = bpy.context.active_object
    item.name = name
    texture = bpy.data.textures.new(name, "CLOUDS")
    texture.noise_scale = 0.35 * size + 0.1 * seed
    modifier = item.modifiers.new("Displace", "DISPLACE")
    modifier.texture, modifier.strength, modifier.mid_level = texture, strength, 0.5
    modifier.direction = "Z"  # along normals outlines of grids would differ, and slivers stay
    return item


def grids():
    """The surfaces of layers as grids, selected, with colors of their own; the ground has a cliff."""
    import bpy
    from mathutils import Color

    for name, (height, strength) in _GRIDS.items():
        grid(name, height, 12.0, strength, 7 if name == "ground" else 1)
    for vertex in bpy.data.objects["ground"].data.vertices:
        x, y, _ = vertex.co
        across = 2.0 + y + 0.22 * x + 0.9 * math.sin(0.8 * x) + 0.35 * math.sin(2.1 * x)
        vertex.co.z = _CLIFF * (0.5 * math.tanh(across / 0.45) - 0.5) + 0.05 * across
    for name, color in zip(_GRIDS, GRID_COLORS, strict=True):
        item = bpy.data.objects[name]
        item.select_set(True)
        item.color = (*Color(rgb(color)).from_srgb_to_scene_linear(), 1.0)
        shade_smooth(item)


def shade_smooth(item):
    """Shades a mesh smoothly, except at its edges."""
    item.data.polygons.foreach_set("use_smooth", [True] * len(item.data.polygons))
    item.data.use_auto_smooth = True


def rgb(color):
    """(3,) of #rrggbb."""
    return [int(color[k : k + 2], 16) / 255 for k in (1, 3, 5)]


def paint(library, colors):
    """Gives the rows of a library these colors, as far as there are."""
    for row, color in zip(library, colors, strict=False):
        row.color = rgb(color)


def visible_meshes():
    """What the viewport shows of meshes."""
    import bpy

    return [item for item in bpy.data.objects if item.visible_get() and item.type == "MESH"]


def line(points):
    """A curve through points (x, y), as one draws it seen from above; it is the active object."""
    import bpy

    curve = bpy.data.curves.new("line", "CURVE")
    spline = curve.splines.new("POLY")
    spline.points.add(len(points) - 1)
    for corner, (x, y) in zip(spline.points, points, strict=True):
        corner.co = (x, y, 0.0, 1.0)
    item = bpy.data.objects.new("line", curve)
    bpy.context.scene.collection.objects.link(item)
    bpy.context.view_layer.objects.active = item
    item.select_set(True)
    return item


def ghost(items):
    """The box around objects as thin lines, the object BOX."""
    import bpy
    from realmodel.bl.objects import viewports

    bpy.context.view_layer.update()
    around = viewports.corners(items)
    low, high = around.min(axis=0), around.max(axis=0)
    bpy.ops.mesh.primitive_cube_add(location=(low + high) / 2, scale=(high - low) / 2)
    box = bpy.context.active_object
    box.name, box.display_type = BOX, "WIRE"
    box.select_set(False)


def gap(fence):
    """The middle of the widest gap in a fence, in the scene."""
    import numpy as np

    places = np.array([fence.matrix_world @ vertex.co for vertex in fence.data.vertices])
    places = places[np.argsort(places[:, 0])]
    last = np.diff(places[:, 0]).argmax()
    west, east = places[last], places[last + 1]
    return (*((west + east)[:2] / 2), places[:, 2].mean())


def _across(fault, y, z):
    """x of a listric fault."""
    x, lean, turn = _FAULTS[fault]
    down = 150.0 - z
    return x + turn * (y - 350.0) + lean * down * (0.5 + down / 1600.0)


def _displaced(base, x, y):
    """The height of a layer where the graben has sunk; None where the layer is missing beside a fault."""
    z = base + 0.06 * x + 9.0 * math.sin(x / 250.0) * math.cos(y / 230.0)
    if x < _across("West fault", y, z):
        return z
    if x > _across("East fault", y, z + 15.0):
        return z + 15.0
    sunk = z - 90.0
    is_between = _across("West fault", y, sunk) < x < _across("East fault", y, sunk)
    return sunk if is_between else None


def graben():
    """A model of points and two faults in the scene, not built yet."""
    import bpy
    import numpy as np
    from realmodel.bl.objects import meshes
    from realmodel.bl.project import library_rows

    def added(name, places, triangles=()):
        if len(triangles):
            mesh = meshes.triangle_mesh(name, np.array(places, np.float32), np.array(triangles))
        else:
            mesh = bpy.data.meshes.new(name)
            mesh.from_pydata(places, [], [])
        item = bpy.data.objects.new(name, mesh)
        bpy.context.scene.collection.objects.link(item)
        return item

    scene, random = bpy.context.scene, np.random.default_rng(3)
    bpy.ops.realmodel.new()
    bpy.ops.realmodel.rock_add()
    rock = scene.realmodel.rocks[0]
    for name, base in _LAYERS.items():
        plan = random.uniform((2.0, 2.0), (998.0, 698.0), (260, 2)).tolist()
        places = [(x, y, _displaced(base, x, y)) for x, y in plan]
        bpy.ops.realmodel.surface_add(name=name, empty=True)
        row = rock.surfaces[-1]
        row.source, row.method = "POINTS_OBJECT", "kriging"
        row.object = added(name, [place for place in places if place[2] is not None])
        row.object.hide_set(True)
    bpy.ops.realmodel.surface_add(name="Cover", empty=True)
    cover = rock.surfaces[-1]
    cover.source, cover.method, cover.value = "NONE", "constant", 0.0
    for row in rock.surfaces:
        row.property_id = library_rows.for_surface(scene, row.name)
    corners = [(0.0, 0.0, 0.0), (1000.0, 0.0, 0.0), (1000.0, 700.0, 0.0), (0.0, 700.0, 0.0)]
    rock.region = added("region", corners, [[0, 1, 2], [0, 2, 3]])
    rock.region.hide_set(True)
    rock.edge_length, rock.use_base, rock.base_elevation = 30.0, True, -640.0
    heights, along = np.linspace(-650.0, 150.0, 9), np.linspace(-150.0, 850.0, 6)
    n = len(heights)
    quads = [j * n + i for j in range(len(along) - 1) for i in range(n - 1)]
    triangles = [t for a in quads for t in ((a, a + 1, a + n + 1), (a, a + n + 1, a + n))]
    chosen = [
        added(name, [(_across(name, y, z), y, z) for y in along for z in heights], triangles)
        for name in _FAULTS
    ]
    for item in bpy.context.view_layer.objects:
        item.select_set(item in chosen)
    bpy.ops.realmodel.fault_body_from_selected()
    for row in scene.realmodel.faults:
        row.youngest = "Limestone"


def logs(folder, sample):
    """Tables of the holes of a sample as a driller logs them: collars, and the blocks that its model has
    there. Returns their paths."""
    import csv

    from realmodel.core import build, load_project

    path = SAMPLES / sample / "project.toml"
    model = build(load_project(path))
    with (path.parent / "collars.csv").open(encoding="utf-8") as file:
        holes = list(csv.DictReader(file))
    collars, intervals = ["hole,x,y,z,end"], ["hole,from,to,block"]
    for hole in holes:
        name, x, y = (hole[key] for key in ("hole", "x", "y"))
        met = model.borehole(float(x), float(y))
        end = met[-1].top - 15.0  # it ends in the bedrock
        collars.append(f"{name},{x},{y},{met[0].top:.2f},{met[0].top - end:.2f}")
        for part in met:
            depths = met[0].top - part.top, met[0].top - max(part.bottom, end)
            intervals.append(f"{name},{depths[0]:.2f},{depths[1]:.2f},{model.blocks[part.block].name}")
    paths = []
    for name, lines in (("collars", collars), ("intervals", intervals)):
        paths.append(folder / f"{name}.csv")
        paths[-1].write_text("\n".join(lines) + "\n", encoding="utf-8")
    return paths


def mistaken(tables):
    """Exchanges two units in the logs of some holes."""
    path = tables[1]
    lines = path.read_text(encoding="utf-8").splitlines()
    for hole in ("V02", "V11", "V28"):
        upper, lower = [n for n, line in enumerate(lines) if line.startswith(f"{hole},")][1:3]
        (*first, one), (*second, other) = lines[upper].split(","), lines[lower].split(",")
        lines[upper], lines[lower] = ",".join([*first, other]), ",".join([*second, one])
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def empty_folder(name):
    """A folder whose path says nothing of this machine, for pictures of the file browser."""
    folder = Path("/tmp", name)
    folder.mkdir()
    return folder


def in_tiles(folder, sample):
    """Builds a sample in tiles, with the command line; returns the path of their table."""
    import subprocess

    root = SAMPLES.parent
    command = [root / "build" / "venv" / "bin" / "python", root / "build_model.py"]
    command += [SAMPLES / sample / "project.toml", "--tiles", "600,400", "--out", folder / "tiles"]
    subprocess.run(list(map(str, command)), check=True, cwd=root)
    return folder / "tiles" / "tiles.toml"


def along(model, block, y, share, count):
    """Places (x, y, z) along x in a block, at a share of its height, where it is: of so many."""
    import numpy as np

    low, high = model.vertices[:, 0].min(), model.vertices[:, 0].max()
    for x in (low + (high - low) * np.linspace(0.02, 0.98, count)).tolist():
        for part in model.borehole(x, y):
            if model.blocks[part.block].name == block:
                yield x, y, part.bottom + share * (part.top - part.bottom)


def scan(path, model, y):
    """Saves a section of a model along x as a scanner reads it of an old print: yellowed, with inked
    contacts. Returns x and the heights of its corners."""
    import numpy as np
    from driver import save_picture

    low, high = model.vertices.min(axis=0), model.vertices.max(axis=0)
    width = 1400
    height = int(width * (high[2] - low[2]) / (high[0] - low[0]))
    random = np.random.default_rng(1)
    paper = np.array((0.95, 0.91, 0.8)) - random.uniform(0.0, 0.04, (height, width, 1))
    for column in range(width):
        x = low[0] + (column + 0.5) / width * (high[0] - low[0])
        for part in model.borehole(x, y):
            top, bottom = (int((z - low[2]) / (high[2] - low[2]) * height) for z in (part.top, part.bottom))
            dots = (np.arange(bottom, top) + 3 * column) % (5 + 4 * part.block) == 0
            paper[bottom:top, column] -= 0.25 * dots[:, None]
            paper[max(top - 4, 0) : top, column] = (0.2, 0.16, 0.14)
    save_picture(np.clip(paper, 0.0, 1.0), path)
    return (low[0], high[0]), (low[2], high[2])
