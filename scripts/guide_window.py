# SPDX-License-Identifier: GPL-3.0-or-later
"""The window in which `draw_guide.py` takes pictures: the tab of the sidebar, where the viewport looks, and
what is kept of the screen. Needs Blender."""

import math

TAB = {}  # the panels of the tab in their order, and their options
ELEVATION = math.radians(27.0)  # of the eye above the horizon, as in the add-on
LOWEST = 0.5  # height of a viewport to its width, where a picture has few panels
MARGIN = 14  # pixels around a viewport, where Blender has a border and arrows that open regions


def find_panels():
    """Remembers the panels of the tab, a parent before its children."""
    import bpy

    kinds = bpy.types.Panel.__subclasses__()
    found = [cls for cls in kinds if getattr(cls, "bl_category", "") == "RealModel" and cls.is_registered]
    found.sort(key=lambda cls: hasattr(cls, "bl_parent_id"))
    TAB.update({cls: set(getattr(cls, "bl_options", ())) for cls in found})


def open_panels(are_as_found):
    """Panels are open or closed as users find them, or else all open, when they are shown next."""
    for cls, options in TAB.items():
        cls.bl_options = options - (set() if are_as_found else {"DEFAULT_CLOSED"})


def open_tab(walk, first="start"):
    """Opens the tab of the sidebar that begins with a panel; the names of tabs stand at its right border."""
    import bpy

    drawn = []
    panel = getattr(bpy.types, f"REALMODEL_PT_{first}")
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
        raise AssertionError(f"the tab {panel.bl_category} was not found")
    walk.over_viewport()
    yield walk.redrawn()


def show_panels(walk, names=(), folded=()):
    """Registers these panels of the tab alone, so that no other takes room; none given: all. folded: more
    panels, of which the headers alone are shown, if they were not shown before."""
    import bpy

    for cls in reversed(list(TAB)):
        if cls.is_registered:
            bpy.utils.unregister_class(cls)
    for cls in TAB:
        name = cls.__name__.removeprefix("REALMODEL_PT_")
        if name in folded:
            cls.bl_options = TAB[cls] | {"DEFAULT_CLOSED"}
        if not names or name in names or name in folded:
            bpy.utils.register_class(cls)
    yield walk.redrawn(3)


def fit(walk, panels):
    """Shows these panels alone, and makes the viewport as high as they are, at least LOWEST of its width."""
    yield from show_panels(walk, panels)
    area, sidebar = walk.area, walk.region("UI")
    drawn = len(without_tabs(seen(walk, sidebar)))
    height = max(drawn, int(LOWEST * area.width)) + area.height - sidebar.height
    x, y = area.x + area.width // 2, area.y - 1
    yield from drag(walk, (x, y), (x, y + area.height - height))
    walk.over_viewport()
    yield walk.redrawn(3)
    if abs(walk.area.height - height) > 40:
        raise AssertionError(f"the viewport is {walk.area.height} pixels high, not {height}")


def widen(walk, region, pixels):
    """Makes a region at the right wider."""
    before, x, y = region.width, region.x, region.y + region.height // 3
    yield from drag(walk, (x, y), (x - pixels, y))
    if region.width < before + 0.5 * pixels:
        raise AssertionError("the sidebar stays as wide as it is")


def drag(walk, begin, end):
    """Drags a border, as a mouse does. begin, end: (x, y) in the window."""
    (x, y), (right, up) = begin, end
    for step in (40, 0):  # the border is found when the mouse comes to it
        walk.move(x - step, y - step)
        yield from redrawn(walk)
    walk.window.event_simulate(type="LEFTMOUSE", value="PRESS", x=x, y=y)
    yield from redrawn(walk)
    for share in (0.2, 0.5, 1.0, 1.0):
        walk.move(x + share * (right - x), y + share * (up - y))
        yield from redrawn(walk)
    walk.window.event_simulate(type="LEFTMOUSE", value="RELEASE", x=int(right), y=int(up))
    yield from redrawn(walk)


