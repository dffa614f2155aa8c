// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/ear_ring.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "meshing/plan_predicates.hpp"
#include "meshing/point_insertion.hpp"

namespace realmodel::meshing {

EarRing::EarRing(std::span<const Ring> rings) {
    std::size_t corners = 0;
    for (const Ring& ring : rings)
        corners += ring.size();
    nodes.reserve(corners + 2 * rings.size());
    std::int32_t first_corner = 0;
    for (std::size_t r = 0; r < rings.size(); ++r) {
        const std::int32_t node = add_ring(rings[r], first_corner, r == 0);
        if (r == 0) {
            outline_ = node;
        } else {
            holes_.push_back(node);
        }
        first_corner += static_cast<std::int32_t>(rings[r].size());
    }
}

/// Returns the ring's leftmost node, the lowest of those.
std::int32_t EarRing::add_ring(const Ring& ring, std::int32_t first_corner, bool is_outline) {
    double area = 0;
    for (std::size_t i = 0; i + 1 < ring.size(); ++i)
        area += twice_area(ring[0], ring[i], ring[i + 1]);
    const bool turns = is_outline ? area < 0 : area > 0;
    const auto begin = static_cast<std::int32_t>(nodes.size());
    const auto count = static_cast<std::int32_t>(ring.size());
    for (std::int32_t i = 0; i < count; ++i) {
        const std::int32_t corner = turns ? count - 1 - i : i;
        const auto here = static_cast<std::int32_t>(nodes.size());
        if (here > begin && place(here - 1) == ring[corner]) continue;
        nodes.push_back({ring[corner], first_corner + corner, here - 1, here + 1});
    }
    while (static_cast<std::int32_t>(nodes.size()) > begin + 1 &&
           place(static_cast<std::int32_t>(nodes.size()) - 1) == place(begin)) {
        nodes.pop_back();
    }
    const auto last = static_cast<std::int32_t>(nodes.size()) - 1;
    nodes[begin].previous = last;
    nodes[last].next = begin;
    std::int32_t leftmost = begin;
    for (std::int32_t n = begin; n <= last; ++n)
        if (place(n) < place(leftmost)) leftmost = n;
    return leftmost;
}

bool EarRing::opens_towards(std::int32_t node, const PlanPoint& p) const {
    const PlanPoint &a = place(nodes[node].previous), &b = place(node),
                    &c = place(nodes[node].next);
    const bool left_of_first = orient2d(a, b, p) > 0, left_of_second = orient2d(b, c, p) > 0;
    return orient2d(a, b, c) > 0 ? left_of_first && left_of_second
                                 : left_of_first || left_of_second;
}

std::size_t EarRing::row_of(double y) const {
    const double row = std::floor((y - low_) / row_height_);
    return static_cast<std::size_t>(std::clamp(row, 0.0, static_cast<double>(rows_.size() - 1)));
}

void EarRing::enter_rows(std::int32_t node) {
    const double y = place(node)[1], z = place(nodes[node].next)[1];
    for (std::size_t row = row_of(std::min(y, z)); row <= row_of(std::max(y, z)); ++row)
        rows_[row].push_back(node);
}

bool EarRing::join_holes() {
    if (holes_.empty()) return true;
    low_ = std::numeric_limits<double>::infinity();
    double high = -low_;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        low_ = std::min(low_, place(static_cast<std::int32_t>(n))[1]);
        high = std::max(high, place(static_cast<std::int32_t>(n))[1]);
    }
    rows_.resize(std::clamp<std::size_t>(nodes.size() / 8, 1, 4096));
    row_height_ = (high - low_) / static_cast<double>(rows_.size());
    if (!(row_height_ > 0)) return false;
    std::int32_t node = outline_;
    do {
        enter_rows(node);
        node = nodes[node].next;
    } while (node != outline_);
    // What lies left of a hole is joined before it.
    std::ranges::sort(holes_, {}, [&](std::int32_t n) { return std::pair(place(n), n); });
    for (const std::int32_t hole : holes_) {
        const std::int32_t bridge = find_bridge(hole);
        if (bridge < 0) return false;
        join(hole, bridge);
    }
    return true;
}

