// SPDX-License-Identifier: GPL-3.0-or-later
#include "booleans/loops.hpp"

#include <cassert>
#include <utility>

#include "base/counting_sort.hpp"
#include "base/parallel.hpp"

namespace realmodel::booleans {

namespace {

bool is_intersection(const FacetMesh& mesh, std::size_t edge) {
    bool of_first = false, of_second = false, of_one = false;
    for (const arrangement::EdgeUse& use : mesh.edges[edge]) {
        const auto& is_of = mesh.facets[index(use.item)].is_of;
        of_first = of_first || is_of[0];
        of_second = of_second || is_of[1];
        of_one = of_one || is_of[0] != is_of[1];
    }
    return of_first && of_second && of_one;
}

/// The intersection edges as a graph.
class LoopGraph {
public:
    LoopGraph(const FacetMesh& mesh, std::size_t vertices, const Execution& execution)
        : mesh_(mesh) {
        result_.of_edge.assign(mesh.edges.size(), -1);
        std::vector<std::uint8_t> is_in_loop(mesh.edges.size());
        parallel_each(mesh.edges.size(), execution,
                      [&](std::size_t e) { is_in_loop[e] = is_intersection(mesh, e); });
        edges_at_ = bucketize<std::int32_t>(vertices, [&](const auto& put) {
            for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
                poll(execution.progress, e);
                if (is_in_loop[e] == 0) continue;
                for (const std::int32_t v : mesh.edges.ends(e))
                    put(index(v), static_cast<std::int32_t>(e));
            }
        });
    }

    /// First the paths between vertices that have not two edges, then the cycles of those that do.
    IntersectionLoops run(Progress* progress) {
        for (const bool paths : {true, false}) {
            for (std::size_t v = 0; v < edges_at_.size(); ++v) {
                poll(progress, v);
                for (const std::int32_t edge : edges_at_[v]) {
                    const auto vertex = static_cast<std::int32_t>(v);
                    if (result_.of_edge[index(edge)] < 0 && (degree(vertex) != 2) == paths)
                        follow(vertex, edge);
                }
            }
        }
        return std::move(result_);
    }

private:
    std::size_t degree(std::int32_t vertex) const { return edges_at_[index(vertex)].size(); }
    void follow(std::int32_t start, std::int32_t edge) {
        const auto number = static_cast<std::int32_t>(result_.loops.size());
        IntersectionLoop loop{LoopKind::kOpen, {start}};
        for (std::int32_t at = start;;) {
            assert(result_.of_edge[index(edge)] < 0);  // each edge is in one loop
            result_.of_edge[index(edge)] = number;
            const auto& ends = mesh_.edges.ends(index(edge));
            at = ends[0] == at ? ends[1] : ends[0];
            if (at == start && degree(at) == 2) {
                loop.kind = LoopKind::kHardClosed;
                break;
            }
            loop.vertices.push_back(at);
            if (degree(at) != 2) {
                if (degree(start) > 2 && degree(at) > 2) loop.kind = LoopKind::kSoftClosed;
                break;
            }
            const auto both = edges_at_[index(at)];
            edge = both[0] == edge ? both[1] : both[0];
        }
        result_.loops.push_back(std::move(loop));
    }

    const FacetMesh& mesh_;
    IntersectionLoops result_;
    Buckets<std::int32_t> edges_at_;  ///< of vertices: intersection edges
};

}  // namespace

IntersectionLoops find_loops(const FacetMesh& mesh, std::size_t vertices,
                             const Execution& execution) {
    return LoopGraph(mesh, vertices, execution).run(execution.progress);
}

}  // namespace realmodel::booleans
