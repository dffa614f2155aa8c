// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/booleans/intersect.hpp"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <utility>

#include "base/algorithms.hpp"
#include "base/disjoint_sets.hpp"
#include "base/parallel.hpp"
#include "base/parallel_counts.hpp"
#include "booleans/facets.hpp"
#include "booleans/refinement.hpp"
#include "exact/double_double_interval.hpp"

namespace realmodel::booleans {

namespace {

using exact::DoubleDoubleInterval;

/// Whether a surface has no border: it passes each edge as often one way as the other.
std::array<bool, 2> closed_surfaces(const FacetMesh& mesh, const Execution& execution) {
    std::array<std::uint8_t, 2> is_open{0, 0};
    const auto look_at = [&](std::size_t e) {
        std::array<int, 2> net{0, 0};
        for (const arrangement::EdgeUse& use : mesh.edges[e]) {
            const Facet& facet = mesh.facets[index(use.item)];
            for (std::size_t source = 0; source < 2; ++source)
                net[source] += use.direction * facet.times[source];
        }
        for (std::size_t source = 0; source < 2; ++source) {
            if (net[source] != 0) atomic_set(is_open[source]);
        }
    };
    parallel_for_each(mesh.edges.size(), execution, look_at);
    return {is_open[0] == 0, is_open[1] == 0};
}

/// Whether the winding of each closed surface changes with each facet by how often that is one of
/// its pieces: around each edge all changes add up to zero.
[[maybe_unused]] bool are_wound(const FacetMesh& mesh, const FacetCells& cells,
                                const std::array<bool, 2>& is_closed) {
    for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
        const auto& [below, above] = cells.of_facet[f];
        for (std::size_t source = 0; source < 2; ++source) {
            if (is_closed[source] &&
                cells.winding[index(below)][source] - cells.winding[index(above)][source] !=
                    mesh.facets[f].times[source])
                return false;
        }
    }
    return true;
}

/// The components of each surface that hang together across edges that are in no loop.
void find_sub_surfaces(const RefinedTriangles& refined, const FacetMesh& mesh,
                       const IntersectionLoops& loops, const FacetCells& cells, Refinement& result,
                       const Execution& execution) {
    const std::size_t count = mesh.facets.size();
    // a facet of both surfaces is in a sub-surface of either
    DisjointSets joined(2 * count);
    const auto side_of = [](std::int32_t facet, std::size_t source) {
        return 2 * facet + static_cast<std::int32_t>(source);
    };
    const auto join_along = [&](std::size_t e) {
        if (loops.of_edge[e] >= 0) return;
        std::array<std::int32_t, 2> first{-1, -1};
        for (const arrangement::EdgeUse& use : mesh.edges[e]) {
            for (std::size_t source = 0; source < 2; ++source) {
                if (!mesh.facets[index(use.item)].is_of[source]) continue;
                std::int32_t& other = first[source];
                if (other < 0) {
                    other = side_of(use.item, source);
                } else {
                    joined.join(other, side_of(use.item, source));
                }
            }
        }
    };
    parallel_for_each(mesh.edges.size(), execution, join_along);
    std::vector<std::int32_t> root(refined.triangles.size()), number(2 * count, -1);
    parallel_for_each(root.size(), execution, [&](std::size_t t) {
        root[t] = joined.find(side_of(mesh.of_piece[t], refined.triangles[t].source));
    });
    for (std::size_t t = 0; t < root.size(); ++t) {
        poll(execution.progress, t);
        std::int32_t& sub_surface = number[index(root[t])];
        if (sub_surface < 0) {
            sub_surface = static_cast<std::int32_t>(result.sub_surfaces.size());
            const auto& [below, above] = cells.of_facet[index(mesh.of_piece[t])];
            const bool is_between =
                below != above && below != FacetCells::kOutside && above != FacetCells::kOutside;
            result.sub_surfaces.push_back({refined.triangles[t].source, {}, {}, is_between});
        }
        result.sub_surfaces[index(sub_surface)].triangles.push_back(static_cast<std::int32_t>(t));
    }
    for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
        poll(execution.progress, e);
        if (loops.of_edge[e] < 0) continue;
        for (const arrangement::EdgeUse& use : mesh.edges[e]) {
            for (std::size_t source = 0; source < 2; ++source) {
                if (!mesh.facets[index(use.item)].is_of[source]) continue;
                const std::int32_t sub_surface =
                    number[index(joined.find(side_of(use.item, source)))];
                result.sub_surfaces[index(sub_surface)].loops.push_back(loops.of_edge[e]);
            }
        }
    }
    for (SubSurface& sub_surface : result.sub_surfaces)
        sort_unique(sub_surface.loops);
}

void find_sub_blocks(const FacetMesh& mesh, const FacetCells& cells, Refinement& result,
                     Progress* progress) {
    result.sub_blocks.resize(cells.size() - 1);
    std::vector<std::size_t> facets(cells.size());
    for (const auto& [below, above] : cells.of_facet) {
        if (below == above) continue;
        ++facets[index(below)];
        ++facets[index(above)];
    }
    for (std::size_t i = 0; i < result.sub_blocks.size(); ++i)
        result.sub_blocks[i].triangles.reserve(facets[i + 1]);
    for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
        poll(progress, f);
        const auto& [below, above] = cells.of_facet[f];
        if (below == above) continue;
        const auto& [a, b, c] = mesh.facets[f].corners;
        if (below != FacetCells::kOutside)
            result.sub_blocks[index(below) - 1].triangles.push_back({a, b, c});
        if (above != FacetCells::kOutside)
            result.sub_blocks[index(above) - 1].triangles.push_back({a, c, b});
    }
    for (std::size_t i = 0; i < result.sub_blocks.size(); ++i) {
        for (std::size_t source = 0; source < 2; ++source)
            result.sub_blocks[i].is_in[source] =
                result.is_closed[source] && cells.winding[i + 1][source] != 0;
    }
}

