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
constexpr double kAcceptedRadius = 0.75;

enum State : std::uint8_t { kWaiting, kActive, kAccepted };

class Front {
public:
    Front(FlatMesh& mesh, SizeField& size, std::size_t most_vertices, const Check& check)
        : mesh_(mesh), size_(size), most_vertices_(most_vertices), check_(check) {}

    void run(std::int32_t first) {
        Ticker tick(check_);
        const auto count = static_cast<std::int32_t>(mesh_.corners.size());
        states_.assign(count, kAccepted);
        for (std::int32_t t = first; t < count; ++t) {
            tick(0);
            states_[t] = is_small(t) ? kAccepted : kWaiting;
        }
        for (std::int32_t t = first; t < count; ++t)
            activate(t);
        std::size_t steps = 0;
        while (!queue_.empty()) {
            if (++steps % 256 == 0) check_(0.5);
            const Asking asking = queue_.front();
            queue_.pop_front();
            const std::int32_t t = asking.triangle;
            if (states_[t] != kActive || mesh_.corners[t] != asking.corners) continue;
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
            kAcceptedRadius * size_.at({(a[0] + b[0] + c[0]) / 3, (a[1] + b[1] + c[1]) / 3});
        const double area = twice_area(a, b, c);
        return squared_distance(a, b) * squared_distance(b, c) * squared_distance(c, a) <=
               4 * area * area * wanted * wanted;
    }

    bool is_front(HalfEdge edge) const {
        const HalfEdge other = mesh_.twin(edge);
        return mesh_.is_fixed(edge) || other.is_none() || states_[other.triangle()] == kAccepted;
    }

    void activate(std::int32_t t) {
        if (states_[t] != kWaiting) return;
        for (int i = 0; i < 3; ++i) {
            if (!is_front({t, i})) continue;
            states_[t] = kActive;
            queue_.push_back({t, mesh_.corners[t]});
            return;
        }
    }

    void accept(std::int32_t t) {
        states_[t] = kAccepted;
        for (int i = 0; i < 3; ++i) {
            const HalfEdge other = mesh_.twin({t, i});
            if (!other.is_none()) activate(other.triangle());
        }
    }

    /// Adds a vertex above the shortest of a triangle's edges that is in the front; false where
    /// there is no room for one.
    bool fill(std::int32_t t) {
        HalfEdge base = HalfEdge::none();
        double shortest = 0;
        for (int i = 0; i < 3; ++i) {
            const HalfEdge edge(t, i);
            if (!is_front(edge)) continue;
            const double length2 =
                squared_distance(mesh_.origin_point(edge), mesh_.target_point(edge));
            if (!base.is_none() && length2 >= shortest) continue;
            base = edge;
            shortest = length2;
        }
        if (base.is_none()) {  // what was small beside it is so no longer
            states_[t] = kWaiting;
            return true;
        }
        const std::optional<PlanPoint> goal = place(base);
        if (!goal) return false;
        const Arrival at = walk_to(mesh_, t, *goal);
        if (at.kind != Arrival::kInside && at.kind != Arrival::kOnEdge) return false;
        if (!encroachment_.find(mesh_, at, *goal).is_none()) return false;
        const HalfEdge leaving = at.kind == Arrival::kInside
                                     ? mesh_.insert_inside(at.edge.triangle(), *goal)
                                     : mesh_.insert_on(at.edge, *goal);
        require_room(mesh_, most_vertices_);
        states_.resize(mesh_.corners.size(), kWaiting);
        judge_star(leaving);
        return true;
    }

    /// The point above the middle of an edge, as high as the length wanted there asks, at most at
    /// the center of the circle: from there down to the edge no other vertex is nearer than its
    /// ends.
    std::optional<PlanPoint> place(HalfEdge base) const {
        const std::optional<PlanPoint> center = circumcenter(mesh_, base.triangle());
        if (!center) return std::nullopt;
        const PlanPoint &a = mesh_.origin_point(base), &b = mesh_.target_point(base);
        const PlanPoint m = middle(a, b);
        const double length = std::sqrt(squared_distance(a, b));
        const PlanPoint up{-(b[1] - a[1]) / length, (b[0] - a[0]) / length};
        const double center_height =
            (center->at(0) - m[0]) * up[0] + (center->at(1) - m[1]) * up[1];
        double height = std::numbers::sqrt3 / 2 * length;
        const auto wanted_height = [&](double wanted) {
            // Sides as long as wanted, but a triangle neither flat nor a needle.
            const double edge = std::clamp(wanted, 0.75 * length, 1.6 * length);
            return std::sqrt(edge * edge - length * length / 4);
        };
        height = wanted_height(size_.at({m[0] + height * up[0], m[1] + height * up[1]}));
        if (!(center_height > 0)) return std::nullopt;
        height = std::min(height, center_height);
        return PlanPoint{m[0] + height * up[0], m[1] + height * up[1]};
    }

    void judge_star(HalfEdge leaving) {
        star_.clear();
        mesh_.visit_star(leaving, [&](HalfEdge edge) { star_.push_back(edge.triangle()); });
        for (const std::int32_t t : star_)
            states_[t] = is_small(t) ? kAccepted : kWaiting;
        for (const std::int32_t t : star_) {
            if (states_[t] == kAccepted) {
                accept(t);
            } else {
                activate(t);
            }
        }
    }

    FlatMesh& mesh_;
    SizeField& size_;
    std::size_t most_vertices_;
    const Check& check_;
    Encroachment encroachment_;
    std::vector<std::uint8_t> states_;
    std::vector<std::int32_t> star_;
    std::deque<Asking> queue_;
};

}  // namespace

void advance_front(FlatMesh& mesh, SizeField& size, std::int32_t first, std::size_t most_vertices,
                   const Check& check) {
    Front(mesh, size, most_vertices, check).run(first);
}

}  // namespace realmodel::meshing
