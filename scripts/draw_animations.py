#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders the looping pictures of the guide in background Blender: docs/images/guide/NAME.webp.

    BLENDER=build/venv-bpy/bin/python build/venv/bin/python scripts/draw_animations.py [NAME ...]

BLENDER is as for draw_gallery.py. Each function in ANIMATIONS is one picture: a generator that changes the
scene and yields how long each frame is shown, in milliseconds. Frames dissolve into each other. It needs
Pillow.
"""

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
import gallery_picture
from gallery_picture import blocks_of, sample

ROOT = Path(__file__).resolve().parents[1]
IMAGES = ROOT / "docs" / "images" / "guide"
SIZES = {"exploded": (960, 760)}  # others have SIZE
SIZE = (960, 600)
ROOMS = {"deposition": (0.2, 0.0)}  # share of the width for the legend
RAYS, SECONDS = 5, 40.0  # of a pixel, and of a frame at most
STEP, REST = 170, 1200  # milliseconds: of a moving picture, and where it stands
LAPSE = 240  # of a picture of the time lapse
DISSOLVE = {"deposition": 4, "section_sweep": 1, "exploded": 1, "time_lapse": 1}  # frames between two
FADE = 60  # milliseconds of each of them
GLASS = {"section_sweep": 0.14}  # the first frame over others, so that what is cut away is seen as glass
MOST = 2_500_000  # bytes of a file


def main(names):
    """Outside Blender: runs this file in it, then puts the frames together."""
    from PIL import Image

    program = os.environ.get("BLENDER", "blender")
    command = [program, "-b", "--factory-startup", "--python-exit-code", "1", "-P", __file__, "--"]
    if Path(program).name.startswith("python"):
        command = [program, __file__, "--"]
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run([*command, folder, *names], cwd=ROOT, check=False)
        for path in sorted(Path(folder).glob("*.json")):
            durations = json.loads(path.read_text(encoding="utf-8"))
            files = [path.with_name(f"{path.stem}_{n:02}.png") for n in range(len(durations))]
            frames = [Image.open(file).convert("RGB") for file in files]
            if path.stem in GLASS:
                frames = [Image.blend(frame, frames[0], GLASS[path.stem]) for frame in frames]
            frames, durations = dissolved(frames, durations, DISSOLVE.get(path.stem, 0))
            target = IMAGES / f"{path.stem}.webp"
            frames[0].save(
                target,
                save_all=True,
                append_images=frames[1:],
                duration=durations,
                loop=0,
                quality=80,
                method=6,
            )
            if target.stat().st_size > MOST:
                sys.exit(f"{target} has {target.stat().st_size:,} bytes, more than {MOST:,}")
    return done.returncode


def dissolved(frames, durations, count):
    """Frames and their durations with so many mixed ones between two, also before the first comes again."""
    from PIL import Image

    made, times = [], []
    for number, frame in enumerate(frames):
        after = frames[(number + 1) % len(frames)]
        made.append(frame)
        times.append(durations[number] - (count * FADE if durations[number] == STEP else 0))
        for step in range(1, count + 1):
            made.append(Image.blend(frame, after, step / (count + 1)))
            times.append(FADE)
    return made, times


# -- in Blender


def deposition(folder):
    """The stages of a castle hill, one after another, with the names of its layers."""
    model, picture = sample("castle_hill", folder)
    last = len(model.project.rocks[0].surfaces) - 1
    yield from shown(model, picture, [(model.stage(n), None) for n in range(last + 1)], 700)


def section_sweep(folder):
    """A plane sweeps through a castle hill and back."""
    import numpy as np

    model, picture = sample("castle_hill", folder)
    low, high = model.vertices.min(axis=0), model.vertices.max(axis=0)
    planes = low[1] + (high[1] - low[1]) * np.linspace(0.04, 0.86, 11)
    halves = [(model, None)]
    halves += [(model.cut_by_plane((0.0, y, 0.0), (0.0, 1.0, 0.0)).above, None) for y in planes]
    yield from there_and_back(shown(model, picture, halves, STEP))


def exploded(folder):
    """The layers of a castle hill move apart and back."""
    import numpy as np

    model, picture = sample("castle_hill", folder)
    size = float(np.ptp(model.vertices[:, 2]))
    lifts = [0.13 * size * share for share in (0.0, 0.04, 0.15, 0.32, 0.5, 0.68, 0.85, 0.96, 1.0)]
    yield from there_and_back(shown(model, picture, [(model, lift) for lift in lifts], STEP))


def time_lapse(folder):
    """Beds are deposited, folded and cut by rivers, and hard ones stand out, in ten seconds: the modifier
    Strata on a mesh that changes, which is divided at its beds so that they have sharp edges."""
    import bpy
    import hero_parts
    import hero_rocks
    import numpy as np
    from realmodel.bl.objects import meshes
    from realmodel.bl.shading import strata_modifier
    from realmodel.core.filling import divided_at_beds

    high, full = 38.0, 60.0  # of what is deposited, and of the box in which beds are laid
    x, y = np.linspace(-62.0, 62.0, 125), np.linspace(-46.0, 46.0, 93)
    u, v = np.meshgrid(x, y, indexing="ij")
    vertices, triangles = mesh = hero_parts.block(x, y, np.full(u.shape, full), 0.0)
    values = {"beds": 26, "variation": 0.8, "dip": 0.0, "seed": 3}
    values |= {"fold_amplitude": 0.0, "fold_wavelength": 0.55, "fold_axis": 0.5}
    item = hero_rocks.strata("Rock", mesh, "CANYON", is_compact=False, **values)
    bpy.ops.realmodel.set_up_picture(sun_elevation=0.5, sun_azimuth=3.75, scene_settings=True)
    corners = np.concatenate([vertices * (1.0, 1.0, share) for share in (0.0, 0.9)])
    gallery_picture.aim(bpy.context.scene.camera, corners, SIZE, 156.0, 24.0, (0.0, 0.0))

    ripple = 0.25 * hero_parts.rough(u, v, 12.0, 3)

    def frame(amplitude, level, land=np.inf):
        hero_rocks.reshape(item, vertices)
        strata_modifier.set_values(item, {"fold_amplitude": amplitude})
        beds, _ = strata_modifier.beds_of(item)
        plan = np.column_stack([u.ravel(), v.ravel()])
        folded = beds.datum(plan, beds.strips(plan)).reshape(u.shape)
        folded += level - folded.mean()
        # to the middle of a bed: ripples above its top would be parts of the next one
        _, share, thickness = beds.places(np.array([[u[0, 0], v[0, 0], folded[0, 0]]]))
        places = vertices.copy()
        top = np.minimum(folded + (0.5 - share) * thickness + ripple, land)
        places[: u.size, 2] = np.clip(top, 1.0, full).ravel()
        hero_rocks.reshape(item, places)
        divided = meshes.triangle_mesh("Rock Divided", *divided_at_beds(places, triangles, beds))
        strata_modifier.show_eroded(item, divided)
        return _OfCamera(), LAPSE

    for share in np.linspace(0.06, 1.0, 9):
        yield frame(0.0, high * share)
    most = 0.13
    for share in np.linspace(0.14, 1.0, 7):
        yield frame(most * share, high)
    edge = np.zeros(u.shape, bool)
    edge[:, 0] = edge[-1, :] = True  # the sides that are seen, where rivers flow out
    rivers = np.where(edge, 6.0, 16.0 + 8.0 * np.abs(hero_parts.rough(u, v, 40.0, 8)))
    land = hero_rocks.drained(
        rivers,
        x[1] - x[0],
        lambda z: np.full(len(z), 0.12),
        16,
        1.0,
        2.2,
        fixed=edge,
        smooth=0.1,
        steepest=0.9,
    )
    for share in np.linspace(0.12, 1.0, 8):
        yield frame(most, high, land + 52.0 * (1.0 - share))
    for strength in (0.3, 0.65, 1.0):
        hero_rocks.erode(item, 150_000, strength, scree=0.0)
        yield _OfCamera(), LAPSE if strength < 1.0 else 2 * REST


class _OfCamera:
    """What the scene's camera sees."""

    def render(self, file, size, *_):
        import bpy
        from realmodel.bl.host import versions

        scene = bpy.context.scene
        scene.render.engine, scene.cycles.samples = "CYCLES", 3
        versions.plain_colors(scene)
        versions.denoise(scene)
        scene.render.resolution_x, scene.render.resolution_y = size
        scene.render.image_settings.file_format, scene.render.filepath = "PNG", str(file)
        bpy.ops.render.render(write_still=True)


