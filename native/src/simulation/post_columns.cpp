// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/post_columns.hpp"

#include <algorithm>
#include <cmath>

#include "base/counting_sort.hpp"
#include "base/index.hpp"
#include "exact/orient2d.hpp"
#include "realmodel/base/errors.hpp"
#include "spatial/plan_tiles.hpp"

namespace realmodel::simulation {

namespace {

/// The steps of the model, to be found by position.
class Steps {
public:
    explicit Steps(std::span<const std::array<PlanPoint, 2>> steps)
        : steps_(steps), tiles_(frame_of(steps), steps.size()) {
        bins_ = bucketize<std::int32_t>(tiles_.size(), [&](const auto& put) {
            for (std::size_t s = 0; s < steps.size(); ++s) {
                tiles_.for_each(tiles_.span(spatial::box_around(steps[s])),
                                [&](std::size_t tile) { put(tile, static_cast<std::int32_t>(s)); });
            }
        });
    }

    /// How much of the way from a to b is free: 1 if all of it is, but for b itself.
    double free_way(const PlanPoint& a, const PlanPoint& b) const {
        double free = 1;
        const spatial::PlanBox box = spatial::box_around(std::array{a, b});
        if (steps_.empty() || !box.meets(tiles_.frame())) return free;
        tiles_.for_each(tiles_.span(box), [&](std::size_t tile) {
            for (const std::int32_t s : bins_[tile]) {
                const auto& step = steps_[index(s)];
                const auto &p = step[0], &q = step[1];
                if (exact::orient2d(a, b, p) * exact::orient2d(a, b, q) > 0) continue;
                const int from = exact::orient2d(p, q, a), to = exact::orient2d(p, q, b);
                if (from * to > 0 || (from == 0 && to == 0)) continue;
                const auto off = [&](const PlanPoint& c) {
                    return std::abs((q[0] - p[0]) * (c[1] - p[1]) - (q[1] - p[1]) * (c[0] - p[0]));
                };
                const double whole = off(a) + off(b);
                if (whole > 0) free = std::min(free, off(a) / whole);
            }
        });
        return free;
    }

private:
    static spatial::PlanBox frame_of(std::span<const std::array<PlanPoint, 2>> steps) {
        spatial::PlanBox box = spatial::kNoBox;
        for (const auto& step : steps)
            box = box.united(spatial::box_around(step));
        return steps.empty() ? spatial::PlanBox{} : box;
    }
    std::span<const std::array<PlanPoint, 2>> steps_;
    spatial::PlanTiles tiles_;
    Buckets<std::int32_t> bins_;
};

PlanPoint between(const PlanPoint& a, const PlanPoint& b, double share) {
    if (share == 1) return b;
    return {a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])};
}

}  // namespace

ColumnHeights post_columns(const ComplexView& model, const RockBlocks& blocks,
                           const PlanLines& lines, const PlanTopology& plan,
                           const Execution& execution) {
    constexpr double kBesideStep = 1 - 1e-9;
    const Steps steps(lines.steps);
    const std::size_t count = plan.post_count();
    std::vector<std::uint8_t> beside(plan.nodes(), 0);
    std::vector<std::int32_t> rock(count, -1);
    for (std::size_t c = 0; c < 3 * plan.triangles(); ++c) {
        rock[index(plan.posts()[c])] = plan.rock(c / 3);
        if (plan.neighbor(c / 3, c % 3) >= 0 && !plan.is_step(c / 3, c % 3)) continue;
        beside[index(plan.node(c))] = 1;
        beside[index(plan.mesh().triangles[c / 3][(c % 3 + 1) % 3])] = 1;
    }
    std::vector<PlanPoint> center(count), place(count);
    std::vector<double> free(count, -1);
    for (std::size_t p = 0; p < count; ++p)
        place[p] = center[p] = plan.mesh().vertices[index(plan.post_node(p))];
    for (std::size_t c = 0; c < 3 * plan.triangles(); ++c) {
        const auto post = index(plan.posts()[c]);
        const auto node = index(plan.node(c));
        if (free[post] >= 1) continue;
        PlanPoint middle{};
        for (const std::int32_t n : plan.mesh().triangles[c / 3]) {
            for (std::size_t axis = 0; axis < 2; ++axis)
                middle[axis] += plan.mesh().vertices[index(n)][axis] / 3;
        }
        const double own =
            beside[node] != 0 ? steps.free_way(middle, plan.mesh().vertices[node]) : 1;
        if (own <= free[post]) continue;
        free[post] = own;
        center[post] = middle;
    }
    std::vector<std::size_t> open(count);
    for (std::size_t p = 0; p < count; ++p) {
        open[p] = p;
        if (beside[index(plan.post_node(p))] != 0)
            place[p] = between(center[p], place[p], free[p] * kBesideStep);
    }
    ColumnHeights columns(model, blocks, place, execution);
    const auto settled = [&](std::size_t p) { return columns.rock(p) == rock[p] && rock[p] >= 0; };
    // where rounding, or a border that was simplified, leaves nothing: further from the node
    for (const double share : {1 - 1e-6, 0.99, 0.9, 0.7, 0.4, 0.0}) {
        std::erase_if(open, settled);
        if (open.empty()) return columns;
        std::vector<PlanPoint> tried;
        for (const std::size_t p : open) {
            tried.push_back(between(center[p], plan.mesh().vertices[index(plan.post_node(p))],
                                    std::max(free[p], 0.0) * share));
        }
        const ColumnHeights found(model, blocks, tried, execution);
        for (std::size_t i = 0; i < open.size(); ++i) {
            if (found.rock(i) == rock[open[i]]) columns.copy(open[i], found, i);
        }
    }
    // what a simplified border added to the region is as beside it
    for (bool any = true; any;) {
        any = false;
        std::vector<std::pair<std::size_t, std::size_t>> copies;
        for (std::size_t t = 0; t < plan.triangles(); ++t) {
            for (std::size_t i = 0; i < 3; ++i) {
                const auto post = index(plan.posts()[3 * t + i]);
                if (settled(post)) continue;
                for (std::size_t k = 1; k < 3; ++k) {
                    const auto other = index(plan.posts()[3 * t + (i + k) % 3]);
                    if (settled(other)) {
                        copies.emplace_back(post, other);
                        break;
                    }
                }
            }
        }
        for (const auto& [to, from] : copies) {
            if (settled(to)) continue;
            columns.copy(to, columns, from);
            any = true;
        }
    }
    return columns;
}

}  // namespace realmodel::simulation
