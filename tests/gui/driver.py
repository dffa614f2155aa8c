# SPDX-License-Identifier: GPL-3.0-or-later
"""A person in front of Blender's window: mouse, keyboard, eyes.

Steps are generators. They yield a condition - a function without arguments - and go on when it holds, however
slow the machine is; a condition that does not hold in time ends the walk.

Screenshots are read from the frame buffer of Xvfb (its option -fbdir). Blender's own are black in Blender 4.3
with Mesa 25, and end Blender 3.4 now and then while other threads run Python: it reads an override of the
context (`temp_override`) without Python's lock if another thread has it. So no override lasts while Blender
draws, that is over a `yield`.
"""

import struct
import time
import traceback

import bpy
import numpy as np
from bpy_extras.view3d_utils import location_3d_to_region_2d
from mathutils import Vector

PATIENCE = 150.0  # seconds for one condition
LOOK = 0.02

_KEYS = {" ": "SPACE", ".": "PERIOD", "-": "MINUS"}
_DIGITS = ("ZERO", "ONE", "TWO", "THREE", "FOUR", "FIVE", "SIX", "SEVEN", "EIGHT", "NINE")


class Walk:
    """Runs steps in a window; `pictures` are the screenshots taken on the way.

    folder: where they are saved. screen: the file in which Xvfb has the pixels of its screen.
    """

    def __init__(self, folder, screen):
        self.folder = folder
        self.screen = screen
        self.pictures = []
        self.passed = []
        self.failure = None
        self.ticks = 0  # how often Blender's loop came here
        self._draws = 0

    # -- running

    def run(self, steps, at_end):
        """steps: (name, generator function of the walk) in their order. at_end(walk) is called at the end."""
        bpy.types.SpaceView3D.draw_handler_add(self._drawn, (), "WINDOW", "POST_PIXEL")
        self._steps = iter(steps)
        self._at_end = at_end
        self._generator = None
        self._condition = None
        bpy.app.timers.register(self._tick, first_interval=0.5, persistent=True)

    def _drawn(self):
        self._draws += 1

    def _tick(self):
        self.ticks += 1
        try:
            going_on = self._advance()
        except BaseException:
            self.failure = f"{self._name}: {traceback.format_exc()}"
            going_on = False
        if going_on:
            return LOOK
        self._at_end(self)
        return None

    def _advance(self):
        if self._condition is not None:
            if not self._condition():
                if time.monotonic() > self._deadline:
                    self.shot("failed")
                    raise TimeoutError(f"waited {PATIENCE:.0f} s in vain at line {self._line()}")
                return True
            self._condition = None
        if self._generator is None:
            step = next(self._steps, None)
            if step is None:
                return False
            self._name, function = step
            self._generator = function(self)
        try:
            self._condition = next(self._generator)
        except StopIteration:
            self._generator = None
            self.passed.append(self._name)
            print(f"walk: {self._name}: ok", flush=True)
        self._deadline = time.monotonic() + PATIENCE
        return True

    def _line(self):
        inner = self._generator.gi_yieldfrom
        within = f", within at line {inner.gi_frame.f_lineno}" if hasattr(inner, "gi_frame") else ""
        return f"{self._generator.gi_frame.f_lineno}{within}"

    # -- places

    @property
    def window(self):
        return bpy.context.window_manager.windows[0]

    @property
    def area(self):
        return next(a for a in self.window.screen.areas if a.type == "VIEW_3D")

    def region(self, kind):
        return next(r for r in self.area.regions if r.type == kind)

    def pixel_of(self, place):
        """Window pixel of a place (object coordinates of the world) in the 3D viewport."""
        region = self.region("WINDOW")
        at = location_3d_to_region_2d(region, self.area.spaces.active.region_3d, Vector(place))
        return int(at.x) + region.x, int(at.y) + region.y

    # -- hands

    def move(self, x, y):
        self._at = (int(x), int(y))
        self.window.event_simulate(type="MOUSEMOVE", value="NOTHING", x=self._at[0], y=self._at[1])

    def click(self, x, y, button="LEFTMOUSE"):
        self.move(x, y)
        for value in ("PRESS", "RELEASE"):
            self.window.event_simulate(type=button, value=value, x=self._at[0], y=self._at[1])

    def key(self, name, **modifiers):
        x, y = self._at
        for value in ("PRESS", "RELEASE"):
            self.window.event_simulate(type=name, value=value, x=x, y=y, **modifiers)

    def write(self, text):
        x, y = self._at
        for letter in text:
            key = _DIGITS[int(letter)] if letter.isdigit() else _KEYS.get(letter, letter.upper())
            for value, unicode in (("PRESS", letter), ("RELEASE", None)):
                self.window.event_simulate(type=key, value=value, unicode=unicode, x=x, y=y)

    def over_viewport(self):
        region = self.region("WINDOW")
        self.move(region.x + region.width * 0.4, region.y + region.height * 0.5)

    def command(self, words):
        """Runs an operator as a person does who knows its name: F3, the words, Enter."""
        self.over_viewport()
        yield self.redrawn()
        self.key("F3")
        yield self.redrawn()
        self.write(words)
        yield self.redrawn()
        self.key("RET")
        yield self.redrawn()

    # -- eyes

    def redrawn(self, times=1):
        """A condition: the viewport has been drawn anew so many times, the rest of the window once."""
        before = self._draws
        for area in self.window.screen.areas:
            area.tag_redraw()

        def drawn():
            if self._draws >= before + times:
                return True
            self.area.tag_redraw()
            return False

        return drawn

    def shot(self, name):
        """A screenshot of the window, kept as NN_name.png; returns (height, width, 3) from 0 to 1, the bottom
        row first."""
        time.sleep(LOOK)  # the X server is another process
        picture = read_screen(self.screen)
        path = self.folder / f"{len(self.pictures):02d}_{name}.png"
        save_picture(picture, path)
        self.pictures.append(path)
        return picture

    def visible_place(self, name):
        """A place of an object that nothing hides: the middle of one of its faces."""
        item = bpy.data.objects[name]
        depsgraph = bpy.context.evaluated_depsgraph_get()
        view = self.area.spaces.active.region_3d
        eye = view.view_matrix.inverted().translation
        region = self.region("WINDOW")
        for polygon in sorted(item.data.polygons, key=lambda p: -p.area):
            place = item.matrix_world @ polygon.center
            at = location_3d_to_region_2d(region, view, place)
            if at is None or not (60 < at.x < region.width - 320 and 60 < at.y < region.height - 120):
                continue
            hit, _, _, _, seen, _ = bpy.context.scene.ray_cast(depsgraph, eye, (place - eye).normalized())
            if hit and seen.name == name:
                return place
        raise AssertionError(f"{name} cannot be seen")

    def color_at(self, picture, place, size=3):
        """Mean color of a screenshot around where a place of the scene is drawn."""
        x, y = self.pixel_of(place)
        return picture[y - size : y + size + 1, x - size : x + size + 1].reshape(-1, 3).mean(axis=0)


