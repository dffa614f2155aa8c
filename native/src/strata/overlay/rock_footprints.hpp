// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "strata/overlay/envelope.hpp"

namespace realmodel::strata {

/// Where rock masses stand in plan. They may share borders but no area: one that overlaps an
/// earlier one is refused.
class RockFootprints {
public:
    /// Adds a rock mass, whose faces are those from `first_face` on.
    /// @throws InputError kind rocks_overlap, with the numbers of both and a position
    void add(const exact::PlanArrangement& geometry, const FaceList& faces, std::size_t first_face,
             Progress* progress);

private:
    std::vector<PolygonPool> rocks_;
};

}  // namespace realmodel::strata
