// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "strata/overlay/envelope.hpp"
#include "strata/repair/plan_context.hpp"

namespace realmodel::strata {

/// The envelope under the sky over the region of a rock mass, with the outside around it; where
/// there is a window, only what of the region lies in it. The planes of the window are made.
Envelope region_envelope(PlanContext& context, LoadedRock& rock, const Execution& execution);

/// Cuts off what of a surface lies beyond the window of a tile, where its polygons cross the
/// border. So what they are divided into can become one facet again there, too, and the overlay
/// does not compound along the border.
void clip_to_window(PlanContext& context, const LoadedRock& rock, SurfaceTiling& tiling,
                    Progress* progress);

/// Where rock masses stand in plan. They may share borders but no area: one that overlaps an
/// earlier one is refused.
class RockFootprints {
public:
    /// Adds a rock mass, whose faces are those from `first_face` on.
    /// @throws InputError kind rocks_overlap, with the numbers of both and a position
    void add(const exact::PlanArrangement& geometry, const FaceList& faces, std::size_t first_face,
             Progress* progress);

private:
    struct Footprint {
        PolygonPool polygons;
        PlanBox box = spatial::kNoBox;
    };

    std::vector<Footprint> rocks_;
};

}  // namespace realmodel::strata
