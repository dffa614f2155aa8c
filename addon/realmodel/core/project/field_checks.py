# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks of boreholes, observations, maps and the names in them."""

from __future__ import annotations

import difflib
from collections.abc import Mapping

from ..settings.map_file import MapFile
from ..settings.method_options import is_name
from .entry import check_file, check_table_file, refused_by
from .plan_input import check_layer
from .project import Project, Rock


def check_field_data(project: Project, rock: Rock) -> None:
    """Refuses boreholes, observations, a map and names of a rock mass that make no sense. Raises
    InputRefused."""
    refuse = rock.refused
    tables = {"boreholes": rock.boreholes, "observations": rock.observation_file, "dips": rock.dip_file}
    for key, table in tables.items():
        check_table_file(table, key, refuse)
    if rock.map is not None:
        _check_map(rock, rock.map)
    for key in ("boreholes", "observations", "map", "dips"):
        has_effect = rock.interpolates or (
            key != "dips" and any(surface.has_points for surface in rock.surfaces)
        )
        if getattr(rock, key) is not None and not has_effect:
            raise refuse(f"'{key}' has no effect, as no surface is interpolated", key)
    _check_names(project, rock)


def _check_map(rock: Rock, map_file: MapFile) -> None:
    refuse = rock.refused
    with refused_by(refuse, "map", "map: "):
        map_file.check()
    check_layer(map_file.polygons, "map", refuse)
    check_layer(map_file.faults, "map", refuse)
    number = rock.ground_number
    if rock.ground_file is None and number is not None and rock.is_level_set(rock.surfaces[number]):
        what = f"the ground of the map cannot be '{rock.surfaces[number].name}': it is a level set"
        raise refuse(what, "map", 'give its heights: ground = "dem.tif", or a sheet as youngest surface')
    for file in rock.map_files:
        check_file(file, "map", refuse)


def _check_names(project: Project, rock: Rock) -> None:
    advice = 'write names = { SST = "Sandstone" }'
    if not isinstance(rock.names, Mapping):
        raise rock.refused(f"'names' must be a table of names, not {rock.names!r}", "names", advice)
    unit_names = project.names_of_units(rock)
    for code, name in rock.names.items():
        if not is_name(code) or not isinstance(name, str):
            raise rock.refused(f"'names' must give a name for each name, not {name!r}", "names", advice)
        if name and name not in unit_names:
            near = difflib.get_close_matches(name, unit_names, n=1)
            what = f"'names' gives {code!r} the name '{name}', which is no block, surface or body"
            raise rock.refused(
                what, "names", f"did you mean '{near[0]}'?" if near else f"there are {', '.join(unit_names)}"
            )
