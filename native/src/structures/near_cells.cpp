// SPDX-License-Identifier: GPL-3.0-or-later
#include "structures/near_cells.hpp"

#include <cassert>

#include "cutting/near_part.hpp"

namespace realmodel::structures {

std::vector<CellPlace> places_of_cells(const ComplexView& model, const Sides& sides,
                                       std::span<const cutting::NearestSide> structures,
                                       std::span<const Structure> given,
                                       const Execution& execution) {
    assert(sides.size() == structures.size() && sides.size() == given.size());
    const cutting::CellBoxes cells(model, structures, execution);
    std::vector<CellPlace> places(model.cell_count(), CellPlace::kInside);
    for (std::size_t s = 0; s < sides.size(); ++s) {
        auto is_near = cutting::cells_near(cells, structures[s], execution);
        for (std::size_t c = 0; c < places.size(); ++c) {
            if (places[c] == CellPlace::kElsewhere) {
                is_near[c] = 1;  // not asked for
            } else if (is_near[c] != 0) {
                places[c] = CellPlace::kNear;
            }
        }
        if (sides[s] == 0) continue;  // either side will do
        // some corners of these may lie where the branch is not, and nearest to its other side
        for (const std::int32_t other : given[s].ends_at) {
            const auto beside = cutting::cells_near(cells, structures[index(other)], execution);
            for (std::size_t c = 0; c < places.size(); ++c) {
                if (beside[c] != 0) is_near[c] = 1;
            }
        }
        const auto own = cutting::sides_of_far_cells(model, structures[s], is_near, execution);
        for (std::size_t c = 0; c < places.size(); ++c) {
            if (own[c] != cutting::kOn && own[c] != sides[s]) places[c] = CellPlace::kElsewhere;
        }
    }
    return places;
}

}  // namespace realmodel::structures
