// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/tiling/block_tiling.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>

#include "base/lists.hpp"

namespace realmodel::strata {

using exact::PlanArrangement;

namespace {

/// Whether neighbors have each other.
[[maybe_unused]] bool are_symmetric(const TriangleLinks& links, PlaneId first) {
    for (std::size_t p = index(first); p < links.neighbor.size(); ++p) {
        for (const PlaneId n : links.neighbor[p]) {
            if (n == kNone) continue;
            const auto& back = links.of(n);
            if (std::find(back.begin(), back.end(), static_cast<PlaneId>(p)) == back.end())
                return false;
        }
    }
    return true;
}

}  // namespace

BlockTiling make_block_tiling(PlanArrangement& geometry, const std::vector<UsedTriangle>& triangles,
                              SurfacePlan plan, std::int32_t number, TriangleLinks& links,
                              const Execution& execution) {
    if (!plan.filling)
        make_surface_tiling(geometry, triangles, plan, {}, number, execution);  // refuses
    const PlaneId first = make_planes(geometry, triangles, execution);
    assert(plan.links.neighbor.size() == triangles.size());
    links.neighbor.resize(index(first), {kNone, kNone, kNone});  // planes of bases
    links.neighbor.resize(index(first) + triangles.size());
    BlockTiling tiling;
    tiling.whole.resize(triangles.size());
    std::iota(tiling.whole.begin(), tiling.whole.end(), first);
    const auto border = found_in_each<std::pair<exact::VertexId, exact::VertexId>>(
        triangles.size(), execution, [&](std::size_t t, auto& found) {
            const PlaneId plane = tiling.whole[t];
            const PlanTriangle& corner = geometry.plane(plane).plan;
            auto& neighbors = links.neighbor[index(plane)];
            for (std::size_t i = 0; i < 3; ++i) {
                const std::int32_t n = plan.links.neighbor[t][i];
                if (n >= 0 && meet_in_height(geometry, plane, i, first + n)) {
                    neighbors[i] = first + n;
                    continue;
                }
                neighbors[i] = kNone;
                found.emplace_back(corner[i], corner[(i + 1) % 3]);
            }
        });
    assert(are_symmetric(links, first));
    links.border.insert(links.border.end(), border.begin(), border.end());
    for (std::size_t t = 0; t < plan.filling->triangles.size(); ++t) {
        if (plan.filling->covered[t] == 0) tiling.empty.push_back(plan.filling->triangles[t]);
    }
    return tiling;
}

}  // namespace realmodel::strata
