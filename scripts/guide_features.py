# SPDX-License-Identifier: GPL-3.0-or-later
"""Chapters of the guide beside those of `guide_chapters.py`: holes, a field on the cut, faults, and the
dialog of filling. Needs Blender."""

import itertools
import math

import guide_scenes
import sculptures
from guide_window import (
    blocks,
    browse,
    build,
    drag,
    example,
    fill_view,
    fit,
    keep,
    keep_below,
    labeled,
    open_tab,
    place_in_view,
    settled,
    to_the_end,
    viewed,
    viewport,
)


def boreholes(walk):
    """Logged holes in the colors of their units, at the cut of the model that follows from them."""
    import bpy

    yield from logged(walk)
    yield from build(walk)
    group = bpy.context.scene.realmodel
    group.view.exaggeration = 6.0
    group.view.show_boreholes = group.view.show_hole_names = True
    with viewport(walk):
        bpy.ops.realmodel.section_plane(axis="X")
    hide_outlines()
    yield from settled(walk)
    yield from fit(walk, ["results", "field"])
    fill_view(walk, guide_scenes.visible_meshes(), azimuth=math.radians(122.0))  # to the cut, from the east
    yield from keep(walk, "boreholes")


def hide_outlines():
    """Hides the section plane, and the outlines far below what holes are in."""
    import bpy

    for item in bpy.context.visible_objects:
        if not item.dimensions.z or item == bpy.context.scene.realmodel.view.plane:
            item.hide_set(True)


def logged(walk, edit=None):
    """The logs of Uncertain Valley in its colors, as a project that follows from them, not built yet. edit:
    changes the paths of their tables before they are read."""
    import bpy

    with viewport(walk):
        bpy.ops.realmodel.open_sample(sample="uncertain_valley")
    yield from build(walk)
    colors = {row.name: tuple(row.color) for row in bpy.context.scene.realmodel.library}
    tables = guide_scenes.logs(walk.folder, "uncertain_valley")
    if edit is not None:
        edit(tables)
    with viewport(walk):
        bpy.ops.realmodel.new()
        files = [{"name": path.name} for path in tables]
        bpy.ops.realmodel.boreholes_read(
            filepath=str(tables[0]), directory=str(walk.folder), files=files, propose=True
        )
    for row in bpy.context.scene.realmodel.library:
        row.color = colors.get(row.name, row.color)


def misfits(walk):
    """A hole whose log was written down in the wrong order, in the list and in red."""
    import bpy

    yield from logged(walk, guide_scenes.mistaken)
    yield from build(walk)
    group = bpy.context.scene.realmodel
    group.view.exaggeration = 6.0
    group.view.show_boreholes = group.view.show_hole_names = group.view.show_misfits = True
    with viewport(walk):
        bpy.ops.realmodel.section_plane(axis="X")
    hide_outlines()
    yield from settled(walk)
    group["active_misfit"] = 0  # without picking its datum
    yield from fit(walk, ["field", "field_misfits"])
    fill_view(walk, guide_scenes.visible_meshes(), azimuth=math.radians(122.0))
    yield from keep(walk, "misfits")


def planned_hole(walk):
    """A planned hole beside the cut that it crosses."""
    import bpy

    yield from example(walk, "uncertain_valley")
    group = bpy.context.scene.realmodel
    group.view.exaggeration = 6.0
    with viewport(walk):
        bpy.ops.realmodel.section_plane(axis="Y")
    group.view.plane.hide_set(True)
    yield from settled(walk)
    with viewport(walk):
        bpy.ops.realmodel.planned_hole_add()
    hole = group.planned_holes[0]
    hole.azimuth, hole.dip, hole.length = 90.0, 60.0, 140.0
    yield from settled(walk)
    yield from fit(walk, ["results", "planned_holes"])
    fill_view(walk, guide_scenes.visible_meshes())
    yield from to_the_end(walk)
    yield from keep(walk, "planned_hole")


def ensemble(walk):
    """The section of an ensemble: how probable the gravel is."""
    import bpy

    yield from example(walk, "uncertain_valley")
    group = bpy.context.scene.realmodel
    group.view.exaggeration = 8.0
    group.ensemble.realizations, group.ensemble.seed = 100, 1
    with viewport(walk):
        bpy.ops.realmodel.section_plane(axis="Y")
        bpy.ops.realmodel.ensemble("EXEC_DEFAULT")
    group.view.plane.hide_set(True)
    group.ensemble.color_by, group.ensemble.block = "PROBABILITY", "Gravel"
    yield from settled(walk)
    yield from fit(walk, ["results", "ensemble"])
    group.ensemble.object.select_set(False)
    fill_view(walk, [group.ensemble.object])
    yield from keep(walk, "ensemble_panel")