def redrawn(walk, times=3):
    """Blender's loop comes by so many times and draws the window, whatever areas it has."""
    for _ in range(times):
        for area in walk.window.screen.areas:
            area.tag_redraw()
        yield lambda: True


def to_the_end(walk):
    """Scrolls the sidebar down, as the wheel of a mouse does."""
    region = walk.region("UI")
    x, y = region.x + region.width // 2, region.y + region.height // 2
    walk.move(x, y)
    for _ in range(12):
        walk.window.event_simulate(type="WHEELDOWNMOUSE", value="PRESS", x=x, y=y)
        yield from redrawn(walk, 2)
    walk.over_viewport()


def keep(walk, name, region=None, panels=(), folded=()):
    """Keeps a picture of the sidebar (region "UI"), or of the viewport with it, as NAME.png. panels, folded:
    of the sidebar these alone, as of show_panels; their idnames end so."""
    from driver import save_picture

    if panels:
        yield from show_panels(walk, panels, folded)
    yield walk.redrawn(3)
    picture = seen(walk, walk.area if region is None else walk.region(region))
    save_picture(without_tabs(picture) if region == "UI" else picture, walk.folder / f"{name}.png")


def keep_below(walk, name, parent, child):
    """Keeps a picture of a panel that is below what its parent has."""
    from driver import save_picture

    pictures = []
    for panels in ([parent], [parent, child]):
        yield from show_panels(walk, panels)
        pictures.append(without_tabs(seen(walk, walk.region("UI"))))
    save_picture(pictures[1][: len(pictures[1]) - len(pictures[0])], walk.folder / f"{name}.png")


