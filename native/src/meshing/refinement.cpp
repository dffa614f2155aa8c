// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <numbers>
#include <optional>
#include <queue>
#include <string>
#include <vector>

#include "base/vectors.hpp"
#include "meshing/flat_mesh.hpp"
#include "meshing/improvement.hpp"
#include "meshing/plan_predicates.hpp"
#include "realmodel/base/elementary.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::meshing {

namespace {

/// Where a straight walk through a mesh ended.
struct Arrival {
    enum Outcome { kInside, kOnEdge, kAtFixedEdge, kNowhere } kind;
    HalfEdge edge;  ///< of the triangle (inside), the edge it lies on, or the fixed edge in the way
};

/// Finds a fixed edge that a new point would encroach on: that it would see, without another edge
/// between, under more than 120 degrees (Shewchuk 2002, section 3.4: lenses of 30 degrees).
class Encroachment {
public:
    /// Outside where there is none. `at` is where the point lies.
    HalfEdge find(const FlatMesh& mesh, const Arrival& at, const PlanPoint& p) {
        const auto sees_widely = [&](HalfEdge edge) {
            const PlanPoint &a = mesh.origin_point(edge), &b = mesh.target_point(edge);
            const double product = dot(minus(a, p), minus(b, p));
            return product < 0 &&
                   product * product > 0.25 * squared_distance(a, p) * squared_distance(b, p);
        };
        cavity_.assign({at.edge.triangle()});
        if (at.kind == Arrival::kOnEdge) cavity_.push_back(mesh.twin(at.edge).triangle());
        for (std::size_t n = 0; n < cavity_.size(); ++n) {
            for (int i = 0; i < 3; ++i) {
                const HalfEdge edge(cavity_[n], i);
                if (mesh.is_fixed(edge)) {
                    if (sees_widely(edge)) return edge;
                    continue;
                }
                const HalfEdge other = mesh.twin(edge);
                if (std::find(cavity_.begin(), cavity_.end(), other.triangle()) != cavity_.end()) {
                    continue;
                }
                if (in_circle(mesh.origin_point(other), mesh.target_point(other),
                              mesh.apex_point(other), p) > 0) {
                    cavity_.push_back(other.triangle());
                }
            }
        }
        return HalfEdge::none();
    }

private:
    std::vector<std::int32_t> cavity_;
};

int side_of(const FlatMesh& mesh, HalfEdge edge, const PlanPoint& p) {
    return orient2d(mesh.origin_point(edge), mesh.target_point(edge), p);
}

/// In a triangle that the goal is not outside of; `on` are the edges it lies on.
Arrival arrival(const FlatMesh& mesh, std::int32_t triangle, const std::array<bool, 3>& on) {
    const auto zeros = std::count(on.begin(), on.end(), true);
    if (zeros > 1) return {Arrival::kNowhere, {}};
    if (zeros == 0) return {Arrival::kInside, {triangle, 0}};
    const HalfEdge edge(triangle,
                        static_cast<int>(std::find(on.begin(), on.end(), true) - on.begin()));
    return {mesh.is_fixed(edge) ? Arrival::kAtFixedEdge : Arrival::kOnEdge, edge};
}

/// Goes from within a triangle straight to a goal, and stops at the first fixed edge. `kNowhere`:
/// a vertex is there already, or the triangle is too thin for the question to have an answer.
Arrival walk_to(const FlatMesh& mesh, std::int32_t triangle, const PlanPoint& goal) {
    HalfEdge exit = HalfEdge::none();
    std::array<bool, 3> on{};
    for (int i = 0; i < 3; ++i) {
        const HalfEdge edge(triangle, i);
        const int where = side_of(mesh, edge, goal);
        if (where < 0) exit = edge;
        on[i] = where == 0;
    }
    if (exit.is_none()) return arrival(mesh, triangle, on);

    const PlanPoint start = mesh.apex_point(exit);
    if (orient2d(start, goal, mesh.origin_point(exit)) > 0 ||
        orient2d(goal, start, mesh.target_point(exit)) > 0) {
        return {Arrival::kNowhere, {}};  // rounded to beyond two edges: too thin to judge
    }
    while (true) {
        if (mesh.is_fixed(exit)) return {Arrival::kAtFixedEdge, exit};
        const HalfEdge entry = mesh.twin(exit);
        if (entry.is_none()) return {Arrival::kNowhere, {}};
        // Seen from the start the next edge leads from the right end to the apex.
        const HalfEdge right = entry.next(), left = entry.prev();
        const int beyond_right = side_of(mesh, right, goal),
                  beyond_left = side_of(mesh, left, goal);
        if (beyond_right >= 0 && beyond_left >= 0) {
            std::array<bool, 3> flat{};
            flat[right.index()] = beyond_right == 0;
            flat[left.index()] = beyond_left == 0;
            return arrival(mesh, entry.triangle(), flat);
        }
        const int apex = orient2d(start, goal, mesh.apex_point(entry));
        if (apex == 0) {
            exit = beyond_right < 0 ? right : left;
        } else {
            exit = apex > 0 ? right : left;
        }
    }
}

/// The center of the circle through a triangle's corners; none where doubles do not hold it.
std::optional<PlanPoint> circumcenter(const FlatMesh& mesh, std::int32_t triangle) {
    const auto [i, j, k] = mesh.corners[triangle];
    const PlanPoint &a = mesh.points[i], &b = mesh.points[j], &c = mesh.points[k];
    const double bx = b[0] - a[0], by = b[1] - a[1], cx = c[0] - a[0], cy = c[1] - a[1];
    const double twice = bx * cy - by * cx;
    const double b2 = bx * bx + by * by, c2 = cx * cx + cy * cy;
    const double x = (cy * b2 - by * c2) / (2 * twice), y = (bx * c2 - cx * b2) / (2 * twice);
    if (!std::isfinite(x) || !std::isfinite(y)) return std::nullopt;
    return PlanPoint{a[0] + x, a[1] + y};
}

/// A triangle that misses the target, worst first. It may have changed since: then it is passed
/// over.
struct BadTriangle {
    double sine2;  ///< squared sine of its least angle
    std::uint64_t order;
    std::int32_t triangle;
    std::array<std::int32_t, 3> corners;

