// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cassert>

#include "base/parallel_counts.hpp"
#include "strata/tiling/plan_links.hpp"

namespace realmodel::strata {

/// Where no outline is known that an edge could be taken from.
inline constexpr std::int32_t kNoOutline = -1;

/// Adds the outlines of triangles; their lines are made where they are new. Edges are fetched some
/// triangles before they are needed.
/// @param plan_of  plan_of(i) is the i-th triangle
/// @param earlier  earlier(i, e) is which of the triangles before the i-th has edge e the other way
///     around, or kNoOutline
/// @param similar  similar(i) is an outline that may be of the same triangle, or empty
template <class PlanOf, class Earlier, class Similar>
void add_outlines(exact::PlanArrangement& geometry, std::size_t count, const PlanOf& plan_of,
                  const Earlier& earlier, const Similar& similar, PolygonPool& pool,
                  Progress* progress) {
    constexpr std::size_t kAhead = 8;
    const DirectedLine unknown{LineId(kNone)};
    const std::size_t polygons = pool.size(), corners = pool.corners.size();
    pool.corners.resize(corners + 3 * count);
    pool.offsets.resize(polygons + count + 1);
    const auto outline = [&](std::size_t i) { return &pool.corners[corners + 3 * i]; };
    for (std::size_t ahead = 0; ahead < count + kAhead; ++ahead) {
        poll(progress, ahead);
        if (ahead < count) {
            const PlanTriangle v = plan_of(ahead);
            const PolygonView like = similar(ahead);
            const bool same = like.size() == 3 && like[0].point == v[0] && like[1].point == v[1] &&
                              like[2].point == v[2];
            for (std::size_t e = 0; e < 3; ++e) {
                outline(ahead)[e] = {v[e], same ? like[e].line : unknown};
                if (!same && earlier(ahead, e) == kNoOutline)
                    geometry.prefetch_edge(v[e], v[(e + 1) % 3]);
            }
            pool.offsets[polygons + ahead + 1] =
                static_cast<std::uint32_t>(corners + 3 * (ahead + 1));
        }
        if (ahead < kAhead) continue;
        const std::size_t i = ahead - kAhead;
        Corner* const own = outline(i);
        for (std::size_t e = 0; e < 3; ++e) {
            if (own[e].line != unknown) continue;
            const PointId to = own[(e + 1) % 3].point;
            const std::int32_t before = earlier(i, e);
            if (before == kNoOutline) {
                own[e].line = geometry.add_edge(geometry.vertex(own[e].point), geometry.vertex(to));
                continue;
            }
            assert(static_cast<std::size_t>(before) < i);
            const Corner* other = outline(static_cast<std::size_t>(before));
            while (other->point != to)
                ++other;
            own[e].line = other->line.reversed();
        }
    }
}

/// The same where nothing is known of the triangles' neighbors.
template <class PlanOf>
void add_outlines(exact::PlanArrangement& geometry, std::size_t count, const PlanOf& plan_of,
                  PolygonPool& pool, Progress* progress) {
    add_outlines(
        geometry, count, plan_of, [](std::size_t, std::size_t) { return kNoOutline; },
        [](std::size_t) { return PolygonView(); }, pool, progress);
}

}  // namespace realmodel::strata