def browse(walk, name, folder, only_options=False, chosen=False):
    """Keeps a picture of the file browser that was opened, without its bookmarks, or of its options;
    then closes it. chosen: all files of the folder are."""
    import bpy
    from driver import save_picture

    def opened():
        return next((area for area in walk.window.screen.areas if area.type == "FILE_BROWSER"), None)

    yield lambda: opened() is not None and opened().spaces.active.params is not None
    opened().spaces.active.show_region_toolbar = False
    opened().spaces.active.params.directory = str(folder).encode()
    yield from redrawn(walk, 20)
    files = next(region for region in opened().regions if region.type == "WINDOW")
    walk.move(files.x + files.width // 2, files.y + files.height // 3)
    if chosen:
        walk.key("A")
        yield from redrawn(walk, 20)
    options = next(region for region in opened().regions if region.type == "TOOL_PROPS")
    yield from widen(walk, options, 110 * bpy.context.preferences.view.ui_scale)
    picture = seen(walk, options if only_options else opened())
    save_picture(drawn_part(picture) if only_options else picture, walk.folder / f"{name}.png")
    with bpy.context.temp_override(window=walk.window, area=opened()):
        bpy.ops.file.cancel()
    yield lambda: any(area.type == "VIEW_3D" for area in walk.window.screen.areas)


def seen(walk, part):
    """(height, width, 3) a part of the window as it is on the screen."""
    from driver import read_screen

    return read_screen(walk.screen)[part.y : part.y + part.height, part.x : part.x + part.width]


def without_tabs(picture):
    """The sidebar without the names of its tabs, and without the empty part below its panels."""
    import bpy

    width = picture.shape[1] - int(30 * bpy.context.preferences.view.ui_scale)
    return drawn_part(picture[:, :width])


def drawn_part(picture):
    """A region without the empty part below its panels."""
    background = picture[8, picture.shape[1] // 2]
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


def viewed(walk):
    """(height, width, 3) the viewport without its margins."""
    return seen(walk, walk.region("WINDOW"))[MARGIN:-MARGIN, MARGIN:-MARGIN]


def place_in_view(walk, point):
    """(2,) where a point of the scene is in the picture of `viewed`."""
    region = walk.region("WINDOW")
    x, y = walk.pixel_of(point)
    return x - region.x - MARGIN, y - region.y - MARGIN


def settled(walk):
    """Nothing is being made any more, and all of it was drawn."""
    import bpy
    from realmodel.bl.display import cuts, preparing

    yield walk.redrawn(2)
    yield lambda: not preparing.is_working(bpy.context.scene) and not cuts.is_working(bpy.context.scene)
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


def frame(walk, share=0.92, elevation=ELEVATION, **more):
    """Turns the viewport to the blocks, or else to what the scene has. elevation: of the eye, radians; more:
    its azimuth."""
    import bpy

    for item in bpy.context.selected_objects:
        item.select_set(False)
    fill_view(
        walk, blocks() or [item for item in bpy.data.objects if item.type == "MESH"], share, elevation, **more
    )


def blocks():
    """The objects of the blocks."""
    import bpy

    return [row.object for row in bpy.context.scene.realmodel.results if row.object is not None]


def fill_view(walk, items, share=0.92, elevation=ELEVATION, left=0.0, **more):
    """Turns the viewport to objects, which then fill a share of it. left: share of its width at the left that
    stays free, for legends."""
    import bpy
    import numpy as np
    from gallery_picture import seen_from
    from mathutils import Vector
    from realmodel.bl.objects import viewports

    bpy.context.view_layer.update()
    corners = [item.matrix_world @ Vector(place) for item in items for place in _places(item)]
    view = walk.area.spaces.active.region_3d
    rotation = viewports.view_rotation(elevation=elevation, **more)
    view.view_perspective, view.view_rotation = "PERSP", rotation.to_quaternion()
    view.update()
    tangents = share / np.array([view.window_matrix[0][0], view.window_matrix[1][1]])
    axes = np.array(rotation.transposed())
    corners = np.array(corners, float)
    whole = tangents[0]
    tangents[0] *= 1.0 - left
    eye, middle = seen_from(corners, axes, tangents), (corners @ axes[2]).mean()
    eye[0] -= left * whole * (eye[2] - middle)
    view.view_location = axes.T @ np.array([*eye[:2], middle])
    view.view_distance = eye[2] - middle
    space = walk.area.spaces.active
    space.clip_end = max(space.clip_end, 10.0 * view.view_distance)
    space.clip_start = max(
        space.clip_start, view.view_distance / 200.0
    )  # with a nearer clip plane outlines are jagged


def _places(item):
    """The vertices of a mesh, the corners of an image, or else of the box around an object."""
    if item.type == "MESH":
        return [vertex.co for vertex in item.data.vertices]
    if item.type == "EMPTY" and item.data is not None:
        width, height = (size / max(item.data.size) for size in item.data.size)
        return (0.0, 0.0, 0.0), (width, 0.0, 0.0), (0.0, height, 0.0), (width, height, 0.0)
    return item.bound_box


def side_by_side(pictures, path, columns, smaller=1):
    """Saves several pictures of one width as one, so many times smaller, with white lines between."""
    import numpy as np
    from driver import save_picture

    tiles, highest = [], max(len(picture) for picture in pictures)
    for picture in pictures:
        picture = np.pad(picture, ((0, highest - len(picture)), (0, 0), (0, 0)), constant_values=1.0)
        height, width = (size // smaller * smaller for size in picture.shape[:2])
        blocks = picture[:height, :width].reshape(height // smaller, smaller, width // smaller, smaller, 3)
        tiles.append(np.pad(blocks.mean(axis=(1, 3)), ((4, 4), (4, 4), (0, 0)), constant_values=1.0))
    rows = [np.concatenate(tiles[n : n + columns], axis=1) for n in range(0, len(tiles), columns)]
    save_picture(np.concatenate(rows[::-1]), path)


def labeled(picture, text, labels=()):
    """A picture of the window with a text at its upper left, and labels: (text, position (x, y), offset)."""
    import numpy as np
    from gallery_picture import INK, LABEL, WHITE, add_label
    from realmodel.core.drawing.drawing import Drawing, text_width
    from realmodel.core.drawing.png import over, rasterize

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
