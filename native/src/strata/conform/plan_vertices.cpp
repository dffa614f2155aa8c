// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/conform/plan_vertices.hpp"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cmath>
#include <tuple>

#include "base/bucket_sort.hpp"
#include "base/parallel_counts.hpp"

namespace realmodel::strata {

using exact::PlanArrangement;

namespace {

constexpr std::size_t kVerticesAtOnce = 1 << 14, kMostVertexChunks = 64;

/// A point with its rounded position.
struct Rounded {
    double x, y;
    PointId point;

    bool in_position_of(const Rounded& other) const { return x == other.x && y == other.y; }
};

/// A range of x.
struct XRange {
    double low = HUGE_VAL, high = -HUGE_VAL, scale = 0;

    void include(double x) {
        low = std::min(low, x);
        high = std::max(high, x);
    }
    /// How much of it lies before x, from 0 to 1.
    double share(double x) const { return std::clamp((x - low) * scale, 0.0, 1.0); }
};

/// Where the vertices in use are, and nearly all points with them.
XRange range_of_vertices(const PlanArrangement& geometry, const Array<std::uint8_t>& used,
                         const Execution& execution) {
    const auto vertices = geometry.vertex_count();
    std::vector<XRange> ranges((vertices + kVerticesAtOnce - 1) / kVerticesAtOnce);
    parallel_ranges(vertices, kVerticesAtOnce, execution, [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) {
            if (used[v] != 0)
                ranges[begin / kVerticesAtOnce].include(geometry.point(static_cast<PointId>(v)).x);
        }
    });
    XRange all;
    for (const XRange& range : ranges) {
        all.include(range.low);
        all.include(range.high);
    }
    const double width = all.high - all.low;
    if (!std::isfinite(width) || !std::isnormal(1 / width)) return {0, 0, 0};  // nothing is known
    all.scale = 1 / width;
    return all;
}

/// The points that faces use and the extra ones, in order of position.
Array<Rounded> points_in_use(const PlanArrangement& geometry, const FaceList& faces,
                             const std::vector<ExtraPoint>& extra, const Execution& execution) {
    auto used = zeros<std::uint8_t>(geometry.point_count(), execution);
    const auto& points = faces.polygons.points;
    parallel_each(points.size(), execution, [&](std::size_t c) { mark(used[index(points[c])]); });
    for (const ExtraPoint& e : extra)
        used[index(e.point)] = 1;
    const XRange range = range_of_vertices(geometry, used, execution);
    const auto share = [range](const Rounded& p) { return range.share(p.x); };
    const auto in_order = [](const Rounded& a, const Rounded& b) {
        return std::tie(a.x, a.y, a.point) < std::tie(b.x, b.y, b.point);
    };
    const std::size_t chunks =
        std::clamp<std::size_t>(used.size() / kVerticesAtOnce, 1, kMostVertexChunks);
    const auto produce = [&](std::size_t chunk, const auto& take) {
        const std::size_t end = used.size() * (chunk + 1) / chunks;
        for (std::size_t p = used.size() * chunk / chunks; p < end; ++p) {
            if (used[p] == 0) continue;
            const auto id = static_cast<PointId>(p);
            take(Rounded{geometry.point(id).x, geometry.point(id).y, id});
        }
    };
    // input vertices have the lowest ids
    return BucketSort<Rounded, decltype(share), decltype(in_order)>(share, in_order)
        .sorted(chunks, used.size(), produce, execution);
}

/// Calls visit(begin, end) for the groups of points in equal positions that begin in a range.
template <class Visit>
void for_each_position(const Array<Rounded>& points, std::size_t begin, std::size_t end,
                       const Visit& visit) {
    while (begin < end && begin > 0 && points[begin].in_position_of(points[begin - 1]))
        ++begin;
    while (begin < end) {
        std::size_t next = begin + 1;
        while (next < points.size() && points[next].in_position_of(points[begin]))
            ++next;
        visit(begin, next);
        begin = next;
    }
}

/// Finds which points are in the same position. Rounded coordinates are the same for every way to
/// name a point, so only points with equal ones can be; among those the exact test decides.
/// @param before  how many positions begin in each range of kVerticesAtOnce points
/// @return for each point, the first one in its position
Array<std::uint32_t> find_first_there(const PlanArrangement& geometry, const Array<Rounded>& points,
                                      std::vector<std::size_t>& before,
                                      const Execution& execution) {
    Array<std::uint32_t> first_there(points.size());
    before.assign((points.size() + kVerticesAtOnce - 1) / kVerticesAtOnce, 0);
    const auto find_among = [&](LocalArrangement& scope, std::size_t begin, std::size_t end) {
        std::size_t positions = 0;
        for (std::size_t i = begin; i < end; ++i) {
            first_there[i] = static_cast<std::uint32_t>(i);
            for (std::size_t j = begin; j < i; ++j) {
                if (first_there[j] == j && scope.same_place(points[i].point, points[j].point)) {
                    first_there[i] = static_cast<std::uint32_t>(j);
                    break;
                }
            }
            positions += first_there[i] == i;
        }
        return positions;
    };
    parallel_ranges(points.size(), kVerticesAtOnce, execution,
                    [&](std::size_t range_begin, std::size_t range_end) {
                        LocalArrangement scope(geometry);
                        for_each_position(points, range_begin, range_end,
                                          [&](std::size_t begin, std::size_t end) {
                                              before[range_begin / kVerticesAtOnce] +=
                                                  find_among(scope, begin, end);
                                          });
                    });
    return first_there;
}

/// Room for so many plan vertices, none of which is set.
PlanVertices empty_vertices(std::size_t count, std::size_t points, const Execution& execution) {
    PlanVertices vertices;
    vertices.representative = Array<PointId>(count);
    vertices.same_x_bits = zeros<std::uint64_t>(count / 64 + 1, execution);
    vertices.of_point = Array<PlanVertexId>(points);
    parallel_ranges(points, 1 << 18, execution, [&](std::size_t begin, std::size_t end) {
        std::fill(vertices.of_point.begin() + begin, vertices.of_point.begin() + end, -1);
    });
    return vertices;
}

}  // namespace

