// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/refinement.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <queue>
#include <string>

#include "meshing/point_insertion.hpp"
#include "realmodel/base/elementary.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::meshing {

namespace {

/// A triangle that misses the target, worst first. It may have changed since: then it is passed
/// over.
struct BadTriangle {
    double sine2;  ///< squared sine of its least angle
    std::uint64_t order;
    std::int32_t triangle;
    std::array<std::int32_t, 3> corners;

    auto operator<=>(const BadTriangle&) const = default;
};

class Refinement {
public:
    Refinement(FlatMesh& mesh, const RefinementTarget& target, SizeField& size, const Check& check)
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
    Refinement(mesh, target, size, check).run(first, also);
}

}  // namespace realmodel::meshing
