// SPDX-License-Identifier: GPL-3.0-or-later
#include "booleans/facet_division.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "arrangement/polygons.hpp"
#include "base/parallel.hpp"
#include "exact/space_points.hpp"
#include "meshing/constrained_delaunay.hpp"

namespace realmodel::booleans {

namespace {

/// Triangles of a polygon of any shape: a fan from its least corner. Those without extent are left
/// out.
void add_fan(const std::vector<SpacePointId>& loop, std::vector<TriangleCorners>& triangles) {
    const auto least =
        static_cast<std::size_t>(std::min_element(loop.begin(), loop.end()) - loop.begin());
    const auto at = [&](std::size_t i) { return loop[(least + i) % loop.size()]; };
    for (std::size_t i = 1; i + 1 < loop.size(); ++i) {
        const TriangleCorners t{at(0), at(i), at(i + 1)};
        if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) triangles.push_back(t);
    }
}

/// The places of a facet's points in a view along an axis, as CGAL's triangulation asks for them:
/// which way they turn is decided exactly; whether an edge is Delaunay by the angles in space, and
/// where that is a tie by numbers. So triangles near one another that have the same points get the
/// same edges, along whichever axis they are seen.
class PlacesInView {
public:
    using Point_2 = SpacePointId;
    using Segment_2 = SpaceEdge;
    using Triangle_2 = TriangleCorners;
    struct ByCoordinate {
        const PlacesInView* view;
        std::size_t axis;
        CGAL::Comparison_result operator()(Point_2 a, Point_2 b) const {
            return CGAL::enum_cast<CGAL::Comparison_result>(
                exact::compare(view->places_, axis, a, b));
        }
    };
    struct ByTurn {
        const PlacesInView* view;
        CGAL::Orientation operator()(Point_2 a, Point_2 b, Point_2 c) const {
            return CGAL::enum_cast<CGAL::Orientation>(view->turn(a, b, c));
        }
    };
    struct ByAngles {
        const PlacesInView* view;
        CGAL::Oriented_side operator()(Point_2 a, Point_2 b, Point_2 c, Point_2 d) const {
            return view->should_flip({a, b, c}, d) ? CGAL::ON_POSITIVE_SIDE
                                                   : CGAL::ON_NEGATIVE_SIDE;
        }
    };
    struct Copy {
        const Point_2& operator()(const Point_2& p) const { return p; }
    };
    using Compare_x_2 = ByCoordinate;
    using Compare_y_2 = ByCoordinate;
    using Orientation_2 = ByTurn;
    using Side_of_oriented_circle_2 = ByAngles;
    using Construct_point_2 = Copy;

    /// @param names  of places: the points that lie there
    /// @param tests_left  so many edges are tested still: rounded angles might ask for flips
    ///                    without end
    PlacesInView(const SpacePoints& points, const SpacePoints& places,
                 const std::vector<SpacePointId>& names, const TriangleCorners& corners,
                 std::size_t& tests_left)
        : points_(points), places_(places), names_(names), tests_left_(tests_left) {
        // the view in which the triangle is largest, of those in which it has an area
        const auto position = [&](std::size_t k) -> const Vec3& {
            return places.rounded(corners[k]);
        };
        const Vec3 normal = triangle_normal(position(0), position(1), position(2));
        double largest = -1;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (std::abs(normal[axis]) <= largest) continue;
            const int turn = exact::orient2d(places, axis, corners[0], corners[1], corners[2]);
            if (turn == 0) continue;
            largest = std::abs(normal[axis]);
            axis_ = axis;
            facing_ = turn;
        }
    }

    bool has_area() const { return facing_ != 0; }
    std::size_t axis() const { return axis_; }
    int turn(SpacePointId a, SpacePointId b, SpacePointId c) const {
        return facing_ * exact::orient2d(places_, axis_, a, b, c);
    }

    Compare_x_2 compare_x_2_object() const { return {this, (axis_ + (facing_ > 0 ? 1 : 2)) % 3}; }
    Compare_y_2 compare_y_2_object() const { return {this, (axis_ + (facing_ > 0 ? 2 : 1)) % 3}; }
    Orientation_2 orientation_2_object() const { return {this}; }
    Side_of_oriented_circle_2 side_of_oriented_circle_2_object() const { return {this}; }
    Construct_point_2 construct_point_2_object() const { return {}; }

private:
    /// Whether the edge of a triangle that a point lies beyond is to be exchanged with the other
    /// diagonal of the quadrilateral, which must be convex: the sum of the angles across from the
    /// edge is more than half a turn. The same for the same four points in whichever triangles.
    bool should_flip(const TriangleCorners& t, SpacePointId p) const {
        std::size_t beyond = 3;
        for (std::size_t k = 0; k < 3; ++k) {
            const int side = turn(t[k], t[(k + 1) % 3], p);
            if (side == 0 || (side < 0 && beyond < 3)) return false;
            if (side < 0) beyond = k;
        }
        if (beyond == 3) return true;
        if (tests_left_ == 0) return false;
        --tests_left_;
        const auto name = [&](SpacePointId place) { return names_[index(place)]; };
        auto [a, b] = unordered(name(t[beyond]), name(t[(beyond + 1) % 3]));
        auto [c, d] = unordered(name(t[(beyond + 2) % 3]), name(p));
        const bool other_first = c < a;
        if (other_first) {
            std::swap(a, c);
            std::swap(b, d);
        }
        constexpr double kTie = 1e-6;
        return (cotangent(c, a, b) + cotangent(d, a, b) < -kTie) != other_first;
    }
    /// The cotangent of the angle at a point, between two others.
    double cotangent(SpacePointId at, SpacePointId from, SpacePointId to) const {
        const Vec3 u = minus(points_.rounded(from), points_.rounded(at)),
                   v = minus(points_.rounded(to), points_.rounded(at));
        return dot(u, v) / length(cross(u, v));
    }

