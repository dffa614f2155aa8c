# SPDX-License-Identifier: GPL-3.0-or-later
"""RealModel without Blender: builds a model of polyhedral cells from a project, and writes it to files."""

from .base.errors import (
    BuildFailed,
    BuildWarning,
    Cancelled,
    InputRefused,
    NotEnoughMemory,
    OutputFailed,
    RealModelError,
    UsageError,
)
from .base.triangles import Triangulation
from .cells.blocks import Block, BlockBoundary
from .exporters import save_mesh
from .exporters.report import Report
from .fields import Lattice, ScalarField
from .filling import DifferentialErosion, Strata, fill_with_strata, rock_shape
from .heights import Interpolation
from .heights.cross_validation import CrossValidation, cross_validate
from .heights.interpolate import interpolate
from .model.build import build
from .model.cutting import Cut, Fence, Section
from .model.estimate import Estimate, estimate
from .model.juxtapositions import Juxtaposition
from .model.model import Model
from .model.planned_hole import PlannedHole
from .model.stereonets import Stereonet
from .model.surface_set import SurfaceSet, build_surfaces
from .project.library import Library, Property
from .project.peers.from_gempy import from_gempy
from .project.peers.from_loop import from_loop
from .project.project import Project, Rock, Surface
from .project.project_file import load_library, load_project
from .project.series import Series
from .project.structure_entries import Body, Fault
from .proposal import ProposedProject, propose_project
from .readers.borehole_tables import BoreholeTables, read_boreholes
from .readers.code_counts import CodeCount, count_codes
from .readers.mesh_data import MeshData, read_mesh
from .readers.point_input import PointData, read_points
from .readers.tables.hole_problems import HoleProblem
from .readers.tables.observations import Bounds, LeftOut, Observations
from .results.booleans import Intersection, Loop, SubBlock, SubSurface, intersect
from .results.contours import Contour
from .results.geological_map import MapArea
from .results.model_holes import HoleAxis, HoleContact, HoleInterval, Interval
from .results.volumes import Erosion
from .settings.data_files import Boreholes, MapFile, MapLayer, MeshFile, ObservationFile, PointFile
from .settings.dips import DipFile, Dips, SpaceDips
from .settings.variogram import Structure, Variogram
from .simulation import CleanedCells, SimulationMesh
from .surfaces.planar_mesh import MeshEstimate, estimate_mesh, mesh_region, triangulate_polygon
from .tiles import Tile, TiledModel, open_tiles
from .validation.left_out_holes import HoleValidation, LeftOutContact, LeftOutHole
from .validation.misfits import Misfit
from .validation.observed import Observed, ObservedBlock, ObservedContact, ViolatedBound
from .validation.validation import ValidationReport

__all__ = [
    "Block",
    "BlockBoundary",
    "Body",
    "BoreholeTables",
    "Boreholes",
    "Bounds",
    "BuildFailed",
    "BuildWarning",
    "Cancelled",
    "CleanedCells",
    "CodeCount",
    "Contour",
    "CrossValidation",
    "Cut",
    "DifferentialErosion",
    "DipFile",
    "Dips",
    "Erosion",
    "Estimate",
    "Fault",
    "Fence",
    "HoleAxis",
    "HoleContact",
    "HoleInterval",
    "HoleProblem",
    "HoleValidation",
    "InputRefused",
    "Interpolation",
    "Intersection",
    "Interval",
    "Juxtaposition",
    "Lattice",
    "LeftOut",
    "LeftOutContact",
    "LeftOutHole",
    "Library",
    "Loop",
    "MapArea",
    "MapFile",
    "MapLayer",
    "MeshData",
    "MeshEstimate",
    "MeshFile",
    "Misfit",
    "Model",
    "NotEnoughMemory",
    "ObservationFile",
    "Observations",
    "Observed",
    "ObservedBlock",
    "ObservedContact",
    "OutputFailed",
    "PlannedHole",
    "PointData",
    "PointFile",
    "Project",
    "Property",
    "ProposedProject",
    "RealModelError",
    "Report",
    "Rock",
    "ScalarField",
    "Section",
    "Series",
    "SimulationMesh",
    "SpaceDips",
    "Stereonet",
    "Strata",
    "Structure",
    "SubBlock",
    "SubSurface",
    "Surface",
    "SurfaceSet",
    "Tile",
    "TiledModel",
    "Triangulation",
    "UsageError",
    "ValidationReport",
    "Variogram",
    "ViolatedBound",
    "build",
    "build_surfaces",
    "count_codes",
    "cross_validate",
    "estimate",
    "estimate_mesh",
    "fill_with_strata",
    "from_gempy",
    "from_loop",
    "interpolate",
    "intersect",
    "load_library",
    "load_project",
    "mesh_region",
    "open_tiles",
    "propose_project",
    "read_boreholes",
    "read_mesh",
    "read_points",
    "rock_shape",
    "save_mesh",
    "triangulate_polygon",
]
