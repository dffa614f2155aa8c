// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrangement/triangle_regions.hpp"

#include <algorithm>
#include <cassert>
#include <set>

#include "exact/space_predicates.hpp"

namespace realmodel::arrangement {

namespace {

struct HalfEdge {
    SpacePointId from, to;
    std::size_t origin;  ///< the position of `from` among the nodes
    std::int32_t next = -1, loop = -1;
};

/// The faces of a plane graph by its half-edges: 2 i and 2 i + 1 are those of edge i.
class PlaneGraph {
public:
    PlaneGraph(const exact::SpacePoints& points, const Projection& view,
               const std::vector<std::array<SpacePointId, 2>>& edges)
        : points_(points), view_(view) {
        assert(std::is_sorted(edges.begin(), edges.end()));
        for (const auto& edge : edges)
            nodes_.insert(nodes_.end(), edge.begin(), edge.end());
        std::sort(nodes_.begin(), nodes_.end());
        nodes_.erase(std::unique(nodes_.begin(), nodes_.end()), nodes_.end());
        leaving_.resize(nodes_.size());
        for (const auto& [a, b] : edges) {
            for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)}) {
                const std::size_t origin = position(from);
                leaving_[origin].push_back(static_cast<std::int32_t>(halves_.size()));
                halves_.push_back({from, to, origin});
            }
        }
    }

    std::vector<RegionLoops> regions() {
        link();
        trace_loops();
        find_components();
        std::vector<RegionLoops> regions;
        region_of_.assign(loops_.size(), -1);
        for (std::size_t i = 0; i < loops_.size(); ++i) {
            if (is_outer_[i]) continue;
            region_of_[i] = static_cast<std::int32_t>(regions.size());
            regions.push_back({loops_[i]});
        }
        if (leftmost_.size() > 1) add_holes(regions);
        return regions;
    }

private:
    static std::int32_t twin(std::int32_t h) { return h ^ 1; }
    const HalfEdge& half(std::int32_t h) const { return halves_[index(h)]; }
    std::size_t position(SpacePointId node) const {
        return static_cast<std::size_t>(std::lower_bound(nodes_.begin(), nodes_.end(), node) -
                                        nodes_.begin());
    }
    int orientation(SpacePointId a, SpacePointId b, SpacePointId c) const {
        return view_.facing * exact::orient2d(points_, view_.axis, a, b, c);
    }
    /// From left to right, then from below: the triangle turns left in this view.
    bool is_before(SpacePointId p, SpacePointId q) const {
        const int x = exact::compare(points_, (view_.axis + 1) % 3, p, q);
        return x != 0 ? x < 0
                      : view_.facing * exact::compare(points_, (view_.axis + 2) % 3, p, q) < 0;
    }

    void link();
    void trace_loops();
    void find_components();
    void add_holes(std::vector<RegionLoops>& regions) const;
    bool is_below(std::int32_t g, std::int32_t h) const;

    const exact::SpacePoints& points_;
    Projection view_;
    std::vector<SpacePointId> nodes_;  ///< in order
    std::vector<HalfEdge> halves_;
    std::vector<std::vector<std::int32_t>> leaving_;  ///< of nodes: counter-clockwise
    std::vector<std::vector<SpacePointId>> loops_;
    std::vector<std::size_t> leftmost_;    ///< of components: the position of their first node
    std::vector<std::int32_t> outer_;      ///< of components: the loop around them
    std::vector<bool> is_outer_;           ///< of loops
    std::vector<std::int32_t> region_of_;  ///< of loops, -1 of outer ones
};

/// Sorts the half-edges that leave each node from straight down on, and links those that follow.
void PlaneGraph::link() {
    for (auto& out : leaving_) {
        std::sort(out.begin(), out.end(), [&](std::int32_t a, std::int32_t b) {
            const HalfEdge &g = half(a), &h = half(b);
            const bool left_g = is_before(g.to, g.from), left_h = is_before(h.to, h.from);
            if (left_g != left_h) return left_h;
            return orientation(g.from, g.to, h.to) > 0;
        });
        // arriving against out[i], the edge that follows is the one clockwise of it
        for (std::size_t i = 0; i < out.size(); ++i)
            halves_[index(twin(out[i]))].next = out[(i + out.size() - 1) % out.size()];
    }
}

