# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes for simulation, made from a model: Model.simulation_mesh."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from ..base.algebra import is_number
from ..base.errors import BuildFailed, BuildWarning, InputRefused, UsageError, place_text
from ..base.work import Arguments, Cancel, Progress, Result, Work, native_module, run
from ..cells.model_data import ModelData
from ..settings.meshers import check_mesher, local_lengths
from ..settings.method_options import check_threads
from ..surfaces.planar_mesh import MeshOptions, mesh_rings
from .elements import divided, divided_quadrilaterals
from .volume_mesh import PlanMesh, VolumeMesh, changed_voids, changed_volumes, model_arrays


def call_native(
    work: Work,
    function: Callable[Arguments, Result],
    *arguments: Arguments.args,
    **options: Arguments.kwargs,
) -> Result:
    """The result of a native function. Raises InputRefused, BuildFailed."""
    native = native_module()
    try:
        return work.native(function, *arguments, **options)
    except native.InputError as error:
        if error.kind == "nothing":
            raise InputRefused(str(error), advice="use a shorter edge length") from error
        if error.kind == "size":
            raise InputRefused(str(error)) from error
        place = tuple(error.place[:2]) if error.place is not None else None
        raise BuildFailed(f"the mesh cannot be made: {error}" + (f" at {place}" if place else "")) from error


_FAULT = 1  # of surface_kind


def filled(work: Work, model: ModelData, edge_length: float, tolerance: float, sizes: list[tuple]) -> dict:
    """Tetrahedra of a model: points (P, 3), corners (E, 4), block and compartment (E,), triangles (F, 3)
    outside, between blocks or compartments and on faults, and surface (F,) of these.

    tolerance: how far boundaries may lie from the exact ones, model units. sizes: as local_lengths gives
    them.
    """
    parts = np.stack([model.cell_block, model.cell_compartment], axis=1)
    regions, of_cell = np.unique(parts, axis=0, return_inverse=True)
    made = call_native(
        work,
        native_module().filled_mesh,
        model_arrays(model),
        of_cell.ravel().astype(np.int32),
        (np.asarray(model.surface_kind) == _FAULT).astype(np.uint8),
        edge_length,
        tolerance,
        sizes,
    )
    block, compartment = regions[made["region"]].T.astype(np.int32)
    return {
        "points": made["points"],
        "corners": made["tetrahedra"],
        "block": np.ascontiguousarray(block),
        "compartment": np.ascontiguousarray(compartment),
        "triangles": made["triangles"],
        "surface": made["surface"],
    }


