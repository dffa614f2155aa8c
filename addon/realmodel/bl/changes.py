# SPDX-License-Identifier: GPL-3.0-or-later
"""What follows when a setting is changed by hand or by a script: each update callback is one function
here."""

from . import display, live, region_size, settings, units


def setting(row, _context):
    """Any setting that the model depends on."""
    if not settings.is_filling():
        live.touch(row.id_data)


def model_unit(group, _context):
    """Another unit of the model's lengths."""
    if not settings.is_filling():
        units.set_up(group.id_data, group.units)
        live.touch(group.id_data)


def colouring(row, _context):
    """A setting that only the colours depend on."""
    if not settings.is_filling():
        display.colours_changed(row.id_data)


def base_elevation(rock, context):
    """Whoever gives a height of the base wants a base."""
    if not settings.is_filling():
        rock.use_base = True
        setting(rock, context)


def switched_on(switch):
    """Of a setting that counts only where `switch` is on: whoever gives it wants it."""

    def changed(row, context):
        if not settings.is_filling():
            setattr(row, switch, True)
            setting(row, context)

    return changed


def region(rock, context):
    """Another region: what was kept of the earlier one is worth nothing."""
    if settings.is_filling():
        return
    rock.region_stored = rock.region_stamp = ""
    rock.region_area = -1.0
    region_size.ask()
    setting(rock, context)


def source(surface, context):
    """Another source of a surface: it is made from that, whatever was done to its interface before."""
    if settings.is_filling():
        return
    surface.interface_digest = surface.reading = ""
    if surface.source != "MESH_OBJECT":
        surface.stored_stamp = ""
    setting(surface, context)


def reading(surface):
    """A file is to be read in another way: what was read before is worth nothing."""
    if settings.is_filling():
        return
    surface.interface_digest = ""
    if surface.filepath:
        surface.stored = surface.stored_stamp = ""
    setting(surface, None)


def hide(surface, _context):
    if not settings.is_filling():
        display.mode_changed(surface.id_data)


def live_switched(_row, _context):
    live.switched()


def stage(group, _context):
    scene = group.id_data
    last = settings.last_stage(scene)
    if group.stage > last:
        group.stage = last  # comes here again
    elif not settings.is_filling():
        display.stage_changed(scene)


def view(row, _context):
    """What is drawn in the display modes."""
    if not settings.is_filling():
        display.mode_changed(row.id_data)


def exaggeration(row, _context):
    if not settings.is_filling():
        display.exaggeration_changed(row.id_data)


def section(row, _context):
    """Another section plane, or none."""
    if not settings.is_filling():
        display.section_changed(row.id_data)
