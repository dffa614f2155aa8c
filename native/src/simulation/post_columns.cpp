// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/post_columns.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/counting_sort.hpp"
#include "base/index.hpp"
#include "base/vectors.hpp"
#include "exact/orient2d.hpp"
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
                const auto off = [&](const PlanPoint& c) { return std::abs(twice_area(p, q, c)); };
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
    return moved(a, share, minus(b, a));
}

/// Where the model is asked for the heights of each post.
class PostPositions {
public:
    PostPositions(const PlanLines& lines, const PlanTopology& plan)
        : plan_(plan),
          is_beside_(plan.post_count(), 0),
          center_(plan.post_count()),
          free_(plan.post_count(), -1) {
        const Steps steps(lines.steps);
        find_beside();
        for (std::size_t p = 0; p < center_.size(); ++p)
            center_[p] = node(p);
        // of the triangles around a post the one that is best seen from its node
        for (std::size_t t = 0; t < plan.triangles(); ++t) {
            const auto [a, b, c] = plan.corners(t);
            const PlanPoint middle = middle_of(plan.point(a), plan.point(b), plan.point(c));
            for (std::size_t i = 0; i < 3; ++i) {
                const std::size_t p = plan.post(t, i);
                if (free_[p] >= 1) continue;
                const double own = is_beside_[p] != 0 ? steps.free_way(middle, node(p)) : 1;
                if (own <= free_[p]) continue;
                free_[p] = own;
                center_[p] = middle;
            }
        }
    }

    /// At the node, or beside a step or the border as near to it as the way is free.
    PlanPoint nearest(std::size_t post) const {
        constexpr double kBesideStep = 1 - 1e-9;
        return is_beside_[post] == 0
                   ? node(post)
                   : between(center_[post], node(post), free_[post] * kBesideStep);
    }
    /// Part of the way to there, from the middle of a triangle.
    PlanPoint farther(std::size_t post, double share) const {
        return between(center_[post], node(post), std::max(free_[post], 0.0) * share);
    }

private:
    const PlanPoint& node(std::size_t post) const { return plan_.point(plan_.post_node(post)); }

    void find_beside() {
        std::vector<std::uint8_t> is_beside(plan_.nodes(), 0);
        for (std::size_t t = 0; t < plan_.triangles(); ++t) {
            for (std::size_t i = 0; i < 3; ++i) {
                if (plan_.neighbor(t, i) < 0 || plan_.is_inner_step(t, i))
                    is_beside[index(plan_.corners(t)[i])] =
                        is_beside[index(plan_.corners(t)[(i + 1) % 3])] = 1;
            }
        }
        for (std::size_t p = 0; p < is_beside_.size(); ++p)
            is_beside_[p] = is_beside[index(plan_.post_node(p))];
    }

    const PlanTopology& plan_;
    std::vector<std::uint8_t> is_beside_;  ///< a step or the border
    std::vector<PlanPoint> center_;        ///< the middle of a triangle at the post
    std::vector<double> free_;             ///< how much of the way from there to the node is
};

/// What a simplified border added to the region is as beside it.
template <class IsSettled>
void copy_from_neighbors(const PlanTopology& plan, const IsSettled& is_settled,
                         ColumnHeights& columns) {
    for (bool any = true; any;) {
        any = false;
        std::vector<std::pair<std::size_t, std::size_t>> copies;
        for (std::size_t t = 0; t < plan.triangles(); ++t) {
            for (std::size_t i = 0; i < 3; ++i) {
                const std::size_t post = plan.post(t, i);
                if (is_settled(post)) continue;
                for (std::size_t k = 1; k < 3; ++k) {
                    const std::size_t other = plan.post(t, (i + k) % 3);
                    if (!is_settled(other)) continue;
                    copies.emplace_back(post, other);
                    break;
                }
            }
        }
        for (const auto& [to, from] : copies) {
            if (is_settled(to)) continue;
            columns.copy(to, columns, from);
            any = true;
        }
    }
}

}  // namespace

ColumnHeights post_columns(const ComplexView& model, const RockBlocks& blocks,
                           const PlanLines& lines, const PlanTopology& plan,
                           const Execution& execution) {
    const std::size_t count = plan.post_count();
    const PostPositions positions(lines, plan);
    std::vector<std::int32_t> rock(count, -1);
    for (std::size_t t = 0; t < plan.triangles(); ++t) {
        for (std::size_t i = 0; i < 3; ++i)
            rock[plan.post(t, i)] = plan.rock(t);
    }
    std::vector<std::size_t> open(count);
    std::vector<PlanPoint> asked(count);
    for (std::size_t p = 0; p < count; ++p) {
        open[p] = p;
        asked[p] = positions.nearest(p);
    }
    ColumnHeights columns(model, blocks, asked, execution);
    const auto is_settled = [&](std::size_t p) {
        return columns.rock(p) == rock[p] && rock[p] >= 0;
    };
    // where rounding, or a border that was simplified, leaves nothing: farther from the node
    for (const double share : {1 - 1e-6, 0.99, 0.9, 0.7, 0.4, 0.0}) {
        std::erase_if(open, is_settled);
        if (open.empty()) return columns;
        asked.clear();
        for (const std::size_t p : open)
            asked.push_back(positions.farther(p, share));
        const ColumnHeights found(model, blocks, asked, execution);
        for (std::size_t i = 0; i < open.size(); ++i) {
            if (found.rock(i) == rock[open[i]]) columns.copy(open[i], found, i);
        }
    }
    copy_from_neighbors(plan, is_settled, columns);
    return columns;
}

}  // namespace realmodel::simulation