    auto operator<=>(const BadTriangle&) const = default;
};

class DelaunayRefinement {
public:
    DelaunayRefinement(FlatMesh& mesh, const RefinementTarget& target, SizeField& size,
                       const Check& check)
        : mesh_(mesh),
          target_(target),
          size_(size),
          least_sine2_(elementary::sin(target.least_angle) * elementary::sin(target.least_angle)),
          check_(check) {}

    void run(std::int32_t first, std::span<const std::int32_t> also) {
        Ticker tick(check_);
        for (const std::int32_t t : also)
            enqueue_if_bad(t);
        const auto count = static_cast<std::int32_t>(mesh_.corners.size());
        for (std::int32_t t = first; t < count; ++t) {
            tick(0);
            enqueue_if_bad(t);
        }
        std::size_t steps = 0;
        while (!queue_.empty()) {
            if (++steps % 256 == 0) check_(0.5);
            const BadTriangle bad = queue_.top();
            queue_.pop();
            if (bad.corners == mesh_.corners[bad.triangle] && improve(bad.triangle)) {
                enqueue_if_bad(bad.triangle);
            }
        }
    }

private:
    void enqueue_if_bad(std::int32_t triangle) {
        const auto& corners = mesh_.corners[triangle];
        const PlanPoint &a = mesh_.points[corners[0]], &b = mesh_.points[corners[1]],
                        &c = mesh_.points[corners[2]];
        const std::array<double, 3> squared{squared_distance(a, b), squared_distance(b, c),
                                            squared_distance(c, a)};
        const auto [shortest, longest] = std::minmax_element(squared.begin(), squared.end());
        if (*shortest <= target_.shortest_edge * target_.shortest_edge) return;
        const double area = twice_area(a, b, c);
        double sine2 = 1;
        for (int i = 0; i < 3; ++i) {
            const int before = (i + 2) % 3;
            // An angle between two fixed edges is given: no vertex can widen it.
            if (mesh_.is_fixed({triangle, i}) && mesh_.is_fixed({triangle, before})) continue;
            sine2 = std::min(sine2, area * area / (squared[i] * squared[before]));
        }
        if (sine2 >= least_sine2_) {
            const double wanted = target_.longest_edge *
                                  size_.at({(a[0] + b[0] + c[0]) / 3, (a[1] + b[1] + c[1]) / 3});
            if (*longest <= wanted * wanted) return;
        }
        queue_.push({sine2, order_++, triangle, corners});
    }

