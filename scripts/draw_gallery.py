#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders the pictures of docs/gallery.md in background Blender.

    build/venv/bin/python scripts/draw_gallery.py [NAME ...]      (default: all; it needs Pillow)

BLENDER is the Blender that renders (default: blender), or a Python that has the module bpy. With a denoiser,
which Debian's Blender lacks, pictures have no grain.

Each function in SCENES is one picture, docs/images/gallery/NAME.png or NAME.jpg: it builds a sample and
says what is shown of it, from where, and with which labels. DRAFT=3 makes pictures of a third of the size in
a folder for drafts, to compose them.
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
IN_GUIDE, NARROW = ("tunnel",), 900  # pictures that the guide, and so the zip, has too; pixels
DRAFT = float(os.environ.get("DRAFT", "1"))
SIZE = (round(1600 / DRAFT), round(980 / DRAFT))
RAYS, SECONDS = 16, 200.0  # of a pixel, and of a picture at most
FRAME = (600, 300)  # of a film strip
EXPOSURE = 0.2
PHOTOS = (
    "rocks",
    "canyon",
    "quarry",
    "island",
    "diagram",
    "basin",
)  # JPEG; in the others few colors are enough
POINTS = 900.0  # the width of a picture, as labels are measured
LABEL, TITLE = 12.0, 17.0
HORIZON, ZENITH = (0.66, 0.76, 0.86), (0.09, 0.25, 0.62)  # of a landscape's sky, linear
WHITE, INK, SOFT = (1.0, 1.0, 1.0), (0.13, 0.15, 0.18), (0.35, 0.38, 0.42)


def main(names):
    """Outside Blender: runs this file in it, then makes the pictures small."""
    from PIL import Image

    program = os.environ.get("BLENDER", "blender")
    command = [program, "-b", "--factory-startup", "--python-exit-code", "1", "-P", __file__, "--"]
    if Path(program).name.startswith("python"):
        command = [program, __file__, "--"]
    images = ROOT / "build" / "gallery_drafts" if DRAFT != 1 else IMAGES
    images.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run([*command, folder, *names], cwd=ROOT, check=False)
        for path in sorted(Path(folder).glob("*.png")):
            with Image.open(path) as picture:
                whole = picture.convert("RGB")
                if path.stem in PHOTOS:
                    whole.save(images / f"{path.stem}.jpg", quality=84, optimize=True, progressive=True)
                    continue
                palette = whole.quantize(256, Image.Quantize.FASTOCTREE)
                small = whole.quantize(palette=palette, dither=Image.Dither.FLOYDSTEINBERG)
                small.save(images / path.name, optimize=True)
                if path.stem in IN_GUIDE and DRAFT == 1:
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

    def show(self, model, shapes, shifts=None, only_outside=False):
        """Shows a mesh for each block of a model. shifts: (N, 3) how far its compartments are moved.
        only_outside: without what other blocks hide, which saves most of the time and memory of a render."""
        import bpy
        import numpy as np
        from realmodel.bl import materials, meshes
        from realmodel.core import polygon_mesh

        for block, shape in zip(model.blocks, shapes, strict=True):
            if shape is None:
                continue
            shape = shape if shifts is None else polygon_mesh.moved_apart(shape, shifts)
            if only_outside:
                on_body = np.append(model.surface_kind == 2, [False, False])[shape.face_surface]
                shape = part(shape, shape.bedding.is_top | (shape.face_surface < 0) | on_body)
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

    def landscape(self, sun, haze=None):
        """Sun and sky of a landscape. sun: azimuth and elevation, radians. haze: how far one sees clearly."""
        import bpy
        import numpy as np
        from realmodel.bl import materials, picture

        scene = bpy.context.scene
        picture.set_up(scene, np.concatenate(self.points), SIZE, sun=sun)
        ground = next(item for item in scene.objects if item.get(picture.KEY) == "ground")
        bpy.data.objects.remove(ground)
        lamp = next(item for item in scene.objects if item.type == "LIGHT")
        lamp.data.energy, lamp.data.angle = 3.6, 0.01
        put_sky(scene.world)
        for material in list(bpy.data.materials):
            if haze and materials.KEY in material:
                haze_before(material, HORIZON, haze)

    def look(self, eye, target, lens):
        """Puts the camera at a place of the scene. lens: focal length in millimeters."""
        import bpy
        from mathutils import Vector

        camera = bpy.context.scene.camera
        camera.location = eye
        back = Vector(eye) - Vector(target)
        camera.rotation_euler = back.to_track_quat("Z", "Y").to_euler()
        camera.data.sensor_width, camera.data.lens = 36.0, lens
        camera.data.shift_x = camera.data.shift_y = 0.0
        camera.data.clip_start, camera.data.clip_end = back.length / 1e3, back.length * 100.0

    def finish(self, name, title, subtitle, color=None, exposure=-0.3):
        """Renders and writes the picture as the camera stands, with a title. color: of the title."""
        import bpy
        from realmodel.bl import picture

        scene = bpy.context.scene
        file = self.folder / f"{name}.png"
        picture.set_renderer(scene, file, SIZE, RAYS, SECONDS)
        scene.view_settings.exposure = exposure
        scene.cycles.max_bounces = 3
        scene.cycles.denoising_prefilter = "FAST"
        bpy.ops.render.render(write_still=True)
        write_title(file, title, subtitle, color or INK)

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