def read_screen(path):
    """(height, width, 3) from 0 to 1, the bottom row first: what a screen of Xvfb shows, 32 bits a pixel. The
    file has the format of xwd (XWDFile.h of X.Org)."""
    content = path.read_bytes()
    header = struct.unpack_from(">25I", content)
    size, width, height, row, colors = (header[at] for at in (0, 4, 5, 12, 19))
    flat = np.frombuffer(content, np.uint8, row * height, size + 12 * colors)
    pixels = flat.reshape(height, row)[::-1, : 4 * width].reshape(height, width, 4)
    return pixels[:, :, 2::-1] / np.float32(255)


def save_picture(pixels, path):
    """pixels: (height, width, 3) from 0 to 1, the bottom row first."""
    image = bpy.data.images.new(path.name, pixels.shape[1], pixels.shape[0])
    try:
        image.colorspace_settings.name = "Non-Color"
        opaque = np.ones((*pixels.shape[:2], 1), np.float32)
        image.pixels.foreach_set(np.concatenate([pixels, opaque], axis=2).astype(np.float32).ravel())
        image.filepath_raw, image.file_format = str(path), "PNG"
        image.save()
    finally:
        bpy.data.images.remove(image)


def read_picture(path):
    """(height, width, 3) from 0 to 1, the bottom row first."""
    return _channels(path)[:, :, :3].copy()


def read_alpha(path):
    """(height, width) how opaque a picture is, from 0 to 1."""
    return _channels(path)[:, :, 3].copy()


def _channels(path):
    image = bpy.data.images.load(str(path))
    try:
        width, height = image.size
        flat = np.empty(width * height * image.channels, np.float32)
        image.colorspace_settings.name = "Non-Color"
        image.pixels.foreach_get(flat)
    finally:
        bpy.data.images.remove(image)
    return flat.reshape(height, width, -1)


def contact_sheet(pictures, path, columns=3, smaller=3):
    """All screenshots on one sheet, each so many times smaller."""
    tiles = []
    for picture in map(read_picture, pictures):
        height, width = (size // smaller * smaller for size in picture.shape[:2])
        blocks = picture[-height:, :width].reshape(height // smaller, smaller, width // smaller, smaller, 3)
        tiles.append(np.pad(blocks.mean(axis=(1, 3)), ((3, 3), (3, 3), (0, 0)), constant_values=1.0))
    tiles += [np.ones_like(tiles[0])] * (-len(tiles) % columns)
    rows = [np.concatenate(tiles[n : n + columns], axis=1) for n in range(0, len(tiles), columns)]
    save_picture(np.concatenate(rows[::-1], axis=0), path)


def hue_differs(first, second):
    """How far apart two colors are, whatever the light: 0 the same hue, 1 as far as can be."""
    first, second = (np.asarray(c, float) - min(c) + 1e-6 for c in (first, second))
    return float(1.0 - first @ second / np.linalg.norm(first) / np.linalg.norm(second))
