// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "booleans/facets.hpp"

namespace realmodel::booleans {

/// The edges along which both surfaces meet, and the loops that these make.
struct IntersectionLoops {
    std::vector<IntersectionLoop> loops;
    std::vector<std::int32_t> of_edge;  ///< the loop of each edge of the mesh, -1 none
};

/// An edge of facets of both surfaces is an intersection edge, but within a part that they share:
/// there all of its facets are of both.
/// @param vertices  how many there are
/// @throws Cancelled
IntersectionLoops find_loops(const FacetMesh& mesh, std::size_t vertices,
                             const Execution& execution);

}  // namespace realmodel::booleans
