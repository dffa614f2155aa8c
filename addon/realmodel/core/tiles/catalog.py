# SPDX-License-Identifier: GPL-3.0-or-later
"""tiles.toml: the table of a model in tiles."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ..base.atomic import Outputs
from ..base.errors import BuildWarning, InputRefused
from ..base.toml_table import TomlDocument
from ..cells.blocks import Block
from ..project.project import Project, Rock, Surface
from ..project.project_file import load_library
from ..project.project_writer import library_text, toml_value
from ..project.series import Series
from ..project.structure_entries import Body, Fault
from .grid import TileGrid

CATALOG, LIBRARY, TILES, INDEX = "tiles.toml", "library.toml", "tiles", "model.pvtu"
_FORMAT = 1


@dataclass(frozen=True)
class TileEntry:
    """A tile in the table: its place in the grid, the name of its files without ending, the SHA-256 of its
    .npz, its numbers, the box of its vertices, and its blocks' volumes, model units cubed."""

    column: int
    row: int
    name: str
    sha256: str
    cells: int
    faces: int
    vertices: int
    low: list[float]
    high: list[float]
    volumes: list[float]


@dataclass(frozen=True)
class Catalog:
    """The content of tiles.toml. project: without shapes. digest: of the input. patches: quadrilaterals of
    blocks on the borders between tiles, or with faults or bodies the faces between cells of two tiles, which
    were compared double for double; unequal: those that one side alone has."""

    project: Project
    cell_kind: str
    digest: str
    grid: TileGrid
    blocks: list[Block]
    tiles: list[TileEntry]
    patches: int = 0
    unequal: int = 0
    warnings: list[BuildWarning] = field(default_factory=list)


def write_catalog(catalog: Catalog, folder: Path) -> None:
    """Writes tiles.toml and, where there is one, the library. Raises OutputFailed."""
    project = catalog.project
    lines = [
        "# A model in tiles, written by RealModel (docs/tiles.md)",
        *_lines(
            format=_FORMAT,
            name=project.name,
            units=project.units,
            cell_kind=catalog.cell_kind,
            digest=catalog.digest,
            border_patches=catalog.patches,
            unequal_patches=catalog.unequal,
            x=catalog.grid.x,
            y=catalog.grid.y,
        ),
    ]
    for rock in project.rocks:
        lines += ["", "[[rock]]", *_lines(name=rock.name, base_elevation=rock.base_elevation)]
        for series in rock.series:
            lines += ["", "[[rock.series]]", *_lines(name=series.name)]
        for surface in rock.surfaces:
            lines += ["", "[[rock.surface]]"]
            lines += _lines(
                name=surface.name,
                rule=surface.rule,
                property=surface.property,
                block=surface.block,
                series=surface.series,
            )
    for fault in project.faults:
        lines += ["", "[[fault]]", *_lines(name=fault.name)]
    for body in project.bodies:
        lines += ["", "[[body]]", *_lines(name=body.name, property=body.property)]
    for block in catalog.blocks:
        lines += ["", "[[block]]", *_lines(**asdict(block))]
    for tile in catalog.tiles:
        lines += ["", "[[tile]]", *_lines(**asdict(tile))]
    for warning in catalog.warnings:
        lines += ["", "[[warning]]", *_lines(**asdict(warning))]
    with Outputs() as outputs:
        if project.library is not None:
            with outputs.file(folder / LIBRARY) as file:
                file.write(library_text(project.library).encode())
        with outputs.file(folder / CATALOG) as file:
            file.write(("\n".join(lines) + "\n").encode())


def _lines(**values: Any) -> list[str]:
    return [f"{key} = {toml_value(value)}" for key, value in values.items() if value is not None]


def read_catalog(folder: Path) -> Catalog:
    """Raises InputRefused where the folder holds no whole model in tiles."""
    file = folder / CATALOG
    if not file.is_file():
        raise InputRefused(f"no {CATALOG}: it contains no model in tiles, or an unfinished one", file=folder)
    content = TomlDocument(file).content
    try:
        if content["format"] != _FORMAT:
            raise InputRefused(f"format {content['format']} is unknown", file=file)
        library = folder / LIBRARY
        rocks = [
            Rock(
                rock["name"],
                [Surface(**surface) for surface in rock["surface"]],
                base_elevation=rock.get("base_elevation"),
                series=[Series(**series) for series in rock.get("series", [])],
            )
            for rock in content["rock"]
        ]
        project = Project(
            content["name"],
            rocks,
            load_library(library) if library.exists() else None,
            faults=[Fault(**fault) for fault in content.get("fault", [])],
            bodies=[Body(**body) for body in content.get("body", [])],
            units=content["units"],
        )
        return Catalog(
            project,
            content["cell_kind"],
            content["digest"],
            TileGrid(np.array(content["x"], float), np.array(content["y"], float)),
            [Block(**block) for block in content.get("block", [])],
            [TileEntry(**tile) for tile in content.get("tile", [])],
            content["border_patches"],
            content["unequal_patches"],
            [
                BuildWarning(**{**warning, "items": tuple(warning["items"])})
                for warning in content.get("warning", [])
            ],
        )
    except (KeyError, TypeError) as error:
        raise InputRefused(f"it is damaged: {error}", file=file) from error
