// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/segment_crossings.hpp"

#include <algorithm>

#include "base/vectors.hpp"
#include "meshing/plan_predicates.hpp"
#include "spatial/box_tree.hpp"

namespace realmodel::meshing {

namespace {

spatial::Box::Position in_space(const PlanPoint& p) {
    return {p[0], p[1], 0};
}

}  // namespace

std::vector<std::vector<PlanPoint>> crossings(std::span<const PlanPoint> points,
                                              std::span<const Segment> segments,
                                              std::size_t settled, const Check& check) {
    std::vector<spatial::Box> boxes(segments.size());
    for (std::size_t s = 0; s < segments.size(); ++s) {
        for (const std::int32_t end : segments[s])
            boxes[s].include(in_space(points[end]));
    }
    std::vector<std::vector<PlanPoint>> cuts(segments.size());
    const auto meet = [&](std::int32_t s, std::int32_t t) {
        const PlanPoint &a = points[segments[s][0]], &b = points[segments[s][1]],
                        &c = points[segments[t][0]], &d = points[segments[t][1]];
        const int ac = orient2d(a, b, c), ad = orient2d(a, b, d), ca = orient2d(c, d, a),
                  cb = orient2d(c, d, b);
        if (ac * ad < 0 && ca * cb < 0) {
            // From the same two names in the same order, so that both get the same place.
            PlanPoint p = crossing_place(a, b, c, d);
            for (const spatial::Box& box : {boxes[s], boxes[t]}) {
                for (int k = 0; k < 2; ++k)
                    p[k] = std::clamp(p[k], box.low[k], box.high[k]);
            }
            cuts[s].push_back(p);
            cuts[t].push_back(p);
            return;
        }
        if (ac == 0 && boxes[s].contains(in_space(c))) cuts[s].push_back(c);
        if (ad == 0 && boxes[s].contains(in_space(d))) cuts[s].push_back(d);
        if (ca == 0 && boxes[t].contains(in_space(a))) cuts[t].push_back(a);
        if (cb == 0 && boxes[t].contains(in_space(b))) cuts[t].push_back(b);
    };

    const spatial::BoxTree tree(boxes);
    for (std::size_t t = settled; t < segments.size(); ++t) {
        if (t % 64 == 0) check(0);
        tree.find(boxes[t], [&](std::int32_t s) {
            const auto number = static_cast<std::int32_t>(t);
            if (s < number) meet(s, number);
        });
    }
    for (std::size_t s = 0; s < segments.size(); ++s) {
        const PlanPoint &a = points[segments[s][0]], &b = points[segments[s][1]];
        const auto along = [&](const PlanPoint& p) { return dot(minus(p, a), minus(b, a)); };
        std::sort(cuts[s].begin(), cuts[s].end(), [&](const PlanPoint& p, const PlanPoint& q) {
            return along(p) != along(q) ? along(p) < along(q) : p < q;
        });
        cuts[s].erase(std::unique(cuts[s].begin(), cuts[s].end()), cuts[s].end());
    }
    return cuts;
}

}  // namespace realmodel::meshing