/// The node that a hole's leftmost corner can see: left of it, the edge met first, and of its lower
/// left end and the corners that hide that the one nearest in direction.
std::int32_t EarRing::find_bridge(std::int32_t hole) const {
    const PlanPoint& from = place(hole);
    // Where the hole touches what is joined already, no bridge is needed.
    const PlanPoint& ahead = place(nodes[hole].next);
    double met = -std::numeric_limits<double>::infinity();
    std::int32_t edge = -1;
    for (const std::int32_t n : rows_[row_of(from[1])]) {
        const std::int32_t m = nodes[n].next;
        const PlanPoint &a = place(n), &b = place(m);
        if (a == from && opens_towards(n, ahead)) return n;
        // The ring lies right of edges that run down.
        if (a[1] < from[1] || b[1] > from[1] || a[1] == b[1]) continue;
        if (a[0] > from[0] && b[0] > from[0]) continue;
        if (orient2d(a, b, from) < 0) continue;  // it is right of here
        const double x = a[0] + (from[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
        if (x > met) {
            met = x;
            edge = n;
        }
    }
    if (edge < 0) return -1;
    const std::int32_t end = nodes[edge].next;
    std::int32_t best = place(edge)[0] < place(end)[0] ? edge : end;
    if (met >= from[0]) return -1;  // it touches an edge between its corners
    const PlanPoint hit{met, from[1]}, goal = place(best);
    // Corners in the triangle between here, the edge and its end hide that end.
    const auto slope = [&](const PlanPoint& p) {
        return std::abs(p[1] - from[1]) / (from[0] - p[0]);
    };
    const bool is_above = goal[1] > from[1];
    double least = std::numeric_limits<double>::infinity();
    std::int32_t nearest = -1;
    const auto consider = [&](std::int32_t n) {
        const PlanPoint& p = place(n);
        if (p[0] >= from[0] || p[0] < std::min(goal[0], met)) return;
        const int below = is_above ? orient2d(from, goal, p) : orient2d(goal, from, p);
        const int above = is_above ? orient2d(hit, goal, p) : orient2d(goal, hit, p);
        const bool within =
            p == goal || (p[1] == from[1] && p[0] > met) ||
            (below >= 0 && above <= 0 && (is_above ? p[1] >= from[1] : p[1] <= from[1]));
        if (!within || !opens_towards(n, from)) return;
        const double steepness = slope(p);
        const bool is_nearer = steepness == least && nearest >= 0 && place(nearest)[0] < p[0];
        if (steepness < least || is_nearer) {
            least = steepness;
            nearest = n;
        }
    };
    const std::size_t row = row_of(from[1]), goal_row = row_of(goal[1]);
    for (std::size_t r = std::min(row, goal_row); r <= std::max(row, goal_row); ++r)
        for (const std::int32_t n : rows_[r])
            consider(n);
    return nearest;
}

void EarRing::join(std::int32_t hole, std::int32_t outline) {
    std::int32_t node = hole;
    do {
        enter_rows(node);
        node = nodes[node].next;
    } while (node != hole);
    if (place(hole) == place(outline)) {  // the two take each other's way on
        std::swap(nodes[hole].next, nodes[outline].next);
        std::swap(nodes[hole].twin, nodes[outline].twin);
        for (const std::int32_t n : {hole, outline}) {
            nodes[nodes[n].next].previous = n;
            if (nodes[n].twin >= 0) nodes[nodes[n].twin].twin = n;
            enter_rows(n);
        }
        return;
    }
    // outline -> hole ... round it ... hole again -> outline again -> on
    const auto hole_again = static_cast<std::int32_t>(nodes.size());
    const std::int32_t outline_again = hole_again + 1;
    nodes.push_back(nodes[hole]);
    nodes.push_back(nodes[outline]);
    EarNode &h = nodes[hole_again], &o = nodes[outline_again];
    nodes[h.previous].next = hole_again;
    h.next = outline_again;
    o.previous = hole_again;
    nodes[o.next].previous = outline_again;
    if (o.twin >= 0) nodes[o.twin].twin = outline_again;
    nodes[outline].next = hole;
    nodes[hole].previous = outline;
    nodes[outline].twin = hole_again;
    h.twin = outline;
    enter_rows(outline);
    enter_rows(hole_again);
    enter_rows(outline_again);
}

}  // namespace realmodel::meshing
