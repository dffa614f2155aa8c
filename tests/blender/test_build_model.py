# SPDX-License-Identifier: GPL-3.0-or-later
"""build_model.py run by Blender: exit status, output, and nothing left behind."""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import bpy
import realmodel
from blender_state import empty_file, open_edges, pixels
from realmodel.bl.objects import model_tree
from realmodel.bl.pictures import batch
from realmodel.bl.project import compartments

ROOT = Path(__file__).resolve().parents[2]
SAMPLE = ROOT / "blend_samples" / "two_layers" / "project.toml"
# Pictures are small: at their size, as many rays and the denoiser take a minute.
SMALL = (
    f"import sys; sys.path.insert(0, {str(ROOT / 'addon')!r}); from realmodel.bl.pictures import batch; "
    "batch.render.__defaults__ = ((160, 100), 4, 30.0)"
)
# The module bpy has no program of its own: the script is run as Blender would, by this interpreter.
AS_MODULE = (
    f"import bpy, runpy; {SMALL}; sys.argv = ['build_model.py', '--', *sys.argv[1:]]; "
    f"runpy.run_path({str(ROOT / 'build_model.py')!r}, run_name='__main__')"
)


def build_model(*arguments):
    """Runs build_model.py in a new process of the Blender that these tests run in."""
    if Path(bpy.app.binary_path).name.startswith("blender"):
        start = [bpy.app.binary_path, "-b", "--factory-startup", "--python-exit-code", "1"]
        start += ["--python-expr", SMALL, "-P", str(ROOT / "build_model.py"), "--"]
    else:
        start = [sys.executable, "-c", AS_MODULE]
    command = [*start, *(str(argument) for argument in arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)


class BuildModel(unittest.TestCase):
    def setUp(self):
        self.place = tempfile.TemporaryDirectory()
        self.addCleanup(self.place.cleanup)
        self.folder = Path(self.place.name)

    def left(self):
        return sorted(path.name for path in self.folder.rglob("*"))

    def test_done(self):
        blend, picture = self.folder / "m.blend", self.folder / "m.png"
        done = build_model(SAMPLE, "--blend", blend, "--render", picture)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(done.stderr, "")
        self.assertIn("Sand", done.stdout)
        self.assertNotIn("Fra:", done.stdout, "Blender's chatter")
        self.assertEqual(self.left(), ["m.blend", "m.png"])
        self.assertEqual(pixels(picture).shape, (100, 160, 3))
        empty_file()
        bpy.ops.wm.open_mainfile(filepath=str(blend))
        blocks = model_tree.model_objects(bpy.context.scene, "block")
        self.assertEqual([block.name for block in blocks][-1], "Sand")
        self.assertEqual([open_edges(block.data) for block in blocks], [0, 0])

    def test_a_picture_is_large(self):
        self.assertEqual(batch.render.__defaults__[0], (1600, 1000))

    def test_faults_and_bodies(self):
        """Written, and rendered, as any other; the .blend builds again what it has."""
        square = "0 0 {z}\n10 0 {z}\n10 10 {z}\n0 10 {z}\n"
        for name, z in (("low", 0), ("high", 4)):
            text = "OFF\n4 2 0\n" + square.format(z=z) + "3 0 1 2\n3 0 2 3\n"
            (self.folder / f"{name}.off").write_text(text)
        wall = "OFF\n4 2 0\n6 -1 -9\n6 11 -9\n6 11 9\n6 -1 9\n3 0 1 2\n3 0 2 3\n"
        (self.folder / "wall.off").write_text(wall)
        corners = "1 1 1\n3 1 1\n1 3 1\n1 1 3\n"
        (self.folder / "ore.off").write_text(f"OFF\n4 4 0\n{corners}3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n")
        project = self.folder / "p.toml"
        project.write_text(
            'format = 1\nname = "x"\n[[rock]]\nname = "r"\n[[rock.surface]]\nname = "low"\nmesh = "low.off"\n'
            '[[rock.surface]]\nname = "high"\nmesh = "high.off"\n[[fault]]\nname = "F"\nmesh = "wall.off"\n'
            '[[body]]\nname = "ore"\nmesh = "ore.off"\n'
        )
        blend = self.folder / "m.blend"
        done = build_model(project, "--blend", blend)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        empty_file()
        realmodel.register()
        self.addCleanup(realmodel.unregister)
        bpy.ops.wm.open_mainfile(filepath=str(blend))
        current = bpy.context.scene
        kinds = {item["realmodel_surface"]: item["realmodel"] for item in model_tree.model_objects(current)}
        self.assertEqual({kinds["F"], kinds["low"]}, {"fault", "interface"})
        self.assertEqual(len(model_tree.model_objects(current, "body")), 1)
        self.assertEqual(len(compartments.names(current)), 2)
        volumes = {row.name: float(row.volume_exact) for row in current.realmodel.results}
        self.assertAlmostEqual(volumes["ore"], 8 / 6, places=9)
        self.assertAlmostEqual(sum(volumes.values()), 400.0, places=9)
        batch.render(self.folder / "m.png", (48, 30), samples=1)
        self.assertEqual(pixels(self.folder / "m.png").shape, (30, 48, 3))
        for path in self.folder.glob("*.off"):
            path.unlink()
        bpy.ops.realmodel.build()
        again = {row.name: float(row.volume_exact) for row in current.realmodel.results}
        self.assertEqual(again, volumes)

    def test_refused(self):
        project = self.folder / "p.toml"
        project.write_text('format = 1\nname = "x"\ncolour = "red"\n')
        done = build_model(project, "--blend", self.folder / "m.blend")
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"\A[^\n]*p\.toml:3[^\n]*colour[^\n]*\n\Z")
        self.assertEqual(self.left(), ["p.toml"])

    def test_wrong_usage(self):
        """As without Blender, where all options are tested."""
        done = build_model(SAMPLE, "--blend", self.folder / "m.txt")
        self.assertEqual(done.returncode, 2)
        self.assertIn(".blend", done.stderr)
        self.assertEqual(self.left(), [])

    def test_failure_keeps_earlier_files(self):
        blend = self.folder / "m.blend"
        blend.write_bytes(b"earlier")
        done = build_model(SAMPLE, "--blend", blend, "--render", self.folder / "missing" / "m.png")
        self.assertNotEqual(done.returncode, 0)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        self.assertEqual(blend.read_bytes(), b"earlier")
        self.assertEqual(self.left(), ["m.blend"])
