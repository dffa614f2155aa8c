// SPDX-License-Identifier: GPL-3.0-or-later
// On which side of a structure points are.
#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <numeric>
#include <utility>

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
constexpr std::size_t kFew = 4;  // points that are asked about one by one

/// A fault with what continues it.
struct Continued {
    explicit Continued(StructureCutter&& of) : cutter(std::move(of)), nearest(cutter.single[0]) {}
    StructureCutter cutter;
    NearestSide nearest;
};

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
        const Box whole = spatial::bounding_box(points);
        parallel_ranges(points.size(), 1 << 12, execution, [&](std::size_t begin, std::size_t end) {
            std::vector<std::int32_t> some(end - begin);
            std::iota(some.begin(), some.end(), static_cast<std::int32_t>(begin));
            Asked asked{points, whole, sides, nullptr};
            decide(asked, some);
        });
        return sides;
    }

private:
    /// What points are asked about, and what continues the fault, once one of them needs it.
    struct Asked {
        std::span<const Position> points;
        const Box& whole;  ///< around all
        std::vector<std::int8_t>& sides;
        const NearestSide* continued;
    };

    /// Decides some of the points: all together where a ball around them is on one side, else each
    /// half of them.
    void decide(Asked& asked, std::span<std::int32_t> some) const {
        if (structures_[0].is_body || some.size() <= kFew) {
            for (const std::int32_t i : some)
                asked.sides[index(i)] = side_of(asked, asked.points[index(i)]);
            return;
        }
        const auto at = [&](std::int32_t i) -> const Position& { return asked.points[index(i)]; };
        const Box box = spatial::bounding_box(some, at);
        const Position extent = minus(box.high, box.low);
        const Position center = times(0.5, plus(box.low, box.high));
        // half of the diagonal, and what rounding may add to that
        const double radius =
            0.5 * length(extent) * (1 + 0x1p-40) + 0x1p-50 * (length(box.low) + length(box.high));
        if (const auto side = side_of(asked, center, radius, at(some[0]))) {
            for (const std::int32_t i : some)
                asked.sides[index(i)] = *side;
            return;
        }
        const auto axis = std::ranges::max_element(extent) - extent.begin();
        const auto middle = some.begin() + static_cast<std::ptrdiff_t>(some.size() / 2);
        std::ranges::nth_element(some, middle, {},
                                 [&](std::int32_t i) { return std::pair(at(i)[index(axis)], i); });
        decide(asked, {some.begin(), middle});
        decide(asked, {middle, some.end()});
    }

    /// What is beside the fault itself is on its side, wherever its continuation goes: kOpen where
    /// its border is nearest.
    std::int8_t side_beside(const Position& p) const {
        bool at_border = false;
        const std::int8_t side = beside_(p, &at_border);
        return at_border ? kOpen : side;
    }
    std::int8_t side_of(Asked& asked, const Position& p) const {
        if (structures_[0].is_body) return beside_.within(p);
        const std::int8_t side = side_beside(p);
        return side == kOpen ? continued(asked)(p) : side;
    }
    /// Of a ball.
    /// @param inside  a point in it
    std::optional<std::int8_t> side_of(Asked& asked, const Position& center, double radius,
                                       const Position& inside) const {
        bool at_border = false;
        const auto side = beside_.of_ball(center, radius, at_border);
        if (!side || !at_border) return side;
        if (asked.continued == nullptr && side_beside(inside) != kOpen) return std::nullopt;
        // on the side of both it does not matter whether the border is nearest
        const auto beyond = continued(asked).of_ball(center, radius, at_border);
        return beyond == side ? side : std::nullopt;
    }
    const NearestSide& continued(Asked& asked) const {
        if (asked.continued == nullptr) asked.continued = &continued_for(asked.whole).nearest;
        return *asked.continued;
    }
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

std::vector<std::int8_t> PreparedStructure::sides(std::span<const std::array<double, 3>> points,
                                                  const Execution& execution) const {
    return cutters_->sides(points, execution);
}

}  // namespace realmodel::structures