def put_sky(world):
    """Blue above, pale at the horizon and below."""
    tree = world.node_tree
    back = next(node for node in tree.nodes if node.type == "BACKGROUND")
    place = tree.nodes.new("ShaderNodeTexCoord")
    apart = tree.nodes.new("ShaderNodeSeparateXYZ")
    ramp = tree.nodes.new("ShaderNodeValToRGB")
    tree.links.new(place.outputs["Generated"], apart.inputs[0])
    tree.links.new(apart.outputs[2], ramp.inputs[0])
    tree.links.new(ramp.outputs[0], back.inputs["Color"])
    back.inputs["Strength"].default_value = 0.9
    first, last = ramp.color_ramp.elements
    first.position, first.color = 0.0, (*HORIZON, 1.0)
    last.position, last.color = 0.5, (*ZENITH, 1.0)
    middle = ramp.color_ramp.elements.new(0.14)
    middle.color = (*(0.45 * a + 0.55 * b for a, b in zip(HORIZON, ZENITH, strict=True)), 1.0)


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


def write_title(file, title, subtitle, color=None):
    """Writes a title into a picture, at the upper left."""
    from realmodel.core.drawing.drawing import Drawing

    drawing = Drawing(POINTS, POINTS * SIZE[1] / SIZE[0])
    drawing.text(28, drawing.height - 40, title, TITLE, color or INK)
    drawing.text(28, drawing.height - 60, subtitle, LABEL, color or SOFT)
    put_over(file, drawing)


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


def apply_looks(model, scale):
    """Gives the material of each property the look that suits its rock. scale: of the texture, times that of
    Rock Looks."""
    import bpy
    import numpy as np
    from realmodel.bl import looks, materials
    from realmodel.core.looks import look_of

    diagonal = float(np.linalg.norm(np.ptp(model.vertices, axis=0)))
    for material in list(bpy.data.materials):
        entry = model.project.library.get(material.get(materials.KEY, 0))
        if entry is not None:
            looks.apply(material, look_of(entry.rock or "", entry.name), scale, entry.id, diagonal)


def part(shape, keep):
    """Some of the polygons of a mesh; keep: (F,) bool."""
    from dataclasses import replace

    import numpy as np
    from realmodel.core.bedding import Bedding

    counts = np.diff(shape.offsets)
    corners = np.repeat(keep, counts)
    used, numbers = np.unique(shape.corners[corners], return_inverse=True)
    bedding = shape.bedding
    return replace(
        shape,
        coordinates=shape.coordinates[used],
        offsets=np.append(0, np.cumsum(counts[keep])).astype(np.int32),
        corners=numbers.astype(np.int32).ravel(),
        face_surface=shape.face_surface[keep],
        face_compartment=None if shape.face_compartment is None else shape.face_compartment[keep],
        edges=None,
        corner_edges=None,
        bedding=Bedding(
            bedding.height[corners],
            bedding.thickness[corners],
            bedding.depth[corners],
            bedding.is_top[keep],
            bedding.age[keep],
        ),
    )


def blocks_of(model, picture):
    from realmodel.core import polygon_mesh

    return polygon_mesh.of_blocks(model, picture.origin)


