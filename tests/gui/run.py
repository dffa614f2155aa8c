# SPDX-License-Identifier: GPL-3.0-or-later
"""The walk of a new user through a real window, under Xvfb:

    mkdir -p build/gui
    xvfb-run -a -s "-screen 0 1280x800x24 -fbdir build/gui" blender --factory-startup \\
        --enable-event-simulate --window-geometry 0 0 1280 800 -P tests/gui/run.py -- [FOLDER] [SAMPLE]

FOLDER: where Xvfb has its frame buffer, and where the screenshots and a sheet of all go (default build/gui).
SAMPLE: the example that is opened (default two_layers).
The steps are in steps_*.py, in the order of those files' names. Blender ends with status 1 where one failed.
"""

import importlib
import os
import sys
from pathlib import Path

import bpy

FOLDER = Path(__file__).resolve().parent
ROOT = FOLDER.parents[1]
sys.path[:0] = [str(ROOT / "addon"), str(FOLDER)]

import realmodel  # noqa: E402
from driver import Walk, contact_sheet  # noqa: E402


def main():
    given = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    folder = Path(given[0] if given else ROOT / "build" / "gui").resolve()
    for picture in folder.glob("*.png"):
        picture.unlink()
    bpy.context.preferences.view.show_splash = False
    # Drawn in software, smooth edges take more than half of the walk's processor time.
    bpy.context.preferences.system.viewport_aa = "OFF"
    bpy.context.preferences.system.use_overlay_smooth_wire = False
    realmodel.register()
    walk = Walk(folder, folder / "Xvfb_screen0")
    walk.sample = given[1] if len(given) > 1 else "two_layers"
    modules = [importlib.import_module(path.stem) for path in sorted(FOLDER.glob("steps_*.py"))]
    steps = [(step.__name__, step) for module in modules for step in module.STEPS]
    walk.run(steps, lambda walk: at_end(walk, len(steps)))


def at_end(walk, count):
    if walk.pictures:
        contact_sheet(walk.pictures, walk.folder / "contact_sheet.png", columns=6, smaller=4)
    if walk.failure:
        print(f"FAILED: {walk.failure}", flush=True)
    failed = count - len(walk.passed)
    counts = f"{len(walk.passed)} passed, {failed} failed, 0 skipped"
    print(f"Blender {bpy.app.version_string} in a window: {counts}", flush=True)
    os._exit(1 if failed else 0)  # Blender would ask whether to save


main()
