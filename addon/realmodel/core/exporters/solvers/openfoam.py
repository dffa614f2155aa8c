# SPDX-License-Identifier: GPL-3.0-or-later
"""OpenFOAM cases: constant/polyMesh in binary, and as much of system as checkMesh and a first solver need
(OpenFOAM User Guide, "Mesh generation and conversion"; labels of 32 bits, numbers of 64).

The zones of cells are the blocks, those of faces the surfaces. Patches: boundary_patches.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO

import numpy as np

from ...base.work import native_module
from ...simulation import PolyhedralMesh
from ...simulation.patches import Patch, boundary_patches, solver_names

POLY_MESH = "constant/polyMesh"
_HEADER = """FoamFile
{{
    version     2.0;
    format      {format};
    class       {kind};
{arch}    location    "{location}";
    object      {name};
}}

"""
_ARCH = '    arch        "LSB;label=32;scalar=64";\n'
_SYSTEM = {
    "controlDict": """application     laplacianFoam;
startFrom       latestTime;
startTime       0;
stopAt          endTime;
endTime         1;
deltaT          1;
writeControl    timeStep;
writeInterval   1;
writeFormat     binary;
writePrecision  12;
""",
    "fvSchemes": """ddtSchemes { default steadyState; }
gradSchemes { default Gauss linear; }
divSchemes { default none; }
laplacianSchemes { default Gauss harmonic corrected; }
interpolationSchemes { default linear; }
snGradSchemes { default corrected; }
""",
    "fvSolution": """solvers
{
    ".*"
    {
        solver          PCG;
        preconditioner  DIC;
        tolerance       1e-10;
        relTol          0;
    }
}
SIMPLE { nNonOrthogonalCorrectors 5; }
""",
}


def write_openfoam(mesh: PolyhedralMesh, folder: Path, step: Callable[[float], None]) -> None:
    """Writes a case into an empty folder."""
    poly = folder / POLY_MESH
    poly.mkdir(parents=True)
    (folder / "system").mkdir()
    for name, text in _SYSTEM.items():
        head = _HEADER.format(format="ascii", kind="dictionary", arch="", location="system", name=name)
        (folder / "system" / name).write_text(head + text)
    (folder / f"{folder.stem}.foam").touch()  # the file to open in ParaView
    order, inner, patches, starts = _ordered(mesh)
    step(0.2)
    made = native_module().ordered_faces(mesh.face_offsets, mesh.face_vertices, mesh.face_cells, order)
    step(0.4)
    cells, faces = mesh.cells, len(order)
    note = f"nPoints:{len(mesh.points)}  nCells:{cells}  nFaces:{faces}  nInternalFaces:{inner}"
    note = f'    note        "{note}";\n'
    with _file(poly, "points", "vectorField") as file:
        _list(file, np.ascontiguousarray(mesh.points, "<f8"))
    with _file(poly, "faces", "faceCompactList") as file:
        _list(file, made["offsets"].astype("<i4", copy=False))
        _list(file, made["vertices"].astype("<i4", copy=False))
    step(0.7)
    with _file(poly, "owner", "labelList", note) as file:
        _list(file, made["owner"].astype("<i4", copy=False))
    with _file(poly, "neighbour", "labelList", note) as file:
        _list(file, made["neighbor"][:inner].astype("<i4", copy=False))
    with _file(poly, "boundary", "polyBoundaryMesh", is_binary=False) as file:
        file.write(_boundary(patches, starts).encode())
    _write_zones(mesh, poly, order, made["turned"])
    step(1.0)


def _ordered(mesh: PolyhedralMesh) -> tuple[np.ndarray, int, list[Patch], np.ndarray]:
    """The faces in OpenFOAM's order: those between cells by the lower cell and then the higher, then the
    outside patch by patch; how many are inner; the patches, and where each begins, and the last ends."""
    inner = native_module().inner_faces(mesh.face_cells, mesh.cells)
    outer = np.flatnonzero(mesh.face_cells[:, 1] < 0)
    patches, number = boundary_patches(
        mesh.face_surface[outer], _rises(mesh, outer), mesh.surface_names, mesh.surface_kind
    )
    by_patch = np.argsort(number.astype(np.int64) * mesh.cells + mesh.face_cells[outer, 0], kind="stable")
    order = np.concatenate([inner, outer[by_patch]])
    starts = len(inner) + np.searchsorted(number[by_patch], np.arange(len(patches) + 1))
    return order, len(inner), patches, starts


def _rises(mesh: PolyhedralMesh, faces: np.ndarray) -> np.ndarray:
    """(N,) the upward parts of the normals of faces, each as long as twice its area."""
    sizes = np.diff(mesh.face_offsets)[faces]
    rises = np.zeros(len(faces))
    for size in np.unique(sizes).tolist():
        of_size = np.flatnonzero(sizes == size)
        at = mesh.face_offsets[faces[of_size], None] + np.arange(size)
        x, y, _ = mesh.points[mesh.face_vertices[at]].transpose(2, 0, 1)
        x, y = x - x[:, :1], y - y[:, :1]
        rises[of_size] = (x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)).sum(axis=1)
    return rises


def _boundary(patches: list[Patch], starts: np.ndarray) -> str:
    text = f"{len(patches)}\n(\n"
    for number, patch in enumerate(patches):
        group = f"        inGroups        1({patch.group});\n" if patch.group != patch.name else ""
        text += (
            f"    {patch.name}\n    {{\n        type            patch;\n{group}"
            f"        nFaces          {starts[number + 1] - starts[number]};\n"
            f"        startFace       {starts[number]};\n    }}\n"
        )
    return f"{text})\n"


def _write_zones(mesh: PolyhedralMesh, poly: Path, order: np.ndarray, turned: np.ndarray) -> None:
    names = solver_names(mesh.block_names)
    with _file(poly, "cellZones", "regIOobject") as file:
        zones = _zones(mesh.cell_block)
        file.write(b"%d\n(\n" % len(zones))
        for block, labels in zones:
            file.write(f"{names[block]}\n{{\ntype cellZone;\ncellLabels List<label> ".encode())
            _list(file, labels)
            file.write(b";\n}\n")
        file.write(b")\n")
    names = solver_names(mesh.surface_names)
    with _file(poly, "faceZones", "regIOobject") as file:
        zones = _zones(mesh.face_surface[order])
        file.write(b"%d\n(\n" % len(zones))
        for number, labels in zones:
            file.write(f"{names[number]}\n{{\ntype faceZone;\nfaceLabels List<label> ".encode())
            _list(file, labels)
            file.write(b";\nflipMap List<bool> ")
            _list(file, turned[labels])
            file.write(b";\n}\n")
        file.write(b")\n")


def _zones(number: np.ndarray) -> list[tuple[int, np.ndarray]]:
    """The elements with each number from 0, ascending, as labels; negative numbers are left out."""
    with_one = np.flatnonzero(number >= 0)
    numbers = number[with_one]
    # NumPy sorts short numbers by counting
    short = numbers.astype(np.uint16) if numbers.max(initial=0) < 2**16 else numbers
    order = np.argsort(short, kind="stable")
    ends = np.cumsum(np.bincount(numbers)) if len(numbers) else np.empty(0, np.int64)
    parts = np.split(with_one[order].astype("<i4"), ends)
    return [(k, part) for k, part in enumerate(parts) if len(part)]


def _file(folder: Path, name: str, kind: str, note: str = "", is_binary: bool = True) -> BinaryIO:
    file = (folder / name).open("wb")
    arch = (_ARCH if is_binary else "") + note
    form = "binary" if is_binary else "ascii"
    file.write(_HEADER.format(format=form, kind=kind, arch=arch, location=POLY_MESH, name=name).encode())
    return file


def _list(file: BinaryIO, values: np.ndarray) -> None:
    file.write(b"%d\n" % len(values))
    if len(values):
        file.write(b"(")
        file.write(values)
        file.write(b")\n")
