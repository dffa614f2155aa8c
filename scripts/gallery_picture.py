# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of models with titles, labels and legends, and what stands in their scenes: for the scripts that
draw, in Blender. tests/blender/test_recipes.py has the cliff from here."""

import os
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
SAMPLES = ROOT / "blend_samples"
DRAFT = float(os.environ.get("DRAFT", "1"))
SIZE = (round(1600 / DRAFT), round(980 / DRAFT))
RAYS, SECONDS = 16, 600.0  # of a pixel, and of a picture at most
EXPOSURE = 0.2
POINTS = 900.0  # the width of a picture, as labels are measured
LABEL, TITLE = 12.0, 17.0
HORIZON, ZENITH = (0.66, 0.76, 0.86), (0.09, 0.25, 0.62)  # of a landscape's sky, linear
WHITE, INK, SOFT = (1.0, 1.0, 1.0), (0.13, 0.15, 0.18), (0.35, 0.38, 0.42)
FAULT = (0.62, 0.05, 0.05)


@dataclass
class Picture:
    """What is shown: meshes with a material for each property, and texts at positions in the model."""

    origin: tuple
    folder: Path  # of the file
    names: dict = field(default_factory=dict)  # of the properties that are shown: their colors
    points: list = field(default_factory=list)  # that the camera sees
    lines: list = field(default_factory=list)  # drawn over the picture: positions in the scene
    sun: tuple | None = None  # azimuth and elevation, radians; None: where it always stands

    def show(self, model, shapes, shifts=None, only_outside=False):
        """Shows a mesh for each block of a model. shifts: (N, 3) how far its compartments are moved.
        only_outside: without what other blocks hide, which saves most of the time and memory of a render."""
        import bpy
        import numpy as np
        from realmodel.bl.objects import materials, meshes
        from realmodel.core.display import polygon_mesh

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
        left free at the left and at the top. Over it are the `lines`."""
        from realmodel.core.drawing.drawing import Drawing

        file = self.folder / f"{name}.png"
        self.render(file, SIZE, azimuth, elevation, room)
        drawing = Drawing(POINTS, POINTS * SIZE[1] / SIZE[0])
        height = drawing.height
        drawing.text(28, height - 40, title, TITLE, INK)
        for number, line in enumerate(subtitle.split("\n")):
            drawing.text(28, height - 60 - 1.45 * LABEL * number, line, LABEL, SOFT)
        for line in self.lines:
            drawing.line([seen(drawing, position) for position in line], FAULT, 1.6)
        for text, position, offset in labels:
            add_label(drawing, seen(drawing, position), offset, text)
        if legend:
            add_legend(drawing, list(self.names.items()))
        put_over(file, drawing)

    def landscape(self, sun, haze=None):
        """Sun and sky of a landscape. sun: azimuth and elevation, radians. haze: how far one sees clearly."""
        import bpy
        import numpy as np
        from realmodel.bl.objects import materials
        from realmodel.bl.pictures import picture
        from realmodel.bl.shading import weathering

        scene = bpy.context.scene
        picture.set_up(scene, np.concatenate(self.points), SIZE, sun=sun)
        ground = next(item for item in scene.objects if item.get(picture.KEY) == "ground")
        bpy.data.objects.remove(ground)
        lamp = next(item for item in scene.objects if item.type == "LIGHT")
        lamp.data.energy, lamp.data.angle = 3.6, 0.01
        put_sky(scene.world)
        for material in list(bpy.data.materials):
            if haze and (materials.KEY in material or weathering.KEY in material):
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

    def finish(self, name, title, subtitle, color=None, exposure=-0.3, labels=()):
        """Renders and writes the picture as the camera stands, with a title and labels as `draw` has them.
        color: of the title. Of a label without an offset the position is the two ends of a scale."""
        import bpy
        from realmodel.bl.pictures import picture
        from realmodel.core.drawing.drawing import Drawing

        scene = bpy.context.scene
        file = self.folder / f"{name}.png"
        picture.set_renderer(scene, file, SIZE, RAYS, SECONDS)
        scene.view_settings.exposure = exposure
        scene.cycles.max_bounces = 3
        scene.cycles.denoising_prefilter = "FAST"
        bpy.ops.render.render(write_still=True)
        write_title(file, title, subtitle, color or INK)
        drawing = Drawing(POINTS, POINTS * SIZE[1] / SIZE[0])
        for text, position, offset in labels:
            if offset is None:
                add_scale(drawing, [seen(drawing, end) for end in position], text)
            else:
                add_label(drawing, seen(drawing, position), offset, text)
        put_over(file, drawing)

    def render(self, file, size, azimuth, elevation, room):
        """Writes a picture of so many pixels without texts."""
        import bpy
        import numpy as np
        from realmodel.bl.objects.viewports import towards
        from realmodel.bl.pictures import picture

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
    from realmodel.bl.objects.viewports import towards

    back = towards(math.radians(azimuth), math.radians(elevation))
    right = Vector((0.0, 0.0, 1.0)).cross(back).normalized()
    axes = np.array([right, back.cross(right), back])
    half = math.tan(camera.data.angle / 2.0)
    tangents = half * np.array([1.0 - room[0], (1.0 - room[1]) * size[1] / size[0]]) / 1.12
    place = seen_from(points, axes, tangents)
    camera.matrix_world = Matrix.Translation(axes.T @ place) @ Matrix(axes.T.tolist()).to_4x4()
    camera.data.shift_x, camera.data.shift_y = -room[0] / 2, room[1] / 2 * size[1] / size[0]
    camera.data.clip_end = 100.0 * place[2]


