// SPDX-License-Identifier: GPL-3.0-or-later
// The regions of one triangle: the faces of the plane graph of its border and segments.
#include <algorithm>
#include <cmath>

#include "overlay.hpp"

namespace realmodel::cutting {

namespace {

struct Half {
    NodeId from, to;
    std::int32_t twin = -1, next = -1, loop = -1;
};

}  // namespace

void Overlay::find_regions(std::int32_t triangle) {
    const Triangle& t = triangles_[index(triangle)];
    if (t.points.empty() && t.segments.empty()) {
        regions_.push_back({triangle, {{t.corners[0], t.corners[1], t.corners[2]}}});
        return;
    }
    std::set<std::array<NodeId, 2>> edges;
    const auto lay = [&](NodeId a, NodeId b) {
        NodeId last = a;
        for (const NodeId p : nodes_on(t, a, b)) {
            edges.insert({std::min(last, p), std::max(last, p)});
            last = p;
        }
        edges.insert({std::min(last, b), std::max(last, b)});
    };
    for (std::size_t i = 0; i < 3; ++i)
        lay(t.corners[i], t.corners[(i + 1) % 3]);
    for (const Segment& s : t.segments)
        lay(s.ends[0], s.ends[1]);

    std::vector<Half> halves;
    std::map<NodeId, std::vector<std::int32_t>> leaving;
    for (const auto& [a, b] : edges) {
        const auto first = static_cast<std::int32_t>(halves.size());
        halves.push_back({a, b, first + 1, -1, -1});
        halves.push_back({b, a, first, -1, -1});
        leaving[a].push_back(first);
        leaving[b].push_back(first + 1);
    }
    const std::size_t k = (t.axis + 1) % 3, l = (t.axis + 2) % 3;
    // the plane's own x and y, in which the triangle turns left
    const auto order_x = [&](NodeId p, NodeId q) { return points_.compare(k, p, q); };
    const auto order_y = [&](NodeId p, NodeId q) { return t.turned * points_.compare(l, p, q); };
    const auto to_the_right = [&](const Half& h) {  // angles over -90 and up to 90 degrees
        const int x = order_x(h.from, h.to);
        return x < 0 || (x == 0 && order_y(h.from, h.to) < 0);
    };
    for (auto& [node, out] : leaving) {
        std::sort(out.begin(), out.end(), [&](std::int32_t a, std::int32_t b) {
            const Half &g = halves[index(a)], &h = halves[index(b)];
            const bool right_g = to_the_right(g), right_h = to_the_right(h);
            if (right_g != right_h) return right_g;
            return turn(t, g.from, g.to, h.to) > 0;
        });
        for (std::size_t i = 0; i < out.size(); ++i) {
            // arriving against out[i], the edge that follows is the one clockwise of it
            const std::int32_t arriving = halves[index(out[i])].twin;
            halves[index(arriving)].next = out[(i + out.size() - 1) % out.size()];
        }
    }
    std::vector<std::vector<NodeId>> loops;
    for (std::size_t h = 0; h < halves.size(); ++h) {
        if (halves[h].loop >= 0) continue;
        auto& loop = loops.emplace_back();
        for (auto e = static_cast<std::int32_t>(h); halves[index(e)].loop < 0;
             e = halves[index(e)].next) {
            halves[index(e)].loop = static_cast<std::int32_t>(loops.size()) - 1;
            loop.push_back(halves[index(e)].from);
        }
    }
    // connected parts of the graph, and the loop around each
    std::map<NodeId, std::int32_t> part_of;
    std::vector<NodeId> least;
    for (const auto& [node, out] : leaving) {
        if (part_of.contains(node)) continue;
        const auto part = static_cast<std::int32_t>(least.size());
        std::vector<NodeId> open{node};
        part_of[node] = part;
        NodeId low = node;
        while (!open.empty()) {
            const NodeId at = open.back();
            open.pop_back();
            const int x = order_x(at, low);
            if (x < 0 || (x == 0 && order_y(at, low) < 0)) low = at;
            for (const std::int32_t h : leaving[at]) {
                if (part_of.emplace(halves[index(h)].to, part).second)
                    open.push_back(halves[index(h)].to);
            }
        }
        least.push_back(low);
    }
    std::vector<bool> around(loops.size(), false);
    std::vector<std::int32_t> outer(least.size());
    for (std::size_t part = 0; part < least.size(); ++part) {
        // at the leftmost node nothing leaves to the left: that sector is outside
        outer[part] = halves[index(leaving[least[part]].back())].loop;
        around[index(outer[part])] = true;
    }
    std::vector<std::int32_t> region_of(loops.size(), -1);
    const auto first_region = regions_.size();
    for (std::size_t i = 0; i < loops.size(); ++i) {
        if (around[i]) continue;
        region_of[i] = static_cast<std::int32_t>(regions_.size());
        regions_.push_back({triangle, {loops[i]}});
    }
    const std::int32_t main_part = part_of[t.corners[0]];
    const auto contains = [&](const std::vector<NodeId>& loop, NodeId p) {
        bool inside = false;
        for (std::size_t i = 0; i < loop.size(); ++i) {
            const NodeId a = loop[i], b = loop[(i + 1) % loop.size()];
            const bool above_a = order_y(a, p) > 0, above_b = order_y(b, p) > 0;
            if (above_a == above_b) continue;
            if ((turn(t, a, b, p) > 0) == above_b) inside = !inside;
        }
        return inside;
    };
    const auto size = [&](const std::vector<NodeId>& loop) {
        double sum = 0;
        const Position& o = points_.rounded(loop[0]);
        for (std::size_t i = 1; i + 1 < loop.size(); ++i) {
            const Position &p = points_.rounded(loop[i]), &q = points_.rounded(loop[i + 1]);
            sum += (p[k] - o[k]) * (q[l] - o[l]) - (p[l] - o[l]) * (q[k] - o[k]);
        }
        return std::abs(sum);
    };
    for (std::size_t part = 0; part < least.size(); ++part) {
        if (static_cast<std::int32_t>(part) == main_part) continue;
        std::size_t found = regions_.size();
        for (std::size_t r = first_region; r < regions_.size(); ++r) {
            const auto& outline = regions_[r].loops[0];
            if (part_of[outline[0]] == static_cast<std::int32_t>(part)) continue;
            if (!contains(outline, least[part])) continue;
            if (found == regions_.size() || size(outline) < size(regions_[found].loops[0]))
                found = r;
        }
        if (found < regions_.size()) regions_[found].loops.push_back(loops[index(outer[part])]);
    }
}

}  // namespace realmodel::cutting
