// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrangement/triangle_regions.hpp"

#include <algorithm>
#include <cassert>
#include <set>

#include "base/algorithms.hpp"
#include "exact/space_points.hpp"

namespace realmodel::arrangement {

void PlaneGraph::add_regions(const Projection& view,
                             const std::vector<std::array<SpacePointId, 2>>& edges,
                             LoopTable<SpacePointId>& regions) {
    view_ = view;
    take(edges);
    link();
    trace_loops();
    find_components();
    region_of_.assign(is_outer_.size(), -1);
    std::int32_t count = 0;
    for (std::size_t i = 0; i < is_outer_.size(); ++i) {
        if (is_outer_[i] == 0) region_of_[i] = count++;
    }
    holes_.clear();
    if (leftmost_.size() > 1) find_holes();
    auto hole = holes_.begin();
    for (std::size_t i = 0; i < is_outer_.size(); ++i) {
        if (is_outer_[i] != 0) continue;
        regions.add_loop(loop(i));
        for (; hole != holes_.end() && hole->first == region_of_[i]; ++hole)
            regions.add_loop(loop(index(hole->second)));
        regions.end_region();
    }
}

std::size_t PlaneGraph::position(SpacePointId node) const {
    return static_cast<std::size_t>(std::lower_bound(nodes_.begin(), nodes_.end(), node) -
                                    nodes_.begin());
}

int PlaneGraph::orientation(SpacePointId a, SpacePointId b, SpacePointId c) const {
    return view_.facing * exact::orient2d(points_, view_.axis, a, b, c);
}

/// From left to right, then from below: the triangle turns left in this view.
bool PlaneGraph::is_before(SpacePointId p, SpacePointId q) const {
    const int x = exact::compare(points_, (view_.axis + 1) % 3, p, q);
    return x != 0 ? x < 0 : view_.facing * exact::compare(points_, (view_.axis + 2) % 3, p, q) < 0;
}

void PlaneGraph::take(const std::vector<std::array<SpacePointId, 2>>& edges) {
    assert(std::is_sorted(edges.begin(), edges.end()));
    nodes_.clear();
    for (const auto& edge : edges)
        nodes_.insert(nodes_.end(), edge.begin(), edge.end());
    sort_unique(nodes_);
    halves_.clear();
    first_leaving_.assign(nodes_.size() + 2, 0);
    for (const auto& [a, b] : edges) {
        for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)}) {
            const std::size_t origin = position(from);
            halves_.push_back({from, to, origin});
            ++first_leaving_[origin + 2];
        }
    }
    for (std::size_t node = 0; node < nodes_.size(); ++node)
        first_leaving_[node + 2] += first_leaving_[node + 1];
    leaving_.resize(halves_.size());
    for (std::size_t h = 0; h < halves_.size(); ++h)
        leaving_[first_leaving_[halves_[h].origin + 1]++] = static_cast<std::int32_t>(h);
}

/// Sorts the half-edges that leave each node from straight down on, and links those that follow.
void PlaneGraph::link() {
    for (std::size_t node = 0; node < nodes_.size(); ++node) {
        const auto out = leaving(node);
        std::sort(out.begin(), out.end(), [&](std::int32_t a, std::int32_t b) {
            const GraphHalfEdge &g = half(a), &h = half(b);
            const bool left_g = is_before(g.to, g.from), left_h = is_before(h.to, h.from);
            if (left_g != left_h) return left_h;
            return orientation(g.from, g.to, h.to) > 0;
        });
        // arriving against out[i], the edge that follows is the one clockwise of it
        for (std::size_t i = 0; i < out.size(); ++i)
            halves_[index(twin(out[i]))].next = out[(i + out.size() - 1) % out.size()];
    }
    assert(std::ranges::all_of(halves_, [this](const GraphHalfEdge& h) {
        return h.next >= 0 && half(h.next).from == h.to;
    }));
}

void PlaneGraph::trace_loops() {
    loop_nodes_.clear();
    loop_begins_.assign(1, 0);
    for (std::size_t start = 0; start < halves_.size(); ++start) {
        if (halves_[start].loop >= 0) continue;
        const auto number = static_cast<std::int32_t>(loop_begins_.size()) - 1;
        for (std::size_t h = start; halves_[h].loop < 0; h = index(halves_[h].next)) {
            halves_[h].loop = number;
            loop_nodes_.push_back(halves_[h].from);
        }
        loop_begins_.push_back(loop_nodes_.size());
    }
    assert(loop_nodes_.size() == halves_.size());
}