def generator(name):
    """The module that made a sample."""
    import importlib.util

    spec = importlib.util.spec_from_file_location(name, SAMPLES / name / "generate.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def around(made, origin, like, reach, step):
    """The ground beyond the border of a sample, by the formula that made it, in the material of a block."""
    import bpy
    import numpy as np
    from realmodel.bl import meshes

    x = np.arange(-reach, made.WIDTH + reach + 1, step)
    y = np.arange(-reach, made.LENGTH + reach + 1, step)
    for values, size in ((x, made.WIDTH), (y, made.LENGTH)):
        for border in (0.0, size):
            values[np.abs(values - border).argmin()] = border
    points = np.array([(a, b, made.ground(a, b)) for b in y for a in x]) - origin
    column, row = (a.ravel() for a in np.meshgrid(np.arange(len(x) - 1), np.arange(len(y) - 1)))
    inside = (x[column] >= 0) & (x[column] < made.WIDTH) & (y[row] >= 0) & (y[row] < made.LENGTH)
    first = (row * len(x) + column)[~inside]
    over = first + len(x)
    triangles = np.concatenate(
        [np.stack([first, first + 1, over + 1], 1), np.stack([first, over + 1, over], 1)]
    )
    mesh = meshes.triangle_mesh("Around", points, triangles, smooth=True)
    top = mesh.attributes.new(meshes.PREFIX + "is_top", "BOOLEAN", "FACE")
    top.data.foreach_set("value", np.ones(len(triangles), bool))
    mesh.materials.append(bpy.data.objects[like].data.materials[0])
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Around", mesh))


def painted(name, color, roughness=0.7):
    import bpy
    from realmodel.bl import materials

    material = bpy.data.materials.get(name)
    if material is None:
        material = materials.new_material(name, 0, color)
        shader = next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
        shader.inputs["Roughness"].default_value = roughness
    return material


def cuboid(name, low, high, color, parent):
    import bpy
    import numpy as np
    from realmodel.bl import meshes

    mesh = meshes.triangle_mesh(name, *box(np.array(low, float), np.array(high, float)))
    mesh.materials.append(painted(f"{name} paint", color))
    item = bpy.data.objects.new(name, mesh)
    item.parent = parent
    bpy.context.scene.collection.objects.link(item)


def empty(matrix):
    import bpy

    item = bpy.data.objects.new("place", None)
    item.matrix_world = matrix
    bpy.context.scene.collection.objects.link(item)
    return item


def truck(place, heading):
    """A dump truck, nine meters long."""
    from mathutils import Matrix, Vector

    parent = empty(Matrix.Translation(Vector(place)) @ Matrix.Rotation(heading, 4, "Z"))
    cuboid("Chassis", (-4.4, -1.5, 1.0), (4.4, 1.5, 1.7), "#3a3a3a", parent)
    cuboid("Bed", (-4.6, -2.1, 1.8), (1.9, 2.1, 3.9), "#d9a21b", parent)
    cuboid("Hood", (2.1, -1.7, 1.2), (4.6, 1.7, 2.9), "#d9a21b", parent)
    cuboid("Cab", (2.2, -1.6, 2.9), (3.6, 0.4, 4.2), "#2b3a44", parent)
    for x in (-3.4, -1.5, 3.1):
        for y in (-2.0, 1.3):
            cuboid("Tire", (x - 0.8, y, 0.0), (x + 0.8, y + 0.7, 1.6), "#1d1d1d", parent)


def board(rows):
    """A board before the camera, at its left: two columns of text. rows: (left, right), the first the
    title."""
    import bpy
    from mathutils import Matrix

    bpy.context.view_layer.update()
    camera = bpy.context.scene.camera
    before = set(bpy.data.objects)
    parent = empty(
        camera.matrix_world
        @ Matrix.Translation((-5.3, -0.6, -8.0))
        @ Matrix.Rotation(0.16, 4, "Y")
        @ Matrix.Rotation(-0.10, 4, "X")
    )
    pitch, width = 0.34, 4.2
    height = pitch * len(rows) + 0.42
    cuboid("Board", (-0.2, -height, -0.08), (width, 0.0, 0.0), "#f4f1e8", parent)
    cuboid("Frame", (-0.28, -height - 0.08, -0.12), (width + 0.08, 0.08, -0.02), "#5b4632", parent)
    for x in (0.25, width - 0.45):
        cuboid("Post", (x, -12.0, -0.30), (x + 0.2, -height, -0.12), "#5b4632", parent)
    for number, row in enumerate(rows):
        base = -0.46 - pitch * number - (0.06 if number else 0.0)
        for text, x, align in ((row[0], 0.0, "LEFT"), (row[1], width - 0.2, "RIGHT")):
            curve = bpy.data.curves.new("text", "FONT")
            curve.body, curve.align_x, curve.size = text, align, 0.34 if number == 0 else 0.29
            curve.extrude = 0.004
            curve.materials.append(painted("Ink", "#1f2a33"))
            item = bpy.data.objects.new("text", curve)
            item.parent, item.location = parent, (x, base, 0.012)
            bpy.context.scene.collection.objects.link(item)
    for item in set(bpy.data.objects) - before:
        item.visible_shadow = False  # far away on the ground it would be a blot


def haze_before(material, color, distance):
    """Has what is far away of a material fade into the color of the air."""
    tree = material.node_tree
    output = next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL")
    eye = tree.nodes.new("ShaderNodeCameraData")
    share = tree.nodes.new("ShaderNodeMath")
    share.operation = "DIVIDE"
    share.inputs[1].default_value = -distance
    tree.links.new(eye.outputs["View Distance"], share.inputs[0])
    seen = tree.nodes.new("ShaderNodeMath")
    seen.operation = "EXPONENT"
    tree.links.new(share.outputs[0], seen.inputs[0])
    ray = tree.nodes.new("ShaderNodeLightPath")
    hidden = tree.nodes.new("ShaderNodeMath")
    hidden.operation = "SUBTRACT"
    hidden.inputs[0].default_value = 1.0
    tree.links.new(seen.outputs[0], hidden.inputs[1])
    only = tree.nodes.new("ShaderNodeMath")
    only.operation = "MULTIPLY"
    tree.links.new(hidden.outputs[0], only.inputs[0])
    tree.links.new(ray.outputs["Is Camera Ray"], only.inputs[1])
    air = tree.nodes.new("ShaderNodeEmission")
    air.inputs["Color"].default_value = (*color, 1.0)
    mix = tree.nodes.new("ShaderNodeMixShader")
    rock = output.inputs["Surface"].links[0].from_socket
    tree.links.new(only.outputs[0], mix.inputs[0])
    tree.links.new(rock, mix.inputs[1])
    tree.links.new(air.outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], output.inputs["Surface"])


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