def seen_from(points, axes, tangents):
    """(3,) where an eye must be to see points (N, 3) in all of its picture. axes: (3, 3) right, up and
    backward of the eye, in which the place is given, too. tangents: of half the angles across and up."""
    import numpy as np

    local = points @ axes.T
    away, center = -np.inf, []
    for axis, tangent in enumerate(tangents):
        high = (local[:, axis] + tangent * local[:, 2]).max()
        low = (tangent * local[:, 2] - local[:, axis]).max()
        away = max(away, (high + low) / (2.0 * tangent))
        center.append((high - low) / 2.0)
    return np.array([*center, away])


def seen(drawing, position):
    """Where the camera sees a position of the scene, in a drawing over the picture."""
    import bpy
    from bpy_extras.object_utils import world_to_camera_view
    from mathutils import Vector

    bpy.context.view_layer.update()
    scene = bpy.context.scene
    x, y, _ = world_to_camera_view(scene, scene.camera, Vector(position))
    return x * drawing.width, y * drawing.height


def add_scale(drawing, ends, text):
    """An upright bar between two ends, and its length beside it."""
    drawing.line(ends, WHITE, 5.0)
    drawing.line(ends, INK, 2.6)
    drawing.text(ends[0][0] + 8.0, (ends[0][1] + ends[1][1]) / 2.0 - 0.35 * LABEL, text, LABEL, WHITE)


def add_label(drawing, place, offset, text):
    """A text on a white plate at an offset from a place, and a line to it."""
    from realmodel.core.drawing.drawing import text_width

    lines = text.split("\n")
    width = max(text_width(line, LABEL) for line in lines) + 12
    height = 1.35 * LABEL * len(lines) + 7
    x, y = place[0] + offset[0], place[1] + offset[1]
    drawing.line([place, (x, y)], INK, 0.8)
    drawing.dots([place], [2.2], INK)
    drawing.rectangle((x - width / 2, y - height / 2, width, height), WHITE, INK, 0.6)
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
    drawing.rectangle((20, 20, width + 20, height - 8), WHITE, SOFT, 0.5)
    charts.legend(drawing, (30, 20 + height + 9), "", colors, LABEL)


def legend_band(names, width):
    """(height, width, 4): the properties and their colors in a row. names: of the properties: their colors.
    width: in pixels."""
    import numpy as np
    from realmodel.core.drawing.drawing import Drawing, text_width
    from realmodel.core.drawing.png import over, rasterize

    drawing = Drawing(POINTS * width / SIZE[0], 3.0 * LABEL)
    taken = sum(text_width(name, LABEL) + 24.0 for name in names)
    apart, x = (drawing.width - taken) / (len(names) + 1), 0.0
    for name, color in names.items():
        x += apart
        color = tuple(int(color[k : k + 2], 16) / 255 for k in (1, 3, 5))
        drawing.rectangle((x, LABEL, 18.0, LABEL), color, SOFT, 0.5)
        drawing.text(x + 24.0, 1.12 * LABEL, name, LABEL, INK)
        x += text_width(name, LABEL) + 24.0
    pixels = np.ones((round(drawing.height * width / drawing.width), width, 4), np.float32)
    over(pixels, rasterize(drawing, width / drawing.width, None), 0, 0)
    return pixels


def write_title(file, title, subtitle, color=None):
    """Writes a title into a picture, at the upper left."""
    from realmodel.core.drawing.drawing import Drawing

    drawing = Drawing(POINTS, POINTS * SIZE[1] / SIZE[0])
    drawing.text(28, drawing.height - 40, title, TITLE, color or INK)
    drawing.text(28, drawing.height - 60, subtitle, LABEL, color or SOFT)
    put_over(file, drawing)


def put_over(file, drawing):
    """Puts a drawing over a picture."""
    from realmodel.core.drawing.png import over, rasterize, write_pixels

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