/// The connected components, and the loop around each.
void PlaneGraph::find_components() {
    leftmost_.clear();
    outer_.clear();
    is_outer_.assign(loop_begins_.size() - 1, 0);
    is_reached_.assign(nodes_.size(), 0);
    for (std::size_t start = 0; start < nodes_.size(); ++start) {
        if (is_reached_[start] != 0) continue;
        open_.assign(1, start);
        is_reached_[start] = 1;
        std::size_t first = start;
        while (!open_.empty()) {
            const std::size_t at = open_.back();
            open_.pop_back();
            if (is_before(nodes_[at], nodes_[first])) first = at;
            for (const std::int32_t h : leaving(at)) {
                const std::size_t to = half(twin(h)).origin;
                if (is_reached_[to] == 0) open_.push_back(to);
                is_reached_[to] = 1;
            }
        }
        // at the leftmost node nothing leaves to the left: that sector is outside
        leftmost_.push_back(first);
        outer_.push_back(half(leaving(first).back()).loop);
        assert(is_outer_[index(outer_.back())] == 0);
        is_outer_[index(outer_.back())] = 1;
    }
    // Euler: edges that met elsewhere than at nodes would leave too few faces
    assert(is_outer_.size() + nodes_.size() == halves_.size() / 2 + 2 * outer_.size());
}

/// Whether one of two half-edges to the right is below the other where both are above one another.
bool PlaneGraph::is_below(std::int32_t g, std::int32_t h) const {
    const GraphHalfEdge &e = half(g), &f = half(h);
    if (e.from == f.from) return orientation(e.from, e.to, f.to) > 0;
    return is_before(e.from, f.from) ? orientation(e.from, e.to, f.from) > 0
                                     : orientation(f.from, f.to, e.from) < 0;
}

/// Finds the regions around the outer loops of components: a line that sweeps from left to
/// right keeps the edges that it meets from below to above, and of each component that it comes to
/// finds the edge below its leftmost node. (M. I. Shamos and D. Hoey, "Geometric intersection
/// problems", 1976; edges here meet at nodes only.)
void PlaneGraph::find_holes() {
    std::vector<std::size_t> order(nodes_.size());
    for (std::size_t i = 0; i < order.size(); ++i)
        order[i] = i;
    std::sort(order.begin(), order.end(),
              [this](std::size_t p, std::size_t q) { return is_before(nodes_[p], nodes_[q]); });
    std::vector<std::int32_t> component(nodes_.size(), -1);  // of leftmost nodes
    for (std::size_t c = 0; c < leftmost_.size(); ++c)
        component[leftmost_[c]] = static_cast<std::int32_t>(c);
    std::vector<std::int32_t> around(is_outer_.size(), -1);  // of outer loops: the region
    const auto less = [this](std::int32_t g, std::int32_t h) { return g != h && is_below(g, h); };
    std::set<std::int32_t, decltype(less)> met(less);
    for (const std::size_t at : order) {
        for (const std::int32_t h : leaving(at)) {
            if (is_before(half(h).to, half(h).from)) met.erase(twin(h));
        }
        if (component[at] >= 0) {
            // none of its edges is met yet: the first of them stands for the node
            const auto above = met.lower_bound(leaving(at).front());
            const std::int32_t outer = outer_[index(component[at])];
            if (above != met.begin()) {
                const std::int32_t loop = half(*std::prev(above)).loop;
                around[index(outer)] =
                    region_of_[index(loop)] >= 0 ? region_of_[index(loop)] : around[index(loop)];
            }
        }
        for (const std::int32_t h : leaving(at)) {
            if (is_before(half(h).from, half(h).to)) met.insert(h);
        }
    }
    assert(met.empty());
    for (const std::int32_t outer : outer_) {
        if (around[index(outer)] >= 0) holes_.push_back({around[index(outer)], outer});
    }
    std::ranges::stable_sort(holes_, {}, &std::pair<std::int32_t, std::int32_t>::first);
}

}  // namespace realmodel::arrangement
