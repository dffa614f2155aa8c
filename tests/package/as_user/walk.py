# SPDX-License-Identifier: GPL-3.0-or-later
"""A first use of the installed add-on: open an example, build, look, save, open again, build again.

    HOME=FOLDER blender -b --python-exit-code 1 -P walk.py -- FOLDER

Leaves picture.png, walk.blend, model.npz and walk.json (versions) in FOLDER.
"""

import json
import platform
import sys
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
import installed
from installed import check

SAMPLE = "two_layers"


def block_volumes():
    """{block: volume inside its mesh}, by the divergence theorem."""
    volumes = {}
    for item in bpy.context.scene.objects:
        if item.get("realmodel") != "block":
            continue
        mesh = item.data
        mesh.calc_loop_triangles()
        corners = np.empty(3 * len(mesh.loop_triangles), np.int32)
        mesh.loop_triangles.foreach_get("vertices", corners)
        flat = np.empty(3 * len(mesh.vertices), np.float32)
        mesh.vertices.foreach_get("co", flat)
        at = flat.reshape(-1, 3).astype(np.float64)
        a, b, c = (at - at.mean(axis=0))[corners].reshape(-1, 3, 3).transpose(1, 0, 2)
        volumes[item["realmodel_block"]] = float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0)
    return volumes


def exact_volumes():
    """{block: volume} of the same example, built without Blender's meshes."""
    core = installed.part("core")
    model = core.build(core.load_project(installed.part("bl.scene.samples").project_file(SAMPLE)))
    check(model.validate().passed, "the model is not a valid one")
    return {block.name: block.volume for block in model.blocks if block.cells}


def check_blocks(expected, when):
    volumes = block_volumes()
    check(volumes.keys() == expected.keys(), f"{when}: blocks {sorted(volumes)}")
    for block, volume in expected.items():
        check(
            abs(volumes[block] / volume - 1.0) < 1e-4, f"{when}: {block} has {volumes[block]}, not {volume}"
        )


def check_picture(path):
    """It shows something: the model's two colors cover a good part of it."""
    image = bpy.data.images.load(str(path))
    flat = np.empty(image.size[0] * image.size[1] * image.channels, np.float32)
    image.pixels.foreach_get(flat)
    colors = flat.reshape(image.size[1], image.size[0], -1)[:, :, :3]
    drawn = np.abs(colors - colors[0, 0]).max(axis=2) > 0.1
    check(0.05 < drawn.mean() < 0.9, f"{path.name}: {100 * drawn.mean():.1f} % of it is drawn on")
    check(colors[drawn].std(axis=0).max() > 0.02, f"{path.name}: one color only")
    bpy.data.images.remove(image)


def check_vendored(package):
    """The packages of others are those that travel in the add-on."""
    folder = Path(package.__file__).parent / "vendor"
    for name in ("tifffile", "shapefile"):
        module = installed.part("core.base.packages").vendored(name, name, "this test")
        check(Path(module.__file__).is_relative_to(folder), f"{name} is {module.__file__}")


def main(folder):
    package = installed.package()
    bpy.ops.wm.read_homefile(use_empty=True)
    expected = exact_volumes()
    bpy.ops.realmodel.open_sample(sample=SAMPLE)
    check_blocks(expected, "after the first build")
    bpy.ops.realmodel.export(filepath=str(folder / "model.npz"))
    with np.load(folder / "model.npz") as arrays:
        check(len(arrays["block_names"]) == len(expected), "model.npz has other blocks")
    check_vendored(package)
    installed.part("bl.pictures.batch").render(folder / "picture.png", size=(480, 300), samples=16)
    check_picture(folder / "picture.png")

    blend = str(folder / "walk.blend")
    bpy.ops.wm.save_as_mainfile(filepath=blend)
    bpy.ops.wm.read_homefile(use_empty=True)
    check(not block_volumes(), "a new file has blocks")
    bpy.ops.wm.open_mainfile(filepath=blend)
    check_blocks(expected, "after opening the file again")
    bpy.ops.realmodel.clear()
    check(not block_volumes(), "clear() left blocks")
    bpy.ops.realmodel.build()
    check_blocks(expected, "after building again")

    versions = {
        "blender": bpy.app.version_string,
        "python": platform.python_version(),
        "numpy": np.__version__,
        "glibc": platform.libc_ver()[1],
        "installed_as": package.__name__,
    }
    installed.disabled()
    (folder / "walk.json").write_text(json.dumps(versions, indent=1) + "\n", encoding="utf-8")
    print("walk:", versions)


main(Path(installed.arguments()[0]))
installed.leave()
