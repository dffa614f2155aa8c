// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/edge_cutting.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <deque>
#include <limits>
#include <optional>

#include "meshing/plan_predicates.hpp"
#include "meshing/point_insertion.hpp"

namespace realmodel::meshing {

namespace {

/// The point, or one of the eight doubles around it, at which an edge can be cut.
std::optional<PlanPoint> point_with_room(const FlatMesh& mesh, HalfEdge edge, const PlanPoint& p) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    const auto beside = [](double x) {
        return std::array{x, std::nextafter(x, -kInfinity), std::nextafter(x, kInfinity)};
    };
    for (const double x : beside(p[0]))
        for (const double y : beside(p[1]))
            if (can_cut(mesh, edge, {x, y})) return PlanPoint{x, y};
    return std::nullopt;
}

}  // namespace

double rounding_slack(std::span<const PlanPoint> points) {
    double largest = 0;
    for (const PlanPoint& p : points)
        largest = std::max({largest, std::abs(p[0]), std::abs(p[1])});
    // a + t (b - a) is off by 5 half units in the last place of the largest coordinate at most, on
    // either axis, so by less than 4 units in all.
    return 4 * largest * std::numeric_limits<double>::epsilon();
}

bool has_room(const FlatMesh& mesh, HalfEdge edge, double nearest, double slack) {
    const PlanPoint &a = mesh.origin_point(edge), &b = mesh.target_point(edge),
                    &c = mesh.apex_point(edge);
    const double length = std::sqrt(squared_distance(a, b));
    const double height = twice_area(a, b, c) / length;
    // Both edges may be bent, and the height is itself rounded.
    const double needed = 4 * slack;
    const double farther = std::sqrt(std::max(squared_distance(a, c), squared_distance(b, c)));
    return height > needed && nearest * height > needed * farther;
}

EdgeCutting::EdgeCutting(const ConstrainedTriangulation& triangulation,
                         const std::vector<bool>& inside, std::vector<PlanPoint> points)
    : inside_(inside), at_(points.size()) {
    const auto count = static_cast<std::int32_t>(triangulation.triangles.size());
    mesh_.points = std::move(points);
    mesh_.corners = triangulation.triangles;
    mesh_.twins.resize(count);
    mesh_.marks.resize(count);
    mesh_.for_each_edge([&](HalfEdge edge) {
        const std::int32_t t = edge.triangle();
        const int i = edge.index();
        at_[mesh_.from(edge)] = edge;
        if (triangulation.constrained[t][i]) mesh_.fix(edge);
        const std::int32_t other = triangulation.neighbors[t][i];
        if (other < 0) return;
        const auto& corners = mesh_.corners[other];
        const auto twin = std::find(corners.begin(), corners.end(), mesh_.to(edge));
        assert(twin != corners.end());
        mesh_.twins[t][i] = {other, static_cast<int>(twin - corners.begin())};
    });
}

void EdgeCutting::add_points(std::span<const PlanPoint> points) {
    const auto more = points.subspan(mesh_.points.size());
    mesh_.points.insert(mesh_.points.end(), more.begin(), more.end());
    at_.resize(points.size());
}

HalfEdge EdgeCutting::between(std::int32_t a, std::int32_t b) const {
    HalfEdge found = HalfEdge::none();
    mesh_.visit_star(at_[a], [&](HalfEdge edge) {
        if (!found.is_none()) return;
        if (mesh_.to(edge) == b) found = edge;
        if (mesh_.apex(edge) == b) found = edge.prev();
    });
    return found;
}

bool EdgeCutting::insert(HalfEdge edge, std::int32_t point) {
    const std::optional<PlanPoint> p = point_with_room(mesh_, edge, mesh_.points[point]);
    if (!p) return false;
    mesh_.points[point] = *p;
    const HalfEdge other = mesh_.twin(edge);
    inside_.push_back(inside_[edge.triangle()]);
    if (!other.is_none()) inside_.push_back(inside_[other.triangle()]);
    mesh_.visit_star(mesh_.insert_on(edge, point), [&](HalfEdge e) {
        at_[mesh_.from(e)] = e;
        at_[mesh_.to(e)] = e.next();
        at_[mesh_.apex(e)] = e.prev();
    });
    assert(inside_.size() == mesh_.corners.size());
    return true;
}

void EdgeCutting::cut(std::span<const CutEdge> edges, const Check& check) {
    Ticker tick(check, 1024);
    std::deque<CutEdge> open(edges.begin(), edges.end());
    while (!open.empty()) {
        tick(0);
        const auto [edge, first, last] = open.front();
        open.pop_front();
        const HalfEdge whole = between(edge[0], edge[1]);
        assert(!whole.is_none() && mesh_.is_fixed(whole));
        // The middle one; where that has no room any other.
        std::int32_t point = first + (last - first) / 2;
        bool is_cut = first < last && insert(whole, point);
        for (std::int32_t i = first; i < last && !is_cut; ++i) {
            point = i;
            is_cut = insert(whole, point);
        }
        if (!is_cut) continue;
        if (first < point) open.push_back({{edge[0], point}, first, point});
        if (point + 1 < last) open.push_back({{point, edge[1]}, point + 1, last});
    }
}

FlatMesh EdgeCutting::take_inside(double nearest, double slack) && {
    const auto count = static_cast<std::int32_t>(mesh_.corners.size());
    for (std::int32_t t = 0; t < count; ++t) {
        for (int i = 0; i < 3 && inside_[t]; ++i) {
            const HalfEdge edge(t, i), other = mesh_.twin(edge);
            if (other.is_none() || is_inside(other)) continue;
            if (!has_room(mesh_, other, nearest, slack)) mesh_.fix(edge, true, true);
            mesh_.twins[t][i] = HalfEdge::none();
        }
    }
    for (std::int32_t t = 0; t < count; ++t)
        if (!inside_[t]) mesh_.corners[t] = {-1, -1, -1};
    mesh_.compact();
    return std::move(mesh_);
}

}  // namespace realmodel::meshing