def fold(walk):
    """A field on the cut."""
    import bpy

    yield from example(walk, "recumbent_fold")
    group = bpy.context.scene.realmodel
    with viewport(walk):
        bpy.ops.realmodel.section_plane(axis="Y")
    group.view.plane.hide_set(True)
    group.view.show_field_section = True
    yield from settled(walk)
    yield from fit(walk, ["view", "view_section", "view_fields"])
    fill_view(walk, guide_scenes.visible_meshes())
    yield from keep(walk, "field_cut")


def series(walk):
    """The panel of the series of a fold."""
    import bpy

    yield from example(walk, "recumbent_fold")
    rock = bpy.context.scene.realmodel.rocks[0]
    rock.active_surface = rock.surfaces.find("upper bed")
    yield from keep_below(walk, "series_panel", "surfaces", "series")


def residuals(walk):
    """Contacts in holes, in the colors of their distance from a surface that is not tied to them."""
    import bpy

    with viewport(walk):
        bpy.ops.realmodel.open_sample(sample="uncertain_valley", build=False)
        group = bpy.context.scene.realmodel
        rock = group.rocks[0]
        for name in ("gravel", "clay"):
            rock.active_surface = rock.surfaces.find(name)
            bpy.ops.realmodel.surface_remove()
    bedrock = rock.surfaces["bedrock"]
    bedrock.tie, bedrock.variogram_nugget = False, 60.0
    rock.edge_length = 80.0
    yield from build(walk)
    group.view.exaggeration, group.view.show_residuals = 8.0, True
    for item in blocks():
        item.hide_set(True)
    surface = bedrock.interface
    surface.hide_set(False)
    surface.display_type, surface.show_wire, surface.show_all_edges = "TEXTURED", True, True
    surface.active_material = bpy.data.materials.new("surface")
    surface.active_material.diffuse_color = (0.42, 0.25, 0.14, 0.3)  # points beneath it are seen
    yield from settled(walk)
    yield from fit(walk, ["view"])
    fill_view(walk, [surface], 0.94, math.radians(30.0), 0.15, azimuth=math.radians(118.0))
    yield from keep(walk, "residuals")


def faults(walk):
    """The panel of faults and bodies beside its model."""
    import bpy

    yield from example(walk, "fault_blocks")
    bpy.context.scene.realmodel.active_fault = 1
    yield from keep(walk, "faults_panel", panels=["structures"])


def filling(walk):
    """What Fill with Strata asks, with its presets."""
    import bpy
    from driver import save_picture

    walk.area.spaces.active.show_region_ui = False
    item = sculptures.boulder()
    fill_view(walk, [item], 0.5)
    walk.area.spaces.active.region_3d.view_location.x -= 2.0
    region = walk.region("WINDOW")
    walk.move(region.x + 0.75 * region.width, region.y + 0.9 * region.height)
    yield walk.redrawn()
    with viewport(walk):
        bpy.ops.realmodel.fill_with_strata("INVOKE_DEFAULT")
    yield walk.redrawn(8)
    picture = viewed(walk)  # its rows from the bottom up: above the dialog it is empty
    save_picture(picture[: int(0.96 * len(picture))], walk.folder / "filling.png")
    walk.key("ESC")
    yield lambda: not bpy.data.objects[item.name].modifiers
    yield walk.redrawn(3)


def strata_tab(walk):
    """The tab Strata beside an arch that it has made."""
    import bpy

    with viewport(walk):
        bpy.ops.realmodel.strata_rock_add(kind="ARCH", faces=300_000)
    item = bpy.context.active_object
    item.select_set(False)
    yield from open_tab(walk, "strata_shape")
    fill_view(walk, [item], 0.95, azimuth=math.radians(155.0))
    yield from keep(walk, "strata_tab")
    yield from open_tab(walk)


def meshing(walk):
    """The options of a mesh for simulation, in the file browser."""
    import bpy

    yield from example(walk, "two_layers")
    options = {"edge_length": 4.0, "minimum_thickness": 0.7, "layer_thickness": 2.0, "format": "INP"}
    folder = guide_scenes.empty_folder("two_layers")
    with viewport(walk):
        bpy.ops.realmodel.export_mesh("INVOKE_DEFAULT", filepath=str(folder / "mesh.inp"), **options)
    yield from browse(walk, "mesh_options", folder, only_options=True)
    folder.rmdir()


def importing(walk):
    """What the file browser says of tables that are chosen in it."""
    import shutil

    import bpy

    folder = guide_scenes.empty_folder("valley")
    guide_scenes.logs(folder, "uncertain_valley")
    for name in ("map.geojson", "dips_shale.csv"):
        shutil.copy(guide_scenes.SAMPLES / "mapped_valley" / name, folder)
    yield walk.redrawn()
    with viewport(walk):
        bpy.ops.realmodel.boreholes_read("INVOKE_DEFAULT")
    yield from browse(walk, "import_browser", folder, chosen=True)
    shutil.rmtree(folder)