/// The vertices and triangles, and what these are inside of.
void write_triangles(const RefinedTriangles& refined, const FacetMesh& mesh,
                     const FacetCells& cells, Refinement& result, const Execution& execution) {
    const std::size_t count = refined.triangles.size();
    result.vertices.resize(3 * refined.vertices.size());
    std::memcpy(result.vertices.data(), refined.vertices.data(),
                sizeof(double) * result.vertices.size());
    result.triangles.resize(count);
    result.source.resize(count);
    result.source_triangle.resize(count);
    result.is_in.resize(count);
    parallel_for_each(count, execution, [&](std::size_t t) {
        result.triangles[t] = refined.triangles[t].corners;
        result.source[t] = refined.triangles[t].source;
        result.source_triangle[t] = refined.triangles[t].origin;
        // the first piece of a facet is turned as that is, the others are not asked
        const auto& sides = cells.of_facet[index(mesh.of_piece[t])];
        for (std::size_t side = 0; side < 2; ++side) {
            for (std::size_t source = 0; source < 2; ++source)
                result.is_in[t][source][side] =
                    result.is_closed[source] && cells.winding[index(sides[side])][source] != 0;
        }
    });
}

bool is_in_result(Operation operation, bool in_first, bool in_second) {
    switch (operation) {
        case Operation::kUnion:
            return in_first || in_second;
        case Operation::kIntersection:
            return in_first && in_second;
        case Operation::kDifference:
            return in_first && !in_second;
        default:
            return in_second && !in_first;
    }
}

}  // namespace

Refinement intersect(const TriangleView& first, const TriangleView& second,
                     const Execution& execution) {
    const RefinedTriangles refined = refine({first, second}, execution);
    begin_phase(execution.progress, 0.8, 0.9, "finding facets");
    FacetMesh mesh = facets_of(refined, execution);
    begin_phase(execution.progress, 0.9, 0.99, "finding what is inside");
    const FacetCells cells = cells_of(refined.vertices, mesh, execution);
    IntersectionLoops loops = find_loops(mesh, refined.vertices.size(), execution);
    Refinement result;
    result.is_closed = closed_surfaces(mesh, execution);
    assert(are_wound(mesh, cells, result.is_closed));
    parallel_tasks(3, execution, 0.01, [&](std::size_t task, const Execution& task_execution) {
        if (task == 0) {
            find_sub_surfaces(refined, mesh, loops, cells, result, task_execution);
        } else if (task == 1) {
            find_sub_blocks(mesh, cells, result, task_execution.progress);
        } else {
            write_triangles(refined, mesh, cells, result, task_execution);
        }
    });
    result.loops = std::move(loops.loops);
    result.coinciding = std::move(mesh.first_piece);
    if (execution.progress != nullptr) execution.progress->report(1.0, nullptr);
    return result;
}

std::vector<std::array<std::int32_t, 3>> Refinement::boundary(Operation operation) const {
    for (int surface = 0; surface < 2; ++surface) {
        if (!is_closed[static_cast<std::size_t>(surface)])
            throw InputError("not_closed",
                             "the surface is open, and only solids can be joined or cut out; "
                             "divide it, or close its border",
                             surface);
    }
    std::vector<std::array<std::int32_t, 3>> result;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        if (coinciding[t] != static_cast<std::int32_t>(t)) continue;
        const auto& [in_first, in_second] = is_in[t];
        const bool below = is_in_result(operation, in_first[0], in_second[0]);
        const bool above = is_in_result(operation, in_first[1], in_second[1]);
        if (below == above) continue;
        const auto& [a, b, c] = triangles[t];
        result.push_back(below ? std::array{a, b, c} : std::array{a, c, b});
    }
    return result;
}

double Refinement::volume(const SubBlock& block) const {
    const auto at = [&](std::int32_t vertex, std::size_t axis) {
        const auto first = index(block.triangles[0][0]);
        return DoubleDoubleInterval::difference(vertices[3 * index(vertex) + axis],
                                                vertices[3 * first + axis]);
    };
    DoubleDoubleInterval sum = 0.0;  // six times the volume
    for (const auto& t : block.triangles) {
        std::array<std::array<DoubleDoubleInterval, 3>, 3> p;
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t k = 0; k < 3; ++k)
                p[i][k] = at(t[i], k);
        }
        sum = sum + (p[0][0] * (p[1][1] * p[2][2] - p[1][2] * p[2][1]) -
                     p[0][1] * (p[1][0] * p[2][2] - p[1][2] * p[2][0]) +
                     p[0][2] * (p[1][0] * p[2][1] - p[1][1] * p[2][0]));
    }
    return (sum.high + sum.low) / 6;
}

}  // namespace realmodel::booleans
