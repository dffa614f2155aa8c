# SPDX-License-Identifier: GPL-3.0-or-later
"""The wheels: what is in them, and each one whose Python is here, installed in an empty environment."""

import email
import os
import re
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from conftest import ROOT, VERSION, Environment

SAMPLE = ROOT / "blend_samples" / "two_layers" / "project.toml"
VERSIONS = ("3.11", "3.12", "3.13", "3.14")


def interpreter(version):
    """A Python of this version that runs here, or None."""
    pyenv = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv")) / "versions"
    for python in (f"/usr/bin/python{version}", f"python{version}", *pyenv.glob(f"{version}.*/bin/python")):
        try:
            subprocess.run([python, "-c", "import venv, ensurepip"], check=True, capture_output=True)
        except (OSError, subprocess.CalledProcessError):
            continue
        return python
    return None


def linux_wheel(wheels, version):
    tag = f"cp{version.replace('.', '')}"
    for name, path in wheels.items():
        if name.startswith(tag) and "manylinux" in name:
            return path
    return pytest.skip(f"there is no wheel for Python {version} on Linux: its headers could not be had")


@pytest.fixture(scope="module", params=VERSIONS)
def installed(request, wheels, tmp_path_factory):
    """An empty environment of each Python into which pip installed the wheel, with Dask."""
    wheel = linux_wheel(wheels, request.param)
    python = interpreter(request.param)
    if python is None:
        pytest.skip(f"Python {request.param} is not here")
    environment = Environment(python, tmp_path_factory.mktemp("environment"))
    environment.install(f"{wheel}[dask]")
    return environment


def test_the_command_builds_a_model(installed):
    done = installed.run("realmodel", SAMPLE, "--export", "model.npz", "--export", "model.vtu")
    assert done.returncode == 0, done.stderr
    assert re.search(r"^Clay +Clay +field +104876\.4 ", done.stdout, re.MULTILINE), done.stdout
    assert (installed.folder / "model.npz").stat().st_size > 0


def test_the_command_says_its_own_name(installed):
    done = installed.run("realmodel", "nowhere.toml")
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr.startswith("realmodel: ")
    assert "usage: realmodel PROJECT" in installed.run("realmodel", "--help").stdout


def test_it_is_a_package_without_blender(installed):
    program = (
        "import sys, pathlib, realmodel.core, realmodel.distributed\n"
        "from realmodel.core.base.packages import vendored\n"
        "assert 'bpy' not in sys.modules\n"
        "assert 'site-packages' in realmodel.__file__\n"
        "for name in ('shapefile', 'tifffile'):\n"
        "    vendored(name, name, 'this test')\n"
    )
    done = installed.run("python", "-c", program)
    assert done.returncode == 0, done.stderr


def test_workers_that_have_the_wheel_build_tiles(installed):
    """A scheduler and two workers, as docs/tiles.md has a cluster started."""
    file = installed.folder / "scheduler.json"
    started = []
    for part, *options in (
        ["scheduler", "--port", "0", "--dashboard-address", ":0"],
        ["worker", "--nthreads", "1", "--no-dashboard"],
        ["worker", "--nthreads", "1", "--no-dashboard"],
    ):
        started.append(
            subprocess.Popen(
                [installed.programs / "dask", part, *options, "--scheduler-file", file],
                env=installed.variables,
                cwd=installed.folder,
                stderr=subprocess.DEVNULL,
            )
        )
    try:
        program = (
            "import distributed, sys\n"
            f"client = distributed.Client(scheduler_file={str(file)!r}, timeout=60)\n"
            "client.wait_for_workers(2, timeout=60)\n"
            "print(client.scheduler.address)\n"
        )
        found = installed.run("python", "-c", program, timeout=120)
        assert found.returncode == 0, found.stderr
        address = found.stdout.strip()
        done = installed.run(
            "realmodel", SAMPLE, "--tiles", "40,30", "--out", "tiles", "--scheduler", address, timeout=120
        )
        assert (done.returncode, done.stderr) == (0, "")
    finally:
        for process in reversed(started):
            process.terminate()
        for process in started:
            process.wait()
    program = "from realmodel.core import open_tiles; print([b.volume for b in open_tiles('tiles').blocks])"
    volumes = installed.run("python", "-c", program).stdout
    assert sorted(float(v) for v in re.findall(r"[\d.]+", volumes)) == pytest.approx([25555.00, 104876.39])


def test_each_platform_has_its_tag_and_one_module(wheels):
    module = {
        "manylinux_2_34_x86_64": r"_native\.cpython-{}-x86_64-linux-gnu\.so",
        "win_amd64": r"_native\.cp{}-win_amd64\.pyd",
        "macosx_11_0_arm64": r"_native\.cpython-{}-darwin\.so",
    }
    for name, path in wheels.items():
        python, abi, platform = name.split("-")
        assert python == abi
        with zipfile.ZipFile(path) as archive:
            (native,) = (name for name in archive.namelist() if name.startswith("realmodel/_native.cp"))
            about = archive.read(f"realmodel-{VERSION}.dist-info/WHEEL").decode()
        assert re.fullmatch(f"realmodel/{module[platform].format(python[2:])}", native)
        assert f"Tag: {name}" in about
        assert "Root-Is-Purelib: false" in about


def test_small(wheels):
    assert max(path.stat().st_size for path in wheels.values()) < 6e6


