// SPDX-License-Identifier: GPL-3.0-or-later
// The regions of one triangle: the faces of the plane graph of its border and segments.
#include <algorithm>
#include <cmath>

#include "cutting/overlay.hpp"

namespace realmodel::cutting {

namespace {

struct Half {
    NodeId from, to;
    std::int32_t twin = -1, next = -1, loop = -1;
};

}  // namespace

void Overlay::find_regions(std::int32_t triangle, std::vector<Region>& regions) const {
    const Triangle& t = triangles_[index(triangle)];
    if (t.points.empty() && t.segments.empty()) {
        regions.push_back({triangle, {{t.corners[0], t.corners[1], t.corners[2]}}});
        return;
    }
    std::vector<std::array<NodeId, 2>> edges;
    const auto lay = [&](NodeId a, NodeId b) {
        NodeId last = a;
        for (const NodeId p : nodes_on(t, a, b)) {
            edges.push_back({std::min(last, p), std::max(last, p)});
            last = p;
        }
        edges.push_back({std::min(last, b), std::max(last, b)});
    };
    for (std::size_t i = 0; i < 3; ++i)
        lay(t.corners[i], t.corners[(i + 1) % 3]);
    for (const Segment& s : t.segments)
        lay(s.ends[0], s.ends[1]);
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());

    // the nodes, in order, and the half edges that leave each
    std::vector<NodeId> nodes;
    for (const auto& edge : edges)
        nodes.insert(nodes.end(), edge.begin(), edge.end());
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    const auto place = [&nodes](NodeId node) {
        return static_cast<std::size_t>(std::lower_bound(nodes.begin(), nodes.end(), node) -
                                        nodes.begin());
    };
    std::vector<Half> halves;
    std::vector<std::vector<std::int32_t>> leaving(nodes.size());
    for (const auto& [a, b] : edges) {
        const auto first = static_cast<std::int32_t>(halves.size());
        halves.push_back({a, b, first + 1, -1, -1});
        halves.push_back({b, a, first, -1, -1});
        leaving[place(a)].push_back(first);
        leaving[place(b)].push_back(first + 1);
    }
    const std::size_t k = (t.axis + 1) % 3, l = (t.axis + 2) % 3;
    // the plane's own x and y, in which the triangle turns left
    const auto order_x = [&](NodeId p, NodeId q) { return points_.compare(k, p, q); };
    const auto order_y = [&](NodeId p, NodeId q) { return t.turned * points_.compare(l, p, q); };
    const auto to_the_right = [&](const Half& h) {  // angles over -90 and up to 90 degrees
        const int x = order_x(h.from, h.to);
        return x < 0 || (x == 0 && order_y(h.from, h.to) < 0);
    };
    for (auto& out : leaving) {
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
    std::vector<std::int32_t> part_of(nodes.size(), -1);
    std::vector<NodeId> least;
    for (std::size_t start = 0; start < nodes.size(); ++start) {
        if (part_of[start] >= 0) continue;
        const auto part = static_cast<std::int32_t>(least.size());
        std::vector<std::size_t> open{start};
        part_of[start] = part;
        NodeId low = nodes[start];
        while (!open.empty()) {
            const std::size_t at = open.back();
            open.pop_back();
            const int x = order_x(nodes[at], low);
            if (x < 0 || (x == 0 && order_y(nodes[at], low) < 0)) low = nodes[at];
            for (const std::int32_t h : leaving[at]) {
                const std::size_t to = place(halves[index(h)].to);
                if (part_of[to] >= 0) continue;
                part_of[to] = part;
                open.push_back(to);
            }
        }
        least.push_back(low);
    }
    std::vector<bool> around(loops.size(), false);
    std::vector<std::int32_t> outer(least.size());
    for (std::size_t part = 0; part < least.size(); ++part) {
        // at the leftmost node nothing leaves to the left: that sector is outside
        outer[part] = halves[index(leaving[place(least[part])].back())].loop;
        around[index(outer[part])] = true;
    }
    const auto first_region = regions.size();
    for (std::size_t i = 0; i < loops.size(); ++i) {
        if (!around[i]) regions.push_back({triangle, {loops[i]}});
    }
    if (least.size() == 1) return;
    const std::int32_t main_part = part_of[place(t.corners[0])];
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
        std::size_t found = regions.size();
        for (std::size_t r = first_region; r < regions.size(); ++r) {
            const auto& outline = regions[r].loops[0];
            if (part_of[place(outline[0])] == static_cast<std::int32_t>(part)) continue;
            if (!contains(outline, least[part])) continue;
            if (found == regions.size() || size(outline) < size(regions[found].loops[0])) found = r;
        }
        if (found < regions.size()) regions[found].loops.push_back(loops[index(outer[part])]);
    }
}

}  // namespace realmodel::cutting