def tiles(walk):
    """Two tiles of a plain as they are, before all of it, coarse."""
    import bpy
    from driver import save_picture

    yield from settled(walk)
    path = guide_scenes.in_tiles(walk.folder, "gravel_plain")
    with viewport(walk):
        bpy.ops.realmodel.tiles_read(filepath=str(path), what="TILES", column=0, row=0, columns=2, rows=2)
    yield from settled(walk)
    items = guide_scenes.visible_meshes()
    for item in items:  # apart, so that each tile is seen
        column, row = (int(number) for number in item.name.split()[-1].split("-"))
        item.location = 120.0 * column, 120.0 * row, 0.0
        item.scale.z = 4.0
    fill_view(walk, items, 0.84, math.radians(38.0))
    yield from settled(walk)
    labels = []
    for item in items:
        if item.name.startswith("Gravel"):  # the uppermost block
            column, row = (int(number) for number in item.name.split()[-1].split("-"))
            places = [vertex.co for vertex in item.data.vertices]
            middle = sum(places[1:], places[0]) / len(places)
            tops = [place for place in places if place.z > middle.z]
            place = item.matrix_world @ min(tops, key=lambda place: (place - middle).xy.length)
            labels.append((f"Column {column}, row {row}", place_in_view(walk, place), (0, 24)))
    save_picture(labeled(viewed(walk), "", labels), walk.folder / "tiles.png")


def drawing(walk):
    """A horizon is drawn on a section plane, and another one on the scan of a section."""
    import bpy
    from realmodel.core import build as build_model
    from realmodel.core import load_project

    models = {
        name: build_model(load_project(guide_scenes.SAMPLES / name / "project.toml"))
        for name in ("two_layers", "faulted_dome")
    }
    yield from example(walk, "two_layers")
    group = bpy.context.scene.realmodel
    rock = group.rocks[0]
    with viewport(walk):
        bpy.ops.realmodel.dismiss()
        bpy.ops.realmodel.section_plane(axis="Y")
        rock.active_surface = rock.surfaces.find("ground")
        bpy.ops.realmodel.surface_add(name="horizon", empty=True)
        bpy.ops.realmodel.surface_move(direction="DOWN")
    y = group.view.plane.location.y
    group.view.plane.hide_set(True)
    yield from settled(walk)
    yield from fit(walk, ["surfaces"])
    fill_view(walk, guide_scenes.visible_meshes())
    yield walk.redrawn(3)
    places = list(guide_scenes.along(models["two_layers"], "Sand", y, 0.5, 16))
    yield from keep_drawn(walk, "drawing_section", places)
    y = 500.0
    path = walk.folder / "scan.png"
    (west, east), (base, top) = guide_scenes.scan(path, models["faulted_dome"], y)
    with viewport(walk):
        bpy.ops.realmodel.new()
        bpy.ops.realmodel.surface_add(name="top of the dolomite", empty=True)
        bpy.ops.realmodel.image_place(
            filepath=str(path),
            first=f"{west}, {y}",
            second=f"{east}, {y}",
            heights=f"{base}, {top}",
        )
    path.unlink()
    image = bpy.context.active_object
    image.color[3] = 1.0
    yield from fit(walk, ["surfaces"])
    fill_view(walk, [image], 0.92, math.radians(8.0), azimuth=math.radians(172.0))
    yield walk.redrawn(3)
    places = list(guide_scenes.along(models["faulted_dome"], "Dolomite", y, 1.0, 40))
    jumps = [abs(one[2] - other[2]) for one, other in itertools.pairwise(places)]
    yield from keep_drawn(walk, "drawing_scan", places[: jumps.index(max(jumps)) + 1])  # up to the fault


def keep_drawn(walk, name, places):
    """Keeps a picture of contacts that are being drawn at places of the model."""
    import bpy
    from realmodel.bl.project import project_settings

    walk.over_viewport()
    with viewport(walk):
        bpy.ops.realmodel.draw_contacts("INVOKE_DEFAULT")
    for place in project_settings.in_world(bpy.context.scene, places):
        walk.click(*walk.pixel_of(place))
        yield walk.redrawn()
    yield from keep(walk, name)
    walk.key("ESC")
    yield walk.redrawn(2)


def assets(walk):
    """The Asset Browser with the catalogs of rock looks and strata."""
    import bpy
    from driver import save_picture
    from guide_window import redrawn, seen

    folder = guide_scenes.empty_folder("realmodel_assets")
    with viewport(walk):
        bpy.ops.realmodel.install_looks(directory=str(folder))
    area = next(area for area in walk.window.screen.areas if area.type == "DOPESHEET_EDITOR")
    area.ui_type = "ASSETS"
    edge = walk.area.x + walk.area.width // 2, walk.area.y - 1
    yield from drag(walk, edge, (edge[0], edge[1] + 720))
    params = area.spaces.active.params
    params.asset_library_ref = "RealModel"
    params.display_size = "NORMAL"
    yield from redrawn(walk, 100)
    save_picture(seen(walk, area), walk.folder / "assets.png")
