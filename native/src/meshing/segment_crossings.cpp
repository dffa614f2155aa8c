// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/segment_crossings.hpp"

#include <algorithm>
#include <numeric>

#include "meshing/plan_predicates.hpp"

namespace realmodel::meshing {

namespace {

struct Box {
    PlanPoint low, high;
};

Box box_of(const PlanPoint& a, const PlanPoint& b) {
    return {{std::min(a[0], b[0]), std::min(a[1], b[1])},
            {std::max(a[0], b[0]), std::max(a[1], b[1])}};
}

bool within_box(const Box& box, const PlanPoint& p) {
    return p[0] >= box.low[0] && p[0] <= box.high[0] && p[1] >= box.low[1] && p[1] <= box.high[1];
}

}  // namespace

std::vector<std::vector<PlanPoint>> crossings(std::span<const PlanPoint> points,
                                              std::span<const Segment> segments,
                                              std::size_t settled, const Check& check) {
    std::vector<Box> boxes;
    boxes.reserve(segments.size());
    for (const auto& [from, to] : segments)
        boxes.push_back(box_of(points[from], points[to]));
    std::vector<std::int32_t> order(segments.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
        return boxes[a].low[0] != boxes[b].low[0] ? boxes[a].low[0] < boxes[b].low[0] : a < b;
    });

    std::vector<std::vector<PlanPoint>> cuts(segments.size());
    const auto meet = [&](std::int32_t s, std::int32_t t) {
        const PlanPoint &a = points[segments[s][0]], &b = points[segments[s][1]],
                        &c = points[segments[t][0]], &d = points[segments[t][1]];
        const int ac = orient2d(a, b, c), ad = orient2d(a, b, d), ca = orient2d(c, d, a),
                  cb = orient2d(c, d, b);
        if (ac * ad < 0 && ca * cb < 0) {
            // From the same two names in the same order, so that both get the same place.
            PlanPoint p = crossing_place(a, b, c, d);
            for (const Box& box : {boxes[s], boxes[t]}) {
                for (int k = 0; k < 2; ++k)
                    p[k] = std::clamp(p[k], box.low[k], box.high[k]);
            }
            cuts[s].push_back(p);
            cuts[t].push_back(p);
            return;
        }
        if (ac == 0 && within_box(boxes[s], c)) cuts[s].push_back(c);
        if (ad == 0 && within_box(boxes[s], d)) cuts[s].push_back(d);
        if (ca == 0 && within_box(boxes[t], a)) cuts[t].push_back(a);
        if (cb == 0 && within_box(boxes[t], b)) cuts[t].push_back(b);
    };

    // A sweep over x, with those constraints and those segments of rings that are under it.
    std::vector<std::int32_t> under_rings, under_lines;
    const auto visit = [&](std::vector<std::int32_t>& under, std::int32_t s) {
        std::size_t kept = 0;
        for (const std::int32_t t : under) {
            if (boxes[t].high[0] < boxes[s].low[0]) continue;
            under[kept++] = t;
            if (boxes[t].high[1] < boxes[s].low[1] || boxes[t].low[1] > boxes[s].high[1]) continue;
            meet(std::min(s, t), std::max(s, t));
        }
        under.resize(kept);
    };
    std::size_t seen = 0;
    for (const std::int32_t s : order) {
        if (++seen % 64 == 0) check(0);
        const bool is_ring = static_cast<std::size_t>(s) < settled;
        visit(under_lines, s);
        if (!is_ring) visit(under_rings, s);
        (is_ring ? under_rings : under_lines).push_back(s);
    }
    for (std::size_t s = 0; s < segments.size(); ++s) {
        const PlanPoint &a = points[segments[s][0]], &b = points[segments[s][1]];
        const auto along = [&](const PlanPoint& p) {
            return (p[0] - a[0]) * (b[0] - a[0]) + (p[1] - a[1]) * (b[1] - a[1]);
        };
        std::sort(cuts[s].begin(), cuts[s].end(), [&](const PlanPoint& p, const PlanPoint& q) {
            return along(p) != along(q) ? along(p) < along(q) : p < q;
        });
        cuts[s].erase(std::unique(cuts[s].begin(), cuts[s].end()), cuts[s].end());
    }
    return cuts;
}

}  // namespace realmodel::meshing