def apply_looks(model, scale, own=()):
    """Gives the material of each property the look that suits its rock. scale: of the texture, times that of
    Rock Looks. own: {name: scale} of some properties."""
    import bpy
    import numpy as np
    from realmodel.bl.objects import materials
    from realmodel.bl.shading import looks
    from realmodel.core.project.looks import look_of

    diagonal = float(np.linalg.norm(np.ptp(model.vertices, axis=0)))
    for material in list(bpy.data.materials):
        entry = model.project.library.get(material.get(materials.KEY, 0))
        if entry is not None:
            look = look_of(entry.rock or "", entry.name)
            looks.apply(material, look, dict(own).get(entry.name, scale), entry.id, diagonal)


def part(shape, keep):
    """Some of the polygons of a mesh; keep: (F,) bool."""
    from dataclasses import replace

    import numpy as np
    from realmodel.core.display.bedding import Bedding

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
    from realmodel.core.display import polygon_mesh

    return polygon_mesh.of_blocks(model, picture.origin)


def generator(name):
    """The module that made a sample."""
    import importlib.util

    spec = importlib.util.spec_from_file_location(name, SAMPLES / name / "generate.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def cliff(levels):
    """The sculpted block of the recipe for a cliff, not yet filled; the active object. levels: of its
    subdivision."""
    import bpy

    bpy.ops.mesh.primitive_cube_add(size=30.0)
    item = bpy.context.object
    item.scale = 1.2, 0.9, 0.8
    subdivision = item.modifiers.new("Subdivision", "SUBSURF")
    subdivision.subdivision_type, subdivision.levels = "SIMPLE", levels
    displace = item.modifiers.new("Displace", "DISPLACE")
    displace.texture = bpy.data.textures.new("Clouds", "CLOUDS")
    displace.texture.noise_scale, displace.strength = 8.0, 6.0
    return item


def around(made, origin, like, reach, step):
    """The ground beyond the border of a sample, by the formula that made it, in the material of a block."""
    import bpy
    import numpy as np

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
    ground("Around", points, triangles, bpy.data.objects[like])


def painted(name, color, roughness=0.7):
    import bpy
    from realmodel.bl.objects import materials

    material = bpy.data.materials.get(name)
    if material is None:
        material = materials.new_material(name, 0, color)
        shader = next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
        shader.inputs["Roughness"].default_value = roughness
    return material


def cuboid(name, low, high, color, parent):
    import bpy
    import numpy as np
    from realmodel.bl.objects import meshes

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


def board(rows, place):
    """A board before the camera. rows: (left, color of a square or None, right), the first the title. place:
    of its upper left corner, to the right and up, of a picture that is 16 wide."""
    import bpy
    from mathutils import Matrix

    bpy.context.view_layer.update()
    camera = bpy.context.scene.camera
    before = set(bpy.data.objects)
    parent = empty(
        camera.matrix_world
        @ Matrix.Translation((*place, -8.0))
        @ Matrix.Rotation(-0.16 if place[0] > 0.0 else 0.16, 4, "Y")
        @ Matrix.Rotation(-0.10, 4, "X")
        @ Matrix.Scale(0.62, 4)
    )
    pitch, width = 0.34, 4.7
    height = pitch * len(rows) + 0.42
    cuboid("Board", (-0.2, -height, -0.08), (width, 0.0, 0.0), "#f4f1e8", parent)
    cuboid("Frame", (-0.28, -height - 0.08, -0.12), (width + 0.08, 0.08, -0.02), "#5b4632", parent)
    for x in (0.25, width - 0.45):
        cuboid("Post", (x, -12.0, -0.30), (x + 0.2, -height, -0.12), "#5b4632", parent)
    for number, (left, color, right) in enumerate(rows):
        base = -0.46 - pitch * number - (0.06 if number else 0.0)
        if color is not None:
            cuboid(f"Square {color}", (0.02, base - 0.03, 0.0), (0.3, base + 0.2, 0.01), color, parent)
        for text, x, align in ((left, 0.42 if number else 0.02, "LEFT"), (right, width - 0.2, "RIGHT")):
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


def sample(name, folder, finer=1.0):
    """The model of a sample, and the picture that it is to be in. finer: times that edges are shorter."""
    from dataclasses import replace

    from realmodel.core import build, load_project

    project = load_project(SAMPLES / name / "project.toml")
    if finer != 1.0:
        for rock in project.rocks:
            rock.edge_length /= finer
            rock.series = [replace(each, resolution=each.resolution / finer) for each in rock.series]
    model = build(project)
    middle = (model.vertices.min(axis=0) + model.vertices.max(axis=0)) / 2
    return model, Picture(tuple(middle), folder)


def box(low, high):
    """The closed surface of a box."""
    import numpy as np

    corners = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
    quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    triangles = [[q[0], q[k], q[k + 1]] for q in quads for k in (1, 2)]
    return np.where(corners == 0, low, high), np.array(triangles, np.int32)


def meadow(like, shapes, reach):
    """The land around a model in the material of a block, an object: at the model's border as high as that,
    level far away. shapes: of the blocks at the border. reach: how far it goes. Returns two objects: the part
    nearby, and the rest."""
    import numpy as np

    rim = np.concatenate([shape.coordinates[wall_corners(shape)] for shape in shapes if shape is not None])
    rim = np.array(rim, float)
    cells = np.round(rim[:, :2]).astype(int)
    order = np.lexsort((-rim[:, 2], cells[:, 1], cells[:, 0]))
    _, first = np.unique(cells[order], axis=0, return_index=True)
    rim = rim[order[first]]
    low, high = rim[:, :2].min(axis=0) - 60.0, rim[:, :2].max(axis=0) + 60.0
    away = np.geomspace(reach, 4.0, 24)
    sides = [
        np.concatenate([begin - away, np.arange(begin, end, 2.0), end + away[::-1]])
        for begin, end in zip(low, high, strict=True)
    ]
    x, y = (a.ravel() for a in np.meshgrid(*sides))
    apart = np.hypot(x[:, None] - rim[:, 0], y[:, None] - rim[:, 1])
    nearest, far = apart.argmin(axis=1), apart.min(axis=1)
    level = float(np.median(rim[:, 2]))
    z = level + (rim[nearest, 2] - level) * np.exp(-((far / 40.0) ** 2)) - 0.25
    z += 0.35 * np.sin(x / 9.0 + 1.3 * np.sin(y / 14.0)) * (1.0 - np.exp(-((far / 12.0) ** 2)))
    columns, rows = map(len, sides)
    column, row = (a.ravel() for a in np.meshgrid(np.arange(columns - 1), np.arange(rows - 1)))
    a = row * columns + column
    triangles = np.concatenate(
        [np.stack([a, a + 1, a + columns + 1], 1), np.stack([a, a + columns + 1, a + columns], 1)]
    )
    points = np.column_stack([x, y, z])
    is_near = far[triangles].max(axis=1) < 90.0
    parts = ("Meadow", triangles[is_near]), ("Fields", triangles[~is_near])
    return [ground(name, points, chosen, like) for name, chosen in parts]


def ground(name, points, triangles, like):
    """An object that is ground, in the material of another one."""
    import bpy
    import numpy as np
    from realmodel.bl.objects import meshes

    mesh = meshes.triangle_mesh(name, points, triangles, smooth=True)
    top = mesh.attributes.new(meshes.PREFIX + "is_top", "BOOLEAN", "FACE")
    top.data.foreach_set("value", np.ones(len(triangles), bool))
    mesh.materials.append(like.data.materials[0])
    item = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(item)
    return item


def desert(height, reach):
    """A plain of sand around the origin with low dunes, an object. height: of the plain."""
    import bpy
    import numpy as np
    from realmodel.bl.objects import materials, meshes
    from realmodel.bl.shading import looks

    away = np.geomspace(reach / 1e3, reach, 90)
    x, y = (a.ravel() for a in np.meshgrid(*2 * [np.concatenate([-away[::-1], [0.0], away])]))
    wave = reach / 60.0
    dunes = np.sin(x / wave + 1.7 * np.sin(y / (1.7 * wave))) * np.cos(0.3 * x / wave - 0.8 * y / wave)
    z = height + 0.1 * wave * dunes * (1.0 - np.exp(-((np.hypot(x, y) / (4.0 * wave)) ** 2)))
    count = 2 * len(away) + 1
    column, row = (a.ravel() for a in np.meshgrid(np.arange(count - 1), np.arange(count - 1)))
    a = row * count + column
    triangles = np.concatenate(
        [np.stack([a, a + 1, a + count + 1], 1), np.stack([a, a + count + 1, a + count], 1)]
    )
    mesh = meshes.triangle_mesh("Desert", np.column_stack([x, y, z]), triangles, smooth=True)
    material = materials.new_material("Desert sand", 1, "#c99b6e")
    looks.apply(material, "SAND", 1.0, 1, looks.UNITS)
    mesh.materials.append(material)
    item = bpy.data.objects.new("Desert", mesh)
    bpy.context.scene.collection.objects.link(item)
    return item


def wall_corners(shape):
    """The vertices of the polygons where the model ends, but for its floor, as often as they are corners."""
    import numpy as np

    return shape.corners[np.repeat(shape.face_surface == -1, np.diff(shape.offsets))]
