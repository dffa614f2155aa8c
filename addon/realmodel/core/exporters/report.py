# SPDX-License-Identifier: GPL-3.0-or-later
"""The report of a model as JSON: for other programs, and for reviewers."""

from __future__ import annotations

import itertools
import json
import platform
import sys
from typing import TYPE_CHECKING, BinaryIO

import numpy as np

from ..base.errors import UsageError
from ..base.text import Step, no_step
from ..base.work import native_module
from ..cells.model_data import ModelData, UsedSurfaces
from ..notebook import data_frame
from ..project.structure_entries import Body, Fault
from ..results.corner_point import CornerPointGrid, corner_point_entry
from ..results.displacements import displacements
from ..results.faults.juxtaposition import fault_areas
from ..results.orientations.stereonet import StereonetData, dip_names, dip_sets, normals_of
from ..results.tables import block_entry
from ..results.volumes import Erosion, volume_deviations
from ..simulation import cleaned_entry, mesh_entry
from ..simulation.cleaned_cells import CleanedCells
from ..simulation.simulation_mesh import SimulationMesh
from ..surfaces.surface_heights import used_vertices
from ..validation.left_out_holes import HoleValidation
from ..validation.observed import Observed, observed
from ..validation.validation import PLACES_OF_REPORT, ValidationReport, validate

if TYPE_CHECKING:
    import pandas

SCHEMA = 1


class Report(dict):
    """The report of a model, as report.json has it (docs/reference/output_files.md)."""

    def table(self, name: str) -> pandas.DataFrame:
        """One of its lists, such as "blocks", "surfaces", "warnings", "compartments" or "faults", as a
        DataFrame of pandas. What is within an entry becomes columns with dots in their names, and a list of
        entries within it rows.

        Raises UsageError where pandas is missing, or for a name that is no list of the report.

        >>> model.report().table("surfaces")[["name", "lowest", "highest"]]
                  name  lowest  highest
        0  top of clay     2.0      2.0
        1  top of sand     3.0      3.0
        2       ground     1.0      5.0
        """
        lists = [key for key, value in self.items() if isinstance(value, list)]
        if name not in lists:
            raise UsageError(f"the report has no list {name!r}; there are {', '.join(lists)}")
        return data_frame(itertools.chain.from_iterable(map(_rows, self[name])))


def _rows(entry: dict) -> list[dict]:
    """An entry without nesting: one row, or one for each combination of the entries of its lists."""
    rows: list[dict] = [{}]
    for key, value in entry.items():
        inner = [value] if isinstance(value, dict) else value
        if not (isinstance(inner, list) and inner and isinstance(inner[0], dict)):
            rows = [{**row, key: value} for row in rows]
            continue
        inner_rows = [
            {f"{key}.{name}": cell for name, cell in row.items()} for one in inner for row in _rows(one)
        ]
        rows = [{**row, **more} for row in rows for more in inner_rows]
    return rows


def model_report(
    model: ModelData,
    stage: int | None = None,
    validation: ValidationReport | None = None,
    erosion: Erosion | None = None,
    mesh: SimulationMesh | None = None,
    cells: CleanedCells | None = None,
    grid: CornerPointGrid | None = None,
) -> Report:
    """The report's content. Volumes are in model units cubed, times in seconds, memory in bytes.

    validation: what Model.validate found; it is run now if none is given. erosion: what Model.eroded found;
    mesh: a SimulationMesh of it; cells: its CleanedCells; grid: its CornerPointGrid; without them the report
    has none.
    """
    model.require_project("the report")
    validation = validation or validate(model, PLACES_OF_REPORT, threads=model.threads)
    total = model.volume
    library = model.project.library
    report = Report()
    report |= {
        "schema": SCHEMA,
        "project": {
            "name": model.project.name,
            "file": str(model.project.path) if model.project.path else None,
            "library": str(library.path) if library and library.path else None,
            "stage": stage,
        },
        "counts": {
            "rocks": len(model.project.rocks),
            "surfaces": int((model.surface_kind == 0).sum()),
            "surface_triangles": len(model.surface_triangles),
            "blocks": len(model.blocks),
            "blocks_present": sum(block.cells > 0 for block in model.blocks),
            "vertices": len(model.vertices),
            "faces": len(model.face_cells),
            "cells": len(model.cell_block),
        },
        "cell_kind": model.cell_kind,
        "volume": total,
        "blocks": [
            _block(model, number, total, deviation)
            for number, deviation in enumerate(volume_deviations(model).tolist())
        ],
        "surfaces": surface_entries(model),
        "warnings": warning_entries(model),
        "validation": validation.to_json(),
        "timings": model.timings,
        "threads": model.threads,
        "peak_memory": _peak_memory(),
        "versions": versions(),
    }
    if model.structures.is_divided:
        report["compartments"] = _compartments(model)
        report["faults"] = _faults(model)
        report["juxtapositions"] = _juxtapositions(model)
        report["bodies"] = [body_entry(body) for body in model.structures.bodies]
    if dips := _dips(model):
        report["dips"] = dips
    if any(rock.observed is not None for rock in model.project.rocks):
        report |= observation_entries(observed(model))
    if erosion is not None:
        report["erosion"] = _erosion(model, erosion)
    if mesh is not None:
        report["mesh"] = mesh_entry(mesh)
    if cells is not None:
        report["cleaned_cells"] = cleaned_entry(cells)
    if grid is not None:
        report["corner_point_grid"] = corner_point_entry(grid)
    return report


