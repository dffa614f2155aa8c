// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <deque>
#include <numbers>
#include <optional>

#include "meshing/point_insertion.hpp"
#include "meshing/refinement.hpp"

namespace realmodel::meshing {

namespace {

// A triangle is small enough when the radius of its circle is below this share of the length
// wanted; an equilateral one has 0.577. What is larger than that and smaller than this would make
// edges too short if it got another vertex.
constexpr double accepted_radius = 0.75;

enum State : std::uint8_t { waiting, active, accepted };

class Front {
public:
    Front(FlatMesh& mesh, const SizeField& size, std::size_t most_vertices, const Check& check)
        : mesh_(mesh), size_(size), most_vertices_(most_vertices), check_(check) {}

    void run(std::int32_t first) {
        Ticker tick(check_);
        const auto count = static_cast<std::int32_t>(mesh_.corners.size());
        states_.assign(count, accepted);
        for (std::int32_t t = first; t < count; ++t) {
            tick(0);
            states_[t] = is_small(t) ? accepted : waiting;
        }
        for (std::int32_t t = first; t < count; ++t)
            activate(t);
        std::size_t steps = 0;
        while (!queue_.empty()) {
            if (++steps % 256 == 0) check_(0.5);
            const Asking asking = queue_.front();
            queue_.pop_front();
            const std::int32_t t = asking.triangle;
            if (states_[t] != active || mesh_.corners[t] != asking.corners) continue;
            if (!fill(t)) accept(t);
        }
    }

private:
    struct Asking {
        std::int32_t triangle;
        std::array<std::int32_t, 3> corners;
    };

    bool is_small(std::int32_t t) const {
        const auto [i, j, k] = mesh_.corners[t];
        const PlanPoint &a = mesh_.points[i], &b = mesh_.points[j], &c = mesh_.points[k];
        const double wanted =
            accepted_radius * size_.at({(a[0] + b[0] + c[0]) / 3, (a[1] + b[1] + c[1]) / 3});
        const double area = twice_area(a, b, c);
        return squared_distance(a, b) * squared_distance(b, c) * squared_distance(c, a) <=
               4 * area * area * wanted * wanted;
    }

    bool is_front(Side side) const {
        const Side other = mesh_.behind(side);
        return mesh_.is_fixed(side) || other.is_outside() || states_[other.triangle()] == accepted;
    }

    void activate(std::int32_t t) {
        if (states_[t] != waiting) return;
        for (int i = 0; i < 3; ++i) {
            if (!is_front({t, i})) continue;
            states_[t] = active;
            queue_.push_back({t, mesh_.corners[t]});
            return;
        }
    }

    void accept(std::int32_t t) {
        states_[t] = accepted;
        for (int i = 0; i < 3; ++i) {
            const Side other = mesh_.behind({t, i});
            if (!other.is_outside()) activate(other.triangle());
        }
    }

    /// Adds a vertex above the shortest of a triangle's sides that is in the front; false where
    /// there is no room for one.
    bool fill(std::int32_t t) {
        Side base = Side::outside();
        double shortest = 0;
        for (int i = 0; i < 3; ++i) {
            const Side side(t, i);
            if (!is_front(side)) continue;
            const double length2 = squared_distance(mesh_.point_from(side), mesh_.point_to(side));
            if (!base.is_outside() && length2 >= shortest) continue;
            base = side;
            shortest = length2;
        }
        if (base.is_outside()) {  // what was small beside it is so no longer
            states_[t] = waiting;
            return true;
        }
        const std::optional<PlanPoint> goal = place(base);
        if (!goal) return false;
        const Arrival at = walk_to(mesh_, t, *goal);
        if (at.kind != Arrival::inside && at.kind != Arrival::on_side) return false;
        if (!encroachment_.find(mesh_, at, *goal).is_outside()) return false;
        const Side leaving = at.kind == Arrival::inside
                                 ? mesh_.insert_inside(at.side.triangle(), *goal)
                                 : mesh_.insert_on(at.side, *goal);
        require_room(mesh_, most_vertices_);
        states_.resize(mesh_.corners.size(), waiting);
        judge_star(leaving);
        return true;
    }

    /// The point above the middle of a side, as high as the length wanted there asks, at most at
    /// the centre of the circle: from there down to the side no other vertex is nearer than its
    /// ends.
    std::optional<PlanPoint> place(Side base) const {
        const std::optional<PlanPoint> centre = circumcentre(mesh_, base.triangle());
        if (!centre) return std::nullopt;
        const PlanPoint &a = mesh_.point_from(base), &b = mesh_.point_to(base);
        const PlanPoint m = middle(a, b);
        const double length = std::sqrt(squared_distance(a, b));
        const PlanPoint up{-(b[1] - a[1]) / length, (b[0] - a[0]) / length};
        const double centre_height =
            (centre->at(0) - m[0]) * up[0] + (centre->at(1) - m[1]) * up[1];
        double height = std::numbers::sqrt3 / 2 * length;
        const auto wanted_height = [&](double wanted) {
            // Sides as long as wanted, but a triangle neither flat nor a needle.
            const double side = std::clamp(wanted, 0.75 * length, 1.6 * length);
            return std::sqrt(side * side - length * length / 4);
        };
        height = wanted_height(size_.at({m[0] + height * up[0], m[1] + height * up[1]}));
        if (!(centre_height > 0)) return std::nullopt;
        height = std::min(height, centre_height);
        return PlanPoint{m[0] + height * up[0], m[1] + height * up[1]};
    }

    void judge_star(Side leaving) {
        star_.clear();
        Side side = leaving;
        do {
            star_.push_back(side.triangle());
            side = mesh_.turn_left(side);
        } while (!side.is_outside() && side != leaving);
        if (side.is_outside()) {
            for (side = mesh_.turn_right(leaving); !side.is_outside();
                 side = mesh_.turn_right(side))
                star_.push_back(side.triangle());
        }
        for (const std::int32_t t : star_)
            states_[t] = is_small(t) ? accepted : waiting;
        for (const std::int32_t t : star_) {
            if (states_[t] == accepted) {
                accept(t);
            } else {
                activate(t);
            }
        }
    }

    FlatMesh& mesh_;
    const SizeField& size_;
    std::size_t most_vertices_;
    const Check& check_;
    Encroachment encroachment_;
    std::vector<std::uint8_t> states_;
    std::vector<std::int32_t> star_;
    std::deque<Asking> queue_;
};

}  // namespace

void advance_front(FlatMesh& mesh, const SizeField& size, std::int32_t first,
                   std::size_t most_vertices, const Check& check) {
    Front(mesh, size, most_vertices, check).run(first);
}

}  // namespace realmodel::meshing
