# SPDX-License-Identifier: GPL-3.0-or-later
"""The chapters of the guide: each function sets up a scene with the operators that the guide names, and keeps
pictures of it. Needs Blender."""

import math

import guide_artists
import guide_features as features
import guide_scenes
from guide_window import (
    blocks,
    build,
    example,
    fill_view,
    frame,
    keep,
    labeled,
    place_in_view,
    settled,
    show_panels,
    side_by_side,
    viewed,
    viewport,
    within_border,
)


def start(walk):
    """The tab in a new file."""
    import bpy
    import guide_panels

    yield from keep(walk, guide_panels.START, "UI")
    guide_panels.keep({guide_panels.START: guide_panels.shown(bpy.context, guide_panels.START)})


def tour(walk):
    """Each panel by itself."""
    import bpy
    import guide_panels

    yield from show_panels(walk, ["start"])  # no other is open yet
    yield from example(walk, guide_panels.EXAMPLE)
    guide_panels.choose_rows(bpy.context.scene.realmodel)
    found = {}
    for name in guide_panels.PANELS:
        parts, headers = guide_panels.PARTS.get(name, ()), guide_panels.HEADERS.get(name, ())
        yield from keep(walk, name, "UI", [name, *parts], headers)
        found[name] = guide_panels.shown(bpy.context, name)
    guide_panels.keep(found)


def window(walk):
    """The window with an example."""
    yield from example(walk, "castle_hill")
    dismiss(walk)
    smooth()
    yield from keep(walk, "window")


def modes(walk):
    """The display modes, and stages: docs/images/view_modes.png and stages.png."""
    import bpy

    yield from example(walk, "castle_hill")
    group = bpy.context.scene.realmodel
    group.view.show_legend = False
    yield from settled(walk)
    frame(walk, 0.78)  # surfaces reach farther than blocks
    pictures = []
    for mode in ("POINTS", "LINES", "AREAS", "SURFACES", "POLYHEDRA", "BLOCKS"):
        group.display = mode
        yield from settled(walk)
        smooth()
        yield from settled(walk)
        pictures.append(labeled(viewed(walk), modes_of(group)[mode]))
    side_by_side(pictures, walk.folder / "view_modes.png", 2)
    group.display, pictures, stages = "BLOCKS", [], (3, 6, 9, 10)
    group.stage = stages[1]  # the highest one
    yield from settled(walk)
    frame(walk, 0.76)
    for stage in stages:
        group.stage = stage
        yield from settled(walk)
        pictures.append(labeled(viewed(walk), f"Stage {stage}: {group.rocks[0].surfaces[stage].name}"))
    side_by_side(pictures, walk.folder / "stages.png", 2)


def modes_of(group):
    """The labels of the display modes."""
    return {item.identifier: item.name for item in group.bl_rna.properties["display"].enum_items}


def csv_panel(walk):
    """The rock mass of two tables."""
    yield walk.redrawn()
    guide_scenes.import_tables()
    guide_scenes.settle_rock()
    yield from keep(walk, "csv_rocks", "UI", ["rocks"])


def csv_dialog(walk):
    """What the import of two tables asks."""
    import bpy
    from driver import save_picture

    walk.area.spaces.active.show_region_ui = False
    folder, tables = guide_scenes.SAMPLES / "two_layers", [{"name": "clay.csv"}, {"name": "ground.csv"}]
    region = walk.region("WINDOW")
    walk.move(region.x + region.width / 2, region.y + 0.9 * region.height)  # the dialog hangs from it
    yield walk.redrawn()
    with viewport(walk):
        bpy.ops.realmodel.surface_add(
            "INVOKE_DEFAULT", filepath=str(folder / "clay.csv"), directory=str(folder), files=tables
        )
    yield walk.redrawn(3)
    save_picture(within_border(viewed(walk)), walk.folder / "csv_dialog.png")
    walk.key("ESC")
    yield walk.redrawn(3)


