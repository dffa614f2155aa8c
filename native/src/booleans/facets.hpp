// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "arrangement/edge_fan.hpp"
#include "base/index.hpp"
#include "booleans/refinement.hpp"

namespace realmodel::booleans {

/// A triangle of the refinement, once for all parts that coincide there.
struct Facet {
    std::array<std::int32_t, 3> corners;  ///< as the first of its parts has them
    /// How often it is a part of either surface: parts that face the other way count -1.
    std::array<std::int32_t, 2> times{};
    std::array<bool, 2> is_of{};  ///< whether it is a part of either surface
};

/// The facets, their edges, and which facets meet there.
struct FacetMesh {
    std::vector<Facet> facets;
    std::vector<std::int32_t> of_part;     ///< the facet of each part
    std::vector<std::int32_t> first_part;  ///< of each part, of those that coincide with it
    arrangement::EdgeUses edges;           ///< of facets as items
};

/// @throws InputError kind too_large, where the two sides of all facets cannot be numbered;
/// Cancelled
FacetMesh facets_of(const RefinedTriangles& parts, const Execution& execution);

}  // namespace realmodel::booleans
