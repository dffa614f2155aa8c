// SPDX-License-Identifier: GPL-3.0-or-later
// On which side of a structure points are.
#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>

#include "base/parallel.hpp"
#include "cutting/nearest_side.hpp"
#include "structures/structure_cutter.hpp"

namespace realmodel::structures {

using cutting::Cutter;
using cutting::NearestSide;
using cutting::Position;
using spatial::Box;

namespace {

constexpr std::int8_t kOpen = 0;
constexpr std::size_t kTogether = 16;  // points that mostly lie together, as nodes of a mesh do

/// A fault with what continues it.
struct Continued {
    explicit Continued(StructureCutter&& of) : cutter(std::move(of)), nearest(cutter.single[0]) {}
    StructureCutter cutter;
    NearestSide nearest;
};

/// A ball around some points.
struct Ball {
    Position center;
    double radius;
};

Ball ball_around(std::span<const Position> points) {
    const Box box = spatial::bounding_box(points);
    const Position center = times(0.5, plus(box.low, box.high));
    Box around;
    around.include(minus(box.low, center));
    around.include(minus(box.high, center));
    around.include(minus(center, box.low));
    return {center, length(around.high) * (1 + 0x1p-40)};
}

}  // namespace

class PreparedStructure::Cutters {
public:
    explicit Cutters(std::span<const Structure> structures)
        : structures_(structures.begin(), structures.end()),
          cutters_(checked_cutters(structures)),
          beside_(cutters_[0]) {
        for (Structure& structure : structures_)
            structure.surface = {};  // its arrays may go
    }

    std::vector<std::int8_t> sides(std::span<const Position> points,
                                   const Execution& execution) const {
        std::vector<std::int8_t> sides(points.size(), kOpen);
        const auto decide = [&](const auto& side_of) {
            parallel_ranges(sides.size(), 1 << 8, execution,
                            [&](std::size_t begin, std::size_t end) {
                                for (std::size_t i = begin; i < end; ++i) {
                                    if (sides[i] == kOpen) sides[i] = side_of(points[i]);
                                }
                            });
        };
        if (structures_[0].is_body) {
            decide([this](const Position& p) { return beside_.within(p); });
            return sides;
        }
        const auto decide_together = [&](const auto& side_of) {
            parallel_ranges(sides.size(), kTogether << 4, execution,
                            [&](std::size_t i, std::size_t end) {
                                for (std::size_t next = i; i < end; i = next) {
                                    next = std::min(end, i + kTogether);
                                    if (sides[i] != kOpen) continue;
                                    const std::int8_t side =
                                        side_of(ball_around(points.subspan(i, next - i)));
                                    std::fill(&sides[i], &sides[i] + (next - i), side);
                                }
                            });
        };
        decide_together([this](const Ball& ball) {
            bool at_border = false;
            const auto side = beside_.of_ball(ball.center, ball.radius, at_border);
            return at_border ? kOpen : side.value_or(kOpen);
        });
        // what is beside the fault itself is on its side, wherever its continuation goes
        const auto side_beside = [this](const Position& p) {
            bool at_border = false;
            const std::int8_t side = beside_(p, &at_border);
            return at_border ? kOpen : side;
        };
        std::size_t first = 0;  // that the border is nearest to
        for (; first < sides.size(); ++first) {
            if (sides[first] == kOpen) sides[first] = side_beside(points[first]);
            if (sides[first] == kOpen) break;
        }
        if (first == sides.size()) return sides;
        const NearestSide& continued = continued_for(spatial::bounding_box(points)).nearest;
        decide_together([&](const Ball& ball) {
            bool at_border = false;
            const auto side = beside_.of_ball(ball.center, ball.radius, at_border);
            if (!side) return kOpen;
            const auto beyond = continued.of_ball(ball.center, ball.radius, at_border);
            return beyond == side ? *side : kOpen;  // whether or not the border is nearest
        });
        decide([&](const Position& p) {
            const std::int8_t side = side_beside(p);
            return side == kOpen ? continued(p) : side;
        });
        return sides;
    }

private:
    /// The fault with what continues it for points in a box: one for each power of two that their
    /// extent does not reach, so that what is asked does not depend on what was asked before.
    const Continued& continued_for(const Box& box) const {
        int power = 0;
        std::frexp(size_with(box, cutters_), &power);
        const std::lock_guard lock(mutex_);
        auto& continued = continued_[power];
        if (!continued) {
            continued = std::make_unique<const Continued>(
                cutter_of_first(structures_, cutters_, std::ldexp(1.0, power)));
        }
        return *continued;
    }

    std::vector<Structure> structures_;
    std::vector<Cutter> cutters_;  ///< of these, each alone
    NearestSide beside_;           ///< of the first
    mutable std::mutex mutex_;
    mutable std::map<int, std::unique_ptr<const Continued>> continued_;
};

PreparedStructure::PreparedStructure(std::span<const Structure> structures)
    : cutters_(std::make_unique<const Cutters>(structures)) {}

PreparedStructure::~PreparedStructure() = default;

std::vector<std::int8_t> PreparedStructure::sides(
    std::span<const std::array<double, 3>> points, const Execution& execution) const {
    return cutters_->sides(points, execution);
}

}  // namespace realmodel::structures