def basin(folder):
    """A section through a rift basin: half of the model, its faults named."""
    import numpy as np
    from realmodel.core import polygon_mesh

    model, picture = sample("rift_basin", folder)
    section = 1500.0
    half = model.cut_by_plane((0.0, section, 0.0), (0.0, 1.0, 0.0)).above
    picture.show(half, polygon_mesh.of_blocks(half, picture.origin))
    apply_looks(model, 0.8)
    made = generator("rift_basin")
    labels = [
        (f"{name} fault", (x_of(section, z), section, z) - np.array(picture.origin), offset)
        for name, x_of, z, offset in (
            ("Western", made.western_fault, -1250.0, (-60.0, -60.0)),
            ("Middle", made.middle_fault, -1500.0, (-10.0, -62.0)),
            ("Antithetic", made.antithetic_fault, -1550.0, (56.0, -62.0)),
            ("Eastern", made.eastern_fault, -1150.0, (66.0, -62.0)),
        )
    ]
    picture.draw(
        "basin",
        169.0,
        15.0,
        "Rift Basin",
        "A section through tilted fault blocks; what filled the basin as it opened was eroded and covered.",
        labels,
        room=(0.1, 0.0),
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
    """Haut-Barr at low sun, its rocks with the looks that suit them, in a meadow."""
    import math

    import numpy as np

    model, picture = sample("haut_barr", folder)
    shapes = blocks_of(model, picture)
    picture.show(model, shapes, only_outside=True)
    tops = [shape.coordinates[top_corners(shape)] for shape in shapes if shape is not None]
    lowest = min(float(corners[:, 2].min()) for corners in tops if len(corners))
    apply_looks(model, 1.0)
    meadow("Soil", lowest, 2500.0)
    picture.landscape(sun=(math.radians(246.0), math.radians(13.0)), haze=6000.0)
    picture.look(np.array([-95.0, -150.0, 15.0]), np.array([-31.0, 0.0, 12.0]), lens=24.5)
    picture.finish(
        "rocks",
        "Haut-Barr",
        "Bedding follows the layers as they were deposited: sets and slip faces of sandstone under "
        "conglomerate.",
        exposure=0.3,
    )


def top_corners(shape):
    """The vertices of the polygons on which nothing lies, as often as they are corners."""
    import numpy as np

    return shape.corners[np.repeat(shape.bedding.is_top, np.diff(shape.offsets))]


def meadow(like, height, reach):
    """A level plane in the material of a block."""
    import bpy
    import numpy as np
    from realmodel.bl import meshes

    corners = np.array([[x * reach, y * reach, height] for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
    mesh = meshes.triangle_mesh("Meadow", corners, np.array([[0, 1, 2], [0, 2, 3]]))
    top = mesh.attributes.new(meshes.PREFIX + "is_top", "BOOLEAN", "FACE")
    top.data.foreach_set("value", np.ones(2, bool))
    mesh.materials.append(bpy.data.objects[like].data.materials[0])
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Meadow", mesh))


def canyon(folder):
    """Forty beds in the walls of a canyon, in the afternoon."""
    import math

    model, picture = sample("canyon", folder)
    picture.show(model, blocks_of(model, picture), only_outside=True)
    apply_looks(model, 0.7)
    picture.landscape(sun=(math.radians(226.0), math.radians(34.0)), haze=16000.0)
    picture.look((-640.0, -150.0, 455.0), (60.0, 60.0, 92.0), lens=22.0)
    picture.finish(
        "canyon",
        "Canyon",
        "Forty beds in its walls, hard ones steep, soft ones flat. Each is a closed block, and the walls cut "
        "all of them exactly.",
    )


def quarry(folder):
    """A quarry with its benches, and a board with the volumes of what was taken."""
    import math

    import numpy as np

    model, picture = sample("quarry", folder)
    made, origin = generator("quarry"), np.array(picture.origin)
    picture.show(model, blocks_of(model, picture), only_outside=True)
    apply_looks(model, 1.0)
    around(made, origin, "Loam", 700.0, 20.0)
    taken = model.eroded().taken.sum(axis=0)
    rows = [(b.name, f"{v:,.0f} m\u00b3") for b, v in zip(model.blocks, taken, strict=True) if v > 0]
    picture.landscape(sun=(math.radians(262.0), math.radians(36.0)), haze=9000.0)
    picture.look(np.array([62.0, 2.0, 186.0]) - origin, np.array([196.0, 150.0, 72.0]) - origin, lens=24.0)
    board([("Excavated", ""), *reversed(rows), ("Together", f"{taken.sum():,.0f} m\u00b3")])
    for x, y, z, heading in ((196.0, 172.0, made.BOTTOM, 20.0), (262.0, 148.0, made.BOTTOM, 115.0)):
        truck(np.array([x, y, z]) - origin, math.radians(heading))
    picture.finish(
        "quarry",
        "Quarry",
        "Benches of twelve meters with their ramps, cut exactly; on the board what they take of each layer.",
        color=WHITE,
    )


def island(folder):
    """A sculpted terrain filled with folded strata."""
    import math

    model, picture = sample("sculpted_island", folder)
    picture.show(model, blocks_of(model, picture), only_outside=True)
    apply_looks(model, 0.8)
    picture.sun = math.radians(95.0), math.radians(33.0)
    picture.draw(
        "island",
        200.0,
        31.0,
        "Sculpted Island",
        "An artist's mesh is the youngest surface: what lies above it of fourteen folded strata is eroded.",
        legend=False,
        room=(0.0, 0.11),
    )


def diagram(folder):
    """A block diagram as geologists draw it: the add-on's own legend, axes and exaggeration."""
    import math

    import bpy
    from realmodel.bl import batch, picture
    from realmodel.bl.display import viewpoints
    from realmodel.bl.overlay import legend_share, rendered
    from realmodel.core import build, load_project

    model = build(load_project(SAMPLES / "block_diagram" / "project.toml"), cells="blocks")
    batch.write_scene(model)
    scene = bpy.context.scene
    view = scene.realmodel.view
    view.exaggeration = 2.0
    view.show_legend = view.show_axes = view.show_north = view.show_scale = True
    for item in scene.objects:
        if item.get("realmodel") == "block":
            smooth(item.data)
            item.hide_render = False
    apply_looks(model, 0.9)
    bpy.context.view_layer.update()
    file = folder / "diagram.png"
    points = viewpoints.model_points(scene)
    sun = math.radians(78.0), math.radians(38.0)
    camera = picture.set_up(scene, points, SIZE, left=legend_share(scene, SIZE), sun=sun)
    aim(camera, points, SIZE, 158.0, 30.0, (0.17, 0.1))
    picture.set_renderer(scene, file, SIZE, RAYS, SECONDS)
    scene.view_settings.exposure = EXPOSURE
    rendered.put(scene)
    bpy.ops.render.render(write_still=True)
    write_title(
        file,
        "Block Diagram",
        "Folds that plunge to the south, below an unconformity; a valley lays them bare. Heights are doubled",
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


SCENES = (rocks, canyon, quarry, island, diagram, basin, faults, intrusion, tunnel, stages)


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
