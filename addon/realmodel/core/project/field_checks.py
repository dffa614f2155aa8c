# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks of boreholes, observations and the names in their tables."""

from __future__ import annotations

import difflib
from collections.abc import Mapping

from ..settings.method_options import is_name
from .entry import check_file, refused_by


def names_of_units(project, rock) -> list[str]:
    """What a name in a table of a rock mass may mean: its blocks and surfaces, and the bodies."""
    surfaces = [surface.name for surface in rock.surfaces]
    return list(dict.fromkeys([*rock.block_names(), *surfaces, *(body.name for body in project.bodies)]))


def check_field_data(project, rock) -> None:
    """Refuses boreholes, observations and names of a rock mass that make no sense. Raises InputRefused."""
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
    for key in ("boreholes", "observations"):
        if getattr(rock, key) is not None and not rock.interpolates:
            raise refuse(f"{key} have no effect, as no surface is interpolated", key)
    _check_names(project, rock)


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
