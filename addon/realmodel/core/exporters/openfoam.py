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

from ..simulation import PolyhedralMesh
from ..simulation.patches import boundary_patches, solver_names
from ..work import native_module

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
    (folder / f"{folder.stem}.foam").touch()  # what ParaView opens
    order, turned, inner, patches, starts = _ordered(mesh)
    step(0.2)
    offsets, corners = native_module().ordered_faces(
        mesh.face_offsets, mesh.face_vertices, order, turned.view(np.uint8)
    )
    step(0.4)
    cells, faces = mesh.cells, len(order)
    note = f"nPoints:{len(mesh.points)}  nCells:{cells}  nFaces:{faces}  nInternalFaces:{inner}"
    note = f'    note        "{note}";\n'
    with _file(poly, "points", "vectorField") as file:
        _list(file, len(mesh.points), np.ascontiguousarray(mesh.points, "<f8"))
    with _file(poly, "faces", "faceCompactList") as file:
        _list(file, faces + 1, offsets.astype("<i4", copy=False))
        _list(file, len(corners), corners.astype("<i4", copy=False))
    step(0.7)
    sides = np.where(turned[:, None], mesh.face_cells[order][:, ::-1], mesh.face_cells[order])
    with _file(poly, "owner", "labelList", note) as file:
        _list(file, faces, sides[:, 0].astype("<i4"))
    with _file(poly, "neighbour", "labelList", note) as file:
        _list(file, inner, sides[:inner, 1].astype("<i4"))
    with _file(poly, "boundary", "polyBoundaryMesh", is_binary=False) as file:
        file.write(_boundary(patches, starts).encode())
    _write_zones(mesh, poly, order, turned)
    step(1.0)


def _ordered(mesh: PolyhedralMesh):
    """The faces in OpenFOAM's order: those between cells by the lower cell and then the higher, then the
    outside patch by patch; which of them are turned over, how many are inner; the patches, and where each
    begins, and the last ends."""
    cells = mesh.face_cells
    is_inner = cells[:, 1] >= 0
    inner = np.flatnonzero(is_inner)
    low, high = cells[inner].min(axis=1), cells[inner].max(axis=1)
    inner = inner[np.argsort(low.astype(np.int64) * mesh.cells + high, kind="stable")]
    outer = np.flatnonzero(~is_inner)
    patches, number = boundary_patches(
        mesh.face_surface[outer], _rises(mesh, outer), mesh.surface_names, mesh.surface_kind
    )
    by_patch = np.argsort(number.astype(np.int64) * mesh.cells + cells[outer, 0], kind="stable")
    order = np.concatenate([inner, outer[by_patch]])
    turned = is_inner[order] & (cells[order, 0] > cells[order, 1])
    starts = len(inner) + np.searchsorted(number[by_patch], np.arange(len(patches) + 1))
    return order, turned, len(inner), patches, starts


def _rises(mesh: PolyhedralMesh, faces: np.ndarray) -> np.ndarray:
    """(N,) the upward parts of the normals of faces, each as long as twice its area."""
    if not len(faces):
        return np.zeros(0)
    sizes = np.diff(mesh.face_offsets)[faces]
    ends = np.cumsum(sizes)
    first = ends - sizes
    at = np.repeat(mesh.face_offsets[faces] - first, sizes) + np.arange(ends[-1])
    corners = mesh.points[mesh.face_vertices[at], :2]
    corners = corners - corners[np.repeat(first, sizes)]
    following = np.arange(1, ends[-1] + 1)
    following[ends - 1] = first
    x, y = corners.T
    return np.add.reduceat(x * y[following] - y * x[following], first)


def _boundary(patches, starts) -> str:
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
    present = np.flatnonzero(np.bincount(mesh.cell_block, minlength=len(mesh.block_names)))
    names = solver_names(mesh.block_names)
    with _file(poly, "cellZones", "regIOobject") as file:
        file.write(b"%d\n(\n" % len(present))
        for block in present.tolist():
            file.write(f"{names[block]}\n{{\ntype cellZone;\ncellLabels List<label> ".encode())
            own = np.flatnonzero(mesh.cell_block == block)
            _list(file, len(own), own.astype("<i4"))
            file.write(b";\n}\n")
        file.write(b")\n")
    surface = mesh.face_surface[order]
    found = np.unique(surface[surface >= 0])
    names = solver_names(mesh.surface_names)
    with _file(poly, "faceZones", "regIOobject") as file:
        file.write(b"%d\n(\n" % len(found))
        for number in found.tolist():
            file.write(f"{names[number]}\n{{\ntype faceZone;\nfaceLabels List<label> ".encode())
            own = np.flatnonzero(surface == number)
            _list(file, len(own), own.astype("<i4"))
            file.write(b";\nflipMap List<bool> ")
            _list(file, len(own), turned[own].astype("u1"))
            file.write(b";\n}\n")
        file.write(b")\n")


def _file(folder: Path, name: str, kind: str, note: str = "", is_binary: bool = True) -> BinaryIO:
    file = (folder / name).open("wb")
    arch = (_ARCH if is_binary else "") + note
    form = "binary" if is_binary else "ascii"
    file.write(_HEADER.format(format=form, kind=kind, arch=arch, location=POLY_MESH, name=name).encode())
    return file


def _list(file: BinaryIO, count: int, values: np.ndarray) -> None:
    file.write(b"%d\n" % count)
    if count:
        file.write(b"(")
        file.write(values)
        file.write(b")\n")
