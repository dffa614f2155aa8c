// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <numbers>

#include "base/counting_sort.hpp"
#include "base/vectors.hpp"
#include "exact/orientation.hpp"
#include "meshing/improvement.hpp"
#include "realmodel/base/elementary.hpp"
#include "simulation/plan_topology.hpp"

namespace realmodel::simulation {

using meshing::HalfEdge;

namespace {

using Triangle = std::array<std::int32_t, 3>;

constexpr double kLeastAngle = 20.0 * std::numbers::pi / 180;
constexpr double kSharpAngle = 25.0 * std::numbers::pi / 180;  ///< made larger, if it can be
constexpr int kImprovements = 12;

double least_angle(const PlanPoint& a, const PlanPoint& b, const PlanPoint& c) {
    double least = std::numbers::pi;
    const std::array<const PlanPoint*, 3> p{&a, &b, &c};
    for (std::size_t i = 0; i < 3; ++i) {
        const PlanPoint u = minus(*p[(i + 1) % 3], *p[i]), v = minus(*p[(i + 2) % 3], *p[i]);
        least = std::min(least, elementary::atan2(std::abs(cross(u, v)), dot(u, v)));
    }
    return least;
}

PlanPoint halfway(const PlanPoint& a, const PlanPoint& b) {
    return {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2};
}

class Adaption {
public:
    Adaption(meshing::FlatMesh& mesh, LineEdges& edges) : mesh_(mesh), edges_(edges) {}

    void run() {
        remove_border_corners();
        find_divided();
        if (divide_between_steps()) find_divided();
        flip_and_move();
        divide_lines_at_sharp_angles();
    }

private:
    std::size_t triangles() const { return mesh_.corners.size(); }
    const PlanPoint& at(std::int32_t node) const { return mesh_.points[index(node)]; }
    double angle_of(const Triangle& t) const { return least_angle(at(t[0]), at(t[1]), at(t[2])); }
    bool is_divided(std::int32_t node) const { return is_divided_[index(node)] != 0; }
    void find_divided() { is_divided_ = Pillars(mesh_, edges_).is_divided; }
    /// Whether an edge is neither on a line nor at the border.
    bool is_free(HalfEdge edge) const {
        return !mesh_.is_border(edge) && edges_.segment(mesh_.from(edge), mesh_.to(edge)) < 0;
    }
    bool is_inner_step(HalfEdge edge) const {
        return !mesh_.is_border(edge) && edges_.is_step(mesh_.from(edge), mesh_.to(edge));
    }
    std::int32_t add_node(const PlanPoint& p) {
        mesh_.points.push_back(p);
        return static_cast<std::int32_t>(mesh_.points.size()) - 1;
    }

    /// The least angle of the two triangles beside an edge once it is flipped; 0 where it cannot
    /// be.
    double angle_after_flip(HalfEdge edge) const {
        const PlanPoint &a = mesh_.origin_point(edge), &b = mesh_.target_point(edge),
                        &apex = mesh_.apex_point(edge), &far = mesh_.apex_point(mesh_.twin(edge));
        if (exact::orient2d(apex, a, far) <= 0 || exact::orient2d(apex, far, b) <= 0) return 0;
        return std::min(least_angle(apex, a, far), least_angle(apex, far, b));
    }
    /// The corner across from the edge becomes the first of both triangles.
    void flip(HalfEdge edge) {
        mesh_.flip(edge);
        mesh_.rotate(edge.triangle(), 1);
    }

    void remove_border_corners() {
        const std::size_t count = triangles();
        for (std::size_t t = 0; t < count; ++t) {
            const auto& twins = mesh_.twins[t];
            if (std::count(twins.begin(), twins.end(), HalfEdge::none()) != 2) continue;
            const auto [a, b, c] = mesh_.corners[t];
            mesh_.divide(static_cast<std::int32_t>(t), add_node(middle_of(at(a), at(b), at(c))));
        }
    }

