# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the tests of this folder inside Blender or with the module bpy.

    blender -b --factory-startup --python-exit-code 1 -P tests/blender/run.py [-- NAME ...]
    python tests/blender/run.py [NAME ...]

NAME: only tests whose name contains one of these words. The exit status is 1 where a test failed or
none ran.
"""

import os
import sys
import unittest
from pathlib import Path

import bpy

FOLDER = Path(__file__).resolve().parent
sys.path[:0] = [str(FOLDER.parents[1] / "addon"), str(FOLDER)]

from realmodel.bl.host import versions  # noqa: E402


def _words():
    if "--" in sys.argv:
        return sys.argv[sys.argv.index("--") + 1 :]
    return [] if _in_blender() else sys.argv[1:]


def _in_blender():
    return Path(sys.argv[0]).resolve() != Path(__file__).resolve()


def _flat(suite):
    for test in suite:
        if isinstance(test, unittest.TestSuite):
            yield from _flat(test)
        else:
            yield test


def _not_denoised(scene):
    scene.cycles.use_denoising = False


def main():
    # Three quarters of a small picture's time. What build_model.py renders in test_build_model is denoised.
    versions.denoise = _not_denoised
    found = _flat(unittest.defaultTestLoader.discover(str(FOLDER), "test_*.py"))
    words = _words()
    chosen = unittest.TestSuite(t for t in found if not words or any(w in t.id() for w in words))
    result = unittest.TextTestRunner(stream=sys.stdout, verbosity=2).run(chosen)
    failed = len(result.failures) + len(result.errors) + len(result.unexpectedSuccesses)
    passed = result.testsRun - failed - len(result.skipped)
    print(
        f"Blender {bpy.app.version_string}: {passed} passed, {failed} failed, {len(result.skipped)} skipped",
        flush=True,
    )
    return 1 if failed or not result.testsRun else 0


if __name__ == "__main__":
    status = main()
    if not _in_blender():
        # The module bpy waits for a thread of its own at exit, sometimes for ever.
        sys.stdout.flush()
        os._exit(status)
    sys.exit(status)