def test_nothing_of_blender_and_all_of_the_rest(wheels):
    for path in wheels.values():
        with zipfile.ZipFile(path) as archive:
            names = set(archive.namelist())
        parts = {name.split("/")[1] for name in names if name.startswith("realmodel/")} - {""}
        assert {part for part in parts if not part.startswith("_native.cp")} == {
            *("__init__.py", "_native.pyi", "py.typed", "batch", "core", "distributed")
        }
        sources = {
            f"realmodel/{file.relative_to(ROOT / 'addon' / 'realmodel').as_posix()}"
            for part in ("batch", "core", "distributed")
            for file in (ROOT / "addon" / "realmodel" / part).rglob("*")
            if file.suffix in (".py", ".npz")
        }
        assert sources <= names


def test_what_pip_and_pypi_are_told(wheels):
    for name, path in wheels.items():
        with zipfile.ZipFile(path) as archive:
            about = email.message_from_bytes(archive.read(f"realmodel-{VERSION}.dist-info/METADATA"))
        assert (about["Name"], about["Version"]) == ("realmodel", VERSION)
        assert about["Requires-Python"] == ">=3.11"
        assert about["License-Expression"] == "GPL-3.0-or-later"
        assert {"dask", "geoh5", "ifc", "notebook", "omf", "resqml"} <= set(about.get_all("Provides-Extra"))
        assert about.get_payload().lstrip().startswith("<!-- SPDX"), name


def test_a_wheel_for_linux_needs_what_its_tag_promises(wheels):
    auditwheel = ROOT / "build" / "packaging" / "bin" / "auditwheel"
    checked = 0
    for name, path in wheels.items():
        if "manylinux" in name:
            done = subprocess.run([auditwheel, "show", path], check=True, capture_output=True, text=True)
            assert 'platform tag: "manylinux_2_34_x86_64"' in " ".join(done.stdout.split())
            checked += 1
    assert checked


def test_same_files_same_bytes(wheels, package, tmp_path):
    """Made again from the modules of the zip: they are those of the wheels."""
    with zipfile.ZipFile(package) as archive:
        module = min(name for name in archive.namelist() if name.startswith("realmodel/_native."))
        archive.extract(module, tmp_path)
    program = ROOT / "scripts" / "packaging" / "make_wheels.py"
    python = ROOT / "build" / "packaging" / "bin" / "python"
    command = [python, program, "linux-x64", tmp_path / "again", tmp_path / module]
    subprocess.run(command, check=True, capture_output=True)
    (again,) = (tmp_path / "again").glob("*.whl")
    assert again.read_bytes() == wheels[again.stem.split("-", 2)[2]].read_bytes()


# What build.sh has compiled of the same source is taken from there, once the compiler has found all that it
# includes in the archive: a fifteenth of the time. The rest is compiled, and not optimized.
COMPILER = """#!/bin/sh
for argument; do
    [ "$before" = -o ] && made=$argument
    before=$argument
done
case $made in
*.o) [ -f "{release}/$made" ] && /usr/bin/c++ "$@" -E && exec cp "{release}/$made" "$made" ;;
esac
exec /usr/bin/c++ "$@" -O0
"""


def test_the_sources_have_what_compiling_takes(tmp_path):
    """What `pip install .` does, by way of the archive for PyPI, which has no more than is needed."""
    build = [ROOT / "build" / "packaging" / "bin" / "python", "-m", "build", "--sdist", "--no-isolation"]
    command = [*build, "--skip-dependency-check", "--outdir", tmp_path, ROOT]
    subprocess.run(command, check=True, capture_output=True)
    (archive,) = tmp_path.glob("*.tar.gz")
    assert archive.stat().st_size < 3e6
    listed = subprocess.run(["tar", "tzf", archive], check=True, capture_output=True, text=True).stdout
    unwanted = r".*(?:/tests/|/fuzz/|/benchmarks/|/vendor/|\.so$|\.pyc$).*"
    assert re.findall(unwanted, listed, re.MULTILINE) == []
    compiled = {path.relative_to(ROOT).as_posix() for path in (ROOT / "native").rglob("*.cpp")}
    compiled = {path for path in compiled if path.split("/")[1] in ("bindings", "cmake", "src")}
    assert compiled <= {path.split("/", 1)[1] for path in listed.split()}
    environment = Environment(sys.executable, tmp_path)
    compiler = tmp_path / "c++"
    compiler.write_text(COMPILER.format(release=ROOT / "build" / "release"))
    compiler.chmod(0o755)
    # ccache would ask for the included text alone and compile that
    environment.install(archive, variables={"CXX": str(compiler), "CCACHE_DISABLE": "1"})
    done = environment.run("realmodel", SAMPLE, "--export", "model.npz")
    assert done.returncode == 0, done.stderr


def test_what_is_missing_for_compiling_is_said_with_the_way_to_get_it(tmp_path):
    (tmp_path / "root").mkdir()
    command = ["cmake", "-S", ROOT, "-B", tmp_path / "build", "-G", "Ninja"]
    command += [f"-DCMAKE_FIND_ROOT_PATH={tmp_path / 'root'}", "-DREALMODEL_BUILD_TESTS=OFF"]
    command += [f"-DCMAKE_FIND_ROOT_PATH_MODE_{kind}=ONLY" for kind in ("INCLUDE", "LIBRARY", "PACKAGE")]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode != 0
    said = " ".join(done.stderr.split())
    assert "this machine lacks Eigen, CGAL, Boost, nanoflann, GMP," in said
    assert "scripts/install_dependencies.sh build" in said
