# SPDX-License-Identifier: GPL-3.0-or-later
"""What is different on Windows, tried on Windows or under Wine: scripts/test_windows.sh.

    python.exe tests/windows/run.py FOLDER [NAME ...]

FOLDER: has what Linux made of the samples, SAMPLE.npz. NAME: as unittest takes it. The add-on is that of
addon/realmodel; build_model.py runs in consoles of its own.
"""

import os
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
SAMPLES = ROOT / "blend_samples"
LINUX = Path(sys.argv.pop(1)).resolve() if len(sys.argv) > 1 else None
NAMED = "Schichten, Klüfte & Größen"


def build_model(*arguments, cwd=ROOT, **more):
    """What build_model.py did, as a user calls it."""
    command = [sys.executable, str(ROOT / "build_model.py"), *map(str, arguments)]
    return subprocess.run(
        command, cwd=cwd, capture_output=True, encoding="utf-8", errors="replace", check=False, **more
    )


class Case(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def copy(self, sample="two_layers", name=NAMED):
        return Path(shutil.copytree(SAMPLES / sample, self.folder / name)) / "project.toml"

    def assert_done(self, done):
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def assert_as_on_linux(self, made, sample="two_layers", folder=""):
        """folder: as the record has it, in which the files of the sample were put."""
        with np.load(made) as mine, np.load(LINUX / f"{sample}.npz") as theirs:
            self.assertEqual(mine.files, theirs.files)
            for name in mine.files:
                with self.subTest(sample=sample, array=name):
                    found, expected = mine[name], theirs[name]
                    if name == "record":
                        self.assertIn(folder.encode(), found.tobytes())
                        found = np.frombuffer(found.tobytes().replace(folder.encode(), b""), found.dtype)
                    self.assertEqual((found.dtype, found.shape), (expected.dtype, expected.shape))
                    self.assertEqual(found.tobytes(), expected.tobytes())
        if not folder:
            self.assertEqual(Path(made).read_bytes(), (LINUX / f"{sample}.npz").read_bytes())


class Samples(Case):
    def test_the_same_models_as_on_linux(self):
        files = sorted(LINUX.glob("*.npz"))
        self.assertGreater(len(files), 5)
        for file in files:
            with self.subTest(sample=file.stem):
                made = self.folder / file.name
                self.assert_done(
                    build_model(SAMPLES / file.stem / "project.toml", "--export", made, "--quiet")
                )
                self.assert_as_on_linux(made, file.stem)


class Paths(Case):
    def test_spaces_and_umlauts_with_a_drive_letter(self):
        project = self.copy()
        made = project.with_name("Modell größer.npz")
        self.assertRegex(str(made), r"^[A-Z]:\\")
        done = build_model(project, "--export", made)
        self.assert_done(done)
        self.assertIn("Clay", done.stdout)
        self.assert_as_on_linux(made)

    def test_backslashes_relative_to_the_folder(self):
        self.copy()
        self.assert_done(
            build_model(rf"{NAMED}\project.toml", "--export", rf".\{NAMED}\model.npz", cwd=self.folder)
        )
        self.assert_as_on_linux(self.folder / NAMED / "model.npz")

    def test_backslashes_in_the_project(self):
        project = self.copy("castle_hill")
        text = project.read_text(encoding="utf-8")
        (project.parent / "Daten").mkdir()
        changed = []
        for file in [each for each in project.parent.iterdir() if each.suffix == ".csv"]:
            if f'"{file.name}"' in text:
                file.rename(project.parent / "Daten" / file.name)
                text = text.replace(f'"{file.name}"', f"'Daten\\{file.name}'")
                changed.append(file.name)
        self.assertTrue(changed)
        project.write_text(text, encoding="utf-8")
        made = self.folder / "model.npz"
        self.assert_done(build_model(project, "--export", made, "--quiet"))
        self.assert_as_on_linux(made, "castle_hill", "Daten/")

    def test_lines_that_end_as_on_windows(self):
        for sample in ("two_layers", "castle_hill"):
            project = self.copy(sample, sample)
            for file in project.parent.rglob("*"):
                if file.suffix in (".toml", ".csv", ".txt", ".xyz"):
                    file.write_bytes(file.read_bytes().replace(b"\r\n", b"\n").replace(b"\n", b"\r\n"))
            made = self.folder / f"{sample}.npz"
            self.assert_done(build_model(project, "--export", made, "--quiet"))
            self.assert_as_on_linux(made, sample)

    def test_all_that_can_be_exported(self):
        project = self.copy()
        outputs = [
            project.with_name(f"Größe 1{ending}")
            for ending in (
                ".vtu",
                ".obj",
                ".glb",
                ".gpkg",
                ".geojson",
                ".csv",
                ".tif",
                ".dxf",
                ".foam",
                ".exo",
            )
        ]
        arguments = [part for file in outputs for part in ("--export", file)]
        self.assert_done(
            build_model(
                project, *arguments, "--cell-size", "20,20,10", "--report", project.with_suffix(".json")
            )
        )
        for file in [*outputs, project.with_suffix(".json")]:
            self.assertTrue(file.exists(), file)


class Files(Case):
    def test_a_file_that_is_open_elsewhere_stays_as_it_was(self):
        project = self.copy()
        made = self.folder / "model.npz"
        made.write_bytes(b"before")
        with made.open("rb"):  # Windows lets nobody replace it meanwhile
            done = build_model(project, "--export", made)
            self.assertEqual(made.read_bytes(), b"before")
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertIn("model.npz: cannot be written", done.stderr)
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), sorted([NAMED, "model.npz"]))

    def test_none_of_two_outputs_is_left_where_the_second_cannot_be_replaced(self):
        project = self.copy()
        first, second = self.folder / "a.npz", self.folder / "b.vtu"
        second.write_bytes(b"before")
        with second.open("rb"):
            done = build_model(project, "--export", first, "--export", second)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertFalse(first.exists())
        self.assertEqual(second.read_bytes(), b"before")


class Interrupted(Case):
    def test_ctrl_c_leaves_nothing(self):
        """As the C runtime does it: another thread than Python's raises the signal, while a third builds."""
        program = (
            "import runpy, signal, sys, threading, time\n"
            "def press():\n"
            "    while not any(each.name == 'realmodel work' for each in threading.enumerate()):\n"
            "        time.sleep(0.001)\n"
            "    signal.raise_signal(signal.SIGINT)\n"
            "sys.argv = sys.argv[1:]\n"
            "threading.Thread(target=press, daemon=True).start()\n"
            "runpy.run_path(sys.argv[0], run_name='__main__')\n"
        )
        project, made = SAMPLES / "haut_barr" / "project.toml", self.folder / "model.npz"
        done = subprocess.run(
            [sys.executable, "-c", program, ROOT / "build_model.py", project, "--export", made, "--quiet"],
            capture_output=True,
            encoding="utf-8",
            errors="replace",
            check=False,
        )
        self.assertEqual(done.returncode, 130, done.stdout + done.stderr)
        self.assertIn("interrupted: nothing was written", done.stderr)
        self.assertEqual(list(self.folder.iterdir()), [])


if __name__ == "__main__":
    if LINUX is None:
        sys.exit(__doc__)
    print(sys.version, os.name, signal.SIGINT.name, flush=True)
    unittest.main(verbosity=2)
