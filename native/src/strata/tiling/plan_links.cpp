// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/tiling/plan_links.hpp"

#include <algorithm>

#include "base/algorithms.hpp"
#include "base/counting_sort.hpp"
#include "base/parallel.hpp"
#include "meshing/winding.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::strata {

using exact::PlanArrangement;
using exact::VertexId;

namespace {

/// A pass of a triangle along a plan edge, kept with the edge's lower vertex: from the top its
/// higher vertex, the half-edge (3 triangle + edge), and whether it runs from the lower vertex to
/// the higher one. As numbers passes are in order of the edges, and along one of the half-edges.
using Pass = std::uint64_t;

Pass pass_of(VertexId high, std::size_t half_edge, bool upward) {
    return static_cast<Pass>(high.number()) << 33 | static_cast<Pass>(half_edge) << 1 |
           (upward ? 1 : 0);
}
VertexId high_of(Pass pass) {
    return static_cast<VertexId>(pass >> 33);
}
std::size_t half_edge_of(Pass pass) {
    return static_cast<std::uint32_t>(pass >> 1);
}
bool is_upward(Pass pass) {
    return (pass & 1) != 0;
}

struct VertexRange {
    VertexId first{INT32_MAX}, last = kNone;
    std::size_t size() const { return last < first ? 0 : index(last - first + 1); }
};

}  // namespace

void check_triangle_count(std::size_t triangles) {
    if (triangles > UINT32_MAX / 3) {
        throw InputError("too_large",
                         "a surface has more than 1431 million triangles; use a coarser one");
    }
}

PlanLinks link_triangles(std::span<const PlanTriangle> triangles, Progress* progress) {
    const std::size_t count = triangles.size();
    check_triangle_count(count);
    PlanLinks links;
    links.neighbor.assign(count, {-1, -1, -1});
    VertexRange range;
    for (std::size_t t = 0; t < count; ++t) {
        poll(progress, t);
        for (const VertexId v : triangles[t]) {
            range.first = std::min(range.first, v);
            range.last = std::max(range.last, v);
        }
    }
    const auto row = [&](VertexId v) { return index(v - range.first); };
    auto passes = bucketize<Pass>(range.size(), [&](const auto& put) {  // by the lower vertex
        for (std::size_t t = 0; t < count; ++t) {
            poll(progress, t);
            const PlanTriangle& v = triangles[t];
            for (std::size_t i = 0; i < 3; ++i) {
                const VertexId from = v[i], to = v[i < 2 ? i + 1 : 0];
                put(row(std::min(from, to)), pass_of(std::max(from, to), 3 * t + i, from < to));
            }
        }
    });
    for (std::size_t r = 0; r < passes.size(); ++r) {
        poll(progress, r);
        std::ranges::sort(passes[r]);
        for (const auto along : groups_of(passes[r], [](Pass pass) { return high_of(pass); })) {
            std::int32_t net = 0;
            for (const Pass pass : along)
                net += is_upward(pass) ? 1 : -1;
            if (along.size() == 2 && net == 0) {
                const std::size_t a = half_edge_of(along[0]), b = half_edge_of(along[1]);
                links.neighbor[a / 3][a % 3] = static_cast<std::int32_t>(b / 3);
                links.neighbor[b / 3][b % 3] = static_cast<std::int32_t>(a / 3);
            } else if (net != 0) {
                links.border.push_back({range.first + r, high_of(along[0]), net});
            }
        }
    }
    return links;
}

namespace {

/// Nothing where segments cross.
std::optional<meshing::ConstrainedTriangulation> triangulate(
    const std::vector<meshing::PlanPoint>& points,
    const std::vector<std::array<std::int32_t, 2>>& segments) {
    try {
        return meshing::constrained_delaunay(points, segments);
    } catch (const InputError& error) {
        if (error.kind != "crossing") throw;
        return std::nullopt;
    }
}

}  // namespace

std::optional<FrameTriangles> fill_frame(const PlanArrangement& geometry,
                                         std::span<const BorderEdge> border, const Frame& frame) {
    std::vector<VertexId> used(frame.begin(), frame.end());
    for (const BorderEdge& edge : border) {
        used.push_back(edge.low);
        used.push_back(edge.high);
    }
    sort_unique(used);
    const auto local = [&](VertexId v) {
        return static_cast<std::int32_t>(std::lower_bound(used.begin(), used.end(), v) -
                                         used.begin());
    };
    std::vector<meshing::PlanPoint> points;
    points.reserve(used.size());
    for (const VertexId v : used)
        points.push_back({geometry.point(v).x, geometry.point(v).y});
    std::vector<std::array<std::int32_t, 2>> segments;
    segments.reserve(border.size());
    for (const BorderEdge& edge : border)
        segments.push_back({local(edge.low), local(edge.high)});
    const auto triangulation = triangulate(points, segments);
    if (!triangulation) return std::nullopt;
    const auto& mesh = *triangulation;
    // whatever is at the hull, that is the frame, lies outside of everything
    const auto nets = transformed(border, [](const BorderEdge& edge) { return edge.net; });
    FrameTriangles result{{}, meshing::winding_numbers(mesh, points, segments, nets)};
    for (const auto& triangle : mesh.triangles) {
        PlanTriangle v;
        for (std::size_t i = 0; i < 3; ++i)
            v[i] = used[static_cast<std::size_t>(triangle[i])];
        result.triangles.push_back(v);
    }
    return result;
}

}  // namespace realmodel::strata
