#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the pictures of docs/guide in a real window under Xvfb, and makes them small.

    build/venv/bin/python scripts/draw_guide.py [NAME ...]      (default: all; it needs Pillow)

Each function in PICTURES is one chapter: it sets up a scene with the operators that the guide names and
keeps pictures.
"""

import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
IMAGES = ROOT / "docs" / "images" / "guide"
SAMPLES = ROOT / "blend_samples"
SIZE = (1900, 1400)
SCALE = 1.5  # of the interface, so that its letters are sharp in print
PANEL_SIZE, PANEL_SCALE = (1900, 2900), 3.0  # where panels are drawn by themselves
COLORS = 256  # of a picture in its palette
WIDEST = 1200  # pixels
LIGHT = "studio.sl"  # of the viewport: brighter than the usual one
PAPER = (0.9, 0.91, 0.92)  # its background, on which dark layers and letters are seen


def main(names):
    """Outside Blender: runs this file in two windows, then gives each picture a palette."""
    failed = 0
    for size, chapters in ((PANEL_SIZE, PANEL_CHAPTERS), (SIZE, CHAPTERS)):
        chosen = [draw.__name__ for draw in chapters if not names or draw.__name__ in names]
        if chosen:
            failed = run_in_window(size, chosen) or failed
    for path in (*sorted(IMAGES.glob("*.png")), IMAGES.parent / "view_modes.png"):
        shrink(path, path)
    return failed


def run_in_window(size, names):
    """Runs chapters in Blender; returns its exit status."""
    with tempfile.TemporaryDirectory() as screen:
        command = ["xvfb-run", "-a", "-s", f"-screen 0 {size[0]}x{size[1]}x24 -fbdir {screen}", "blender"]
        command += ["--factory-startup", "--enable-event-simulate", "--window-geometry", "0", "0"]
        command += [*map(str, size), "-P", __file__, "--", screen, *names]
        return subprocess.run(command, cwd=ROOT, check=False).returncode


def shrink(source, target, widest=WIDEST, method=1):
    """Writes a picture with a palette; one that has a palette already stays as it is. method: of Pillow; 1
    keeps the colors of small areas, 0 those of gradients."""
    from PIL import Image

    with Image.open(source) as picture:
        if picture.mode == "P":
            return
        small = picture.convert("RGB")
        small.thumbnail((widest, 10 * widest), Image.Resampling.LANCZOS)
        small.quantize(COLORS, method=method, dither=Image.Dither.NONE).save(target, optimize=True)


# -- in Blender


def begin(screen, *names):
    """Registers the add-on and runs the chapters, one after another."""
    import bpy

    sys.path[:0] = [str(ROOT / part) for part in ("addon", "scripts", "tests/gui", "tests/blender")]
    import realmodel
    from driver import Walk

    preferences = bpy.context.preferences
    preferences.view.show_splash = False
    of_panels = any(draw.__name__ in names for draw in PANEL_CHAPTERS)
    preferences.view.ui_scale = PANEL_SCALE if of_panels else SCALE
    preferences.system.use_region_overlap = False
    background = preferences.themes[0].view_3d.space.gradients
    background.background_type = "SINGLE_COLOR"  # a gradient needs many colors of the palette
    background.high_gradient = PAPER
    realmodel.register()
    TAB.update({cls: set(getattr(cls, "bl_options", ())) for cls in tab_panels()})
    IMAGES.mkdir(parents=True, exist_ok=True)
    chapters = [
        (draw.__name__, lambda walk, draw=draw: chapter(walk, draw)) for draw in (*PANEL_CHAPTERS, *CHAPTERS)
    ]
    Walk(IMAGES, Path(screen) / "Xvfb_screen0").run([c for c in chapters if c[0] in names], at_end)


def at_end(walk):
    if walk.failure:
        print(walk.failure, flush=True)
    os._exit(1 if walk.failure else 0)


def chapter(walk, draw):
    """One chapter in a new file with an empty scene, and the tab open in the sidebar. In the first one panels
    are open or closed as users find them; in the others all are open."""
    import bpy

    bpy.ops.wm.read_homefile(use_factory_startup=True)
    yield walk.redrawn(2)
    for item in list(bpy.data.objects):
        bpy.data.objects.remove(item)
    for cls, options in TAB.items():
        cls.bl_options = options - (set() if draw in (start, window) else {"DEFAULT_CLOSED"})
    yield from show_panels(walk)
    space = walk.area.spaces.active
    space.overlay.show_floor = space.overlay.show_axis_x = space.overlay.show_axis_y = False
    space.overlay.show_cursor = space.overlay.show_text = space.show_gizmo = False
    space.shading.studio_light = LIGHT
    space.show_object_viewport_mesh = draw not in PANEL_CHAPTERS  # else a large viewport is drawn in vain
    space.show_region_ui, space.show_region_toolbar = True, False
    yield lambda: walk.region("UI").width > 50
    yield from open_tab(walk)
    yield from draw(walk)


TAB = {}  # the panels of the tab in their order, and their options


def tab_panels():
    """The panels of the tab, a parent before its children."""
    import bpy

    kinds = bpy.types.Panel.__subclasses__()
    found = [cls for cls in kinds if getattr(cls, "bl_category", "") == "RealModel" and cls.is_registered]
    return sorted(found, key=lambda cls: hasattr(cls, "bl_parent_id"))


def open_tab(walk):
    """Opens the tab RealModel of the sidebar; the names of the tabs stand at its right border."""
    drawn = []
    panel = next(cls for cls in TAB if cls.__name__ == "REALMODEL_PT_start")
    before = panel.draw

    def draw(self, context):
        drawn.append(True)
        before(self, context)

    panel.draw = draw
    region = walk.region("UI")
    for down in range(30, region.height - 30, 30):
        walk.click(region.x + region.width - 10, region.y + region.height - down)
        yield walk.redrawn()
        if drawn:
            break
    panel.draw = before
    if not drawn:
        raise AssertionError("the tab RealModel was not found")
    walk.over_viewport()
    yield walk.redrawn()


def keep(walk, name, region=None, panels=()):
    """Keeps a picture of a region of the 3D viewport, or of all of it with the sidebar, as NAME.png. panels:
    of the sidebar these alone, open; their idnames end so."""
    from driver import save_picture

    if panels:
        yield from show_panels(walk, panels)
    yield walk.redrawn(3)
    picture = seen(walk, walk.area if region is None else walk.region(region))
    save_picture(without_tabs(picture) if region == "UI" else picture, IMAGES / f"{name}.png")


def seen(walk, part):
    """(height, width, 3) a part of the window as it is on the screen."""
    from driver import read_screen

    return read_screen(walk.screen)[part.y : part.y + part.height, part.x : part.x + part.width]


def without_tabs(picture):
    """The sidebar without the names of its tabs, and without the empty part below its panels."""
    import bpy

    width = picture.shape[1] - int(30 * bpy.context.preferences.view.ui_scale)
    picture = picture[:, :width]
    background = picture[8, width // 2]
    drawn = (abs(picture[:, 10:-10] - background) > 0.02).any(axis=(1, 2))
    drawn[:12] = False  # the border of the region
    lowest = int(drawn.argmax())
    return picture[max(lowest - 8, 0) :]


def within_border(picture):
    """A dark window of Blender's that is open over an empty viewport, without what is around it."""
    import numpy as np

    is_dark = picture.mean(axis=2) < 0.16
    rows = np.flatnonzero(is_dark.sum(axis=1) > 200)
    columns = np.flatnonzero(is_dark.sum(axis=0) > 100)
    return picture[rows[0] : rows[-1], columns[0] : columns[-1]]


