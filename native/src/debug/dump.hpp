// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "arrangement/triangle_arrangement.hpp"
#include "booleans/triangle_pieces.hpp"
#include "cutting/rounding/rounded_parts.hpp"
#include "exact/plan_arrangement.hpp"
#include "realmodel/strata/stack.hpp"
#include "simulation/cleaning/editable_complex.hpp"
#include "simulation/columns.hpp"
#include "simulation/pillar_levels.hpp"
#include "simulation/plan_topology.hpp"
#include "strata/overlay/envelope.hpp"

// Pictures of what the steps work on, as Wavefront OBJ files, for whoever looks for an error:
// nothing in the library calls these. From a debugger that has stopped at an assertion, e.g.
//   call realmodel::strata::dump_envelope(geometry, envelope, "/tmp/envelope.obj")
// (CONTRIBUTING.md). Coordinates have 17 digits. They throw std::runtime_error where the file
// cannot be written.

namespace realmodel::strata {

/// The facets of an envelope that lie on a surface, in a group for each surface. Sky and outside
/// have no height and are left out.
void dump_envelope(const exact::PlanArrangement& geometry, const Envelope& envelope,
                   const char* path);

/// The faces that are finished so far, in a group for each surface ("base" for the flat base).
void dump_faces(const exact::PlanArrangement& geometry, const FaceList& faces, const char* path);

/// The plan at height 0: the points in order of their ids (OBJ counts them from 1), and the
/// supporting lines across the box of the input, edges and traces in a group each.
void dump_arrangement(const exact::PlanArrangement& geometry, const char* path);

/// The cells of a finished complex, in a group for each surface, "walls", "base" and "cut".
void dump_complex(const CellComplex& cells, const char* path);

}  // namespace realmodel::strata

namespace realmodel::arrangement {

/// Triangles that were divided: of each with regions a group "triangle_N", with the outlines of its
/// regions as faces and the holes in them as lines.
void dump_regions(const exact::SpacePoints& points, const TriangleArrangement& arrangement,
                  const char* path);

}  // namespace realmodel::arrangement

namespace realmodel::booleans {

/// The pieces of both surfaces, in the groups "P" and "Q", those that are fresh in "P_fresh" and
/// "Q_fresh". Vertices are the points in order of their ids (OBJ counts them from 1).
void dump_pieces(const TrianglePieces& pieces, const char* path);

}  // namespace realmodel::booleans

namespace realmodel::cutting {

/// The polygons around each part, in a group each, seen from outside of it.
void dump_parts(const RoundedParts& parts, const char* path);

}  // namespace realmodel::cutting

namespace realmodel::simulation {

/// The planar mesh at height 0, in a group for each rock mass (or "outside"); as lines its edges on
/// steps, and on other lines.
void dump_plan(const PlanTopology& plan, const char* path);

/// The pillars of all triangles: the levels of each as a line upward, moved a little to the middle
/// of its triangle, in a group "pillar_N" for each.
void dump_pillars(const PlanTopology& plan, const PillarLevels& levels, const char* path);

/// The elements of columns, in a group for each block: their lower and upper faces.
void dump_columns(const PlanTopology& plan, const PillarLevels& levels, const ColumnFronts& columns,
                  const char* path);

/// The faces that a change removes, in a group "before", and those it adds, in one for each.
void dump_change(const EditableComplex& complex, const Change& change, const char* path);

}  // namespace realmodel::simulation
