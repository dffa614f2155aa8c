# SPDX-License-Identifier: GPL-3.0-or-later
"""RealModel without Blender: builds a model of polyhedral cells from a project, and writes it to files."""

from .blocks import Block, BlockBoundary
from .booleans import Intersection, intersect
from .boreholes import Boreholes
from .build import build
from .build_warning import BuildWarning
from .cross_validation import CrossValidation, cross_validate
from .cutting import Cut
from .erosion import Erosion
from .errors import (
    BuildFailed,
    Cancelled,
    InputRefused,
    NotEnoughMemory,
    OutputFailed,
    RealModelError,
    UsageError,
)
from .estimate import Estimate, estimate
from .heights import Interpolation
from .interpolation import interpolate
from .library import Library, Property, load_library
from .map_layer import MapLayer
from .model import Model
from .planar_mesh import MeshEstimate, estimate_mesh, mesh_region, triangulate_polygon
from .point_file import MeshFile, PointFile
from .project import Project, Rock, Surface
from .project_file import load_project
from .section import Fence, Section
from .simulation import SimulationMesh
from .structures.entries import Body, Fault
from .surface_set import SurfaceSet, build_surfaces
from .tiles import Tile, TiledModel, open_tiles
from .validation import ValidationReport
from .variogram import Structure, Variogram

__all__ = [
    "Block",
    "BlockBoundary",
    "Body",
    "Boreholes",
    "BuildFailed",
    "BuildWarning",
    "Cancelled",
    "CrossValidation",
    "Cut",
    "Erosion",
    "Estimate",
    "Fault",
    "Fence",
    "InputRefused",
    "Interpolation",
    "Intersection",
    "Library",
    "MapLayer",
    "MeshEstimate",
    "MeshFile",
    "Model",
    "NotEnoughMemory",
    "OutputFailed",
    "PointFile",
    "Project",
    "Property",
    "RealModelError",
    "Rock",
    "Section",
    "SimulationMesh",
    "Structure",
    "Surface",
    "SurfaceSet",
    "Tile",
    "TiledModel",
    "UsageError",
    "ValidationReport",
    "Variogram",
    "build",
    "build_surfaces",
    "cross_validate",
    "estimate",
    "estimate_mesh",
    "interpolate",
    "intersect",
    "load_library",
    "load_project",
    "mesh_region",
    "open_tiles",
    "triangulate_polygon",
]