def _erosion(model: ModelData, erosion: Erosion) -> dict:
    """The volumes that each surface eroded and each body took of each block, and for each block the volumes
    deposited, eroded, taken and left."""
    names = [block.name for block in model.blocks]
    rock_of = [rock.name for rock in model.project.rocks for _ in rock.surfaces]
    return {
        "total": erosion.total,
        "blocks": [
            {
                "name": name,
                "deposited": float(erosion.deposited[b]),
                "eroded": float(erosion.by_block[b]),
                "taken": float(erosion.taken[:, b].sum()),
                "remaining": float(erosion.remaining[b]),
            }
            for b, name in enumerate(names)
        ],
        "surfaces": [
            {
                "name": surface,
                "rock": rock_of[k],
                "eroded": float(erosion.by_surface[k]),
                "blocks": [
                    {"block": names[b], "eroded": float(erosion.volume[k, b])}
                    for b in np.flatnonzero(erosion.volume[k])
                ],
            }
            for k, surface in enumerate(model.surface_names[: len(rock_of)])
        ],
        "bodies": [
            {
                "name": body.name,
                "taken": float(taken.sum()),
                "blocks": [{"block": names[b], "taken": float(taken[b])} for b in np.flatnonzero(taken)],
            }
            for body, taken in zip(model.structures.bodies, erosion.taken, strict=True)
        ]
        if len(erosion.taken)
        else [],
    }


def _compartments(model: ModelData) -> list[dict]:
    """The volume of every block in every compartment."""
    count = len(model.blocks)
    volumes = np.bincount(
        model.cell_compartment.astype(np.int64) * count + model.cell_block,
        model.cell_volumes,
        count * len(model.compartment_names),
    ).reshape(-1, count)
    return [
        {
            "name": name,
            "volume": float(block_volumes.sum()),
            "blocks": [
                {"block": model.blocks[number].name, "volume": float(block_volumes[number])}
                for number in np.flatnonzero(block_volumes).tolist()
            ],
        }
        for name, block_volumes in zip(model.compartment_names, volumes, strict=True)
    ]


def _faults(model: ModelData) -> list[dict]:
    """Throw and heave along each fault: their means, and the largest values; whether a throw is found; and
    the length of the cutoff lines below it along which the surface is on both sides."""
    all_displacements = displacements(model)
    return [
        {
            **fault_entry(fault),
            "surfaces": [
                {
                    "rock": displacement.rock,
                    "surface": displacement.surface,
                    "throw": _mean_and_largest(displacement.throw, displacement.mean_throw),
                    "throw_deviation": displacement.deviation,
                    "throw_found": displacement.is_found,
                    "heave": _mean_and_largest(displacement.heave, displacement.mean_heave),
                    "length": float(displacement.length.sum()),
                }
                for displacement in all_displacements
                if displacement.fault == fault.name
            ],
        }
        for fault in model.structures.faults
    ]


def _juxtapositions(model: ModelData) -> list[dict]:
    """The areas on each fault by pair of blocks."""
    return [
        {"fault": fault.name, "footwall": low, "hanging_wall": high, "area": area}
        for number, fault in enumerate(model.structures.faults)
        for (low, high), area in fault_areas(model, number).items()
    ]


