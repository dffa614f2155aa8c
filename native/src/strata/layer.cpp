// SPDX-License-Identifier: GPL-3.0-or-later
#include "layer.hpp"

#include <algorithm>
#include <compare>
#include <string>

#include "parallel_sort.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/meshing/triangulation.hpp"
#include "single_elements.hpp"

namespace realmodel::strata {

using exact::PlanGeometry;
using exact::VertexId;

namespace {

struct PlanEdge {
    VertexId low, high;  // plan vertices, low < high
    friend auto operator<=>(const PlanEdge&, const PlanEdge&) = default;
};

VertexId next_vertex(PolygonView polygon, std::size_t i) {
    return polygon[i + 1 < polygon.size() ? i + 1 : 0].point;
}

void add_triangle(PlanGeometry& geometry, PolygonPool& pool, const std::array<VertexId, 3>& v) {
    const Corner corners[] = {{v[0], geometry.add_edge(v[0], v[1])},
                              {v[1], geometry.add_edge(v[1], v[2])},
                              {v[2], geometry.add_edge(v[2], v[0])}};
    pool.add(corners);
}

/// The edges that only one polygon has, ascending.
std::vector<PlanEdge> border_edges(const PolygonPool& polygons, int threads,
                                   const Progress* progress) {
    std::vector<PlanEdge> edges;
    edges.reserve(polygons.corners.size());
    for (std::size_t t = 0; t < polygons.size(); ++t) {
        for (std::size_t i = 0; i < polygons[t].size(); ++i) {
            const VertexId from = polygons[t][i].point, to = next_vertex(polygons[t], i);
            edges.push_back({std::min(from, to), std::max(from, to)});
        }
    }
    parallel_sort(edges, std::less<>(), threads, progress);
    keep_single(edges);
    return edges;
}

/// Covers what the polygons leave of the frame with void triangles (plane `empty`): a constrained
/// Delaunay triangulation of their border edges, of which only whole components can be covered. The
/// grid of the polygons must be there; it does not know the void triangles.
void fill_frame(PlanGeometry& geometry, Layer& layer, const std::vector<PlanEdge>& border,
                const Frame& frame, PlaneId empty) {
    std::vector<VertexId> used(frame.begin(), frame.end());
    for (const PlanEdge& edge : border) {
        used.push_back(edge.low);
        used.push_back(edge.high);
    }
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
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
    for (const PlanEdge& edge : border)
        segments.push_back({local(edge.low), local(edge.high)});
    const auto fill = meshing::constrained_delaunay(points, segments);

    const auto vertices_of = [&](std::size_t t) {
        std::array<VertexId, 3> v;
        for (std::size_t i = 0; i < 3; ++i) {
            v[i] = used[static_cast<std::size_t>(fill.triangles[t][i])];
        }
        return v;
    };

    std::vector<std::int8_t> state(fill.triangles.size(), -1);  // 1 void, 0 covered, -1 unknown
    std::vector<std::size_t> pending;
    std::vector<std::int32_t> candidates;
    for (std::size_t seed = 0; seed < state.size(); ++seed) {
        if (state[seed] >= 0) continue;
        PolygonPool one;
        add_triangle(geometry, one, vertices_of(seed));
        Scope scope(geometry);
        Clipper clipper(scope);
        layer.grid.candidates(scope, one[0], candidates);
        const bool covered = std::any_of(candidates.begin(), candidates.end(), [&](std::int32_t c) {
            return clipper.overlap(one[0], layer.polygons[static_cast<std::size_t>(c)]);
        });
        const std::int8_t mark = covered ? 0 : 1;
        pending.assign(1, seed);
        state[seed] = mark;
        while (!pending.empty()) {
            const std::size_t t = pending.back();
            pending.pop_back();
            for (std::size_t i = 0; i < 3; ++i) {
                const std::int32_t n = fill.neighbours[t][i];
                if (n < 0 || fill.constrained[t][i] || state[static_cast<std::size_t>(n)] >= 0)
                    continue;
                state[static_cast<std::size_t>(n)] = mark;
                pending.push_back(static_cast<std::size_t>(n));
            }
        }
    }
    for (std::size_t t = 0; t < state.size(); ++t) {
        if (state[t] != 1) continue;
        add_triangle(geometry, layer.polygons, vertices_of(t));
        layer.plane.push_back(empty);
    }
}

[[noreturn]] void refuse_overlap(Scope& scope, const Layer& layer,
                                 const std::vector<UsedTriangle>& triangles, std::size_t one,
                                 std::size_t other, int index) {
    Clipper clipper(scope);
    const PolygonView common = clipper.intersect(layer.polygons[one], layer.polygons[other]);
    std::array<double, 3> place{0, 0, 0};
    const auto share = 1.0 / static_cast<double>(common.size());
    for (const Corner& corner : common) {
        const auto& p = scope.point(corner.point);
        place[0] += p.x * share;
        place[1] += p.y * share;
        place[2] += scope.rounded_height(layer.plane[one], corner.point) * share;
    }
    throw InputError("double_valued",
                     "triangles " + std::to_string(triangles[one].number) + " and " +
                         std::to_string(triangles[other].number) +
                         " overlap in plan: the surface has two heights there",
                     index, {triangles[one].number, triangles[other].number}, place);
}

void check_single_valued(const PlanGeometry& geometry, const Layer& layer,
                         const std::vector<UsedTriangle>& triangles, int index, int threads,
                         const Progress* progress) {
    constexpr std::size_t kChunk = 1024;
    parallel_chunks(
        (triangles.size() + kChunk - 1) / kChunk, threads, progress, [&](std::size_t chunk) {
            Scope scope(geometry);
            Clipper clipper(scope);
            std::vector<std::int32_t> candidates;
            const std::size_t end = std::min(triangles.size(), (chunk + 1) * kChunk);
            for (std::size_t t = chunk * kChunk; t < end; ++t) {
                layer.grid.candidates(scope, layer.polygons[t], candidates);
                for (const std::int32_t c : candidates) {
                    const auto other = static_cast<std::size_t>(c);
                    if (other > t && clipper.overlap(layer.polygons[t], layer.polygons[other])) {
                        refuse_overlap(scope, layer, triangles, t, other, index);
                    }
                }
            }
        });
}

}  // namespace

void Layer::index(const PlanGeometry& geometry, const Progress* progress) {
    const Scope scope(geometry);
    grid = PlanGrid(scope, polygons, progress);
}

Layer make_layer(PlanGeometry& geometry, const std::vector<UsedTriangle>& triangles,
                 const Frame& frame, int index, int threads, const Progress* progress) {
    Layer layer;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        poll(progress, t);
        std::array<VertexId, 3> v;
        for (std::size_t i = 0; i < 3; ++i)
            v[i] = geometry.space(triangles[t].corner[i]).plan;
        add_triangle(geometry, layer.polygons, v);
        layer.plane.push_back(geometry.add_plane(triangles[t].corner));
    }
    layer.index(geometry, progress);
    check_single_valued(geometry, layer, triangles, index, threads, progress);
    fill_frame(geometry, layer, border_edges(layer.polygons, threads, progress), frame, kVoid);
    layer.index(geometry, progress);
    return layer;
}

Layer make_region(PlanGeometry& geometry, const std::vector<std::array<VertexId, 3>>& triangles,
                  const Frame& frame, int threads, const Progress* progress) {
    Layer layer;
    for (const auto& triangle : triangles) {
        add_triangle(geometry, layer.polygons, triangle);
        layer.plane.push_back(kSky);
    }
    layer.index(geometry, progress);
    fill_frame(geometry, layer, border_edges(layer.polygons, threads, progress), frame, kOutside);
    return layer;
}

}  // namespace realmodel::strata
