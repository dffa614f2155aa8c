#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the hero scenes, blend_samples/heroes/NAME.blend, and their pictures, docs/images/heroes/NAME.jpg.

    blender -b --factory-startup --python-exit-code 1 -P scripts/draw_heroes.py -- make [NAME ...]
    build/venv-bpy/bin/python scripts/draw_heroes.py cycles FOLDER [WIDTH [SAMPLES]] [NAME ...]
    xvfb-run -a -s "-screen 0 1280x800x24" blender --factory-startup -P scripts/draw_heroes.py -- \\
        eevee FOLDER [WIDTH [SAMPLES]] [NAME ...]

The files are made by Blender 3.4, so that all later versions open them. The module bpy renders with Cycles:
it has a denoiser, which Debian's Blender lacks. Pictures are FOLDER/NAME_ENGINE.png.
"""

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import bpy

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "addon"), str(ROOT / "scripts")]

from realmodel.bl.host import versions  # noqa: E402

FILES = ROOT / "blend_samples" / "heroes"
NAMES = ("canyon", "sea_cliff", "arch", "badlands", "island", "quarry")
SIZE = (1920, 960)
MOST = 3_000_000  # bytes of a file


def make(names):
    """Makes files of scenes. Returns how many of them are too large."""
    import hero_scenes
    import realmodel

    realmodel.register()
    too_large = 0
    for name in names or NAMES:
        begin = time.monotonic()
        bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
        getattr(hero_scenes, name)(bpy.context.scene)
        set_render(bpy.context.scene)
        save(FILES / f"{name}.blend")
        size = (FILES / f"{name}.blend").stat().st_size
        print(f"{name}: {size:,} bytes, {time.monotonic() - begin:.0f} s", flush=True)
        too_large += size > MOST
    return too_large


def set_render(scene):
    """Settings of renders in both engines."""
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.adaptive_threshold = 64, 0.03
    scene.cycles.max_bounces, scene.cycles.diffuse_bounces = 6, 3
    scene.eevee.taa_render_samples = 24
    scene.eevee.use_gtao, scene.eevee.use_ssr = True, True
    scene.eevee.use_soft_shadows = True
    scene.eevee.shadow_cascade_size = "4096"
    scene.view_settings.view_transform = "Filmic"
    if scene.view_settings.look == "None":
        scene.view_settings.look = "Medium High Contrast"
    for screen in bpy.data.screens:
        for area in screen.areas:
            if area.type == "VIEW_3D":
                area.spaces.active.region_3d.view_perspective = "CAMERA"
                area.spaces.active.clip_end = 1e5


def save(path):
    """Saves the file without what nothing uses."""
    path.parent.mkdir(exist_ok=True)
    bpy.data.orphans_purge(do_local_ids=True, do_recursive=True)
    for item in bpy.context.scene.objects:
        item.select_set(False)
    bpy.context.preferences.filepaths.save_version = 0
    with tempfile.TemporaryDirectory() as folder:
        plain = Path(folder) / path.name
        bpy.ops.wm.save_as_mainfile(filepath=str(plain), compress=False, copy=True)
        # Blender compresses in small parts and quickly: the whole file by zstd is smaller
        subprocess.run(["zstd", "-q", "-f", "-19", str(plain), "-o", str(path)], check=True)


def render(engine, folder, *rest):
    """Renders files of scenes. rest: a width, samples, and names."""
    numbers = [int(each) for each in rest if each.isdigit()]
    names = [each for each in rest if not each.isdigit()]
    for name in names or NAMES:
        begin = time.monotonic()
        bpy.ops.wm.open_mainfile(filepath=str(FILES / f"{name}.blend"))
        scene = bpy.context.scene
        width = numbers[0] if numbers else SIZE[0]
        scene.render.resolution_x, scene.render.resolution_y = width, width * SIZE[1] // SIZE[0]
        if engine == "cycles":
            scene.render.engine = "CYCLES"
            if len(numbers) > 1:
                scene.cycles.samples = numbers[1]
            versions.denoise(scene)
        else:
            scene.render.engine = "BLENDER_EEVEE"
            if len(numbers) > 1:
                scene.eevee.taa_render_samples = numbers[1]
        scene.render.image_settings.file_format = "PNG"
        scene.render.filepath = str(Path(folder).resolve() / f"{name}_{engine}.png")
        bpy.ops.render.render(write_still=True)
        print(f"{name}: {engine}, {time.monotonic() - begin:.0f} s", flush=True)


def main(arguments):
    status = 0
    if arguments[0] == "make":
        status = 1 if make(arguments[1:]) else 0
    else:
        render(*arguments)
    sys.stdout.flush()
    os._exit(status)  # the module bpy may hang as it ends


main(sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:])
