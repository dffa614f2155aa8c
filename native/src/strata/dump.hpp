// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "exact/plan_arrangement.hpp"
#include "realmodel/strata/stack.hpp"
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