def csv(walk):
    """Two tables of points become a model."""
    import bpy

    guide_scenes.import_tables()
    for item in bpy.data.objects:
        item.hide_set(item.name.endswith(" points"))
    lines = guide_scenes.drop_lines(bpy.context.scene)
    fill_view(walk, guide_scenes.visible_meshes(), 0.94, math.radians(20.0))
    yield from keep(walk, "csv_points", panels=["start", "surfaces"])
    bpy.data.objects.remove(lines)
    guide_scenes.settle_rock()
    yield from build(walk)
    group = bpy.context.scene.realmodel
    group.rocks[0].region.hide_set(True)  # a line that lies on the walls
    smooth()
    frame(walk)
    yield from keep(walk, "csv_built", panels=["build", "results"])


def quality(walk):
    """Charts of a surface, as the panel saves them."""
    import bpy
    from driver import read_picture

    yield from example(walk, "castle_hill")
    rock = bpy.context.scene.realmodel.rocks[0]
    rock.active_surface = rock.surfaces.find("vosgien")
    rock.surfaces[rock.active_surface].fit_variogram = True  # then the chart has the values that it fits
    yield from build(walk)
    bpy.ops.realmodel.check_quality()
    charts = []
    for chart in ("VARIOGRAM", "CROSS_VALIDATION"):
        path = walk.folder / f"{chart}.png"
        bpy.ops.realmodel.save_chart(filepath=str(path), chart=chart)
        charts.append(read_picture(path))
        path.unlink()
    side_by_side(charts, walk.folder / "quality.png", 2)


def sculpt_grids(walk):
    """Grids that an artist has made."""
    from driver import save_picture

    yield from settled(walk)
    guide_scenes.grids()
    walk.area.spaces.active.shading.color_type = "OBJECT"
    fill_view(walk, guide_scenes.visible_meshes())
    yield from settled(walk)
    save_picture(viewed(walk), walk.folder / "sculpt_grids.png")


def sculpt_built(walk):
    """The strata between these grids."""
    import bpy

    yield from settled(walk)
    guide_scenes.grids()
    bpy.ops.realmodel.from_selected()
    guide_scenes.paint(bpy.context.scene.realmodel.library, guide_scenes.GRID_COLORS)
    yield from build(walk)
    for row in bpy.context.scene.realmodel.results:
        guide_scenes.shade_smooth(row.object)
    frame(walk)
    yield from keep(walk, "sculpt_built", panels=["build", "surfaces"])


def section(walk):
    """A model cut open by a plane, the box of the model around it."""
    import bpy

    yield from example(walk, "castle_hill")
    dismiss(walk)
    guide_scenes.ghost(blocks())
    with viewport(walk):
        bpy.ops.realmodel.section_plane(axis="Y")
    plane = bpy.context.scene.realmodel.view.plane
    plane.location.y -= 0.16 * bpy.data.objects[guide_scenes.BOX].dimensions.y  # most of the model stays
    yield from settled(walk)
    plane.hide_set(True)  # its long edges would look like part of the model
    fill_view(walk, [bpy.data.objects[guide_scenes.BOX]])
    yield from keep(walk, "section_plane", panels=["view", "view_section"])


def fence(walk):
    """A fence along a curve, its gap where the region has a hole, and the same line as a drawing."""
    import bpy
    import numpy as np
    from driver import save_picture

    yield from plain_with_a_box(walk)
    corners = np.concatenate([np.array(block.bound_box) for block in blocks()])
    low, high = corners.min(axis=0)[:2], corners.max(axis=0)[:2]
    shares = ((0.05, 0.2), (0.5, 0.6), (0.95, 0.35))
    curve = guide_scenes.line([low + (high - low) * share for share in shares])
    drawing = walk.folder / "section_drawing.png"
    bpy.ops.realmodel.save_section(filepath=str(drawing), along="LINE", exaggeration=5.0)
    bpy.ops.realmodel.fence()
    made = bpy.context.active_object
    made.select_set(False)
    for item in (curve, *blocks()):
        item.hide_set(True)
    yield from settled(walk)
    fill_view(walk, [bpy.data.objects[guide_scenes.BOX]], 0.96)
    yield from settled(walk)
    label = "Lake, outside of the region", place_in_view(walk, guide_scenes.gap(made)), (0, 100)
    save_picture(labeled(viewed(walk), "", [label]), walk.folder / "section_fence.png")


