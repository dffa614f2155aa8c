# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks of boreholes, observations, maps and the names in them."""

from __future__ import annotations

import difflib
from collections.abc import Mapping
from pathlib import Path

from ..readers.point_input import companions
from ..settings.method_options import is_name
from ..settings.point_file import MeshFile, PointFile
from .entry import check_file, refused_by
from .plan_input import check_layer, layer_files


def names_of_units(project, rock) -> list[str]:
    """What a name in a table of a rock mass may mean: its blocks and surfaces, and the bodies."""
    surfaces = [surface.name for surface in rock.surfaces]
    return list(dict.fromkeys([*rock.block_names(), *surfaces, *(body.name for body in project.bodies)]))


def check_field_data(project, rock) -> None:
    """Refuses boreholes, observations, a map and names of a rock mass that make no sense. Raises
    InputRefused."""
    refuse = rock.refused
    if rock.boreholes is not None:
        with refused_by(refuse, "boreholes", "boreholes: "):
            rock.boreholes.check()
        for file in rock.boreholes.files:
            check_file(file, "boreholes", refuse)
    given = rock.observation_file
    if given is not None:
        with refused_by(refuse, "observations", "observations: "):
            given.check()
        check_file(given.file, "observations", refuse)
    if (dips := rock.dip_file) is not None:
        with refused_by(refuse, "dips", "dips: "):
            dips.check()
        check_file(dips.file, "dips", refuse)
    if rock.map is not None:
        _check_map(rock)
    for key in ("boreholes", "observations", "map", "dips"):
        has_effect = rock.interpolates or (key != "dips" and any(each.has_points for each in rock.surfaces))
        if getattr(rock, key) is not None and not has_effect:
            raise refuse(f"'{key}' has no effect, as no surface is interpolated", key)
    _check_names(project, rock)


def ground_file(rock) -> PointFile | MeshFile | str | Path | None:
    """The file that the ground of its map is read from; None where it is a surface of the rock mass."""
    ground = rock.map.ground
    is_surface = isinstance(ground, str) and ground in [surface.name for surface in rock.surfaces]
    return None if is_surface else ground


def ground_number(rock) -> int | None:
    """The number of the surface that is the ground of its map; None without a map, or where none is."""
    if rock.map is None:
        return None
    names, youngest = [surface.name for surface in rock.surfaces], len(rock.surfaces) - 1
    ground = ground_file(rock)
    if ground is None:
        return names.index(rock.map.ground) if rock.map.ground in names else youngest
    file = Path(ground.file if isinstance(ground, (PointFile, MeshFile)) else ground)
    own = rock.surfaces[-1].input_file
    return youngest if own is None or Path(own) == file else None


def files_of_map(rock) -> list[Path]:
    """The files of the map of a rock mass."""
    if rock.map is None:
        return []
    files = [*layer_files(rock.map.polygons), *layer_files(rock.map.faults)]
    ground = ground_file(rock)
    if ground is not None:
        file = Path(ground.file if isinstance(ground, (PointFile, MeshFile)) else ground)
        files += [file, *companions(file)]
    return files


def _check_map(rock) -> None:
    refuse = rock.refused
    with refused_by(refuse, "map", "map: "):
        rock.map.check()
    check_layer(rock.map.polygons, "map", refuse)
    check_layer(rock.map.faults, "map", refuse)
    number = ground_number(rock)
    if ground_file(rock) is None and number is not None and rock.surfaces[number].is_level_set:
        what = f"the ground of the map cannot be '{rock.surfaces[number].name}': it is a level set"
        raise refuse(what, "map", 'give its heights: ground = "dem.tif", or a sheet as youngest surface')
    for file in files_of_map(rock):
        check_file(file, "map", refuse)


def _check_names(project, rock) -> None:
    advice = 'write names = { SST = "Sandstone" }'
    if not isinstance(rock.names, Mapping):
        raise rock.refused(f"'names' must be a table of names, not {rock.names!r}", "names", advice)
    known = names_of_units(project, rock)
    for code, name in rock.names.items():
        if not is_name(code) or not isinstance(name, str):
            raise rock.refused(f"'names' must give a name for each name, not {name!r}", "names", advice)
        if name and name not in known:
            near = difflib.get_close_matches(name, known, n=1)
            what = f"'names' gives {code!r} the name '{name}', which is no block, surface or body"
            raise rock.refused(
                what, "names", f"did you mean '{near[0]}'?" if near else f"there are {', '.join(known)}"
            )
