// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <string>

#include "layer.hpp"
#include "parallel_counts.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/exact/turn.hpp"

namespace realmodel::strata {

using exact::PlanGeometry;

namespace {

// Beyond these the products behind floating-point filters overflow or vanish.
constexpr double kLargest = 1e50;

constexpr exact::SpaceId kNotEntered = -1;

constexpr std::size_t kRange = 1 << 12;  // looked at at a time

std::array<double, 3> vertex_of(const SurfaceView& surface, std::int64_t v) {
    const auto i = static_cast<std::size_t>(v) * 3;
    return {surface.vertices[i], surface.vertices[i + 1], surface.vertices[i + 2]};
}

void check_numbers(const SurfaceView& surface, int index, int threads, const Progress* progress) {
    const std::size_t count = surface.vertices.size() / 3;
    parallel_ranges(count, kRange, threads, progress, [&](std::size_t begin, std::size_t end) {
        for (auto v = static_cast<std::int64_t>(begin); v < static_cast<std::int64_t>(end); ++v) {
            for (const double c : vertex_of(surface, v)) {
                if (!(std::abs(c) <= kLargest)) {
                    throw InputError("not_finite",
                                     "vertex " + std::to_string(v) +
                                         " has a coordinate that is not a number or is beyond 1e50",
                                     index, {v});
                }
            }
        }
    });
    const std::size_t corners = surface.triangles.size();
    parallel_ranges(corners, 3 * kRange, threads, progress,
                    [&](std::size_t begin, std::size_t end) {
                        for (std::size_t i = begin; i < end; ++i) {
                            const std::int32_t v = surface.triangles[i];
                            if (v >= 0 && static_cast<std::size_t>(v) < count) continue;
                            const auto t = static_cast<std::int64_t>(i / 3);
                            throw InputError("bad_index",
                                             "triangle " + std::to_string(t) + " names vertex " +
                                                 std::to_string(v) + " of " + std::to_string(count),
                                             index, {t});
                        }
                    });
}

bool in_one_line(const std::array<double, 3>& a, const std::array<double, 3>& b,
                 const std::array<double, 3>& c) {
    for (const auto& [i, j] : {std::array<std::size_t, 2>{0, 1}, {0, 2}, {1, 2}}) {
        if (exact::turn({a[i], a[j]}, {b[i], b[j]}, {c[i], c[j]}) != 0) return false;
    }
    return true;
}

/// What the triangles of a range are used as, and which of them have no area.
struct RangeOfTriangles {
    std::vector<UsedTriangle> used;  ///< with numbers of the surface's vertices
    std::vector<std::int64_t> flat;
};

/// Triangles with an area, counter-clockwise; marks their vertices.
RangeOfTriangles triangles_with_area(const SurfaceView& surface, int index,
                                     const PlanSnapping& snapping, std::size_t begin,
                                     std::size_t end, std::vector<std::uint8_t>& is_used) {
    RangeOfTriangles found;
    found.used.reserve(end - begin);
    for (std::size_t t = begin; t < end; ++t) {
        std::array<std::int32_t, 3> v;
        std::array<std::array<double, 3>, 3> p;
        for (std::size_t i = 0; i < 3; ++i) {
            v[i] = surface.triangles[t * 3 + i];
            p[i] = vertex_of(surface, v[i]);
            p[i][0] = snapping.x(p[i][0]);
            p[i][1] = snapping.y(p[i][1]);
        }
        const int turn = exact::turn({p[0][0], p[0][1]}, {p[1][0], p[1][1]}, {p[2][0], p[2][1]});
        const auto number = static_cast<std::int64_t>(t);
        if (turn == 0) {
            if (!in_one_line(p[0], p[1], p[2])) {
                throw InputError("vertical_triangle",
                                 "triangle " + std::to_string(t) +
                                     " stands upright: the surface has no single height there",
                                 index, {number}, p[0]);
            }
            found.flat.push_back(number);
            continue;
        }
        if (turn < 0) std::swap(v[1], v[2]);
        for (const std::int32_t i : v)
            mark(is_used[static_cast<std::size_t>(i)]);
        found.used.push_back({number, {v[0], v[1], v[2]}});
    }
    return found;
}

/// Enters the used vertices in their order, each fetched some rounds before it is needed.
std::vector<exact::SpaceId> enter_vertices(PlanGeometry& geometry, const SurfaceView& surface,
                                           const PlanSnapping& snapping,
                                           const std::vector<std::uint8_t>& is_used,
                                           const Progress* progress) {
    constexpr std::size_t kAhead = 12;
    struct Entering {
        double x, y, z;
        exact::VertexId plan;
    };
    std::array<Entering, 2 * kAhead> ahead{};  // of vertices, in turn
    const std::size_t count = is_used.size();
    std::vector<exact::SpaceId> entered(count, kNotEntered);
    const auto is_to_enter = [&](std::size_t round, std::size_t behind) {
        return round >= behind && round - behind < count && is_used[round - behind] != 0;
    };
    for (std::size_t round = 0; round < count + 2 * kAhead; ++round) {
        poll(progress, round);
        // the space vertex of one, the plan vertex of a later one, the place of an even later one
        if (is_to_enter(round, 2 * kAhead)) {
            const Entering& e = ahead[round % ahead.size()];
            entered[round - 2 * kAhead] = geometry.add_space_vertex(e.plan, e.z);
        }
        if (is_to_enter(round, kAhead)) {
            Entering& e = ahead[(round - kAhead) % ahead.size()];
            e.plan = geometry.add_vertex(e.x, e.y);
            geometry.prefetch_space_vertex(e.plan, e.z);
        }
        if (is_to_enter(round, 0)) {
            const auto [x, y, z] = vertex_of(surface, static_cast<std::int64_t>(round));
            Entering& e = ahead[round % ahead.size()];
            e = {snapping.x(x), snapping.y(y), z, -1};
            geometry.prefetch_vertex(e.x, e.y);
        }
    }
    return entered;
}

}  // namespace

std::vector<UsedTriangle> enter_surface(PlanGeometry& geometry, const SurfaceView& surface,
                                        int index, const PlanSnapping& snapping,
                                        std::vector<Warning>& warnings, int threads,
                                        const Progress* progress) {
    check_numbers(surface, index, threads, progress);
    const std::size_t count = surface.triangles.size() / 3;
    std::vector<std::uint8_t> is_used(surface.vertices.size() / 3, 0);
    std::vector<RangeOfTriangles> ranges((count + kRange - 1) / kRange);
    parallel_ranges(count, kRange, threads, progress, [&](std::size_t begin, std::size_t end) {
        ranges[begin / kRange] = triangles_with_area(surface, index, snapping, begin, end, is_used);
    });
    const auto entered = enter_vertices(geometry, surface, snapping, is_used, progress);
    std::vector<std::size_t> first;
    for (const RangeOfTriangles& range : ranges)
        first.push_back(range.used.size());
    std::vector<UsedTriangle> used(count_before(first));
    parallel_chunks(ranges.size(), threads, progress, [&](std::size_t r) {
        std::transform(ranges[r].used.begin(), ranges[r].used.end(),
                       used.begin() + static_cast<std::ptrdiff_t>(first[r]),
                       [&](UsedTriangle triangle) {
                           for (exact::SpaceId& corner : triangle.corner)
                               corner = entered[static_cast<std::size_t>(corner)];
                           return triangle;
                       });
    });
    Warning flat{"no_area", index, {}, {}};
    for (const RangeOfTriangles& range : ranges)
        flat.items.insert(flat.items.end(), range.flat.begin(), range.flat.end());
    if (!flat.items.empty()) {
        const char* what = flat.items.size() == 1 ? " triangle" : " triangles";
        flat.text = std::to_string(flat.items.size()) + what + " without area left out";
        warnings.push_back(std::move(flat));
    }
    return used;
}

}  // namespace realmodel::strata