def show_panels(walk, names=()):
    """Registers these panels of the tab alone, so that no other takes room; none given: all."""
    import bpy

    for cls in reversed(list(TAB)):
        if cls.is_registered:
            bpy.utils.unregister_class(cls)
    for cls in TAB:
        if not names or cls.__name__.removeprefix("REALMODEL_PT_") in names:
            bpy.utils.register_class(cls)
    yield walk.redrawn(3)


def build(walk):
    """Builds as a press of the button does, and waits."""
    import bpy

    with viewport(walk):
        bpy.ops.realmodel.build("EXEC_DEFAULT")
    yield walk.redrawn(3)


def viewport(walk):
    import bpy

    return bpy.context.temp_override(window=walk.window, area=walk.area, region=walk.region("WINDOW"))


def example(walk, name):
    import bpy

    with viewport(walk):
        bpy.ops.realmodel.open_sample(sample=name)
    if not len(bpy.context.scene.realmodel.results):
        yield from build(walk)
    frame(walk)
    yield walk.redrawn(3)


def frame(walk, share=0.92):
    """Turns the viewport to the blocks, or else to what the scene has."""
    import bpy

    rows = [row.object for row in bpy.context.scene.realmodel.results if row.object is not None]
    for item in bpy.context.selected_objects:
        item.select_set(False)
    fill_view(walk, rows or [item for item in bpy.data.objects if item.type == "MESH"], share)


