// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "booleans/triangle_pieces.hpp"

// Pictures of what Booleans work on, as strata/dump.hpp has them of the stack: nothing in the
// library calls these. From a debugger that has stopped at an assertion, e.g.
//   call realmodel::booleans::dump_pieces(pieces_, "/tmp/pieces.obj")

namespace realmodel::booleans {

/// The pieces of both surfaces, in the groups "P" and "Q", those that are fresh in "P_fresh" and
/// "Q_fresh". Vertices are the points in order of their ids (OBJ counts them from 1).
void dump_pieces(const TrianglePieces& pieces, const char* path);

}  // namespace realmodel::booleans