def shown(whole, picture, states, duration):
    """Shows models one after another; the camera stays where it sees the first one and the last one.
    states: (model, how far each block is lifted above the one beneath, or None)."""
    import bpy
    import numpy as np

    points = [np.array(whole.vertices - picture.origin, float)]
    lift = max((lift or 0.0) for _, lift in states)
    points.append(points[0] + (0.0, 0.0, lift * (len(whole.blocks) - 1)))
    for number, (model, lift) in enumerate(states):
        for item in [item for item in bpy.context.scene.objects if item.type == "MESH"]:
            bpy.data.meshes.remove(item.data)
        shapes = blocks_of(model, picture)
        for place, shape in enumerate(shapes):
            if shape is not None and lift:
                shape.coordinates[:, 2] += lift * place
        picture.show(model, shapes)
        picture.points = points
        yield picture, REST if number in (0, len(states) - 1) else duration


def there_and_back(states):
    """Marks that the frames are to be shown backward, too, after the last one."""
    for picture, duration in states:
        yield picture, -duration


ANIMATIONS = (deposition, section_sweep, exploded, time_lapse)


def in_blender(folder, *names):
    import bpy

    sys.path.insert(0, str(ROOT / "addon"))
    import realmodel

    realmodel.register_for_batch()
    from realmodel.core.drawing.drawing import Drawing

    gallery_picture.RAYS, gallery_picture.SECONDS = RAYS, SECONDS
    for draw in ANIMATIONS:
        name = draw.__name__
        if names and name not in names:
            continue
        bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
        durations, files = [], []
        for number, (picture, duration) in enumerate(draw(Path(folder))):
            files.append(Path(folder) / f"{name}_{number:02}.png")
            size, room = SIZES.get(name, SIZE), ROOMS.get(name, (0.0, 0.0))
            picture.render(files[-1], size, 156.0, 26.0, room)
            if name in ROOMS:
                drawing = Drawing(gallery_picture.POINTS, gallery_picture.POINTS * size[1] / size[0])
                gallery_picture.add_legend(drawing, list(picture.names.items()))
                gallery_picture.put_over(files[-1], drawing)
            durations.append(duration)
        if durations[0] < 0:
            for number in range(len(files) - 2, 0, -1):
                path = Path(folder) / f"{name}_{len(durations):02}.png"
                path.write_bytes(files[number].read_bytes())
                durations.append(durations[number])
        (Path(folder) / f"{name}.json").write_text(json.dumps([abs(d) for d in durations]))
    sys.stdout.flush()
    os._exit(0)  # the module bpy may hang as it ends


if __name__ == "__main__":
    if "--" in sys.argv:
        in_blender(*sys.argv[sys.argv.index("--") + 1 :])
    else:
        sys.exit(main(sys.argv[1:]))
