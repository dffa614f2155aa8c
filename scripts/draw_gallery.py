#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders the pictures of docs/gallery.md in background Blender.

    build/venv/bin/python scripts/draw_gallery.py [NAME ...]      (default: all; it needs Pillow)

BLENDER is the Blender that renders (default: blender), or a Python that has the module bpy. With a denoiser,
which Debian's Blender lacks, pictures have no grain.

Each function in SCENES is one picture, docs/images/gallery/NAME.png: it builds a sample and says what is
shown of it, from where, and with which labels.
"""

import os
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
IMAGES = ROOT / "docs" / "images" / "gallery"
SAMPLES = ROOT / "blend_samples"
SIZE = (1800, 1100)
RAYS, SECONDS = 32, 200.0  # of a pixel, and of a picture at most
IN_GUIDE, NARROW = ("tunnel",), 900  # pictures that the guide, and so the zip, has too; pixels
FRAME = (600, 300)  # of a film strip
EXPOSURE = 0.2
POINTS = 900.0  # the width of a picture, as labels are measured
LABEL, TITLE = 12.0, 17.0
WHITE, INK, SOFT = (1.0, 1.0, 1.0), (0.13, 0.15, 0.18), (0.35, 0.38, 0.42)


def main(names):
    """Outside Blender: runs this file in it, then makes the pictures small."""
    from PIL import Image

    program = os.environ.get("BLENDER", "blender")
    command = [program, "-b", "--factory-startup", "--python-exit-code", "1", "-P", __file__, "--"]
    if Path(program).name.startswith("python"):
        command = [program, __file__, "--"]
    IMAGES.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run([*command, folder, *names], cwd=ROOT, check=False)
        for path in sorted(Path(folder).glob("*.png")):
            with Image.open(path) as picture:
                whole = picture.convert("RGB")
                palette = whole.quantize(256, Image.Quantize.FASTOCTREE)
                small = whole.quantize(palette=palette, dither=Image.Dither.FLOYDSTEINBERG)
                small.save(IMAGES / path.name, optimize=True)
                if path.stem in IN_GUIDE:
                    whole.thumbnail((NARROW, NARROW), Image.Resampling.LANCZOS)
                    narrow = whole.quantize(256, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
                    narrow.save(IMAGES.parent / "guide" / path.name, optimize=True)
    return done.returncode


# -- in Blender


@dataclass
class Picture:
    """What is shown: meshes with a material for each property, and texts at positions in the model."""

    origin: tuple
    folder: Path  # of the file
    names: dict = field(default_factory=dict)  # of the properties that are shown: their colors
    points: list = field(default_factory=list)  # that the camera sees
    sun: tuple | None = None  # azimuth and elevation, radians; None: where it always stands

    def show(self, model, shapes, shifts=None):
        """Shows a mesh for each block of a model. shifts: (N, 3) how far its compartments are moved."""
        import bpy
        import numpy as np
        from realmodel.bl import materials, meshes
        from realmodel.core import polygon_mesh

        for block, shape in zip(model.blocks, shapes, strict=True):
            if shape is None:
                continue
            shape = shape if shifts is None else polygon_mesh.moved_apart(shape, shifts)
            name, color = materials.name_and_color(model.project.library, block.property)
            material = bpy.data.materials.get(name)
            if material is None:
                material = materials.new_material(name, block.property, color)
            item = bpy.data.objects.new(block.name, meshes.new_mesh(block.name, shape))
            item.data.materials.append(material)
            smooth(item.data)
            bpy.context.scene.collection.objects.link(item)
            self.names[name] = color
            self.points.append(np.array(shape.coordinates, float))

    def draw(self, name, azimuth, elevation, title, subtitle, labels=(), legend=True, room=(0.0, 0.0)):
        """Renders and writes the picture. azimuth, elevation: degrees of where it is seen from. labels:
        (text, position in the scene, offset in points from there). room: shares of width and height to be
        left free at the left and at the top."""
        import bpy
        from bpy_extras.object_utils import world_to_camera_view
        from mathutils import Vector
        from realmodel.core.drawing.drawing import Drawing

        scene = bpy.context.scene
        file = self.folder / f"{name}.png"
        camera = self.render(file, SIZE, azimuth, elevation, room)
        drawing = Drawing(POINTS, POINTS * SIZE[1] / SIZE[0])
        height = drawing.height
        drawing.text(28, height - 40, title, TITLE, INK)
        for number, line in enumerate(subtitle.split("\n")):
            drawing.text(28, height - 60 - 1.45 * LABEL * number, line, LABEL, SOFT)
        bpy.context.view_layer.update()
        for text, position, offset in labels:
            x, y, _ = world_to_camera_view(scene, camera, Vector(position))
            add_label(drawing, (x * drawing.width, y * height), offset, text)
        if legend:
            add_legend(drawing, list(self.names.items()))
        put_over(file, drawing)

    def render(self, file, size, azimuth, elevation, room):
        """Writes a picture of so many pixels without texts. Returns the camera."""
        import bpy
        import numpy as np
        from realmodel.bl import picture
        from realmodel.bl.viewports import towards

        scene = bpy.context.scene
        points = np.concatenate(self.points)
        camera = picture.set_up(scene, points, size)
        aim(camera, points, size, azimuth, elevation, room)
        if self.sun is not None:
            sun = next(item for item in scene.objects if item.type == "LIGHT")
            sun.rotation_euler = towards(*self.sun).to_track_quat("Z", "Y").to_euler()
        picture.set_renderer(scene, file, size, RAYS, SECONDS)
        scene.view_settings.exposure = EXPOSURE
        bpy.ops.render.render(write_still=True)
        return camera


def smooth(mesh):
    """Smooth within a surface, sharp where surfaces and walls meet."""
    import math

    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    if hasattr(mesh, "use_auto_smooth"):
        mesh.use_auto_smooth, mesh.auto_smooth_angle = True, math.radians(32.0)
    else:
        mesh.set_sharp_from_angle(angle=math.radians(32.0))


def aim(camera, points, size, azimuth, elevation, room):
    """Turns the camera to points (N, 3), which then fill the picture of a size but for the `room`."""
    import math

    import numpy as np
    from mathutils import Matrix, Vector
    from realmodel.bl.viewports import towards

    back = towards(math.radians(azimuth), math.radians(elevation))
    right = Vector((0.0, 0.0, 1.0)).cross(back).normalized()
    axes = np.array([right, back.cross(right), back])
    local = points @ axes.T
    half = math.tan(camera.data.angle / 2.0)
    tangents = half * np.array([1.0 - room[0], (1.0 - room[1]) * size[1] / size[0]]) / 1.12
    away, center = 0.0, []
    for axis, tangent in enumerate(tangents):
        high = (local[:, axis] + tangent * local[:, 2]).max()
        low = (tangent * local[:, 2] - local[:, axis]).max()
        away = max(away, (high + low) / (2.0 * tangent))
        center.append((high - low) / 2.0)
    camera.matrix_world = (
        Matrix.Translation(axes.T @ np.array([*center, away])) @ Matrix(axes.T.tolist()).to_4x4()
    )
    camera.data.shift_x, camera.data.shift_y = -room[0] / 2, room[1] / 2 * size[1] / size[0]
    camera.data.clip_end = 100.0 * away


def add_label(drawing, place, offset, text):
    """A text on a white plate at an offset from a place, and a line to it."""
    from realmodel.core.drawing.glyphs import text_width

    lines = text.split("\n")
    width = max(text_width(line, LABEL) for line in lines) + 12
    height = 1.35 * LABEL * len(lines) + 7
    x, y = place[0] + offset[0], place[1] + offset[1]
    drawing.line([place, (x, y)], INK, 0.8)
    drawing.dots([place], [2.2], INK)
    drawing.rectangle(x - width / 2, y - height / 2, width, height, WHITE, INK, 0.6)
    for number, line in enumerate(lines):
        base = y + height / 2 - 1.35 * LABEL * (number + 1) + 0.5
        drawing.text(x, base, line, LABEL, INK, anchor="middle")


def add_legend(drawing, entries):
    """The properties and their colors at the lower left, the youngest on top."""
    from realmodel.core.drawing import charts

    colors = [
        (name, tuple(int(color[k : k + 2], 16) / 255 for k in (1, 3, 5))) for name, color in reversed(entries)
    ]
    width, height = charts.legend_size("", colors, LABEL)
    drawing.rectangle(20, 20, width + 20, height - 8, WHITE, SOFT, 0.5)
    charts.legend(drawing, 30, 20 + height + 9, "", colors, LABEL)


def put_over(file, drawing):
    """Puts a drawing over a picture."""
    from realmodel.core.drawing.png import write_pixels
    from realmodel.core.drawing.raster import over, rasterize

    pixels = read_pixels(file)
    over(pixels, rasterize(drawing, pixels.shape[1] / drawing.width, None), 0, 0)
    with open(file, "wb") as out:
        write_pixels(pixels, out, 144)


def read_pixels(file):
    """(height, width, 4) float32, from the top."""
    import bpy
    import numpy as np

    image = bpy.data.images.load(str(file))
    width, height = image.size
    pixels = np.array(image.pixels[:], np.float32).reshape(height, width, -1)[::-1].copy()
    bpy.data.images.remove(image)
    return pixels


def sample(name, folder):
    """The model of a sample, and the picture that it is to be in."""
    from realmodel.core import build, load_project

    model = build(load_project(SAMPLES / name / "project.toml"))
    middle = (model.vertices.min(axis=0) + model.vertices.max(axis=0)) / 2
    return model, Picture(tuple(middle), folder)


# -- scenes


def faults(folder):
    """Fault blocks moved apart, the cover lifted."""
    import bpy
    import numpy as np
    from realmodel.core import polygon_mesh

    model, picture = sample("fault_blocks", folder)
    count = len(model.compartment_names)
    shifts = np.zeros((count, 3))
    cover = model.compartment_names.index("basin")
    for number in range(count):
        cells = np.append(model.cell_compartment == number, False)
        inside = np.repeat(cells[model.face_cells].any(axis=1), np.diff(model.face_offsets))
        box = model.vertices[model.face_vertices[inside]]
        shifts[number] = 0.42 * ((box.min(axis=0) + box.max(axis=0)) / 2 - picture.origin) * (1, 1, 0)
    shifts[cover] = 0.0, 0.0, 640.0
    picture.show(model, polygon_mesh.of_cells(model, picture.origin, None), shifts)
    bpy.data.objects["Till"].visible_shadow = False
    west = shifts[model.compartment_names.index("below main fault")]
    north = shifts[model.compartment_names.index("above main fault, above branch")]
    labels = [
        ("Main fault", west + np.array([1200, 90, -1250]) - picture.origin, (-40.0, -62.0)),
        ("Branch", north + np.array([1560, 850, -1200]) - picture.origin, (66.0, 84.0)),
        ("Western fault, dies out", west + np.array([442, 5, -1045]) - picture.origin, (-70.0, 62.0)),
    ]
    picture.draw(
        "faults",
        150.0,
        24.0,
        "Fault Blocks",
        "A listric fault, its branch, and a fault that dies out. The till is younger: no fault divides it.",
        labels,
        room=(0.0, 0.1),
    )


def intrusion(folder):
    """A granite with a dike, a quarter of the model taken away."""
    import numpy as np
    from realmodel.core import polygon_mesh

    model, picture = sample("intrusion", folder)
    low, high = np.array([1560.0, -100.0, -2000.0]), np.array([3100.0, 1180.0, 2000.0])
    model = model.cut_by_surface(*box(low, high)).above
    picture.show(model, polygon_mesh.of_blocks(model, picture.origin))
    picture.draw(
        "intrusion",
        143.0,
        33.0,
        "Intrusion",
        "A granite has lifted the layers, a dike cuts both, and erosion has laid them bare. One quarter is "
        "cut out.",
        room=(0.1, 0.08),
    )


def box(low, high):
    """The closed surface of a box."""
    import numpy as np

    corners = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
    quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    triangles = [[q[0], q[k], q[k + 1]] for q in quads for k in (1, 2)]
    return np.where(corners == 0, low, high), np.array(triangles, np.int32)


def tunnel(folder):
    """A hill cut open along a tunnel, and the rock that the tunnel takes before it."""
    from dataclasses import replace

    import numpy as np
    from realmodel.core import build, load_project, polygon_mesh
    from realmodel.core.exporters.report import model_report

    model, picture = sample("tunnel", folder)
    found = model_report(model, erosion=model.eroded())["erosion"]["bodies"][0]
    half = model.cut_by_plane((0.0, 160.0, 0.0), (0.0, 1.0, 0.0)).above
    picture.show(half, polygon_mesh.of_blocks(half, picture.origin))
    project = load_project(SAMPLES / "tunnel" / "project.toml")
    body = model.structures.bodies[0]
    core = build(replace(project, bodies=[])).cut_by_surface(body.vertices, body.triangles).below
    shapes = polygon_mesh.of_blocks(core, picture.origin)
    labels = []
    for block, shape in zip(core.blocks, shapes, strict=True):
        if shape is not None:
            shape.coordinates[:] += np.array([0.0, -130.0, -76.0], np.float32)
            taken = next(entry["taken"] for entry in found["blocks"] if entry["block"] == block.name)
            assert np.isclose(block.volume, taken, rtol=1e-6), block.name
            low, high = shape.coordinates.min(axis=0), shape.coordinates.max(axis=0)
            share = 0.25 if block.name == "Mudstone" else 0.5
            place = low[0] + share * (high[0] - low[0]), low[1], 0.6 * low[2] + 0.4 * high[2]
            labels.append((f"{block.name}\n{taken:,.0f} m\u00b3", place, (0.0, -58.0)))
    picture.show(core, shapes)
    picture.draw(
        "tunnel",
        163.0,
        21.0,
        "Tunnel",
        f"The rock that the tunnel takes of each layer, together {found['taken']:,.0f} m\u00b3",
        labels,
        room=(0.1, 0.06),
    )


def rocks(folder):
    """Haut-Barr at low sun, its rocks with the looks that suit them."""
    import math

    import bpy
    import numpy as np
    from realmodel.bl import looks, materials
    from realmodel.core import polygon_mesh
    from realmodel.core.looks import look_of

    model, picture = sample("haut_barr", folder)
    picture.show(model, polygon_mesh.of_blocks(model, picture.origin))
    diagonal = float(np.linalg.norm(np.ptp(model.vertices, axis=0)))
    for material in list(bpy.data.materials):
        entry = model.project.library.get(material.get(materials.KEY, 0))
        if entry is not None:
            looks.apply(material, look_of(entry.rock or "", entry.name), 1.0, entry.id, diagonal)
    picture.sun = math.radians(222.0), math.radians(24.0)
    picture.draw(
        "rocks",
        171.0,
        11.0,
        "Haut-Barr",
        "Bedding follows the layers as they were deposited: sets and slip faces of sandstone under "
        "conglomerate.",
        legend=False,
        room=(0.0, 0.1),
    )


def stages(folder):
    """A film strip: Haut-Barr after each of its surfaces."""
    import bpy
    import numpy as np
    from realmodel.core import polygon_mesh
    from realmodel.core.drawing.drawing import Drawing
    from realmodel.core.drawing.png import write_pixels

    model, picture = sample("haut_barr", folder)
    whole, frames = [np.array(model.vertices - picture.origin, float)], []
    for number in range(1, max(len(rock.surfaces) for rock in model.project.rocks)):
        for item in [item for item in bpy.context.scene.objects if item.type == "MESH"]:
            bpy.data.meshes.remove(item.data)
        stage = model.stage(number)
        picture.show(stage, polygon_mesh.of_blocks(stage, picture.origin))
        picture.points = whole  # the camera stays where it is
        file = folder / "frame.png"
        picture.render(file, FRAME, 160.0, 26.0, (0.0, 0.0))
        drawing = Drawing(*(POINTS / SIZE[0] * side for side in FRAME))
        drawing.text(12, drawing.height - 24, f"Stage {number}", LABEL, INK)
        put_over(file, drawing)
        frames.append(read_pixels(file))
        file.unlink()
    rows = [np.concatenate(frames[n : n + 3], axis=1) for n in range(0, len(frames), 3)]
    with open(folder / "stages.png", "wb") as out:
        write_pixels(np.concatenate(rows), out, 144)


SCENES = (rocks, faults, intrusion, tunnel, stages)


def in_blender(folder, *names):
    import bpy

    sys.path.insert(0, str(ROOT / "addon"))
    import realmodel

    realmodel.register_for_batch()
    for draw in SCENES:
        if not names or draw.__name__ in names:
            bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
            draw(Path(folder))
    sys.stdout.flush()
    os._exit(0)  # the module bpy may hang as it ends


if __name__ == "__main__":
    if "--" in sys.argv:
        in_blender(*sys.argv[sys.argv.index("--") + 1 :])
    else:
        sys.exit(main(sys.argv[1:]))
