#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders the rock looks and weathering in background Blender: docs/images/looks.jpg, looks_close.jpg,
looks_ground.jpg and weathering.jpg, and the previews of the asset library.

    build/venv/bin/python scripts/draw_looks.py [LOOK|close|ground|weathering ...]
                                                                             (default: all; it needs Pillow)

BLENDER is the Blender that renders (default: blender), or a Python that has the module bpy. With a denoiser,
which Debian's Blender lacks, pictures have no grain. Each look is drawn on the same block of folded beds, 30
units wide.
"""

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
SHEET = ROOT / "docs" / "images" / "looks.jpg"
PREVIEWS = ROOT / "addon" / "realmodel" / "previews" / "looks.jpg"
WEATHERED = ROOT / "docs" / "images" / "weathering.jpg"
PICTURES = ROOT / "build" / "looks"  # one for each
CLOSE = ROOT / "docs" / "images" / "looks_close.jpg"
NEAR, WEATHERING = "close", "weathering"
NEAR_SIZE, AWAY = (720, 540), 2.0  # of the picture of a close-up, taken from so many meters
NEAR_BLOCK = "Lower conglomerate"
BAR, PART = 6, 0.05  # parts of the scale in it, and how long one is, meters
GROUND = ROOT / "docs" / "images" / "looks_ground.jpg"
FLOORS = ("Soil", "Grass", "Scree")  # at the reader's feet
FLOOR_SIZE, FLOOR = (480, 420), 10.0  # of the picture of one; how wide it is, meters
HALF = (800, 620)  # of the pictures before and after
SIZE = (400, 325)  # of the picture of a look
SMALL = (320, 260)  # in the sheet
COLUMNS = 4
PREVIEW = 128  # pixels: side of a preview
WIDE = 30.0  # the block
RAYS, SECONDS = 12, 300.0
EXPOSURE = 0.2
INK = (34, 38, 46)


def main(names):
    """Outside Blender: runs this file in it, then puts the pictures together."""
    sys.path.insert(0, str(ROOT / "addon"))
    program = os.environ.get("BLENDER", "blender")
    command = [program, "-b", "--factory-startup", "--python-exit-code", "1", "-P", __file__, "--"]
    if Path(program).name.startswith("python"):
        command = [program, __file__, "--"]
    PICTURES.mkdir(parents=True, exist_ok=True)
    done = subprocess.run([*command, str(PICTURES), *names], cwd=ROOT, check=False)
    if done.returncode == 0:
        put_together()
    return done.returncode


def pictures_of(names):
    """The pictures that were drawn, or None where one is missing."""
    from PIL import Image

    paths = [PICTURES / f"{name}.png" for name in names]
    return [Image.open(path).convert("RGB") for path in paths] if all(map(Path.is_file, paths)) else None


def put_together():
    """Makes the sheet of looks, the previews, and the pictures of weathering and of ground."""
    from realmodel.core.project.looks import LOOKS

    if (pictures := pictures_of(LOOKS)) is not None:
        make_sheet(pictures, [look.label for look in LOOKS.values()])
    if (pictures := pictures_of([NEAR])) is not None:
        pictures[0].save(CLOSE, quality=88, optimize=True)
    if (pictures := pictures_of([f"ground_{name}" for name in FLOORS])) is not None:
        put_in_row(pictures, FLOORS, "white").save(GROUND, quality=84, optimize=True)
    if (pictures := pictures_of([f"{WEATHERING}_{name}" for name in ("before", "after")])) is not None:
        put_in_row(pictures, ("As built", "Weathered"), INK).save(WEATHERED, quality=82, optimize=True)


def put_in_row(pictures, texts, color):
    """A picture of several of one size beside one another, each with a text."""
    from PIL import Image, ImageDraw, ImageFont

    width, height = pictures[0].size
    row = Image.new("RGB", (len(pictures) * width, height))
    pen, font = ImageDraw.Draw(row), ImageFont.load_default(26)
    for number, (picture, text) in enumerate(zip(pictures, texts, strict=True)):
        row.paste(picture, (number * width, 0))
        pen.text((number * width + 24, 18), text, color, font)
    return row


def make_sheet(pictures, labels):
    from PIL import Image, ImageDraw, ImageFont

    rows = -(-len(pictures) // COLUMNS)
    sheet = Image.new("RGB", (COLUMNS * SMALL[0], rows * SMALL[1]), "white")
    pen, font = ImageDraw.Draw(sheet), ImageFont.load_default(17)
    strip = Image.new("RGB", (PREVIEW * len(pictures), PREVIEW))
    for number, (picture, label) in enumerate(zip(pictures, labels, strict=True)):
        at = (number % COLUMNS * SMALL[0], number // COLUMNS * SMALL[1])
        sheet.paste(picture.resize(SMALL, Image.Resampling.LANCZOS), at)
        pen.text((at[0] + 12, at[1] + 8), label, INK, font)
        side, middle = round(0.74 * SIZE[1]), (SIZE[0] // 2, round(0.54 * SIZE[1]))
        box = (middle[0] - side // 2, middle[1] - side // 2, middle[0] + side // 2, middle[1] + side // 2)
        strip.paste(
            picture.crop(box).resize((PREVIEW, PREVIEW), Image.Resampling.LANCZOS), (number * PREVIEW, 0)
        )
    place = (len(labels) % COLUMNS * SMALL[0] + 12, (rows - 1) * SMALL[1] + 8)
    pen.text(place, f"Each block is {WIDE:.0f} m wide, with\nthe texture of a model of 250 m", INK, font)
    sheet.save(SHEET, quality=78, optimize=True)
    PREVIEWS.parent.mkdir(exist_ok=True)
    strip.save(PREVIEWS, quality=82, optimize=True)


# -- in Blender


def grid(wide, count):
    """x and y of the vertices of a square mesh, and its triangles."""
    import numpy as np

    along = np.linspace(0.0, wide, count + 1)
    x, y = (a.ravel() for a in np.meshgrid(along, along))
    column, row = (a.ravel() for a in np.meshgrid(np.arange(count), np.arange(count)))
    a = row * (count + 1) + column
    lower, upper = np.stack([a, a + 1, a + count + 2], 1), np.stack([a, a + count + 2, a + count + 1], 1)
    return x, y, np.concatenate([lower, upper])


def beds(mesh, heights, ground, properties=None, library=None):
    """A model of beds worn down to the ground."""
    import numpy as np
    from realmodel.core import Project, Rock, Surface, build

    x, y, triangles = mesh
    surfaces = [
        Surface(
            f"S{n}",
            vertices=np.column_stack([x, y, z]),
            triangles=triangles,
            rule="erosional" if z is ground else "conformable",
            property=0 if properties is None else properties[n],
        )
        for n, z in enumerate([*heights, ground])
    ]
    return build(Project("beds", rocks=[Rock("rock", surfaces=surfaces)], library=library))


def folded_beds():
    import numpy as np

    x, y, triangles = grid(WIDE, 40)
    fold = 1.8 * np.sin(2.0 * np.pi * (x + 0.35 * y) / 34.0) + 0.12 * x
    hill = 14.0 - 0.012 * (x - 11.0) ** 2 - 0.016 * (y - 18.0) ** 2 + 0.5 * np.sin(x / 2.4) * np.cos(y / 3.1)
    return beds((x, y, triangles), (0.0 * x, 3.0 + fold, 8.0 + 1.2 * fold, 16.0 + 1.2 * fold), hill)


def cliff():
    """Hard and soft beds in a cliff."""
    import numpy as np
    from realmodel.core import Library, Property

    rocks = ((1, "Limestone", "#cbbf9f"), (2, "Shale", "#7d7a78"), (3, "Sandstone", "#b98a60"))
    library = Library([Property(n, name, color=color, look="auto") for n, name, color in rocks])
    x, y, triangles = grid(40.0, 48)
    dip = 0.05 * x - 0.02 * y
    foot = y - 17.0 - 3.0 * np.sin(x / 5.5) - 0.9 * np.sin(x / 1.9)
    ground = 4.0 + 13.5 / (1.0 + np.exp(-foot / 1.9)) + 0.4 * np.sin(x / 4.0) * np.cos(y / 3.0)
    tops = np.cumsum([0.0, 4.0, 2.4, 1.6, 3.2, 1.3, 2.2, 6.0])
    heights = [0.0 * x if n == 0 else z + dip for n, z in enumerate(tops)]
    return beds((x, y, triangles), heights, ground, [0, 3, 1, 2, 3, 2, 1, 1, 1], library)


def set_up(points, azimuth, elevation, size):
    import bpy
    import gallery_picture
    from realmodel.bl.pictures import picture

    scene = bpy.context.scene
    camera = picture.set_up(scene, points, size)
    gallery_picture.aim(camera, points, size, azimuth, elevation, (0.0, 0.06))
    picture.set_renderer(scene, "", size, RAYS, SECONDS)
    scene.view_settings.exposure = EXPOSURE


def render(folder, name):
    import bpy

    bpy.context.scene.render.filepath = str(Path(folder) / f"{name}.png")
    bpy.ops.render.render(write_still=True)


def draw_looks(folder, keys):
    import bpy
    import gallery_picture
    import numpy as np
    from realmodel.bl.objects import materials, meshes
    from realmodel.bl.shading import looks
    from realmodel.core.display import polygon_mesh
    from realmodel.core.project.looks import LOOKS

    material = materials.new_material("look", 1, "#808080")
    points = []
    for shape in polygon_mesh.of_blocks(folded_beds(), (WIDE / 2, WIDE / 2, 0.0)):
        if shape is not None:
            mesh = meshes.new_mesh("block", shape)
            mesh.materials.append(material)
            gallery_picture.smooth(mesh)
            bpy.context.scene.collection.objects.link(bpy.data.objects.new("block", mesh))
            points.append(np.array(shape.coordinates, float))
    set_up(np.concatenate(points), 145.0, 24.0, SIZE)
    for key in keys:
        materials.set_color(material, LOOKS[key].color)
        looks.apply(material, key, 1.0, 1, looks.UNITS)
        render(folder, key)


def draw_weathering(folder):
    """The same cliff as it was built, and weathered."""
    import math

    import bpy
    import numpy as np
    from realmodel.bl.objects import meshes
    from realmodel.bl.scene import built_scene
    from realmodel.bl.shading import weathering

    scene = bpy.context.scene
    built_scene.write_model(scene, cliff())
    scene.realmodel.view.show_legend = False
    items = [row.object for row in scene.realmodel.results if row.object is not None]
    points = np.concatenate([np.array(meshes.mesh_coordinates(item.data), float) for item in items])
    for item in scene.objects:
        item.hide_render = item.get("realmodel") == "interface"
    set_up(points, 150.0, 22.0, HALF)
    render(folder, "weathering_before")
    slopes = (math.radians(24.0), math.radians(36.0))
    weathering.put_on(scene, items, weathering.Weathering(0.6, 0.6, 0.3, 1, *slopes, 3, 1.0))
    render(folder, "weathering_after")


def draw_close(folder):
    """A wall of Haut-Barr, weathered, from two meters away, with a scale."""
    import math

    import bpy
    import gallery_picture
    import numpy as np
    from mathutils import Vector
    from realmodel.bl.objects.viewports import towards
    from realmodel.bl.pictures import batch, picture
    from realmodel.bl.shading import weathering

    scene = bpy.context.scene
    model, shown = gallery_picture.sample("haut_barr", Path(folder))
    batch.write_scene(model)
    scene.realmodel.view.show_legend = False
    blocks = [row.object for row in scene.realmodel.results if row.object is not None]
    for item in scene.objects:
        item.hide_render = item not in blocks
    slopes = math.radians(34.0), math.radians(44.0)
    weathering.put_on(scene, blocks, weathering.Weathering(0.34, 0.5, 0.34, 3, *slopes, 1, wear=0.05))
    corners = np.array([item.matrix_world @ Vector(c) for item in blocks for c in item.bound_box])
    shown.points = [corners]
    azimuth, elevation = math.radians(215.0), math.radians(40.0)
    shown.landscape(sun=(azimuth, elevation))
    low, high = corners.min(axis=0), corners.max(axis=0)
    from_south = [
        (x, low[1] - 5.0, z) for x in np.arange(low[0], high[0], 1.5) for z in np.arange(low[2], high[2])
    ]
    target, normal = lit_place(NEAR_BLOCK, from_south, Vector((0.0, 1.0, 0.0)), towards(azimuth, elevation))
    back = Vector((0.35, -0.9, 0.12)).normalized()
    shown.look(target + AWAY * back, target, lens=30.0)
    scene.camera.data.clip_start = 0.01
    put_scale(target, normal, back)
    picture.set_renderer(scene, "", NEAR_SIZE, RAYS, SECONDS)
    scene.view_settings.exposure = EXPOSURE
    render(folder, NEAR)


def draw_ground(folder, name):
    """Soil, grass with tufts, or scree with stones, as seen by somebody who stands on it."""
    import math

    import bpy
    import gallery_picture
    import numpy as np
    from mathutils import Vector
    from realmodel.bl.host import versions
    from realmodel.bl.pictures import picture
    from realmodel.bl.scene import built_scene
    from realmodel.bl.shading import looks, weathering
    from realmodel.core import Library, Property

    scene = bpy.context.scene
    x, y, triangles = grid(FLOOR, 60)
    heights = 0.12 * np.sin(1.1 * x) * np.cos(0.9 * y) + 0.05 * np.sin(3.1 * x) * np.sin(2.7 * y)
    library = Library([Property(1, name, color="#6a4a32", look="auto")])
    built_scene.write_model(scene, beds((x, y, triangles), [0.0 * x - 1.0], heights, [0, 1], library))
    scene.realmodel.view.show_legend = False
    items = [row.object for row in scene.realmodel.results if row.object is not None]
    for item in scene.objects:
        item.hide_render = item not in items
    if name in weathering.COVERS:
        slopes = (math.radians(80.0) * (name == cover) for cover in ("Grass", "Scree"))
        weathering.put_on(scene, items, weathering.Weathering(0.0, 0.0, 1.0, 3, *slopes, 0, 1.0))
        for item in items:  # as in a model of 250 m
            versions.set_group_input(weathering.modifier_of(item), "Scatter Size", 1.0)
    for material in bpy.data.materials:
        if looks.KEY in material:
            looks.apply(material, material[looks.KEY], 1.0, 0, looks.UNITS)
    corners = np.array([item.matrix_world @ Vector(c) for item in items for c in item.bound_box])
    shown = gallery_picture.Picture((0.0, 0.0, 0.0), Path(folder), points=[corners])
    shown.landscape(sun=(math.radians(215.0), math.radians(40.0)))
    target = Vector((*corners.mean(axis=0)[:2], corners[:, 2].max() - 0.1))
    shown.look(target + AWAY * Vector((0.3, -0.8, 0.75)).normalized(), target, lens=30.0)
    scene.camera.data.clip_start = 0.01
    picture.set_renderer(scene, "", FLOOR_SIZE, RAYS, SECONDS)
    scene.view_settings.exposure = EXPOSURE
    render(folder, f"ground_{name}")


def put_scale(target, normal, back):
    """Puts a scale of black and white parts of 5 cm below the middle of the picture, on the rock."""
    import gallery_picture
    from mathutils import Matrix, Vector

    right = Vector((0.0, 0.0, 1.0)).cross(back)
    right = (right - right.dot(normal) * normal).normalized()
    up = normal.cross(right)
    axes = Matrix((right, up, normal)).transposed().to_4x4()
    parent = gallery_picture.empty(Matrix.Translation(target + 0.04 * normal - 0.42 * up) @ axes)
    for number in range(BAR):
        begin = (number - BAR / 2) * PART
        color = "#f2f0ea" if number % 2 else "#16181b"
        gallery_picture.cuboid(
            f"Part {number % 2}", (begin, 0.0, 0.0), (begin + PART, 0.03, 0.012), color, parent
        )


def lit_place(block, starts, way, sun):
    """One of the places in the sun where rays meet blocks of a name about at right angles, and the normal
    there: the one with the evenest rock around it."""
    import math

    import bpy
    from mathutils import Vector

    scene, depsgraph = bpy.context.scene, bpy.context.evaluated_depsgraph_get()
    places = []
    for start in starts:
        found, place, normal, _, item, _ = scene.ray_cast(depsgraph, Vector(start), way)
        if not found or not item.name.startswith(block):
            continue
        is_open = normal.dot(way) < -0.9 and normal.dot(sun) > 0.3
        if is_open and not scene.ray_cast(depsgraph, place + 0.5 * normal, sun)[0]:
            places.append((place.copy(), normal.copy()))

    def unevenness(found):
        place, normal = found
        right = normal.orthogonal().normalized()
        apart = []
        for step in range(12):
            turn = step * math.pi / 6.0
            side = math.cos(turn) * right + math.sin(turn) * normal.cross(right)
            near, hit, *_, item, _ = scene.ray_cast(depsgraph, place + 1.2 * side + normal, -normal)
            same = near and item.name.startswith(block)
            apart.append(abs((hit - place).dot(normal)) if same else 1.0)
        return max(apart)

    return min(places, key=unevenness)


def in_blender(folder, *names):
    import bpy

    sys.path[:0] = [str(ROOT / "addon"), str(ROOT / "scripts")]
    import realmodel
    from realmodel.core.project.looks import LOOKS

    realmodel.register_for_batch()
    drawn = [(draw_looks, [key for key in names or LOOKS if key in LOOKS])]
    drawn += [(draw_ground, name) for name in FLOORS if not names or "ground" in names]
    for draw, *given in drawn:
        if given != [[]]:
            bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
            draw(folder, *given)
    for draw, name in ((draw_close, NEAR), (draw_weathering, WEATHERING)):
        if not names or name in names:
            bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
            draw(folder)
    sys.stdout.flush()
    os._exit(0)  # the module bpy may hang as it ends


if __name__ == "__main__":
    if "--" in sys.argv:
        in_blender(*sys.argv[sys.argv.index("--") + 1 :])
    else:
        sys.exit(main(sys.argv[1:]))
