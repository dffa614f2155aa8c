// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "booleans/facets.hpp"

namespace realmodel::booleans {

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
