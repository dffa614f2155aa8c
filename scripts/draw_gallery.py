#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders the pictures of docs/gallery.md in background Blender.

    build/venv/bin/python scripts/draw_gallery.py [NAME ...]      (default: all; it needs Pillow)

BLENDER is the Blender that renders (default: blender), or a Python that has the module bpy. With a denoiser,
which Debian's Blender lacks, pictures have no grain.

Each function in SCENES is one picture, docs/images/gallery/NAME.jpg: it builds a sample and says
what is shown of it, from where, and with which labels. DRAFT=3 makes pictures of a third of the size in
a folder for drafts, to compose them.
"""

import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
import sculptures
from gallery_picture import (
    DRAFT,
    EXPOSURE,
    INK,
    LABEL,
    POINTS,
    RAYS,
    SAMPLES,
    SECONDS,
    SIZE,
    Picture,
    aim,
    apply_looks,
    around,
    blocks_of,
    board,
    box,
    desert,
    generator,
    legend_band,
    meadow,
    put_over,
    read_pixels,
    sample,
    smooth,
    truck,
    write_title,
)

ROOT = Path(__file__).resolve().parents[1]
IMAGES = ROOT / "docs" / "images" / "gallery"
FRAME = (600, 300)  # of a film strip
ARCH = 4.0  # meters: a unit of the sculpted arch
BASE = 3  # the rock mass of Haut-Barr around the others


def main(names):
    """Outside Blender: runs this file in it, then makes the pictures small."""
    from PIL import Image

    program = os.environ.get("BLENDER", "blender")
    command = [program, "-b", "--factory-startup", "--python-exit-code", "1", "-P", __file__, "--"]
    if Path(program).name.startswith("python"):
        command = [program, __file__, "--"]
    images = ROOT / "build" / "gallery_drafts" if DRAFT != 1 else IMAGES
    images.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run([*command, folder, *names], cwd=ROOT, check=False)
        for path in sorted(Path(folder).glob("*.png")):
            with Image.open(path) as picture:
                whole = picture.convert("RGB")
                whole.save(images / f"{path.stem}.jpg", quality=84, optimize=True, progressive=True)
    return done.returncode


def faults(folder):
    """Fault blocks moved apart, the cover lifted."""
    import bpy
    import numpy as np
    from realmodel.core.display import polygon_mesh

    model, picture = sample("fault_blocks", folder)
    count = len(model.compartment_names)
    shifts = np.zeros((count, 3))
    cover = model.compartment_names.index("basin")
    for number in range(count):
        cells = np.append(model.cell_compartment == number, False)
        inside = np.repeat(cells[model.face_cells].any(axis=1), np.diff(model.face_offsets))
        box = model.vertices[model.face_vertices[inside]]
        shifts[number] = 0.42 * ((box.min(axis=0) + box.max(axis=0)) / 2 - picture.origin) * (1, 1, 0)
    shifts[cover] = 0.0, 0.0, 640.0
    picture.show(model, polygon_mesh.of_cells(model, picture.origin, None), shifts)
    bpy.data.objects["Till"].visible_shadow = False
    west = shifts[model.compartment_names.index("below main fault")]
    north = shifts[model.compartment_names.index("above main fault, above branch")]
    labels = [
        ("Main fault", west + np.array([1200, 90, -1250]) - picture.origin, (-40.0, -62.0)),
        ("Branch", north + np.array([1560, 850, -1200]) - picture.origin, (66.0, 84.0)),
        ("Western fault, dies out", west + np.array([442, 5, -1045]) - picture.origin, (-70.0, 62.0)),
    ]
    tunnel = model.structures.bodies[0].vertices
    mouth = tunnel[tunnel[:, 1] < tunnel[:, 1].min() + 1.0].mean(axis=0)
    labels.append(("Tunnel, a void", west + mouth - picture.origin, (-74.0, -58.0)))
    picture.draw(
        "faults",
        150.0,
        24.0,
        "Fault Blocks",
        "A listric fault, its branch, and a fault that dies out. The till is younger: no fault divides it.",
        labels,
        room=(0.0, 0.1),
    )


def basin(folder):
    """A section through a rift basin: half of the model, its faults drawn and named."""
    import numpy as np
    from realmodel.core.display import polygon_mesh
    from realmodel.core.results.sections.section_data import traces_on_plane

    model, picture = sample("rift_basin", folder)
    section = 1500.0
    half = model.cut_by_plane((0.0, section, 0.0), (0.0, 1.0, 0.0)).above
    picture.show(half, polygon_mesh.of_blocks(half, picture.origin))
    apply_looks(model, 0.8)
    traces = traces_on_plane(model, (0.0, section, 0.0), (0.0, 1.0, 0.0))
    picture.lines = [ends - np.array(picture.origin) for trace in traces for ends in trace.ends]
    made = generator("rift_basin")
    labels = [
        (f"{name} fault", (x_of(section, z), section, z) - np.array(picture.origin), offset)
        for name, x_of, z, offset in (
            ("Western", made.western_fault, -1250.0, (-60.0, -60.0)),
            ("Middle", made.middle_fault, -1300.0, (-70.0, -78.0)),
            ("Antithetic", made.antithetic_fault, -1550.0, (56.0, -62.0)),
            ("Eastern", made.eastern_fault, -1150.0, (66.0, -62.0)),
        )
    ]
    picture.draw(
        "basin",
        169.0,
        15.0,
        "Rift Basin",
        "A section through tilted fault blocks; what filled the basin as it opened was eroded and covered.",
        labels,
        room=(0.1, 0.0),
    )


def castle_hill(folder):
    """A castle hill, cut open from one valley to the other."""
    model, picture = sample("castle_hill", folder)
    low, high = model.vertices.min(axis=0), model.vertices.max(axis=0)
    half = model.cut_by_plane((0.0, low[1] + 0.42 * (high[1] - low[1]), 0.0), (0.0, 1.0, 0.0)).above
    picture.show(half, blocks_of(half, picture))
    apply_looks(model, 0.8)
    picture.sun = math.radians(130.0), math.radians(40.0)
    picture.draw(
        "castle_hill",
        160.0,
        25.0,
        "Castle Hill",
        "Two valleys cut through red sandstone, down to the granite. Loess and alluvium are younger.",
        room=(0.18, 0.1),
    )


def fold(folder):
    """A fold that lies on its side, cut open along its dip: beds that are met three times."""
    from realmodel.core.display import polygon_mesh

    model, picture = sample("recumbent_fold", folder, finer=1.7)
    half = model.cut_by_plane((0.0, 330.0, 0.0), (0.0, 1.0, 0.0)).above
    picture.show(half, polygon_mesh.of_blocks(half, picture.origin))
    apply_looks(model, 0.6)
    picture.sun = math.radians(140.0), math.radians(42.0)
    picture.draw(
        "fold",
        166.0,
        18.0,
        "Recumbent Fold",
        "Beds that overturn, from twelve boreholes and fifty dips: a hole may meet a bed three times.",
        room=(0.12, 0.13),
    )


def dome(folder):
    """A dome that leans, displaced by a fault, its two sides moved apart."""
    import numpy as np
    from realmodel.core.display import polygon_mesh
    from realmodel.core.results.sections.section_data import traces_on_plane

    model, picture = sample("faulted_dome", folder)
    half = model.cut_by_plane((0.0, 480.0, 0.0), (0.0, 1.0, 0.0)).above
    picture.show(half, polygon_mesh.of_blocks(half, picture.origin))
    apply_looks(model, 0.6)
    traces = traces_on_plane(model, (0.0, 480.0, 0.0), (0.0, 1.0, 0.0))
    picture.lines = [ends - np.array(picture.origin) for trace in traces for ends in trace.ends]
    picture.sun = math.radians(140.0), math.radians(42.0)
    fault = model.structures.faults[0].vertices
    plane = np.linalg.lstsq(np.column_stack([np.ones(len(fault)), fault[:, 1:]]), fault[:, 0], rcond=None)[0]
    place = np.array([plane @ (1.0, 480.0, -190.0), 480.0, -190.0])
    labels = [("Eastern fault", place - picture.origin, (-90.0, 40.0))]
    picture.draw(
        "dome",
        168.0,
        20.0,
        "Faulted Dome",
        "A dome that leans, displaced by a fault: each side has a field of its own, made from its data.",
        labels,
        room=(0.12, 0.13),
    )


def intrusion(folder):
    """A granite with a dike, a quarter of the model taken away."""
    import numpy as np
    from realmodel.core.display import polygon_mesh

    model, picture = sample("intrusion", folder)
    low, high = np.array([1560.0, -100.0, -2000.0]), np.array([3100.0, 1180.0, 2000.0])
    model = model.cut_by_surface(*box(low, high)).above
    picture.show(model, polygon_mesh.of_blocks(model, picture.origin))
    picture.draw(
        "intrusion",
        143.0,
        33.0,
        "Intrusion",
        "A granite has lifted the layers, a dike cuts both, and erosion has laid them bare. One quarter is "
        "cut out.",
        room=(0.1, 0.08),
    )


def tunnel(folder):
    """A hill cut open along a tunnel, and the rock that the tunnel takes before it."""
    from dataclasses import replace

    import numpy as np
    from realmodel.core import build, load_project
    from realmodel.core.display import polygon_mesh
    from realmodel.core.exporters.report import model_report

    model, picture = sample("tunnel", folder)
    found = model_report(model, erosion=model.eroded())["erosion"]["bodies"][0]
    half = model.cut_by_plane((0.0, 160.0, 0.0), (0.0, 1.0, 0.0)).above
    picture.show(half, polygon_mesh.of_blocks(half, picture.origin))
    project = load_project(SAMPLES / "tunnel" / "project.toml")
    body = model.structures.bodies[0]
    core = build(replace(project, bodies=[])).cut_by_surface(body.vertices, body.triangles).below
    shapes = polygon_mesh.of_blocks(core, picture.origin)
    labels = []
    for block, shape in zip(core.blocks, shapes, strict=True):
        if shape is not None:
            shape.coordinates[:] += np.array([0.0, -130.0, -76.0], np.float32)
            taken = next(entry["taken"] for entry in found["blocks"] if entry["block"] == block.name)
            assert np.isclose(block.volume, taken, rtol=1e-6), block.name
            low, high = shape.coordinates.min(axis=0), shape.coordinates.max(axis=0)
            share = 0.25 if block.name == "Mudstone" else 0.5
            place = low[0] + share * (high[0] - low[0]), low[1], 0.6 * low[2] + 0.4 * high[2]
            labels.append((f"{block.name}\n{taken:,.0f} m\u00b3", place, (0.0, -58.0)))
    picture.show(core, shapes)
    picture.draw(
        "tunnel",
        163.0,
        21.0,
        "Tunnel",
        "A hill cut open along a tunnel and its shaft, and the rock that they remove from each layer",
        labels,
        room=(0.1, 0.06),
    )


def rocks(folder):
    """Haut-Barr at low sun, weathered, with the looks that suit its rocks, in a meadow."""
    import bpy
    import numpy as np
    from realmodel.bl.pictures import batch
    from realmodel.bl.project import project_settings
    from realmodel.bl.shading import weathering

    model, picture = sample("haut_barr", folder)
    scene = bpy.context.scene
    batch.write_scene(model)
    scene.realmodel.view.show_legend = False
    picture.origin = tuple(project_settings.model_origin(scene))
    shapes = blocks_of(model, picture)
    picture.points = [shape.coordinates for shape in shapes if shape is not None]
    blocks = [row.object for row in scene.realmodel.results if row.object is not None]
    for item in scene.objects:
        item.hide_render = item not in blocks
    base = [shape for block, shape in zip(model.blocks, shapes, strict=True) if block.rock == BASE]
    near, far = meadow(next(item for item in blocks if item.name.startswith("Soil")), base, 2500.0)
    slopes = math.radians(44.0), 0.0  # without scree, which would be a row of dots along the steep bank
    weathering.put_on(scene, [*blocks, near], weathering.Weathering(0.34, 0.5, 0.34, 3, *slopes, 1, 0.6))
    weathering.put_on(scene, [far], weathering.Weathering(0.0, 0.0, 0.34, 3, *slopes, 0))
    far.location.z = -2.0  # the meadow is worn, so its rim is lower than it was
    picture.landscape(sun=(math.radians(205.0), math.radians(24.0)), haze=6000.0)
    middle = np.concatenate(picture.points)
    middle = 0.5 * (middle.min(axis=0) + middle.max(axis=0))
    eye, target = np.array([-38.0, -94.0, -5.0]), np.array([-38.0, 8.0, 9.0])
    picture.look(middle + eye, middle + target, lens=22.0)
    floor = middle + np.array([-37.0, -13.0, -11.0])
    labels = [
        (text, middle + np.array(place), offset)
        for text, place, offset in (
            ("Upper conglomerate", (-6.0, -14.0, 15.0), (-70.0, 74.0)),
            ("Lower conglomerate", (-50.0, -9.0, 6.0), (-6.0, 92.0)),
            ("Pebble bed", (12.0, -14.0, 3.8), (28.0, -66.0)),
            ("Slip faces of a bar", (-93.0, -9.0, -1.0), (44.0, -84.0)),
            ("Sets of sandstone", (-58.0, -9.0, -6.0), (30.0, -64.0)),
        )
    ]
    picture.finish(
        "rocks",
        "Haut-Barr",
        "Bedding follows the layers as they were deposited: sets and slip faces of sandstone under "
        "conglomerate.",
        exposure=0.35,
        labels=[*labels, ("10 m", (floor, floor + np.array([0.0, 0.0, 10.0])), None)],
    )


def canyon(folder):
    """Forty beds in the walls of a canyon, in the afternoon."""
    model, picture = sample("canyon", folder)
    picture.show(model, blocks_of(model, picture), only_outside=True)
    apply_looks(model, 0.7)
    picture.landscape(sun=(math.radians(226.0), math.radians(34.0)), haze=16000.0)
    picture.look((-640.0, -150.0, 455.0), (60.0, 60.0, 92.0), lens=22.0)
    picture.finish(
        "canyon",
        "Canyon",
        "Forty beds in its walls, hard ones steep, soft ones flat. Each is a closed block, and the walls cut "
        "all of them exactly.",
    )


def quarry(folder):
    """A quarry with its benches, and a board with the volumes of what was taken."""
    import numpy as np

    model, picture = sample("quarry", folder)
    made, origin = generator("quarry"), np.array(picture.origin)
    picture.show(model, blocks_of(model, picture), only_outside=True)
    apply_looks(model, 1.0, {"Loam": 0.3})  # a meadow is finer than a rock
    around(made, origin, "Loam", 4000.0, 40.0)
    taken = model.eroded().taken.sum(axis=0)
    rows = [
        (b.name, picture.names[b.name], f"{v:,.0f} m\u00b3")
        for b, v in zip(model.blocks, taken, strict=True)
        if v > 0
    ]
    picture.landscape(sun=(math.radians(228.0), math.radians(42.0)), haze=5000.0)
    picture.look(np.array([98.0, 24.0, 148.0]) - origin, np.array([214.0, 158.0, 79.0]) - origin, lens=22.0)
    total = ("Total", None, f"{taken.sum():,.0f} m\u00b3")
    board([("Excavated", None, ""), *reversed(rows), total], (2.6, -1.3))
    for x, y, z, heading in ((196.0, 172.0, made.BOTTOM, 20.0), (262.0, 148.0, made.BOTTOM, 115.0)):
        truck(np.array([x, y, z]) - origin, math.radians(heading))
    picture.finish(
        "quarry",
        "Quarry",
        "Benches of twelve meters, cut exactly; on the board what they remove from each layer. The trucks "
        "are nine meters long.",
        exposure=0.15,
    )


def island(folder):
    """A sculpted terrain filled with folded strata."""
    model, picture = sample("sculpted_island", folder)
    picture.show(model, blocks_of(model, picture), only_outside=True)
    apply_looks(model, 0.8)
    picture.sun = math.radians(95.0), math.radians(33.0)
    picture.draw(
        "island",
        200.0,
        31.0,
        "Sculpted Island",
        "An artist's mesh is the youngest surface: what lies above it of fourteen folded strata is eroded.",
        legend=False,
        room=(0.0, 0.11),
    )


def overturned(folder):
    """A sculpted arch filled with folds that lie on their side, weathered, in a desert."""
    import bpy
    import numpy as np

    item = sculptures.arch()
    item.scale = 3 * (ARCH,)
    bpy.ops.realmodel.fill_with_strata(
        preset="OVERTURNED",
        palette="CANYON",
        beds=18,
        dip=math.radians(5.0),
        axial_dip=math.radians(24.0),
        fold_amplitude=0.22,
        fold_wavelength=0.62,
        fold_axis=math.radians(175.0),
        seed=2,
    )
    beds = list(bpy.context.selected_objects)
    bpy.ops.realmodel.weathering(
        strength=0.15, rounding=0.2, detail=1, plants=0.0, grass_slope=0.0, scree_slope=0.0
    )
    corners = np.array([bed.matrix_world @ corner.co for bed in beds for corner in bed.data.vertices])
    low, high = corners.min(axis=0), corners.max(axis=0)
    desert(low[2] + 0.06 * (high[2] - low[2]), 400.0 * ARCH)
    picture = Picture((0.0, 0.0, 0.0), folder)
    picture.points = [corners]
    picture.landscape(sun=(math.radians(118.0), math.radians(30.0)), haze=250.0 * ARCH)
    aim(bpy.context.scene.camera, corners, SIZE, 162.0, 7.0, (0.0, 0.13))
    foot = np.array([high[0] + 0.6 * ARCH, low[1] + 0.6 * ARCH, low[2] + 0.1 * ARCH])
    picture.finish(
        "overturned",
        "Overturned Folds",
        "A sculpted arch, filled with recumbent folds by Fill with Strata, and weathered. Each bed is a "
        "closed solid.",
        exposure=0.1,
        labels=[("5 m", (foot, foot + np.array([0.0, 0.0, 5.0])), None)],
    )


def diagram(folder):
    """A block diagram as geologists draw it: the add-on's own legend, axes and exaggeration."""
    import bpy
    from realmodel.bl.display import viewpoints
    from realmodel.bl.overlay import legend_shares, rendered
    from realmodel.bl.pictures import batch, picture
    from realmodel.core import build, load_project

    model = build(load_project(SAMPLES / "block_diagram" / "project.toml"), cells="blocks")
    batch.write_scene(model)
    scene = bpy.context.scene
    view = scene.realmodel.view
    view.exaggeration = 2.0
    view.show_legend = view.show_axes = view.show_north = view.show_scale = True
    for item in scene.objects:
        if item.get("realmodel") == "block":
            smooth(item.data)
            item.hide_render = False
    apply_looks(model, 0.9)
    bpy.context.view_layer.update()
    file = folder / "diagram.png"
    points = viewpoints.model_points(scene)
    sun = math.radians(78.0), math.radians(38.0)
    camera = picture.set_up(scene, points, SIZE, legend=legend_shares(scene, SIZE), sun=sun)
    aim(camera, points, SIZE, 158.0, 30.0, (0.17, 0.1))
    picture.set_renderer(scene, file, SIZE, RAYS, SECONDS)
    scene.view_settings.exposure = EXPOSURE
    rendered.put(scene)
    bpy.ops.render.render(write_still=True)
    write_title(
        file,
        "Block Diagram",
        "Folds that plunge to the south, below an unconformity; a valley lays them bare. Heights are doubled",
    )


