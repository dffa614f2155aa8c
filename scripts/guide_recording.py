# SPDX-License-Identifier: GPL-3.0-or-later
"""The moving picture of the README: a hand with a mouse in Blender's window. `draw_guide.py` keeps what the
screen shows after each step of the hand, and puts it together. Needs Blender, but for `assemble`."""

import json
import math

SIZE = (1280, 720)
PAUSE = 100  # milliseconds that a frame is shown
# an arrow, pixels
POINTER = ((0, 0), (0, 17), (4, 13.5), (6.5, 19.5), (9, 18.5), (6.5, 12.5), (12, 12))
_VALLEY = ((4.0, -57.0), (6.0, -40.0), (0.0, -24.0), (-10.0, -10.0), (-12.0, 4.0))  # lines of (x, y)
_HILL = ((22.0, -36.0), (30.0, -28.0), (26.0, -20.0), (22.0, -30.0))
MOST = 4_000_000  # bytes


class Recording:
    """Frames of the screen in a folder, and where the mouse was."""

    def __init__(self, walk, name):
        self.walk = walk
        self.folder = walk.folder / name
        self.folder.mkdir()
        self.frames = []  # [x, y, milliseconds]
        self.at = (0.0, 0.0)

    def frame(self, milliseconds=PAUSE, condition=None):
        """One frame, when all has been drawn that the last step changed."""
        from driver import read_screen, save_picture

        yield self.walk.redrawn(2) if condition is None else condition
        picture = read_screen(self.walk.screen)
        save_picture(picture, self.folder / f"{len(self.frames):03}.png")
        self.frames.append([self.at[0], len(picture) - self.at[1], milliseconds])

    def move(self, x, y):
        self.at = (x, y)
        self.walk.move(x, y)

    def glide(self, x, y, steps):
        """The mouse goes to a place, slowly at both ends."""
        west, south = self.at
        for step in range(1, steps + 1):
            share = 0.5 - 0.5 * math.cos(math.pi * step / steps)
            self.move(west + share * (x - west), south + share * (y - south))
            yield from self.frame()

    def button(self, value, button="LEFTMOUSE", **modifiers):
        x, y = map(int, self.at)
        self.walk.window.event_simulate(type=button, value=value, x=x, y=y, **modifiers)

    def finish(self):
        (self.folder / "frames.json").write_text(json.dumps(self.frames), encoding="utf-8")


def alone(walk):
    """Closes all areas of the window but the viewport."""
    import bpy

    while len(others := [a for a in walk.window.screen.areas if a.type != "VIEW_3D"]) > 0:
        count = len(others)
        for area in others:
            with bpy.context.temp_override(window=walk.window, area=area):
                bpy.ops.screen.area_close()
            break
        yield walk.redrawn(2)
        if count == len([a for a in walk.window.screen.areas if a.type != "VIEW_3D"]):
            raise AssertionError("an area cannot be closed")


def carving(walk):
    """A valley is carved into an island and a hill is raised, and the blocks follow."""
    import bpy
    import guide_window

    yield from alone(walk)
    walk.area.spaces.active.show_region_toolbar = True
    guide_window.open_panels(are_as_found=True)
    yield from guide_window.show_panels(walk, ["build", "view", "results"])
    yield from guide_window.example(walk, "sculpted_island")
    group = bpy.context.scene.realmodel
    group.cells, group.rocks[0].edge_length = "BLOCKS", 5.0
    yield from guide_window.build(walk)
    group.live = True
    ground = next(row.interface for row in group.rocks[0].surfaces if row.name == "ground")
    group.active_result = len(group.results) - 4
    for item in bpy.context.selected_objects:
        item.select_set(False)
    ground.hide_set(False)
    bpy.context.view_layer.objects.active = ground
    ground.select_set(True)
    guide_window.fill_view(walk, guide_window.blocks(), 0.98, math.radians(38.0))
    bpy.ops.object.mode_set(mode="SCULPT")
    tools = bpy.context.tool_settings
    tools.sculpt.brush.direction, tools.sculpt.brush.strength = "SUBTRACT", 0.7
    tools.sculpt.brush.sculpt_plane = "Z"  # a stroke along the normals would make overhangs
    tools.unified_paint_settings.size, tools.unified_paint_settings.use_unified_strength = 55, False
    places = _line_on(ground, _VALLEY, 16)
    yield from guide_window.settled(walk)
    record = Recording(walk, "window")
    region = walk.region("WINDOW")
    record.move(region.x + 0.25 * region.width, region.y + 0.12 * region.height)
    yield from record.frame(600)
    yield from record.glide(*walk.pixel_of(places[0]), 5)
    yield from stroke(record, places)
    places = _line_on(ground, _HILL, 9)
    yield from record.glide(*walk.pixel_of(places[0]), 4)
    yield from stroke(record, places, ctrl=True)
    yield from record.glide(region.x + 0.25 * region.width, region.y + 0.12 * region.height, 4)
    yield from record.frame(1500)
    record.finish()


def stroke(record, places, **modifiers):
    """The brush goes over places; each frame waits for the blocks."""
    import bpy
    from realmodel.bl.scene import live

    record.button("PRESS", **modifiers)
    for place in places:
        record.move(*record.walk.pixel_of(place))
        yield record.walk.redrawn()
        yield lambda: not live.is_working()
        if problem := bpy.context.window_manager.realmodel.problem:
            raise AssertionError(problem)
        yield from record.frame()
    record.button("RELEASE")
    yield record.walk.redrawn()
    yield lambda: not live.is_working()
    yield from record.frame(500)


def _line_on(ground, line, count):
    """So many places on a mesh along a line of (x, y), in the scene."""
    import numpy as np

    shares = np.linspace(0.0, len(line) - 1.0, count)
    x, y = (np.interp(shares, range(len(line)), axis) for axis in np.transpose(line))
    hits = [ground.ray_cast((*place, 1000.0), (0.0, 0.0, -1.0)) for place in zip(x, y, strict=True)]
    return [ground.matrix_world @ hit[1] for hit in hits]


def assemble(folder, target):
    """Puts the frames of a folder together, with the mouse on them."""
    from PIL import Image, ImageDraw

    fine = 4
    arrow = Image.new("RGBA", (16 * fine, 24 * fine))
    corners = [(fine * (x + 1), fine * (y + 1)) for x, y in POINTER]
    ImageDraw.Draw(arrow).polygon(corners, fill="black", outline="white", width=fine)
    arrow = arrow.resize((16, 24), Image.Resampling.LANCZOS)
    kept = json.loads((folder / "frames.json").read_text(encoding="utf-8"))
    frames = []
    for number, (x, y, _) in enumerate(kept):
        with Image.open(folder / f"{number:03}.png") as picture:
            frame = picture.convert("RGB")
        frame.paste(arrow, (round(x) - 1, round(y) - 1), arrow)
        frames.append(frame)
    durations = [milliseconds for _, _, milliseconds in kept]
    frames[0].save(
        target, save_all=True, append_images=frames[1:], duration=durations, loop=0, quality=80, method=3
    )
    if target.stat().st_size > MOST:
        raise SystemExit(f"{target} has {target.stat().st_size:,} bytes, more than {MOST:,}")
