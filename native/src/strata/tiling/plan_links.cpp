// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/tiling/plan_links.hpp"

#include <algorithm>
#include <limits>
#include <tuple>

#include "base/algorithms.hpp"
#include "base/counting_sort.hpp"
#include "base/parallel.hpp"
#include "exact/orientation.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/meshing/triangulation.hpp"

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

/// The sums of `net` over all border edges that run along each edge of the triangulation.
class NetAlongEdges {
public:
    NetAlongEdges(const meshing::ConstrainedTriangulation& mesh,
                  const std::vector<meshing::PlanPoint>& points,
                  const std::vector<std::array<std::int32_t, 2>>& segments,
                  std::span<const BorderEdge> border)
        : points_(points) {
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
            for (std::size_t i = 0; i < 3; ++i) {
                if (!mesh.constrained[t][i]) continue;
                const std::int32_t a = mesh.triangles[t][i], b = mesh.triangles[t][(i + 1) % 3];
                edges_.push_back({std::min(a, b), std::max(a, b), 0});
                edges_.push_back({std::max(a, b), std::min(a, b), 0});
            }
        }
        std::sort(edges_.begin(), edges_.end(), before);
        edges_.erase(std::unique(edges_.begin(), edges_.end(),
                                 [](const CoverageEdge& a, const CoverageEdge& b) {
                                     return a.from == b.from && a.to == b.to;
                                 }),
                     edges_.end());
        for (std::size_t s = 0; s < segments.size(); ++s)
            add_along(segments[s][0], segments[s][1], border[s].net);
    }

    /// How much more often the left side of the edge is covered than the right one.
    std::int32_t operator()(std::int32_t from, std::int32_t to) const {
        return std::lower_bound(edges_.begin(), edges_.end(), CoverageEdge{from, to, 0}, before)
            ->net;
    }

private:
    struct CoverageEdge {
        std::int32_t from, to, net;
    };
    static bool before(const CoverageEdge& a, const CoverageEdge& b) {
        return std::tie(a.from, a.to) < std::tie(b.from, b.to);
    }
    std::int32_t& net(std::int32_t from, std::int32_t to) {
        return std::lower_bound(edges_.begin(), edges_.end(), CoverageEdge{from, to, 0}, before)
            ->net;
    }

    void add_along(std::int32_t from, std::int32_t to, std::int32_t value) {
        while (from != to) {
            const std::int32_t next = next_towards(from, to);
            net(from, next) += value;
            net(next, from) -= value;
            from = next;
        }
    }
    /// The far end of the edge that leaves `from` straight towards `to`.
    std::int32_t next_towards(std::int32_t from, std::int32_t to) const {
        auto edge =
            std::lower_bound(edges_.begin(), edges_.end(), CoverageEdge{from, to, 0}, before);
        if (edge != edges_.end() && edge->from == from && edge->to == to) return to;
        const auto& p = at(from);
        const auto& q = at(to);
        for (edge =
                 std::lower_bound(edges_.begin(), edges_.end(), CoverageEdge{from, -1, 0}, before);
             edge != edges_.end() && edge->from == from; ++edge) {
            const auto& r = at(edge->to);
            const bool ahead = (q[0] > p[0]) == (r[0] > p[0]) && (q[0] < p[0]) == (r[0] < p[0]) &&
                               (q[1] > p[1]) == (r[1] > p[1]) && (q[1] < p[1]) == (r[1] < p[1]);
            if (ahead && exact::orient2d(p, q, r) == 0) return edge->to;
        }
        return to;  // not reached: every segment is a chain of edges
    }
    const meshing::PlanPoint& at(std::int32_t i) const {
        return points_[static_cast<std::size_t>(i)];
    }

    const std::vector<meshing::PlanPoint>& points_;
    std::vector<CoverageEdge> edges_;
};

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
    const NetAlongEdges net(mesh, points, segments, border);

    // Whatever has a corner of the frame lies outside of everything.
    constexpr std::int32_t kUnknown = std::numeric_limits<std::int32_t>::min();
    FrameTriangles result;
    result.covered.assign(mesh.triangles.size(), kUnknown);
    std::vector<std::size_t> to_visit;
    const std::int32_t corner = local(frame[0]);
    for (std::size_t t = 0; t < mesh.triangles.size() && to_visit.empty(); ++t) {
        const auto& v = mesh.triangles[t];
        if (v[0] != corner && v[1] != corner && v[2] != corner) continue;
        result.covered[t] = 0;
        to_visit.push_back(t);
    }
    while (!to_visit.empty()) {
        const std::size_t t = to_visit.back();
        to_visit.pop_back();
        for (std::size_t i = 0; i < 3; ++i) {
            if (mesh.neighbors[t][i] < 0) continue;
            const auto n = static_cast<std::size_t>(mesh.neighbors[t][i]);
            if (result.covered[n] != kUnknown) continue;
            const std::int32_t step =
                mesh.constrained[t][i] ? net(mesh.triangles[t][i], mesh.triangles[t][(i + 1) % 3])
                                       : 0;
            result.covered[n] = result.covered[t] - step;
            to_visit.push_back(n);
        }
    }
    for (const auto& triangle : mesh.triangles) {
        PlanTriangle v;
        for (std::size_t i = 0; i < 3; ++i)
            v[i] = used[static_cast<std::size_t>(triangle[i])];
        result.triangles.push_back(v);
    }
    return result;
}

}  // namespace realmodel::strata