def plain_with_a_box(walk):
    """The example Gravel Plain with its heights exaggerated, and its box."""
    import bpy

    yield from example(walk, "gravel_plain")
    group = bpy.context.scene.realmodel
    group.view.exaggeration = 8.0
    yield from settled(walk)
    guide_scenes.ghost(blocks())
    walk.area.spaces.active.overlay.show_relationship_lines = False


def mapped(walk):
    """A geological map with dips, and the model that follows from them."""
    import bpy

    with viewport(walk):
        bpy.ops.realmodel.open_sample(sample="mapped_valley", build=False)
    view = bpy.context.scene.realmodel.view
    view.show_map = True
    yield from settled(walk)
    frame(walk, 0.95, math.radians(50.0))
    yield from settled(walk)
    pictures = [viewed(walk)]
    yield from build(walk)
    view.show_map, view.show_dips = False, True
    frame(walk, 0.95, math.radians(38.0))
    smooth()
    yield from settled(walk)
    pictures.append(viewed(walk))
    side_by_side(pictures, walk.folder / "map.png", 1)


def structures(walk):
    """The compartments of a graben moved apart, what lies on both sides of a fault of Fault Blocks, and the
    dips of Recumbent Fold."""
    import bpy
    from driver import save_picture
    from realmodel.core import build as build_model
    from realmodel.core import load_project

    yield from settled(walk)
    guide_scenes.graben()
    yield from build(walk)
    group = bpy.context.scene.realmodel
    guide_scenes.paint(group.library, guide_scenes.GRABEN_COLORS)
    group.explode_direction, group.explode = "COMPARTMENT", 0.4
    for row in group.results:
        if row.name.startswith("Cover"):  # what is beneath it shall be seen
            row.object.active_material.diffuse_color[3] = 0.3
    frame(walk, 0.74)  # of the blocks where they belong
    yield from settled(walk)
    save_picture(viewed(walk), walk.folder / "structures.png")
    projects = {
        name: guide_scenes.SAMPLES / name / "project.toml" for name in ("fault_blocks", "recumbent_fold")
    }
    faulted = build_model(load_project(projects["fault_blocks"]))
    faulted.juxtaposition("main fault").save(walk.folder / "juxtaposition.png")
    load_project(projects["recumbent_fold"]).stereonet().save(walk.folder / "stereonet.png")


def dismiss(walk):
    """Closes the messages of a build."""
    import bpy

    with viewport(walk):
        bpy.ops.realmodel.dismiss()


def smooth():
    for item in blocks():
        guide_scenes.shade_smooth(item)


OF_PANELS = (start, tour, csv_panel)  # pictures of the sidebar alone
OF_BROWSERS = (features.importing,)
OF_DIALOGS = (csv_dialog, features.filling, features.series, features.meshing)
WITH_PANELS = (  # of the viewport and the sidebar
    csv,
    quality,
    sculpt_built,
    features.boreholes,
    features.drawing,
    features.assets,
)
WITH_MANY_PANELS = (  # with a longer sidebar
    window,
    section,
    features.planned_hole,
    features.fold,
    features.faults,
    features.residuals,
    features.misfits,
    features.ensemble,
    features.strata_tab,
    guide_artists.artists,
    guide_artists.exported,
)
OF_VIEWPORTS = (modes, sculpt_grids, fence, mapped, structures, features.tiles)  # of the viewport alone
AS_FOUND = (start, window)  # with panels open or closed as users find them