    /// Adds one vertex for the sake of a bad triangle; false if there is none to add.
    bool improve(std::int32_t triangle) {
        const std::optional<PlanPoint> center = circumcenter(mesh_, triangle);
        if (!center) return false;
        const Arrival at = walk_to(mesh_, triangle, *center);
        if (at.kind == Arrival::kNowhere) return false;
        if (at.kind == Arrival::kAtFixedEdge) return cut(at.edge);
        const HalfEdge edge = encroachment_.find(mesh_, at, *center);
        if (!edge.is_none()) return cut(edge);
        enqueue_star(at.kind == Arrival::kInside ? mesh_.insert_inside(at.edge.triangle(), *center)
                                                 : mesh_.insert_on(at.edge, *center));
        return true;
    }

    /// Cuts a fixed edge in two; false where it is as short as it may get, or where there is no
    /// room for its rounded middle.
    bool cut(HalfEdge edge) {
        if (mesh_.is_locked(edge)) return false;
        const PlanPoint &a = mesh_.origin_point(edge), &b = mesh_.target_point(edge);
        if (squared_distance(a, b) <= 4 * target_.shortest_edge * target_.shortest_edge) {
            return false;
        }
        // Alike from both sides, so that a region and its neighbor are cut alike.
        const PlanPoint m = a < b ? middle(a, b) : middle(b, a);
        if (!can_cut(mesh_, edge, m)) return false;
        enqueue_star(mesh_.insert_on(edge, m));
        return true;
    }

    void enqueue_star(HalfEdge leaving) {
        require_room(mesh_, target_.most_vertices);
        mesh_.visit_star(leaving, [&](HalfEdge edge) { enqueue_if_bad(edge.triangle()); });
    }

    FlatMesh& mesh_;
    RefinementTarget target_;
    SizeField& size_;
    double least_sine2_;
    const Check& check_;
    Encroachment encroachment_;
    std::priority_queue<BadTriangle, std::vector<BadTriangle>, std::greater<>> queue_;
    std::uint64_t order_ = 0;
};

// A triangle is small enough when the radius of its circle is below this share of the length
// wanted; an equilateral one has 0.577. What is larger than that and smaller than this would make
// edges too short if it got another vertex.
constexpr double kAcceptedRadius = 0.75;

enum FrontState : std::uint8_t { kWaiting, kActive, kAccepted };

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

void require_room(const FlatMesh& mesh, std::size_t most_vertices) {
    if (mesh.points.size() <= most_vertices) return;
    const PlanPoint& p = mesh.points.back();
    throw InputError("too_large",
                     "the mesh needs more than " + std::to_string(most_vertices) +
                         " vertices, because of fine detail of the outlines; simplify them or "
                         "use a larger edge length",
                     -1, {}, std::array{p[0], p[1], 0.0});
}

void refine(FlatMesh& mesh, const RefinementTarget& target, SizeField& size, std::int32_t first,
            std::span<const std::int32_t> also, const Check& check) {
    DelaunayRefinement(mesh, target, size, check).run(first, also);
}

void advance_front(FlatMesh& mesh, SizeField& size, std::int32_t first, std::size_t most_vertices,
                   const Check& check) {
    Front(mesh, size, most_vertices, check).run(first);
}

}  // namespace realmodel::meshing
