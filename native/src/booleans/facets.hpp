// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "arrangement/edge_fan.hpp"
#include "base/index.hpp"
#include "booleans/refinement.hpp"

namespace realmodel::booleans {

/// A triangle of the refinement, once for all pieces that coincide there.
struct Facet {
    std::array<std::int32_t, 3> corners;  ///< as the first of its pieces has them
    /// How often it is a piece of either surface: pieces that face the other way count -1.
    std::array<std::int32_t, 2> times{};
    std::array<bool, 2> is_of{};  ///< whether it is a piece of either surface
};

/// The facets, their edges, and which facets meet there.
struct FacetMesh {
    std::vector<Facet> facets;
    std::vector<std::int32_t> of_piece;     ///< the facet of each piece
    std::vector<std::int32_t> first_piece;  ///< of each piece, of those that coincide with it
    arrangement::EdgeUses edges;            ///< of facets as items
};

/// @throws InputError kind too_large, where the two sides of all facets cannot be numbered;
/// Cancelled
FacetMesh facets_of(const RefinedTriangles& refined, const Execution& execution);

/// The edges along which both surfaces meet, and the loops that these make.
struct IntersectionLoops {
    std::vector<IntersectionLoop> loops;
    std::vector<std::int32_t> of_edge;  ///< the loop of each edge of the mesh, -1 none
};

/// An edge of facets of both surfaces is an intersection edge, but within a region that they share:
/// there all of its facets are of both.
/// @param vertices  how many there are
/// @throws Cancelled
IntersectionLoops find_loops(const FacetMesh& mesh, std::size_t vertices,
                             const Execution& execution);

/// The cells of space (arrangement/space_cells.hpp) that the facets of two surfaces P and Q divide
/// it into. Sources 0 and 1 are P and Q; the windings of a cell say how often each goes round it.
struct FacetCells {
    /// Of each facet the cells below it (where it is seen clockwise from) and above it.
    std::vector<std::array<std::int32_t, 2>> of_facet;
    /// Of each cell how often either surface goes round it. It says nothing where that is open.
    std::vector<std::array<std::int32_t, 2>> winding;
    static constexpr std::int32_t kOutside = 0;  ///< the cell without a bound

    std::size_t size() const { return winding.size(); }
};

/// @throws InputError kind too_large; Cancelled
FacetCells cells_of(const std::vector<Position>& vertices, const FacetMesh& mesh,
                    const Execution& execution);

}  // namespace realmodel::booleans
