// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <tuple>

#include "conforming.hpp"
#include "parallel_sort.hpp"

namespace realmodel::strata {

using exact::PlanGeometry;

// Rounded coordinates are the same for every way to name a place, so only points with equal ones
// can be in the same place; among those the exact test decides.
Places find_places(const PlanGeometry& geometry, const FaceList& faces,
                   const std::vector<ExtraPoint>& extra, int threads, const Progress* progress) {
    std::vector<std::uint8_t> used(geometry.point_count(), 0);
    for (const Corner& corner : faces.polygons.corners)
        used[static_cast<std::size_t>(corner.point)] = 1;
    for (const ExtraPoint& e : extra)
        used[static_cast<std::size_t>(e.point)] = 1;
    std::vector<PointId> points;
    for (std::size_t p = 0; p < used.size(); ++p) {
        if (used[p] != 0) points.push_back(static_cast<PointId>(p));
    }
    const auto in_order = [&](PointId a, PointId b) {
        const auto &p = geometry.point(a), &q = geometry.point(b);
        return std::tie(p.x, p.y, a) < std::tie(q.x, q.y, b);  // input vertices have the lowest ids
    };
    parallel_sort(points, in_order, threads, progress);
    std::vector<std::size_t> group_begin;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const bool same = i > 0 && geometry.point(points[i]).x == geometry.point(points[i - 1]).x &&
                          geometry.point(points[i]).y == geometry.point(points[i - 1]).y;
        if (!same) group_begin.push_back(i);
    }
    group_begin.push_back(points.size());

    std::vector<PointId> first_there(points.size());  // the first point in the place of each
    constexpr std::size_t kChunk = 4096;
    const std::size_t groups = group_begin.size() - 1;
    parallel_chunks((groups + kChunk - 1) / kChunk, threads, progress, [&](std::size_t chunk) {
        Scope scope(geometry);
        for (std::size_t g = chunk * kChunk; g < std::min(groups, (chunk + 1) * kChunk); ++g) {
            for (std::size_t i = group_begin[g]; i < group_begin[g + 1]; ++i) {
                first_there[i] = points[i];
                for (std::size_t j = group_begin[g]; j < i; ++j) {
                    if (first_there[j] == points[j] && scope.same_place(points[i], points[j])) {
                        first_there[i] = points[j];
                        break;
                    }
                }
            }
        }
    });
    Places places;
    places.of_point.assign(geometry.point_count(), -1);
    for (std::size_t i = 0; i < points.size(); ++i) {
        auto& place = places.of_point[static_cast<std::size_t>(points[i])];
        if (first_there[i] == points[i]) {
            place = static_cast<PlaceId>(places.representative.size());
            places.representative.push_back(points[i]);
        } else {
            place = places.of_point[static_cast<std::size_t>(first_there[i])];
        }
    }
    return places;
}

}  // namespace realmodel::strata
