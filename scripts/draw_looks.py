#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders the rock looks in background Blender: docs/images/looks.jpg, and the previews of the asset library.

    build/venv/bin/python scripts/draw_looks.py [LOOK ...]      (default: all; it needs Pillow)

BLENDER is the Blender that renders (default: blender), or a Python that has the module bpy. With a denoiser,
which Debian's Blender lacks, pictures have no grain. Each look is drawn on the same block of folded beds, 30
units wide. Named looks are left in build/looks, for a look at one of them.
"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
SHEET = ROOT / "docs" / "images" / "looks.jpg"
PREVIEWS = ROOT / "addon" / "realmodel" / "previews" / "looks.jpg"
SIZE = (400, 325)  # of the picture of a look
SMALL = (320, 260)  # in the sheet
COLUMNS = 4
PREVIEW = 128  # pixels: side of a preview
WIDE = 30.0  # the block
RAYS, SECONDS = 12, 60.0
EXPOSURE = 0.2
COLORS = {
    "FLAT": "#c0b8a8",
    "SANDSTONE": "#c08a5e",
    "LIMESTONE": "#cbc2a8",
    "SHALE": "#7a7f86",
    "CONGLOMERATE": "#a98c72",
    "GRANITE": "#c0a79c",
    "BASALT": "#55555a",
    "GRAVEL": "#a39a8c",
    "SAND": "#dcc48e",
    "CLAY": "#a5785c",
    "COAL": "#38363a",
    "SALT": "#dcd3d0",
    "SOIL": "#6a4a32",
    "GRASS": "#6d8a3c",
    "WATER": "#3c6a84",
}


def main(names):
    """Outside Blender: runs this file in it, then puts the pictures together."""
    from PIL import Image, ImageDraw, ImageFont

    sys.path.insert(0, str(ROOT / "addon"))
    from realmodel.core.looks import LOOKS

    program = os.environ.get("BLENDER", "blender")
    command = [program, "-b", "--factory-startup", "--python-exit-code", "1", "-P", __file__, "--"]
    if Path(program).name.startswith("python"):
        command = [program, __file__, "--"]
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        if names:
            folder = ROOT / "build" / "looks"
            folder.mkdir(parents=True, exist_ok=True)
        done = subprocess.run([*command, str(folder), *names], cwd=ROOT, check=False)
        if done.returncode or names:
            return done.returncode
        pictures = [Image.open(folder / f"{key}.png").convert("RGB") for key in LOOKS]
        rows = -(-len(pictures) // COLUMNS)
        sheet = Image.new("RGB", (COLUMNS * SMALL[0], rows * SMALL[1]), "white")
        pen, font = ImageDraw.Draw(sheet), ImageFont.load_default(17)
        strip = Image.new("RGB", (PREVIEW * len(pictures), PREVIEW))
        for number, (picture, look) in enumerate(zip(pictures, LOOKS.values(), strict=True)):
            at = (number % COLUMNS * SMALL[0], number // COLUMNS * SMALL[1])
            sheet.paste(picture.resize(SMALL, Image.Resampling.LANCZOS), at)
            pen.text((at[0] + 12, at[1] + 8), look.label, (34, 38, 46), font)
            side, middle = round(0.74 * SIZE[1]), (SIZE[0] // 2, round(0.54 * SIZE[1]))
            box = (middle[0] - side // 2, middle[1] - side // 2, middle[0] + side // 2, middle[1] + side // 2)
            strip.paste(
                picture.crop(box).resize((PREVIEW, PREVIEW), Image.Resampling.LANCZOS), (number * PREVIEW, 0)
            )
        sheet.save(SHEET, quality=78, optimize=True)
        PREVIEWS.parent.mkdir(exist_ok=True)
        strip.save(PREVIEWS, quality=82, optimize=True)
    return 0


# -- in Blender


def folded_beds():
    """A model: three folded beds on a flat base, worn down to a hill."""
    import numpy as np
    from realmodel.core import Project, Rock, Surface, build

    count = 40
    along = np.linspace(0.0, WIDE, count + 1)
    x, y = (a.ravel() for a in np.meshgrid(along, along))
    column, row = (a.ravel() for a in np.meshgrid(np.arange(count), np.arange(count)))
    a = row * (count + 1) + column
    triangles = np.concatenate(
        [np.stack([a, a + 1, a + count + 2], 1), np.stack([a, a + count + 2, a + count + 1], 1)]
    )
    fold = 1.8 * np.sin(2.0 * np.pi * (x + 0.35 * y) / 34.0) + 0.12 * x
    hill = 14.0 - 0.012 * (x - 11.0) ** 2 - 0.016 * (y - 18.0) ** 2 + 0.5 * np.sin(x / 2.4) * np.cos(y / 3.1)
    heights = (np.zeros_like(x), 3.0 + fold, 8.0 + 1.2 * fold, 16.0 + 1.2 * fold)
    surfaces = [
        Surface(f"S{n}", vertices=np.column_stack([x, y, z]), triangles=triangles)
        for n, z in enumerate(heights)
    ]
    top = Surface("hill", vertices=np.column_stack([x, y, hill]), triangles=triangles, rule="erosional")
    return build(Project("looks", rocks=[Rock("r", surfaces=[*surfaces, top])]))


def in_blender(folder, *names):
    import bpy
    import numpy as np

    sys.path[:0] = [str(ROOT / "addon"), str(ROOT / "scripts")]
    import draw_gallery
    import realmodel
    from realmodel.bl import looks, materials, meshes, picture
    from realmodel.core import polygon_mesh
    from realmodel.core.looks import LOOKS

    realmodel.register_for_batch()
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    scene, model = bpy.context.scene, folded_beds()
    material = materials.new_material("look", 1, "#808080")
    points = []
    for shape in polygon_mesh.of_blocks(model, (WIDE / 2, WIDE / 2, 0.0)):
        if shape is not None:
            mesh = meshes.new_mesh("block", shape)
            mesh.materials.append(material)
            draw_gallery.smooth(mesh)
            scene.collection.objects.link(bpy.data.objects.new("block", mesh))
            points.append(np.array(shape.coordinates, float))
    points = np.concatenate(points)
    camera = picture.set_up(scene, points, SIZE)
    draw_gallery.aim(camera, points, SIZE, 145.0, 24.0, (0.0, 0.06))
    picture.set_renderer(scene, "", SIZE, RAYS, SECONDS)
    scene.view_settings.exposure = EXPOSURE
    for key in names or LOOKS:
        materials.set_color(material, COLORS[key])
        looks.apply(material, key, 1.0, 1, looks.UNITS)
        scene.render.filepath = str(Path(folder) / f"{key}.png")
        bpy.ops.render.render(write_still=True)
    sys.stdout.flush()
    os._exit(0)  # the module bpy may hang as it ends


if __name__ == "__main__":
    if "--" in sys.argv:
        in_blender(*sys.argv[sys.argv.index("--") + 1 :])
    else:
        sys.exit(main(sys.argv[1:]))