def fault_entry(fault: Fault) -> dict:
    """The entry of a fault, as far as it does not need a model."""
    return {
        "name": fault.name,
        "triangles": len(fault.triangulation()[1]),
        "youngest": fault.youngest,
        "ends_at": list(fault.ends_at),
        "dies_out": fault.dies_out,
    }


def _dips(model: ModelData) -> list[dict]:
    """The numbers of the stereonets: of all dips but those of faults (`of` is null), and of each group."""
    sets = dip_sets(model.project)
    has_beds = any(entry.dips.in_use.any() for entry in sets if not entry.of_fault)
    names = [*([None] if has_beds else []), *dip_names(sets)]
    return [{"of": name, **StereonetData(normals_of(sets, name)).numbers} for name in names]


def _mean_and_largest(values: np.ndarray, mean: float) -> dict:
    return {"mean": mean, "max": float(values[np.abs(values).argmax()])}


def body_entry(body: Body) -> dict:
    """The entry of a body."""
    return {
        "name": body.name,
        "triangles": len(body.triangulation()[1]),
        "after": body.after,
        "void": body.void,
    }


def _block(model: ModelData, number: int, total: float, deviation: float) -> dict:
    return {
        **block_entry(model, number, total),
        "volume_deviation_at_most": deviation if np.isfinite(deviation) else None,
        "component_volumes": model.component_volumes[number].tolist(),
    }


def observation_entries(found: Observed) -> dict[str, list[dict]]:
    """What became of the observations of a model, as lists of the report."""
    return {
        "observations": [vars(block) for block in found.blocks],
        "contacts": [{**vars(contact), "place": list(contact.place)} for contact in found.contacts],
        "violated_bounds": [{**vars(bound), "place": list(bound.place)} for bound in found.violated],
        "left_out": [
            {"rock": rock, **vars(entry), "place": None if entry.place is None else list(entry.place)}
            for rock, entry in found.left_out
        ],
    }


def hole_entries(found: HoleValidation) -> dict[str, list[dict]]:
    """What models say of holes without knowing them, as a list of the report."""
    holes = [
        {
            **vars(hole),
            "contacts": [{**vars(contact), "place": list(contact.place)} for contact in hole.contacts],
        }
        for hole in found.holes
    ]
    return {"left_out_holes": holes}


def warning_entries(model: UsedSurfaces) -> list[dict]:
    """The warnings of a model, or of a SurfaceSet."""
    return [
        {"kind": w.kind, "rock": w.rock, "surface": w.surface, "items": list(w.items), "text": w.text}
        for w in model.warnings
    ]


def surface_entries(model: UsedSurfaces) -> list[dict]:
    """The entry of each surface of a model, or of a SurfaceSet."""
    entries: list[dict] = []
    for entry in model.rock_inputs:
        rock = entry.rock
        for surface, data in zip(rock.surfaces, entry.data, strict=True):
            number = len(entries)
            vertices, triangles = model.surface(number)
            heights = vertices[used_vertices(vertices, triangles), 2]
            result = model.interpolations[number]
            entries.append(
                {
                    "name": surface.name,
                    "rock": rock.name,
                    "rule": surface.rule,
                    "triangles": len(triangles),
                    "lowest": float(heights.min()),
                    "highest": float(heights.max()),
                    "points": len(data.points) if rock.is_interpolated(surface) else None,
                    "method": result.method if result else None,
                    "method_reason": (result.reason or None) if result else None,
                    "extrapolated": result.extrapolated if result else None,
                    "variogram": result.variogram.settings() if result and result.variogram else None,
                    "neighbours": result.neighbours if result else None,
                    "variogram_fitted": result.variogram.fitted if result and result.variogram else None,
                }
            )
    return entries


def versions() -> dict[str, str]:
    """The versions of all software that affects the result."""
    software = {
        "realmodel": native_module().VERSION,
        "python": platform.python_version(),
        "numpy": np.__version__,
        "system": platform.platform(),
    }
    if "bpy" in sys.modules:
        software["blender"] = sys.modules["bpy"].app.version_string
    return software


def _peak_memory() -> int | None:
    try:
        import resource
    except ImportError:  # not there on Windows
        return None
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak if sys.platform == "darwin" else 1024 * peak


def write_report(report: dict, file: BinaryIO, _step: Step = no_step) -> None:
    """Writes a report as UTF-8 JSON."""
    file.write(f"{json.dumps(report, indent=2, ensure_ascii=False, allow_nan=False)}\n".encode())
