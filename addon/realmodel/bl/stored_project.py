# SPDX-License-Identifier: GPL-3.0-or-later
"""The project inside .blend files of batch before version 1 of the settings, which had no other.

The scene's custom property `realmodel_project` holds a NumPy .npz archive (compressed, no pickles)
in base64:

    archive = numpy.load(io.BytesIO(base64.b64decode(scene["realmodel_project"])))
    settings = json.loads(archive["settings"].tobytes())

`settings` is UTF-8 JSON: {"format": 1, "name", "rocks": [{"name", "edge_length", "mesher",
"base_elevation", "holes": count, "several": true where these are outlines as the region is and count
even-odd with it, "constraints": count, "surfaces": [{"name", "method", "options", "rule", "property",
"block"}]}], "library": [...] or null, "units": "m"}. Numbers keep every bit: JSON's are written with
as many digits as it takes, arrays are float64 and int32 in model units. Rock r's arrays are `r/region`
(N, 2), `r/hole/h`, `r/constraint/c` (one row: a point), and for surface s either `r/s/points` (P, 3) or
`r/s/vertices` (V, 3) with `r/s/triangles` (T, 3).
"""

import json

from ..core import InputRefused, Library, Project, Property, Rock, Surface
from ..core.base.units import MODEL_UNIT
from . import stored_arrays

KEY = "realmodel_project"

_ROCK_KEYS = ("name", "edge_length", "triangles", "mesher", "size", "base_elevation")
_SURFACE_KEYS = ("name", "method", "options", "rule", "property", "block", "minimum_thickness")


def unpack(text):
    """The realmodel.core.Project, with arrays, that a text holds. Raises InputRefused for other texts."""
    try:
        archive = stored_arrays.unpack(text)
        settings = json.loads(archive["settings"].tobytes())
        rocks = [_rock(archive, r, entry) for r, entry in enumerate(settings["rocks"])]
        library = settings["library"]
        if library is not None:
            library = Library([Property(**entry) for entry in library])
        return Project(settings["name"], rocks, library, units=settings.get("units", MODEL_UNIT))
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        advice = "open an older copy of the file, or build from the project file again"
        raise InputRefused(f"the stored project cannot be read: {error}", advice=advice) from error


def _rock(archive, r, entry):
    holes = [archive[f"{r}/hole/{h}"] for h in range(entry["holes"])]
    region = archive.get(f"{r}/region")
    constraints = [archive[f"{r}/constraint/{c}"] for c in range(entry.get("constraints", 0))]
    if entry.get("several"):
        region, holes = [region, *holes], []
    surfaces = []
    for s, given in enumerate(entry["surfaces"]):
        shape = {
            key: archive[f"{r}/{s}/{key}"]
            for key in ("points", "vertices", "triangles")
            if f"{r}/{s}/{key}" in archive
        }
        surfaces.append(Surface(**{key: given[key] for key in _SURFACE_KEYS if key in given}, **shape))
    return Rock(
        surfaces=surfaces,
        region=region,
        holes=holes,
        constraints=constraints,
        **{key: entry[key] for key in _ROCK_KEYS if key in entry},
    )
