# SPDX-License-Identifier: GPL-3.0-or-later
"""The project inside the .blend: all that a model was built from, so that its files may go.

The scene's custom property `realmodel_project` holds a NumPy .npz archive (compressed, no pickles)
in base64: text, because Blender 4.5 cuts bytes that replace earlier bytes at their first zero. It can
be read without RealModel:

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

import base64
import dataclasses
import io
import json
import zipfile
import zlib

import numpy as np

from ..core import InputRefused, Library, Project, Property, Rock, Surface
from ..core.region_rings import is_several
from ..core.units import MODEL_UNIT

KEY = "realmodel_project"
FORMAT = 1

# What reading a damaged archive may raise (binascii.Error and UnicodeDecodeError are ValueErrors)
_BROKEN = (KeyError, TypeError, ValueError, AttributeError, OSError, EOFError, zipfile.BadZipFile, zlib.error)

_ROCK_KEYS = ("name", "edge_length", "triangles", "mesher", "size", "base_elevation")
_SURFACE_KEYS = ("name", "method", "options", "rule", "property", "block", "minimum_thickness")


def pack(project):
    """A project as text for a custom property.

    project: realmodel.core.Project whose shapes are arrays, as `Model.project` is; one that still
    names files raises TypeError.
    """
    arrays = {}
    rocks = []
    for r, rock in enumerate(project.rocks):
        entry = {key: getattr(rock, key) for key in _ROCK_KEYS}
        rings = _rings(rock)
        entry["holes"] = max(len(rings) - 1, 0)
        entry["several"] = is_several(rock.region)
        for h, ring in enumerate(rings, -1):
            arrays[f"{r}/region" if h < 0 else f"{r}/hole/{h}"] = _array(ring, np.float64)
        entry["constraints"] = len(rock.constraints)
        for c, constraint in enumerate(rock.constraints):
            arrays[f"{r}/constraint/{c}"] = _array(constraint, np.float64)
        entry["surfaces"] = []
        for s, surface in enumerate(rock.surfaces):
            entry["surfaces"].append({key: getattr(surface, key) for key in _SURFACE_KEYS})
            if surface.points is not None:
                arrays[f"{r}/{s}/points"] = _array(surface.points, np.float64)
            else:
                arrays[f"{r}/{s}/vertices"] = _array(surface.vertices, np.float64)
                arrays[f"{r}/{s}/triangles"] = _array(surface.triangles, np.int32)
        rocks.append(entry)
    library = None
    if project.library is not None:
        library = [dataclasses.asdict(entry) for entry in project.library]
    settings = {"format": FORMAT, "name": project.name, "rocks": rocks, "library": library}
    settings["units"] = project.units
    text = json.dumps(settings, ensure_ascii=False, default=_plain).encode()
    return _archive({"settings": np.frombuffer(text, np.uint8), **arrays})


def unpack(text):
    """The realmodel.core.Project of `pack`; it names no files. Raises InputRefused where the text
    is not such a project, or one of a newer format."""
    try:
        file = io.BytesIO(base64.b64decode(text, validate=True))
        with np.load(file, allow_pickle=False) as archive:
            settings = json.loads(archive["settings"].tobytes())
            if settings["format"] != FORMAT:
                raise InputRefused(
                    f"the stored project has format {settings['format']}",
                    advice=f"this version of RealModel reads format {FORMAT}; install a newer one",
                )
            rocks = [_rock(archive, r, entry) for r, entry in enumerate(settings["rocks"])]
            library = settings["library"]
            if library is not None:
                library = Library([Property(**entry) for entry in library])
            return Project(settings["name"], rocks, library, units=settings.get("units", MODEL_UNIT))
    except _BROKEN as error:
        advice = "open an older copy of the file, or build from the project file again"
        raise InputRefused(f"the stored project cannot be read: {error}", advice=advice) from error


def project_from_scene(scene):
    """The project that the model in a scene was built from, or None where the scene has no model.

    Returns a realmodel.core.Project with arrays in double precision; building it gives the same
    model, byte for byte, wherever the project's files are. Raises InputRefused.
    """
    text = scene.get(KEY)
    return None if text is None else unpack(text)


def store(scene, project):
    """Keeps a project, whose shapes are arrays, in a scene."""
    scene[KEY] = pack(project)


def _rock(archive, r, entry):
    holes = [archive[f"{r}/hole/{h}"] for h in range(entry["holes"])]
    region = archive[f"{r}/region"] if f"{r}/region" in archive else None
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


def _archive(arrays):
    """What numpy.savez_compressed writes, as base64, but compressed lightly: coordinates hardly get
    smaller with more effort, and a model may be built again and again."""
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        for name, array in arrays.items():
            member = io.BytesIO()
            np.lib.format.write_array(member, array, allow_pickle=False)
            entry = zipfile.ZipInfo(f"{name}.npy")  # dated 1980: the same project gives the same text
            archive.writestr(entry, member.getbuffer(), zipfile.ZIP_DEFLATED, compresslevel=1)
    return base64.b64encode(file.getvalue()).decode("ascii")


def _rings(rock):
    if rock.region is None:
        return []
    if isinstance(rock.region, str) or rock.region_file is not None:
        raise TypeError(f"{rock.region!r} is not an array: store the project of a built model, Model.project")
    return rock.rings()


def _array(given, dtype):
    if given is None or isinstance(given, str) or hasattr(given, "__fspath__"):
        raise TypeError(f"{given!r} is not an array: store the project of a built model, Model.project")
    return np.ascontiguousarray(given, dtype)


def _plain(value):
    """What JSON does not know: NumPy's numbers and arrays, a variogram found by an earlier interpolation."""
    if hasattr(value, "settings"):
        return value.settings()
    if isinstance(value, (np.generic, np.ndarray)):
        return value.tolist()
    raise TypeError(f"{value!r} cannot be stored in a .blend file")