    /// Divides edges between two divided nodes that are no step themselves; a triangle of three
    /// steps is divided at its middle.
    bool divide_between_steps() {
        std::map<std::array<std::int32_t, 2>, std::int32_t> middles;
        std::vector<std::uint8_t> is_closed(triangles(), 1);
        mesh_.for_each_edge([&](HalfEdge edge) {
            if (is_inner_step(edge)) return;
            is_closed[index(edge.triangle())] = 0;
            const auto ends = unordered(mesh_.from(edge), mesh_.to(edge));
            if (!is_divided(ends[0]) || !is_divided(ends[1]) || middles.contains(ends)) return;
            const std::int32_t middle = add_node(halfway(at(ends[0]), at(ends[1])));
            middles[ends] = middle;
            edges_.divide(ends[0], ends[1], middle);
        });
        if (middles.empty() && std::find(is_closed.begin(), is_closed.end(), 1) == is_closed.end())
            return false;
        std::vector<Triangle> made;
        for (std::size_t t = 0; t < is_closed.size(); ++t) {
            const Triangle corner = mesh_.corners[t];
            if (is_closed[t] != 0) {
                const std::int32_t n =
                    add_node(middle_of(at(corner[0]), at(corner[1]), at(corner[2])));
                for (std::size_t i = 0; i < 3; ++i)
                    made.push_back({corner[i], corner[(i + 1) % 3], n});
                continue;
            }
            Triangle middle{-1, -1, -1};
            for (std::size_t i = 0; i < 3; ++i) {
                const auto divider = middles.find(unordered(corner[i], corner[(i + 1) % 3]));
                if (divider != middles.end()) middle[i] = divider->second;
            }
            divide_at(corner, middle, made);
        }
        mesh_.corners = std::move(made);
        mesh_.link();
        return true;
    }

    /// @param middle  of each edge: the node that divides it, or -1
    static void divide_at(const Triangle& corner, const Triangle& middle,
                          std::vector<Triangle>& made) {
        const auto divided = 3 - std::count(middle.begin(), middle.end(), -1);
        if (divided == 0) {
            made.push_back(corner);
        } else if (divided == 3) {
            for (std::size_t i = 0; i < 3; ++i)
                made.push_back({corner[i], middle[i], middle[(i + 2) % 3]});
            made.push_back(middle);
        } else {
            std::size_t i = 0;  // the first divided edge, the one before it not
            while (middle[i] < 0 || middle[(i + 2) % 3] >= 0)
                ++i;
            const std::int32_t a = corner[i], b = corner[(i + 1) % 3], c = corner[(i + 2) % 3],
                               m = middle[i], n = middle[(i + 1) % 3];
            if (divided == 1) {
                made.push_back({a, m, c});
                made.push_back({m, b, c});
            } else {
                made.push_back({m, b, n});
                made.push_back({a, m, n});
                made.push_back({a, n, c});
            }
        }
    }

    void flip_and_move() {
        for (int round = 0; round < kImprovements; ++round) {
            const bool flipped = flip_edges();
            if (!move_nodes() && !flipped) break;
        }
    }

    /// Flips edges where that makes the least angle of both triangles larger.
    bool flip_edges() {
        std::vector<std::uint8_t> is_changed(triangles(), 0);
        bool any = false;
        for (std::size_t t = 0; t < triangles(); ++t) {
            if (is_changed[t] != 0) continue;
            const double before = angle_of(mesh_.corners[t]);
            if (before > kSharpAngle) continue;
            HalfEdge best = HalfEdge::none();
            double largest = 1.01 * before;
            for (int i = 0; i < 3; ++i) {
                const HalfEdge edge(static_cast<std::int32_t>(t), i), twin = mesh_.twin(edge);
                if (!is_free(edge) || is_changed[index(twin.triangle())] != 0 ||
                    (is_divided(mesh_.apex(edge)) && is_divided(mesh_.apex(twin))))
                    continue;
                const double after = angle_after_flip(edge);
                if (after <= largest || leaves_border_corner(edge)) continue;
                largest = after;
                best = edge;
            }
            if (best.is_none()) continue;
            is_changed[t] = is_changed[index(mesh_.twin(best).triangle())] = 1;
            flip(best);
            any = true;
        }
        return any;
    }

    /// Whether a flip would leave a triangle with two edges outside.
    bool leaves_border_corner(HalfEdge edge) const {
        const HalfEdge twin = mesh_.twin(edge);
        return (mesh_.is_border(edge.prev()) && mesh_.is_border(twin.next())) ||
               (mesh_.is_border(edge.next()) && mesh_.is_border(twin.prev()));
    }

