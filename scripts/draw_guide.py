#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the pictures of docs/guide in real windows under Xvfb, and makes them small.

    build/venv/bin/python scripts/draw_guide.py [NAME ...]      (default: all; it needs Pillow)

NAME is a chapter: a function of guide_chapters.py, which sets up a scene and keeps pictures of it.
"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))  # Blender does not put it there
import guide_chapters as chapters
import guide_recording

ROOT = Path(__file__).resolve().parents[1]
IMAGES = ROOT / "docs" / "images" / "guide"
WINDOWS = (  # (width, height), scale of the interface so that its letters are sharp in print, chapters
    (guide_recording.SIZE, 1.35, (guide_recording.carving,)),
    ((1500, 2400), 2.0, chapters.OF_PANELS),
    ((2300, 2200), 2.0, chapters.OF_DIALOGS),
    ((1320, 520), 1.5, chapters.OF_BROWSERS),
    ((1900, 1400), 1.5, chapters.WITH_MANY_PANELS),
    ((1900, 1150), 1.5, chapters.WITH_PANELS),
    ((1900, 1000), 1.5, chapters.OF_VIEWPORTS),
)
COLORS = 256  # of a picture in its palette
BANDS = 1.5  # mean difference that a palette makes, in steps of 255, beyond which shades show bands
WIDEST = 1200  # pixels
# Of the viewport, direction (right, up, to the eye) and brightness: walls and tops have nearly the colors of
# the legend, and the right side is a little darker.
AMBIENT = 0.62
LIGHTS = ((-0.35, 0.0, 0.94), 0.38), ((0.0, 1.0, 0.0), 0.2)
LENS = 110.0  # millimeters, of the viewport: with a shorter one near corners of a model look too large
PATIENCE = 1200.0  # seconds for one step, on a busy machine
WIDER = 130  # pixels that the sidebar is wider than in a new file, at scale 1, so that names are not cut;
WIDEST_SIDEBAR = 190  # in pictures of it alone, and in that of the window, which has the longest names
PAPER = (0.9, 0.91, 0.92)  # its background, on which dark layers and letters are seen


def main(names):
    """Outside Blender: runs this file in the windows that are needed, then makes what they kept small."""
    failed = 0
    for number, (_, _, known) in enumerate(WINDOWS):
        chosen = [draw.__name__ for draw in known if not names or draw.__name__ in names]
        if chosen:
            failed = run_in_window(number, chosen) or failed
    return failed


def run_in_window(number, names):
    """Runs chapters in Blender; returns its exit status."""
    size = WINDOWS[number][0]
    with tempfile.TemporaryDirectory() as folder:
        command = [
            "xvfb-run",
            "-a",
            "-s",
            f"-screen 0 {size[0]}x{size[1]}x24 -nocursor -fbdir {folder}",
            "blender",
        ]
        command += ["--factory-startup", "--enable-event-simulate", "--window-geometry", "0", "0"]
        command += [*map(str, size), "-P", __file__, "--", folder, str(number), *names]
        done = subprocess.run(command, cwd=ROOT, check=False)
        for frames in Path(folder).glob("*/frames.json"):
            guide_recording.assemble(frames.parent, IMAGES.parent / f"{frames.parent.name}.webp")
        for picture in sorted(Path(folder).glob("*.png")):
            shrink(picture, (IMAGES.parent if picture.stem == "view_modes" else IMAGES) / picture.name)
        return done.returncode


def shrink(source, target):
    """Writes a picture of the guide's width, with a palette unless shades would show bands with it."""
    from PIL import Image, ImageChops, ImageStat

    with Image.open(source) as picture:
        small = picture.convert("RGB")
    small.thumbnail((WIDEST, 10 * WIDEST), Image.Resampling.LANCZOS)
    method = {"method": Image.Quantize.MAXCOVERAGE, "kmeans": 3}  # else small things change color
    few = small.quantize(COLORS, dither=Image.Dither.NONE, **method)
    lost = ImageStat.Stat(ImageChops.difference(small, few.convert("RGB"))).mean
    (small if max(lost) > BANDS else few).save(target, optimize=True)


# -- in Blender


def begin(folder, number, *names):
    """Registers the add-on and runs the chapters of a window, one after another."""
    import bpy

    sys.path[:0] = [str(ROOT / part) for part in ("addon", "tests/gui", "tests/blender")]
    import driver
    import guide_window
    import realmodel

    driver.PATIENCE = PATIENCE
    _, scale, known = WINDOWS[int(number)]
    preferences = bpy.context.preferences
    preferences.view.show_splash = False
    preferences.view.filebrowser_display_type = "SCREEN"
    preferences.view.ui_scale = scale
    preferences.system.use_region_overlap = False
    light_up(preferences.system)
    preferences.system.viewport_aa = "FXAA"  # cheap: pictures are made smaller anyway
    background = preferences.themes[0].view_3d.space.gradients
    background.background_type = "SINGLE_COLOR"  # a gradient needs many colors of the palette
    background.high_gradient = PAPER
    realmodel.register()
    guide_window.find_panels()
    steps = [
        (draw.__name__, lambda walk, draw=draw: chapter(walk, draw))
        for draw in known
        if draw.__name__ in names
    ]
    driver.Walk(Path(folder), Path(folder) / "Xvfb_screen0").run(steps, at_end)


def light_up(system):
    """Sets the studio light of Solid view. system: of the preferences."""
    system.use_studio_light_edit = True
    system.light_ambient = 3 * [AMBIENT]
    for number, light in enumerate(system.solid_lights):
        light.use = number < len(LIGHTS)
        if light.use:
            light.direction, light.diffuse_color = LIGHTS[number][0], 3 * [LIGHTS[number][1]]
            light.specular_color, light.smooth = 3 * [0.0], 0.0


def at_end(walk):
    if walk.failure:
        print(walk.failure, flush=True)
    os._exit(1 if walk.failure else 0)


def chapter(walk, draw):
    """One chapter in a new file with an empty scene, and the tab open in the sidebar."""
    import bpy
    import guide_window

    bpy.ops.wm.read_homefile(use_factory_startup=True)
    yield walk.redrawn(2)
    for item in list(bpy.data.objects):
        bpy.data.objects.remove(item)
    guide_window.open_panels(are_as_found=draw in chapters.AS_FOUND)
    yield from guide_window.show_panels(walk)
    space = walk.area.spaces.active
    space.overlay.show_floor = space.overlay.show_axis_x = space.overlay.show_axis_y = False
    space.overlay.show_cursor = space.overlay.show_text = space.show_gizmo = False
    space.overlay.show_object_origins = False
    space.lens = LENS
    space.shading.studio_light = "Default"
    space.shading.show_specular_highlight = False
    # empty where only panels are kept: drawing its objects takes long, and nobody sees them
    space.show_object_viewport_mesh = draw not in chapters.OF_PANELS
    space.show_region_ui, space.show_region_toolbar = True, False
    yield lambda: walk.region("UI").width > 50
    yield from guide_window.open_tab(walk)
    wider = WIDEST_SIDEBAR if draw in (*chapters.OF_PANELS, chapters.window) else WIDER
    yield from guide_window.widen(walk, walk.region("UI"), wider * bpy.context.preferences.view.ui_scale)
    if draw in chapters.OF_VIEWPORTS:
        yield from guide_window.show_panels(walk, ["start"])
        space.show_region_ui = False
    yield from draw(walk)


if __name__ == "__main__":
    if "bpy" in sys.modules:
        begin(*sys.argv[sys.argv.index("--") + 1 :])
    else:
        sys.exit(main(sys.argv[1:]))