def tetrahedron_volumes(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """(E,) float64, positive where corners are in order."""
    a, b, c = (points[corners[:, 1:]] - points[corners[:, :1]]).transpose(1, 0, 2)
    return np.einsum("ij,ij->i", np.cross(a, b), c) / 6


def smallest_dihedral_angle(points: np.ndarray, corners: np.ndarray) -> float:
    """The smallest angle between two faces of a tetrahedron, degrees; 180 without tetrahedra."""
    smallest = np.pi
    for i in range(4):
        for j in range(i + 1, 4):
            k, m = (n for n in range(4) if n not in (i, j))
            edge = points[corners[:, j]] - points[corners[:, i]]
            edge /= np.linalg.norm(edge, axis=1, keepdims=True)
            sides = []
            for n in (k, m):
                side = points[corners[:, n]] - points[corners[:, i]]
                sides.append(side - (side * edge).sum(axis=1, keepdims=True) * edge)
            across = np.linalg.norm(np.cross(*sides), axis=1)
            along = (sides[0] * sides[1]).sum(axis=1)
            smallest = min(smallest, float(np.arctan2(across, along).min(initial=np.pi)))
    return float(np.degrees(smallest))


ALL_LINES = np.empty((0, 2))  # of local lengths: no places
ELEMENTS = ("prisms", "tetrahedra")
MESHER = "frontal"
_CHANGES_LESS = "a shorter edge length or a smaller minimum thickness changes less"
_THINNEST = 1e-9  # of the largest coordinate: nearer than this, doubles leave no room for a layer


@dataclass(frozen=True, eq=False, repr=False)
class SimulationMesh(VolumeMesh):
    """A mesh for solvers, and its changes of volumes.

    volumes: (B,) float64, of the elements of each block; exact_volumes: (B,) float64, of the block itself;
    model units cubed. warnings: blocks whose volume it changes by more than a tenth. smallest_angle: between
    two faces of an element, degrees, of a model without columns; else None.
    """

    volumes: np.ndarray = field(default_factory=lambda: np.empty(0))
    exact_volumes: np.ndarray = field(default_factory=lambda: np.empty(0))
    warnings: list[BuildWarning] = field(default_factory=list)
    smallest_angle: float | None = None


def simulation_mesh(
    model: ModelData,
    edge_length: float,
    minimum_thickness: float,
    layers: int | Mapping[str, int] | Sequence[int] | None = None,
    elements: str = "prisms",
    *,
    layer_thickness: float | None = None,
    size: Iterable[Mapping] = (),
    mesher: str = MESHER,
    threads: int = 0,
    progress: Progress | None = None,
    cancel: Cancel | None = None,
) -> SimulationMesh:
    """A mesh of the model for solvers: columns of prisms on one planar mesh, between its exact surfaces.

    edge_length: of the planar mesh, model units. It contains the outline, the lines where layers end, steps
    and walls as lines, simplified to this length. minimum_thickness: where a layer, or a part that it is
    divided into, would be thinner, it ends, and its neighbors take the volume; prisms become pyramids and
    tetrahedra there. So every element has a positive volume, and elements share whole faces, also between
    blocks and rock masses.

    layers: how many each block is divided into: one number, one for each block, or {block name: number} (1
    where none is given). layer_thickness: instead into layers no thicker than this; `layers` then bounds
    their number. Where neither is given a block is one layer, or more where it is so thick that solvers could
    not use its elements at a steep top or base; a warning has their number. elements: "prisms", or
    "tetrahedra": the same mesh with every element divided. size: where edges are shorter, as of mesh_region;
    "outline" and "constraints" mean all lines. mesher: of the planar mesh.

    Models that have no columns (with bodies, with faults that are not vertical, halves of cuts) are filled
    with tetrahedra of about edge_length, and layers, layer_thickness and mesher mean nothing there. All lines
    are then the sharp edges of their boundaries in plan, and no length of `size` may be below
    minimum_thickness. Their boundaries lie within about minimum_thickness of the exact ones, and no edge is
    made shorter than that to get there: what is thinner may be lost. Compartments are kept apart.

    Raises UsageError and InputRefused for what cannot be meshed so, BuildFailed, Cancelled.

    >>> mesh = model.simulation_mesh(edge_length=1, minimum_thickness=0.2, layers={"clay": 2})
    >>> float(abs(mesh.volumes.sum() - model.volume).round(6)), mesh.plan.layers
    (0.0, 4)
    """
    threads = check_threads(threads)
    check_mesher(mesher)
    if elements not in ELEMENTS:
        raise UsageError(f"elements {elements!r} is unknown; use {', '.join(map(repr, ELEMENTS))}")
    lengths = {"edge_length": edge_length, "minimum_thickness": minimum_thickness}
    _check_lengths(lengths if layer_thickness is None else lengths | {"layer_thickness": layer_thickness})
    numbers = layer_numbers(model, layers, layer_thickness)
    if not len(model.cell_block):
        raise InputRefused("the model has no cells", advice="its surfaces enclose no block")
    sizes = local_lengths(size, [ALL_LINES], None)
    without_columns = _without_columns(model)
    if without_columns:
        _check_without_columns(without_columns, elements, layers is not None or layer_thickness is not None)
    _check_thinnest(model, minimum_thickness)

    def task(work: Work) -> SimulationMesh:
        if without_columns:
            return _filled(work, model, float(edge_length), float(minimum_thickness), sizes)
        arrays = model_arrays(model)
        rocks = np.array([block.rock for block in model.blocks], np.int32)
        with work.phase(0.0, 0.2, "simplifying lines"):
            lines = call_native(
                work, native_module().simulation_lines, arrays, rocks, float(edge_length), sizes
            )
        inner = lines.inner_lines
        plan_sizes = _of_plan(sizes, inner)
        with work.phase(0.2, 0.5, "meshing the plan"):
            options = MeshOptions(float(edge_length), mesher, size=plan_sizes, constraints=inner)
            vertices, triangles = mesh_rings(work, lines.rings, options)
        thickest = 0.0 if layer_thickness is None else float(layer_thickness)
        layering = float(minimum_thickness), numbers, thickest, elements == "tetrahedra"
        with work.phase(0.5, 1.0, "filling columns"):
            function = native_module().layered_mesh
            made = call_native(work, function, arrays, rocks, lines, vertices, triangles, *layering)
        return _assembled(model, made, elements, numbers)

    return run(task, progress, cancel, threads=threads)


def _filled(
    work: Work, model: ModelData, edge_length: float, minimum_thickness: float, sizes: list[tuple]
) -> SimulationMesh:
    """The mesh of a model without columns."""
    with work.phase(0.0, 1.0, "filling with tetrahedra"):
        made = filled(work, model, edge_length, minimum_thickness, sizes)
    return _of_tetrahedra(model, made)


def _check_lengths(lengths: dict[str, float]) -> None:
    for name, value in lengths.items():
        if not is_number(value) or value <= 0:
            raise UsageError(f"{name} must be a finite number above 0, not {value!r}")


def _check_without_columns(what: str, elements: str, has_layers: bool) -> None:
    """what: the reason why a model has no columns."""
    if elements != "tetrahedra":
        raise InputRefused(
            f"{what} cannot be meshed in columns of prisms",
            advice='use elements "tetrahedra" (--mesh-elements tetrahedra)',
        )
    if has_layers:
        raise UsageError(f"layers and layer_thickness are for meshes of columns; {what} has none")


def _check_thinnest(model: ModelData, minimum_thickness: float) -> None:
    largest = float(np.abs(model.vertices).max(initial=0.0))
    if minimum_thickness < _THINNEST * largest:
        raise UsageError(
            f"minimum_thickness {minimum_thickness:g} is too small for coordinates of {largest:g}; "
            f"use {_THINNEST * largest:g} or more"
        )


def layer_numbers(
    model: ModelData, layers: int | Mapping[str, int] | Sequence[int] | None, layer_thickness: float | None
) -> list[int]:
    """How many layers each block is divided into, at most; 0: as many as it takes. Raises UsageError."""
    names = [block.name for block in model.blocks]
    if layers is None:
        return [0] * len(names)
    default = 1 if layer_thickness is None else 0
    if isinstance(layers, Mapping):
        unknown = [name for name in layers if name not in names]
        if unknown:
            raise UsageError(f"layers: there is no block {unknown[0]!r}; blocks are {', '.join(names)}")
        numbers = [layers.get(name, default) for name in names]
    elif isinstance(layers, Sequence | np.ndarray) and not isinstance(layers, str):
        numbers = list(layers)
        if len(numbers) != len(names):
            raise UsageError(f"layers: {len(numbers)} numbers for {len(names)} blocks")
    else:
        numbers = [layers] * len(names)
    for value in numbers:
        whole = is_number(value) and float(value).is_integer()
        if not whole or not default <= value <= 10_000:
            raise UsageError(f"layers must be whole numbers from 1 to 10000, not {value!r}")
    return [int(value) for value in numbers]


def _without_columns(model: ModelData) -> str | None:
    """The reason why the model has no columns, or None."""
    if model.is_cut:
        return "a cut model"
    if model.structures.bodies:
        return "a model with bodies"
    if model.surface_is_level_set.any():
        return "a model with a series of level sets"
    for fault in model.structures.faults:
        vertices, triangles = fault.triangulation()
        corners = vertices[triangles]
        u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        if (u[:, 0] * v[:, 1] != u[:, 1] * v[:, 0]).any():
            return f"a model with a fault that is not vertical ('{fault.name}')"
    return None


def _of_plan(sizes: list[tuple], inner: list[np.ndarray]) -> list[Mapping]:
    """Local lengths for the planar mesh, whose lines are its outline and, where there are any, `inner`."""
    entries: list[Mapping] = []
    of_inner: list[Mapping] = []
    for places, length, distance in sizes:
        of_lines = places is None or not len(places)
        entry = {"at": "outline" if of_lines else places, "length": length, "distance": distance}
        entries.append(entry)
        if of_lines and inner:
            of_inner.append({**entry, "at": "constraints"})
    return entries + of_inner  # so that messages have the numbers of the entries that were given


def _assembled(model: ModelData, made: dict, wanted: str, layers: list[int]) -> SimulationMesh:
    elements = {kind: made[kind] for kind in ("tetrahedron", "pyramid", "prism") if len(made[kind]["block"])}
    faces = {kind: made[kind] for kind in ("triangle", "quadrilateral") if len(made[kind][1])}
    if wanted == "tetrahedra" and elements:
        elements = {"tetrahedron": divided(elements)}
        triangles, surface = made["triangle"]
        sides, side_surface = made["quadrilateral"]
        faces = {
            "triangle": (
                np.concatenate([triangles, divided_quadrilaterals(sides)]),
                np.concatenate([surface, np.repeat(side_surface, 2)]),
            )
        }
    return SimulationMesh(
        points=made["points"],
        elements={kind: arrays["corners"] for kind, arrays in elements.items()},
        element_block={kind: arrays["block"] for kind, arrays in elements.items()},
        faces={kind: arrays[0] for kind, arrays in faces.items()},
        face_surface={kind: arrays[1] for kind, arrays in faces.items()},
        **_names(model),
        plan=PlanMesh(
            made["plan_vertices"],
            made["plan_triangles"],
            {kind: arrays["column"] for kind, arrays in elements.items()},
            {kind: arrays["layer"] for kind, arrays in elements.items()},
            made["layers"],
        ),
        volumes=made["volumes"],
        exact_volumes=np.array([block.volume for block in model.blocks]),
        warnings=[
            *changed_volumes(model, made["volumes"], _CHANGES_LESS),
            *_divided_blocks(model, layers, made["block_layers"]),
            *_skewed_faces(model, *made["skewed"]),
            *_kept_blocks(model, made["kept"]),
        ],
    )


def _divided_blocks(model: ModelData, asked: list[int], layers: list[int]) -> list[BuildWarning]:
    """A warning for each block that was divided although nothing was said about layers."""
    return [
        BuildWarning(
            f"block '{block.name}' is divided into {number} layers: as one it is too thick for how steep its "
            "top or base is; give the layers, or their thickness, for others",
            "mesh_layers",
            model.rock_inputs[block.rock].rock.name,
        )
        for block, limit, number in zip(model.blocks, asked, layers, strict=True)
        if limit == 0 and number > 1
    ]


def _skewed_faces(
    model: ModelData, count: int, most: float, place: tuple, tall: list[int]
) -> list[BuildWarning]:
    """A warning about faces whose skewness is above the limit of OpenFOAM's checkMesh."""
    if not count:
        return []
    advice = "use a shorter edge length, or a base_elevation farther below"
    if tall:
        blocks = ", ".join(f"'{model.blocks[number].name}'" for number in tall)
        advice = f"use thinner layers in {blocks}"
    faces = "1 face has" if count == 1 else f"{count} faces have"
    text = f"{faces} a skewness above 4, up to {most:.1f} near {place_text(place)}"
    return [BuildWarning(f"{text}: checkMesh fails them; {advice}", "mesh_skewness")]


def _kept_blocks(model: ModelData, numbers: list[int]) -> list[BuildWarning]:
    """A warning for each block that keeps elements of bad shape, as a repair would cost too much of it."""
    return [
        BuildWarning(
            f"block '{block.name}' keeps thin ends with elements that solvers may do badly with, as without "
            "them it would lose much more; use a shorter edge length, or another minimum thickness",
            "mesh_thin_ends",
            model.rock_inputs[block.rock].rock.name,
        )
        for block in (model.blocks[number] for number in numbers)
    ]


def _of_tetrahedra(model: ModelData, made: dict) -> SimulationMesh:
    sizes = tetrahedron_volumes(made["points"], made["corners"])
    volumes = np.bincount(made["block"], sizes, minlength=len(model.blocks))
    return SimulationMesh(
        points=made["points"],
        elements={"tetrahedron": made["corners"]},
        element_block={"tetrahedron": made["block"]},
        element_compartment={"tetrahedron": made["compartment"]},
        faces={"triangle": made["triangles"]},
        face_surface={"triangle": made["surface"]},
        **_names(model),
        volumes=volumes,
        exact_volumes=np.array([block.volume for block in model.blocks]),
        warnings=[
            *changed_volumes(model, volumes, _CHANGES_LESS),
            *changed_voids(model, made["points"], made["triangles"], made["surface"]),
        ],
        smallest_angle=smallest_dihedral_angle(made["points"], made["corners"]),
    )


def _names(model: ModelData) -> dict:
    return {
        "block_names": [block.name for block in model.blocks],
        "block_property": np.array([block.property for block in model.blocks], np.int32),
        "surface_names": list(model.surface_names),
        "surface_kind": model.surface_kind,
    }


def mesh_entry(mesh: SimulationMesh) -> dict:
    """The entry of a mesh in the report: volumes are in model units cubed."""
    return {
        "elements": {kind: len(corners) for kind, corners in mesh.elements.items()},
        "points": len(mesh.points),
        **({} if mesh.smallest_angle is None else {"smallest_angle": mesh.smallest_angle}),
        "blocks": [
            {"block": name, "volume": float(volume), "exact_volume": float(exact)}
            for name, volume, exact in zip(mesh.block_names, mesh.volumes, mesh.exact_volumes, strict=True)
        ],
    }