void PlaneGraph::trace_loops() {
    for (std::size_t start = 0; start < halves_.size(); ++start) {
        if (halves_[start].loop >= 0) continue;
        const auto number = static_cast<std::int32_t>(loops_.size());
        auto& loop = loops_.emplace_back();
        for (std::size_t h = start; halves_[h].loop < 0; h = index(halves_[h].next)) {
            halves_[h].loop = number;
            loop.push_back(halves_[h].from);
        }
    }
}

/// The connected components, and the loop around each.
void PlaneGraph::find_components() {
    is_outer_.assign(loops_.size(), false);
    std::vector<bool> found(nodes_.size(), false);
    for (std::size_t start = 0; start < nodes_.size(); ++start) {
        if (found[start]) continue;
        std::vector<std::size_t> open{start};
        found[start] = true;
        std::size_t first = start;
        while (!open.empty()) {
            const std::size_t at = open.back();
            open.pop_back();
            if (is_before(nodes_[at], nodes_[first])) first = at;
            for (const std::int32_t h : leaving_[at]) {
                const std::size_t to = half(twin(h)).origin;
                if (!found[to]) open.push_back(to);
                found[to] = true;
            }
        }
        // at the leftmost node nothing leaves to the left: that sector is outside
        leftmost_.push_back(first);
        outer_.push_back(half(leaving_[first].back()).loop);
        is_outer_[index(outer_.back())] = true;
    }
}

/// Whether one of two half-edges to the right is below the other where both are above one another.
bool PlaneGraph::is_below(std::int32_t g, std::int32_t h) const {
    const HalfEdge &e = half(g), &f = half(h);
    if (e.from == f.from) return orientation(e.from, e.to, f.to) > 0;
    return is_before(e.from, f.from) ? orientation(e.from, e.to, f.from) > 0
                                     : orientation(f.from, f.to, e.from) < 0;
}

/// Gives the outer loops of components to the regions around them: a line that sweeps from left to
/// right keeps the edges that it meets from below to above, and of each component that it comes to
/// finds the edge below its leftmost node. (M. I. Shamos and D. Hoey, "Geometric intersection
/// problems", 1976; edges here meet at nodes only.)
void PlaneGraph::add_holes(std::vector<RegionLoops>& regions) const {
    std::vector<std::size_t> order(nodes_.size());
    for (std::size_t i = 0; i < order.size(); ++i)
        order[i] = i;
    std::sort(order.begin(), order.end(),
              [this](std::size_t p, std::size_t q) { return is_before(nodes_[p], nodes_[q]); });
    std::vector<std::int32_t> component(nodes_.size(), -1);  // of leftmost nodes
    for (std::size_t c = 0; c < leftmost_.size(); ++c)
        component[leftmost_[c]] = static_cast<std::int32_t>(c);
    std::vector<std::int32_t> around(loops_.size(), -1);  // of outer loops: the region
    const auto less = [this](std::int32_t g, std::int32_t h) { return g != h && is_below(g, h); };
    std::set<std::int32_t, decltype(less)> met(less);
    for (const std::size_t at : order) {
        for (const std::int32_t h : leaving_[at]) {
            if (is_before(half(h).to, half(h).from)) met.erase(twin(h));
        }
        if (component[at] >= 0) {
            // none of its edges is met yet: the first of them stands for the node
            const auto above = met.lower_bound(leaving_[at].front());
            const std::int32_t outer = outer_[index(component[at])];
            if (above != met.begin()) {
                const std::int32_t loop = half(*std::prev(above)).loop;
                around[index(outer)] =
                    region_of_[index(loop)] >= 0 ? region_of_[index(loop)] : around[index(loop)];
            }
        }
        for (const std::int32_t h : leaving_[at]) {
            if (is_before(half(h).from, half(h).to)) met.insert(h);
        }
    }
    for (const std::int32_t outer : outer_) {
        if (around[index(outer)] >= 0)
            regions[index(around[index(outer)])].push_back(loops_[index(outer)]);
    }
}

}  // namespace

std::vector<RegionLoops> regions_of_graph(const exact::SpacePoints& points, const Projection& view,
                                          const std::vector<std::array<SpacePointId, 2>>& edges) {
    return PlaneGraph(points, view, edges).regions();
}

}  // namespace realmodel::arrangement
