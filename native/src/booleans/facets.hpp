// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

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

/// A facet seen along one of its edges.
struct FacetUse {
    std::int32_t facet;
    std::int8_t direction;  ///< 1 from the lesser to the greater vertex of the edge, -1 back
    auto operator<=>(const FacetUse&) const = default;

    /// The side of the facet that is ahead of it for one who goes round the edge counter-clockwise,
    /// seen along it: 0 below, 1 above. The other one is behind.
    std::size_t ahead() const { return direction > 0 ? 0 : 1; }
};

/// The facets, their edges, and which facets meet there.
struct FacetMesh {
    std::vector<Facet> facets;
    std::vector<std::int32_t> of_part;               ///< the facet of each part
    std::vector<std::array<std::int32_t, 2>> edges;  ///< lesser, greater vertex; in order
    std::vector<std::size_t> use_begins{0};          ///< of each edge in `uses`, and their end
    std::vector<FacetUse> uses;
    std::vector<std::array<std::int32_t, 3>> edges_of;  ///< of each facet

    std::span<const FacetUse> uses_of(std::size_t edge) const {
        return {uses.data() + use_begins[edge], use_begins[edge + 1] - use_begins[edge]};
    }
};

/// @throws InputError kind too_large, where the two sides of all facets cannot be numbered;
/// Cancelled
FacetMesh facets_of(const Parts& parts, const Execution& execution);

}  // namespace realmodel::booleans