def stages(folder):
    """A film strip: Haut-Barr after each of its surfaces."""
    import bpy
    import numpy as np
    from realmodel.core.display import polygon_mesh
    from realmodel.core.drawing.drawing import Drawing
    from realmodel.core.drawing.png import write_pixels

    model, picture = sample("haut_barr", folder)
    whole, frames = [np.array(model.vertices - picture.origin, float)], []
    lists = [rock.surfaces for rock in model.project.rocks]
    last = max(map(len, lists)) - 1
    for number in range(1, last + 1):
        for item in [item for item in bpy.context.scene.objects if item.type == "MESH"]:
            bpy.data.meshes.remove(item.data)
        stage = model.stage(number)
        picture.show(stage, polygon_mesh.of_blocks(stage, picture.origin))
        picture.points = whole  # the camera stays where it is
        file = folder / "frame.png"
        picture.render(file, FRAME, 160.0, 26.0, (0.0, 0.0))
        drawing = Drawing(*(POINTS / SIZE[0] * side for side in FRAME))
        events = dict.fromkeys(surfaces[number].name for surfaces in lists if number < len(surfaces))
        drawing.text(12, drawing.height - 24, f"Stage {number}: {', '.join(events)}", LABEL, INK)
        put_over(file, drawing)
        frames.append(read_pixels(file))
        file.unlink()
    rows = [np.concatenate(frames[n : n + 3], axis=1) for n in range(0, len(frames), 3)]
    rows.append(legend_band(picture.names, rows[-1].shape[1]))
    with open(folder / "stages.png", "wb") as out:
        write_pixels(np.concatenate(rows), out, 144)


SCENES = (
    castle_hill,
    rocks,
    canyon,
    quarry,
    island,
    overturned,
    diagram,
    basin,
    fold,
    dome,
    faults,
    intrusion,
    tunnel,
    stages,
)


def in_blender(folder, *names):
    import bpy

    sys.path.insert(0, str(ROOT / "addon"))
    import realmodel

    realmodel.register_for_batch()
    for draw in SCENES:
        if not names or draw.__name__ in names:
            bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
            draw(Path(folder))
    sys.stdout.flush()
    os._exit(0)  # the module bpy may hang as it ends


if __name__ == "__main__":
    if "--" in sys.argv:
        in_blender(*sys.argv[sys.argv.index("--") + 1 :])
    else:
        sys.exit(main(sys.argv[1:]))