PlanVertices find_plan_vertices(const PlanArrangement& geometry, const FaceList& faces,
                                const std::vector<ExtraPoint>& extra, const Execution& execution) {
    const Array<Rounded> points = points_in_use(geometry, faces, extra, execution);
    std::vector<std::size_t> before;
    const auto first_there = find_first_there(geometry, points, before, execution);
    const std::size_t count = count_before(before);
    PlanVertices vertices = empty_vertices(count, geometry.point_count(), execution);
    std::vector<std::vector<PlanVertexId>> coincident(before.size());
    const auto of_point = [&](std::size_t i) -> PlanVertexId& {
        return vertices.of_point[index(points[i].point)];
    };
    parallel_ranges(points.size(), kVerticesAtOnce, execution,
                    [&](std::size_t range_begin, std::size_t range_end) {
                        const std::size_t chunk = range_begin / kVerticesAtOnce;
                        std::size_t next = before[chunk];
                        for_each_position(
                            points, range_begin, range_end,
                            [&](std::size_t begin, std::size_t end) {
                                for (std::size_t i = begin; i < end; ++i) {
                                    if (first_there[i] != i) {
                                        of_point(i) = of_point(first_there[i]);
                                        continue;
                                    }
                                    of_point(i) = static_cast<PlanVertexId>(next);
                                    vertices.representative[next] = points[i].point;
                                    if (next > 0 && points[i - 1].x == points[i].x) {
                                        std::atomic_ref(vertices.same_x_bits[(next - 1) / 64])
                                            .fetch_or(std::uint64_t{1} << (next - 1) % 64,
                                                      std::memory_order_relaxed);
                                    }
                                    if (i > begin) coincident[chunk].push_back(of_point(i));
                                    ++next;
                                }
                            });
                        assert(next == (chunk + 1 < before.size() ? before[chunk + 1] : count));
                    });
    for (const auto& some : coincident)
        vertices.coincident.insert(vertices.coincident.end(), some.begin(), some.end());
    return vertices;
}

void set_plan_positions(const PlanArrangement& geometry, PlanVertices& plan_vertices,
                        const Execution& execution) {
    plan_vertices.position = Array<PlanPosition>(plan_vertices.size());
    parallel_each(plan_vertices.size(), execution, [&](std::size_t p) {
        const auto& point = geometry.point(plan_vertices.representative[p]);
        plan_vertices.position[p] = {point.x, point.y};
    });
}

}  // namespace realmodel::strata
