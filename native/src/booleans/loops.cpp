// SPDX-License-Identifier: GPL-3.0-or-later
#include "booleans/loops.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

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
    LoopGraph(const FacetMesh& mesh, Progress* progress) : mesh_(mesh), progress_(progress) {
        result_.of_edge.assign(mesh.edges.size(), -1);
        for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
            poll(progress_, e);
            if (!is_intersection(mesh, e)) continue;
            for (const std::int32_t v : mesh.edges.ends(e))
                ends_.emplace_back(v, static_cast<std::int32_t>(e));
        }
        std::sort(ends_.begin(), ends_.end());
    }

    /// First the paths between vertices that have not two edges, then the cycles of those that do.
    Loops run() {
        for (const bool paths : {true, false}) {
            for (const auto& [vertex, edge] : ends_) {
                poll(progress_, index(edge));
                if (result_.of_edge[index(edge)] < 0 && (degree(vertex) != 2) == paths)
                    follow(vertex, edge);
            }
        }
        return std::move(result_);
    }

private:
    using End = std::pair<std::int32_t, std::int32_t>;  ///< vertex, edge
    std::vector<End>::const_iterator first_of(std::int32_t vertex) const {
        return std::lower_bound(ends_.begin(), ends_.end(), End(vertex, 0));
    }
    std::size_t degree(std::int32_t vertex) const {
        std::size_t count = 0;
        for (auto end = first_of(vertex); end != ends_.end() && end->first == vertex; ++end)
            ++count;
        return count;
    }
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
            const auto first = first_of(at);
            assert(first->first == at && std::next(first)->first == at);
            edge = first->second == edge ? std::next(first)->second : first->second;
        }
        result_.loops.push_back(std::move(loop));
    }

    const FacetMesh& mesh_;
    Progress* progress_;
    Loops result_;
    std::vector<End> ends_;  ///< in order
};

}  // namespace

Loops find_loops(const FacetMesh& mesh, Progress* progress) {
    return LoopGraph(mesh, progress).run();
}

}  // namespace realmodel::booleans