def fill_view(walk, items, share=0.92):
    """Turns the viewport to objects, which then fill a share of it."""
    import bpy
    import numpy as np
    from gallery_picture import seen_from
    from mathutils import Vector
    from realmodel.bl import picture

    bpy.context.view_layer.update()
    corners = [item.matrix_world @ Vector(corner) for item in items for corner in item.bound_box]
    view, rotation = walk.area.spaces.active.region_3d, picture.view_rotation()
    view.view_perspective, view.view_rotation = "PERSP", rotation.to_quaternion()
    view.update()
    tangents = share / np.array([view.window_matrix[0][0], view.window_matrix[1][1]])
    axes = np.array(rotation.transposed())
    corners = np.array(corners, float)
    eye, middle = seen_from(corners, axes, tangents), (corners @ axes[2]).mean()
    view.view_location = axes.T @ np.array([*eye[:2], middle])
    view.view_distance = eye[2] - middle
    space = walk.area.spaces.active
    space.clip_end = max(space.clip_end, 10.0 * view.view_distance)


def side_by_side(pictures, name, columns, smaller=1):
    """Keeps several pictures of one width as one, so many times smaller, with white lines between."""
    import numpy as np
    from driver import save_picture

    tiles, highest = [], max(len(picture) for picture in pictures)
    for picture in pictures:
        picture = np.pad(picture, ((0, highest - len(picture)), (0, 0), (0, 0)), constant_values=1.0)
        height, width = (size // smaller * smaller for size in picture.shape[:2])
        blocks = picture[:height, :width].reshape(height // smaller, smaller, width // smaller, smaller, 3)
        tiles.append(np.pad(blocks.mean(axis=(1, 3)), ((4, 4), (4, 4), (0, 0)), constant_values=1.0))
    rows = [np.concatenate(tiles[n : n + columns], axis=1) for n in range(0, len(tiles), columns)]
    save_picture(np.concatenate(rows[::-1]), IMAGES / f"{name}.png")


# -- chapters


def start(walk):
    """The tab in a new file."""
    import bpy
    import guide_panels

    yield from keep(walk, guide_panels.START, "UI")
    guide_panels.keep({guide_panels.START: guide_panels.shown(bpy.context, guide_panels.START)})


def tour(walk):
    """Each panel by itself."""
    import bpy
    import guide_panels

    yield from example(walk, guide_panels.EXAMPLE)
    guide_panels.choose_rows(bpy.context.scene.realmodel)
    found = {}
    for name in guide_panels.PANELS:
        yield from keep(walk, name, "UI", [name])
        found[name] = guide_panels.shown(bpy.context, name)
    guide_panels.keep(found)


def window(walk):
    """The window with an example."""
    yield from example(walk, "castle_hill")
    yield from keep(walk, "window")


def modes(walk):
    """The display modes, a stage, moved apart, cut open: docs/images/view_modes.png."""
    import bpy

    yield from show_panels(walk, ["start"])
    walk.area.spaces.active.show_region_ui = False
    yield from example(walk, "castle_hill")
    group = bpy.context.scene.realmodel
    group.view.show_legend = False
    yield from settled(walk)
    frame(walk, 0.8)
    pictures = []
    for mode in ("POINTS", "LINES", "AREAS", "SURFACES", "POLYHEDRA", "BLOCKS"):
        group.display = mode
        yield from settled(walk)
        pictures.append(labeled(middle(walk), modes_of(group)[mode]))
    group.display = "BLOCKS"
    group.stage = 5
    yield from settled(walk)
    pictures.append(labeled(middle(walk), "Blocks at Stage 5"))
    group.stage, group.explode = len(group.rocks[0].surfaces) - 1, 0.5
    yield from settled(walk)
    pictures.append(labeled(middle(walk), "Explode 0.5"))
    group.explode = 0.0
    bpy.ops.realmodel.section_plane(axis="Y")
    yield from settled(walk)
    pictures.append(labeled(middle(walk), "Section"))
    side_by_side(pictures, "../view_modes", 3, 2)
    bpy.ops.realmodel.section_remove()
    for stage in (3, 6, 10):
        group.stage = stage
        yield from settled(walk)
        pictures.append(labeled(middle(walk), f"Stage {stage}: {group.rocks[0].surfaces[stage].name}"))
    side_by_side(pictures[-3:], "stages", 3, 2)


def modes_of(group):
    """The labels of the display modes."""
    return {item.identifier: item.name for item in group.bl_rna.properties["display"].enum_items}


def labeled(picture, text, labels=()):
    """A picture of the window with a text at its upper left, and labels: (text, position (x, y), offset)."""
    import numpy as np
    from gallery_picture import INK, LABEL, WHITE, add_label
    from realmodel.core.drawing.drawing import Drawing
    from realmodel.core.drawing.glyphs import text_width
    from realmodel.core.drawing.raster import over, rasterize

    height, width = picture.shape[:2]
    scale = 28.0 / LABEL
    drawing = Drawing(width / scale, height / scale)
    if text:
        size = 52.0 / scale
        drawing.rectangle((8, drawing.height - 42, text_width(text, size) + 14, 34), WHITE)
        drawing.text(15, drawing.height - 32, text, size, INK)
    for words, place, offset in labels:
        add_label(drawing, np.array(place) / scale, offset, words)
    pixels = np.ones((height, width, 4), np.float32)
    pixels[:, :, :3] = picture[::-1]
    over(pixels, rasterize(drawing, scale, None), 0, 0)
    return pixels[::-1, :, :3]


def middle(walk):
    """The viewport without what is empty above and below the model."""
    picture = seen(walk, walk.region("WINDOW"))
    return picture[len(picture) // 8 : -len(picture) // 8]


def settled(walk):
    """Nothing is being made any more, and all of it was drawn."""
    import bpy
    from realmodel.bl.display import cuts, preparing

    yield walk.redrawn(2)
    yield lambda: not preparing.is_working(bpy.context.scene) and not cuts.is_working(bpy.context.scene)
    yield walk.redrawn(3)


def import_tables():
    """Two tables of points become surfaces, their points large and in colors."""
    import bpy

    for name in ("clay", "ground"):
        bpy.ops.realmodel.surface_add(filepath=str(SAMPLES / "two_layers" / f"{name}.csv"))
    bpy.context.scene.realmodel.view.show_contacts = True


def settle_rock():
    """A region around the points, short edges, a base."""
    import bpy

    rock = bpy.context.scene.realmodel.rocks[0]
    bpy.ops.realmodel.region_around()
    rock.edge_length = 4.0
    rock.use_base, rock.base_elevation = True, 0.0


def csv_panel(walk):
    """The rock mass of two tables."""
    yield walk.redrawn()
    import_tables()
    settle_rock()
    yield from keep(walk, "csv_rocks", "UI", ["rocks"])


def csv(walk):
    """Two tables of points become a model."""
    import bpy
    from driver import save_picture

    with viewport(walk):
        bpy.ops.realmodel.surface_add("INVOKE_DEFAULT", filepath=str(SAMPLES / "two_layers" / "clay.csv"))
    yield walk.redrawn(3)
    save_picture(within_border(seen(walk, walk.region("WINDOW"))), IMAGES / "csv_dialog.png")
    walk.key("ESC")
    yield walk.redrawn(3)
    import_tables()
    for item in bpy.data.objects:
        item.hide_set(item.name.endswith(" points"))
    shown = [item for item in bpy.data.objects if item.visible_get() and item.type == "MESH"]
    fill_view(walk, shown)
    yield from keep(walk, "csv_points", panels=["start", "surfaces"])
    settle_rock()
    yield from build(walk)
    frame(walk)
    yield from keep(walk, "csv_built", panels=["build", "results"])


def quality(walk):
    """Charts of a surface, as the panel saves them."""
    import bpy
    from driver import read_picture

    yield from example(walk, "castle_hill")
    bpy.context.scene.realmodel.rocks[0].active_surface = 9
    bpy.ops.realmodel.check_quality()
    charts = []
    for chart in ("VARIOGRAM", "CROSS_VALIDATION"):
        path = IMAGES / f"{chart}.png"
        bpy.ops.realmodel.save_chart(filepath=str(path), chart=chart)
        charts.append(read_picture(path))
        path.unlink()
    side_by_side(charts, "quality", 2)


def grid(name, height, size, strength, seed):
    """A grid with a Displace modifier, as an artist makes it."""
    import bpy

    bpy.ops.mesh.primitive_grid_add(x_subdivisions=60, y_subdivisions=60, size=size, location=(0, 0, height))
    item = bpy.context.active_object
    item.name = name
    texture = bpy.data.textures.new(name, "CLOUDS")
    texture.noise_scale = 0.35 * size + 0.1 * seed
    modifier = item.modifiers.new("Displace", "DISPLACE")
    modifier.texture, modifier.strength, modifier.mid_level = texture, strength, 0.5
    return item


def sculpt(walk):
    """Three grids become strata."""
    import bpy

    for number, (name, height, strength) in enumerate(
        (("clay", 0, 2), ("sand", 2.2, 2.5), ("ground", 4.6, 4))
    ):
        grid(name, height, 12.0, strength, number)
    for item in bpy.data.objects:
        item.select_set(True)
    for item, color in zip(bpy.data.objects, ("#6f8296", "#d9b070", "#7d9460"), strict=True):
        item.data.polygons.foreach_set("use_smooth", [True] * len(item.data.polygons))
        item.color = [int(color[k : k + 2], 16) / 255 for k in (1, 3, 5)] + [1.0]
    walk.area.spaces.active.shading.color_type = "OBJECT"
    fill_view(walk, list(bpy.data.objects))
    yield from keep(walk, "sculpt_grids", "WINDOW", ["start"])
    bpy.ops.realmodel.from_selected()
    walk.area.spaces.active.shading.color_type = "MATERIAL"
    yield from build(walk)
    for row in bpy.context.scene.realmodel.results:
        row.object.data.polygons.foreach_set("use_smooth", [True] * len(row.object.data.polygons))
        row.object.data.use_auto_smooth = True
    frame(walk)
    yield from keep(walk, "sculpt_built", panels=["build", "surfaces"])


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
    """The box around objects as thin lines."""
    import bpy
    from realmodel.bl import viewports

    bpy.context.view_layer.update()
    around = viewports.corners(items)
    low, high = around.min(axis=0), around.max(axis=0)
    bpy.ops.mesh.primitive_cube_add(location=(low + high) / 2, scale=(high - low) / 2)
    box = bpy.context.active_object
    box.display_type = "WIRE"
    box.select_set(False)
    return box


def section(walk):
    """A model cut open by a plane, and a fence along a curve, the box of the model around them."""
    import bpy
    import numpy as np
    from driver import save_picture

    yield from example(walk, "gravel_plain")
    group = bpy.context.scene.realmodel
    group.view.exaggeration = 8.0
    yield from settled(walk)
    box = ghost([row.object for row in group.results if row.object])
    bpy.ops.realmodel.section_plane(axis="Y")
    yield from settled(walk)
    for item in bpy.context.selected_objects:
        item.select_set(False)
    walk.area.spaces.active.overlay.show_relationship_lines = False
    fill_view(walk, [box])
    yield from keep(walk, "section_plane", panels=["view", "view_section"])
    bpy.ops.realmodel.section_remove()
    corners = np.concatenate([np.array(row.object.bound_box) for row in group.results if row.object])
    low, high = corners.min(axis=0)[:2], corners.max(axis=0)[:2]
    curve = line([low + (high - low) * share for share in ((0.05, 0.2), (0.5, 0.6), (0.95, 0.35))])
    drawn = IMAGES / "section_drawing.png"
    bpy.ops.realmodel.save_section(filepath=str(drawn), along="LINE", exaggeration=5.0)
    bpy.ops.realmodel.fence()
    fence = bpy.context.active_object
    curve.hide_set(True)
    for row in group.results:
        if row.object:
            row.object.hide_set(True)
    fence.select_set(False)
    walk.area.spaces.active.show_region_ui = False
    yield from settled(walk)
    fill_view(walk, [box], 0.96)
    yield from settled(walk)
    region = walk.region("WINDOW")
    picture = seen(walk, region)
    x, y = walk.pixel_of(lake(fence))
    at = (x - region.x, y - region.y)
    save_picture(
        labeled(picture, "", [("The lake: a hole of the region", at, (0, 70))]), IMAGES / "section_fence.png"
    )


def lake(fence):
    """The middle of the gap in the fence, in the scene."""
    import json

    import bpy
    import numpy as np

    region = json.loads((SAMPLES / "gravel_plain" / "region.geojson").read_text(encoding="utf-8"))
    hole = np.array(region["features"][0]["geometry"]["coordinates"][1])
    places = np.array([fence.matrix_world @ vertex.co for vertex in fence.data.vertices])
    return (*(hole.mean(axis=0)[:2] - bpy.context.scene["realmodel_origin"][:2]), places[:, 2].max())


def boreholes(walk):
    """Boreholes as tubes over the channel that they found."""
    import bpy

    yield from example(walk, "uncertain_valley")
    group = bpy.context.scene.realmodel
    group.view.exaggeration = 6.0
    group.view.show_boreholes = True
    for row in group.results:
        row.object.hide_set(row.name in ("Till", "Lake clay"))
    yield from settled(walk)
    frame(walk)
    yield from keep(walk, "boreholes", panels=["results", "field"])


def mapped(walk):
    """A geological map with dips, and the model that follows from them."""
    import bpy

    yield from show_panels(walk, ["start"])
    walk.area.spaces.active.show_region_ui = False
    with viewport(walk):
        bpy.ops.realmodel.open_sample(sample="mapped_valley", build=False)
    view = bpy.context.scene.realmodel.view
    view.show_map = view.show_dips = True
    yield from settled(walk)
    frame(walk)
    yield from settled(walk)
    pictures = [labeled(seen(walk, walk.region("WINDOW")), "The map on its ground, and dips")]
    yield from build(walk)
    view.show_map = False
    frame(walk)
    yield from settled(walk)
    pictures.append(labeled(seen(walk, walk.region("WINDOW")), "The model"))
    side_by_side(pictures, "map", 2, 2)


# -- a graben between two faults

PALETTE = ("#c4aeaa", "#e6b069", "#97c0d6", "#f0e4ab", "#a9cc7a", "#d9b8cf")  # by the library's order


def structures(walk):
    """The compartments of a graben moved apart."""
    import bpy

    yield from show_panels(walk, ["start"])
    walk.area.spaces.active.show_region_ui = False
    graben()
    yield from build(walk)
    group = bpy.context.scene.realmodel
    for row, color in zip(group.library, PALETTE, strict=False):
        row.color = [int(color[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    group.explode_direction, group.explode = "COMPARTMENT", 0.4
    frame(walk, 0.66)  # of the blocks where they belong
    yield from settled(walk)
    yield from keep(walk, "structures", "WINDOW")


_FAULTS = {"West fault": (300.0, 0.22, 0.1), "East fault": (720.0, -0.2, -0.06)}
_LAYERS = {"Basement": -420.0, "Sandstone": -300.0, "Marl": -200.0, "Limestone": -110.0}


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
    from realmodel.bl import library_rows, meshes

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


PANEL_CHAPTERS = (start, tour, csv_panel)
CHAPTERS = (window, modes, csv, quality, sculpt, section, boreholes, mapped, structures)

if __name__ == "__main__":
    if "bpy" in sys.modules:
        begin(*sys.argv[sys.argv.index("--") + 1 :])
    else:
        sys.exit(main(sys.argv[1:]))
