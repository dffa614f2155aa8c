// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/overlay/rock_footprints.hpp"

#include <string>

#include "base/parallel.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::strata {

void RockFootprints::add(const exact::PlanArrangement& geometry, const FaceList& faces,
                         std::size_t first_face, Progress* progress) {
    // The lowest faces tile what a rock mass covers, each position once; where columns are left
    // out, others may lie over or under them.
    PolygonPool own;
    for (std::size_t f = first_face; f < faces.size(); ++f) {
        if (faces.below[f] == kOutsideCell) own.add(faces.polygons[f]);
    }
    LocalArrangement scope(geometry);
    Clipper clipper(scope);
    const PlanGrid grid(geometry, own, std::vector<std::uint8_t>(own.size(), 1), 0, {1, progress});
    Array<std::int32_t> candidates;
    for (std::size_t r = 0; r < rocks_.size(); ++r) {
        for (std::size_t i = 0; i < rocks_[r].size(); ++i) {
            poll(progress, i);
            const PolygonView polygon = rocks_[r][i];
            grid.candidates(scope, polygon, candidates);
            for (const std::int32_t c : candidates) {
                const PolygonView other = own[static_cast<std::size_t>(c)];
                if (!clipper.overlap(polygon, other)) continue;
                const auto [x, y] = scope.rounded(clipper.intersect(polygon, other)[0].point);
                throw InputError(
                    "rocks_overlap",
                    "rock masses " + std::to_string(r) + " and " + std::to_string(rocks_.size()) +
                        " overlap in plan; they may only share borders",
                    -1, {static_cast<std::int64_t>(r), static_cast<std::int64_t>(rocks_.size())},
                    std::array<double, 3>{x, y, 0.0});
            }
        }
    }
    rocks_.push_back(std::move(own));
}

}  // namespace realmodel::strata