    const SpacePoints& points_;
    const SpacePoints& places_;
    const std::vector<SpacePointId>& names_;
    std::size_t& tests_left_;
    std::size_t axis_ = 0;
    int facing_ = 0;
};

/// A triangulation of one triangle, in which points are where they would be if they lay on it.
class FacetDivision {
    using FacetCdt = meshing::CdtOf<PlacesInView>;

public:
    FacetDivision(const SpacePoints& points, const FacetPoints& facet, Progress* progress)
        : points_(points),
          progress_(progress),
          corners_{place_of(facet.corners[0]), place_of(facet.corners[1]),
                   place_of(facet.corners[2])},
          view_(points, places_, names_, corners_, tests_left_),
          cdt_(view_) {
        if (!has_area()) return;
        for (std::size_t k = 0; k < 3; ++k)
            insert(corners_[k], facet.corners[k]);
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t next = (k + 1) % 3;
            const std::size_t axis = edge_axis(points, facet.corners[k], facet.corners[next]);
            for (const SpacePointId p : facet.on_edges[k])
                insert(places_.projected(axis, place_of(p), corners_[k], corners_[next]), p);
        }
        const auto& [a, b, c] = corners_;
        for (const SpacePointId p : facet.within) {
            if (vertices_.contains(p)) continue;
            const SpacePointId place = places_.projected(view_.axis(), place_of(p), a, b, c);
            if (view_.turn(a, b, place) > 0 && view_.turn(b, c, place) > 0 &&
                view_.turn(c, a, place) > 0)
                insert(place, p);
        }
        for (const SpaceEdge& edge : facet.wanted)
            insert_edge(edge);
    }

    bool has_area() const { return view_.has_area(); }
    std::vector<TriangleCorners> result() const {
        std::vector<TriangleCorners> triangles;
        for (const auto& face : cdt_.finite_face_handles()) {
            const auto name = [&](int k) { return names_[index(face->vertex(k)->point())]; };
            triangles.push_back({name(0), name(1), name(2)});
        }
        return triangles;
    }

private:
    SpacePointId place_of(SpacePointId p) { return places_.add(points_.rounded(p)); }
    /// Adds a point that is taken to lie at a place, unless another is there. Of two edges that are
    /// near one another both may have it.
    void insert(SpacePointId place, SpacePointId p) {
        if (progress_ != nullptr) progress_->check();
        names_.resize(std::max(names_.size(), index(place) + 1), kNone);
        if (names_[index(place)].has_value()) return;
        names_[index(place)] = p;
        const FacetCdt::Vertex_handle vertex = cdt_.insert(place, near_);
        near_ = vertex->face();
        vertices_.emplace(p, vertex);
    }
    /// Not where it crosses one before it.
    void insert_edge(const SpaceEdge& edge) {
        if (progress_ != nullptr) progress_->check();
        const auto from = vertices_.find(edge[0]), to = vertices_.find(edge[1]);
        if (from == vertices_.end() || to == vertices_.end() || from == to) return;
        tests_left_ = kMostTests + 64 * vertices_.size();
        try {
            cdt_.insert_constraint(from->second, to->second);
        } catch (const FacetCdt::Intersection_of_constraints_exception&) {  // it stays out
        }
    }

    static constexpr std::size_t kMostTests = 100'000;

    const SpacePoints& points_;
    Progress* progress_;
    SpacePoints places_;
    std::vector<SpacePointId> names_;  ///< of places: the point that is taken to lie there
    std::size_t tests_left_ = SIZE_MAX;
    TriangleCorners corners_;  ///< places
    PlacesInView view_;
    FacetCdt cdt_;
    FacetCdt::Face_handle near_;
    std::map<SpacePointId, FacetCdt::Vertex_handle> vertices_;
};

}  // namespace

std::size_t edge_axis(const SpacePoints& points, SpacePointId a, SpacePointId b) {
    const auto &p = points.rounded(a), &q = points.rounded(b);
    std::size_t axis = 0;
    for (std::size_t k = 1; k < 3; ++k) {
        if (std::abs(p[k] - q[k]) > std::abs(p[axis] - q[axis])) axis = k;
    }
    return axis;
}

std::vector<TriangleCorners> divided(const SpacePoints& points, const FacetPoints& facet,
                                     Progress* progress) {
    std::vector<SpacePointId> loop;
    std::optional<std::size_t> folded;  // the edge that the corner across it lies on
    for (std::size_t k = 0; k < 3; ++k) {
        loop.push_back(facet.corners[k]);
        const auto& between = facet.on_edges[k];
        if (std::find(between.begin(), between.end(), facet.corners[(k + 2) % 3]) != between.end())
            folded = k;
        loop.insert(loop.end(), between.begin(), between.end());
    }
    std::vector<TriangleCorners> triangles;
    if (folded) {
        // two polygons that meet in that corner, with hardly any area
        const SpacePointId tip = facet.corners[(*folded + 2) % 3];
        std::rotate(loop.begin(), std::find(loop.begin(), loop.end(), tip), loop.end());
        const auto again = std::find(loop.begin() + 1, loop.end(), tip);
        add_fan({loop.begin(), again}, triangles);
        add_fan({again, loop.end()}, triangles);
        return triangles;
    }
    const FacetDivision division(points, facet, progress);
    if (division.has_area()) return division.result();
    add_fan(loop, triangles);
    return triangles;
}

}  // namespace realmodel::booleans