    /// Moves nodes at sharp angles to where their triangles are best.
    bool move_nodes() {
        std::vector<std::uint8_t> is_sharp(mesh_.points.size(), 0);
        for (const Triangle& t : mesh_.corners) {
            if (angle_of(t) > kSharpAngle) continue;
            for (const std::int32_t n : t)
                is_sharp[index(n)] = 1;
        }
        if (std::ranges::find(is_sharp, 1) == is_sharp.end()) return false;
        mesh_.for_each_edge([&](HalfEdge edge) { mesh_.fix(edge, !is_free(edge)); });
        meshing::SizeField size(1);
        meshing::Valences valences(mesh_, size);
        meshing::StarMoves moves(valences);
        bool any = false;
        for (std::size_t n = 0; n < is_sharp.size(); ++n) {
            const auto node = static_cast<std::int32_t>(n);
            if (is_sharp[n] == 0 || valences.is_fixed(node)) continue;
            const PlanPoint start = at(node);
            moves.free(node);
            moves.move(node);
            any = any || at(node) != start;
        }
        return any;
    }

    std::ptrdiff_t sharp_triangles() const {
        return std::count_if(mesh_.corners.begin(), mesh_.corners.end(),
                             [&](const Triangle& t) { return angle_of(t) < kLeastAngle; });
    }

    /// Edges on lines and at the border that lie across from an obtuse angle beside one that is too
    /// sharp are divided, where fewer sharp angles are left then.
    void divide_lines_at_sharp_angles() {
        const auto before = sharp_triangles();
        if (before == 0) return;
        const meshing::FlatMesh mesh = mesh_;
        const LineEdges edges = edges_;
        if (!divide_lines()) return;
        find_divided();
        flip_and_move();
        if (sharp_triangles() < before) return;
        mesh_ = mesh;
        edges_ = edges;
    }

    bool divide_lines() {
        const std::size_t count = triangles();
        std::vector<std::uint8_t> is_changed(count, 0);
        for (std::size_t t = 0; t < count; ++t) {
            if (is_changed[t] != 0 || angle_of(mesh_.corners[t]) >= kLeastAngle) continue;
            const HalfEdge edge = longest_edge(static_cast<std::int32_t>(t)),
                           twin = mesh_.twin(edge);
            if (is_free(edge) || (!twin.is_none() && is_changed[index(twin.triangle())] != 0))
                continue;
            // on a step the middle is divided, so it may have no edge to another such node
            if (is_inner_step(edge) &&
                (is_divided(mesh_.apex(edge)) || is_divided(mesh_.apex(twin))))
                continue;
            is_changed[t] = 1;
            if (!twin.is_none()) is_changed[index(twin.triangle())] = 1;
            divide(edge);
            is_changed.resize(triangles(), 1);
        }
        return triangles() > count;
    }

    HalfEdge longest_edge(std::int32_t triangle) const {
        HalfEdge longest = HalfEdge::none();
        double most = 0;
        for (int i = 0; i < 3; ++i) {
            const HalfEdge edge(triangle, i);
            const double length = distance(mesh_.origin_point(edge), mesh_.target_point(edge));
            if (length > most) longest = edge;
            most = std::max(most, length);
        }
        assert(!longest.is_none());
        return longest;
    }

    /// Divides an edge in its middle. The corners across from it become the first of their
    /// triangles.
    void divide(HalfEdge edge) {
        const std::int32_t a = mesh_.from(edge), b = mesh_.to(edge),
                           middle = add_node(halfway(at(a), at(b))),
                           first_added = static_cast<std::int32_t>(triangles());
        const HalfEdge twin = mesh_.twin(edge);
        edges_.divide(a, b, middle);
        mesh_.divide(edge, middle);
        mesh_.rotate(edge.triangle(), 2);
        if (!twin.is_none()) mesh_.rotate(twin.triangle(), 2);
        for (auto t = first_added; std::cmp_less(t, triangles()); ++t)
            mesh_.rotate(t, 2);
    }

    meshing::FlatMesh& mesh_;
    LineEdges& edges_;
    std::vector<std::uint8_t> is_divided_;  ///< of each node: Pillars
};

}  // namespace

void adapt_plan(meshing::FlatMesh& mesh, LineEdges& edges) {
    Adaption(mesh, edges).run();
}

}  // namespace realmodel::simulation
