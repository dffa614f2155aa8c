// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/overlay/facet_clipper.hpp"

#include <algorithm>
#include <cassert>

namespace realmodel::strata {

using exact::Sides;

namespace {

bool bit(std::uint32_t bits, std::size_t i) {
    return (bits >> i & 1U) != 0;
}

}  // namespace

void FacetClipper::begin(PolygonView facet) {
    facet_ = facet;
    ++number_;
    corners_.clear();
    lines_.clear();
    if (facet.size() > exact::kRowLength) return;
    for (std::size_t i = 0; i < facet.size(); ++i) {
        corners_.add(scope_, facet[i].point);
        lines_.add(scope_, edge_of(facet, i));
    }
}

[[gnu::always_inline]] inline Sides FacetClipper::sides_of_point(PointId point) {
    KnownPoint& known = points_[index(point) % kKnown];
    if (known.point != point || known.facet != number_)
        known = {point, number_, sides_of(scope_, lines_, point)};
    return known.sides;
}

[[gnu::always_inline]] inline FacetClipper::KnownLine& FacetClipper::known_line(PolygonView window,
                                                                                std::size_t edge) {
    const LineId line = window[edge].line.id();
    KnownLine& known = known_lines_[index(line) % kKnown];
    if (known.line != line || known.facet != number_) {
        const exact::DirectedEdge along = edge_of(window, edge);
        const Sides sides = sides_of(scope_, along, corners_);
        known.line = line;
        known.facet = number_;
        known.sides = along.line.is_reversed() ? sides.turned() : sides;
    }
    return known;
}

PolygonView FacetClipper::intersect(PolygonView window) {
    if (fits(window)) {
        if (!compare(window)) return {};
        if (!on_line_) return follow(window);
        cut_by_lines(window);
    } else {
        const PolygonView common = clipper_.intersect(facet_, window);
        result_.assign(common.begin(), common.end());
    }
    rotate_result(window);
    return result_;
}

bool FacetClipper::meets(PolygonView window) {
    return fits(window) ? compare(window) : clipper_.overlap(facet_, window);
}

/// Finds where the corners of facet and window lie against the lines of the other; false where one
/// of these lines has all of one to its left and nothing of the other. Corners come first: more of
/// the polygons of a tiling meet in a corner than along a line.
bool FacetClipper::compare(PolygonView window) {
    const std::uint32_t all = exact::all_of_row(facet_.size());
    std::uint32_t reached = 0, beside = all;
    for (std::size_t j = 0; j < window.size(); ++j) {
        const Sides lines = sides_of_point(window[j].point);
        window_corners_[j] = lines;
        reached |= lines.left();
        beside &= lines.either();
    }
    if (reached != all) return false;
    for (std::size_t j = 0; j < window.size(); ++j) {
        const Sides known = known_line(window, j).sides;
        const Sides corners = window[j].line.is_reversed() ? known.turned() : known;
        if (corners.left() == 0) return false;
        beside &= corners.either();
        edges_[j] = corners;
    }
    on_line_ = beside != all;
    return true;
}

PointId FacetClipper::crossing(std::size_t i, LineId line) {
    return scope_.crossing_between_ends(facet_[i].line.id(), line);
}

/// Goes around the facet, and from each edge where it leaves the window around the window until
/// that leaves the facet, where the facet comes in again. No corner lies on a line of the other.
PolygonView FacetClipper::follow(PolygonView window) {
    const std::size_t m = facet_.size(), n = window.size();
    const std::uint32_t all = exact::all_of_row(m);
    // The facet's corners in the window, and its edges where it comes in and goes out.
    std::uint32_t inside = all, in = 0, out = 0;
    for (std::size_t j = 0; j < n; ++j) {
        const std::uint32_t left = edges_[j].left();
        const std::uint32_t next_left = left >> 1 | (left & 1U) << (m - 1);
        const std::uint32_t crossed =
            (left ^ next_left) &
            (window_corners_[j].left() ^ window_corners_[j + 1 < n ? j + 1 : 0].left());
        crossed_[j] = crossed;
        inside &= left;
        out |= crossed & left;
        in |= crossed & ~left;
    }
    if (inside == all) return facet_;
    result_.clear();
    const auto edge_crossed = [&](std::size_t i, bool outwards) {
        // a crossing is in a window's edge as in the facet's, for the predicates agree
        for (std::size_t j = 0; j < n; ++j) {
            if (bit(crossed_[j], i) && bit(edges_[j].left(), i) == outwards) return j;
        }
        assert(false);
        return n - 1;
    };
    for (std::size_t i = 0; i < m; ++i) {
        if (bit(inside, i)) result_.push_back(facet_[i]);
        if (bit(in, i))
            result_.push_back(
                {crossing(i, window[edge_crossed(i, false)].line.id()), facet_[i].line});
        if (!bit(out, i)) continue;
        const std::size_t left_at = edge_crossed(i, true);
        result_.push_back({crossing(i, window[left_at].line.id()), window[left_at].line});
        for (std::size_t j = left_at + 1 < n ? left_at + 1 : 0;
             window_corners_[j].left() == all && j != left_at; j = j + 1 < n ? j + 1 : 0)
            result_.push_back(window[j]);
    }
    if (result_.empty()) result_.assign(window.begin(), window.end());  // it lies in the facet
    return result_;
}

/// Clips the facet by the lines of the window in turn, as `clip` does, where a corner of one may
/// lie on a line of the other; only about new corners more is asked.
void FacetClipper::cut_by_lines(PolygonView window) {
    result_.clear();
    left_.clear();
    for (std::size_t i = 0; i < facet_.size(); ++i)
        left_.push_back({facet_[i], static_cast<std::int32_t>(i)});
    for (std::size_t j = 0; j < window.size(); ++j) {
        const DirectedLine line = window[j].line;
        const Sides& known = edges_[j];
        bool any_left = false, any_right = false;
        sides_.clear();
        for (const Left& at : left_) {
            int side;
            if (at.of_facet < 0) {
                side = scope_.side(line, at.point);
            } else {
                const auto i = static_cast<std::size_t>(at.of_facet);
                side = bit(known.left(), i) ? 1 : (bit(known.right(), i) ? -1 : 0);
            }
            any_left |= side > 0;
            any_right |= side < 0;
            sides_.push_back(side);
        }
        if (!any_left) return;
        if (!any_right) continue;
        next_left_.clear();
        keep_left(scope_, left_, line, sides_, next_left_);
        std::swap(left_, next_left_);
    }
    result_.assign(left_.begin(), left_.end());
}

/// Has the result begin where `follow` and TilingWalk begin: with the first of the facet's edges
/// that it has a part of, or with the window's first corner where it has none.
void FacetClipper::rotate_result(PolygonView window) {
    const auto begin_at = [this](const auto& is_first) {
        for (std::size_t k = 0; k < result_.size(); ++k) {
            if (!is_first(result_[k], result_[(k > 0 ? k : result_.size()) - 1])) continue;
            std::rotate(result_.begin(), result_.begin() + static_cast<std::ptrdiff_t>(k),
                        result_.end());
            return true;
        }
        return false;
    };
    for (const Corner& edge : facet_) {
        if (begin_at([&](const Corner& corner, const Corner& before) {
                return corner.line == edge.line &&
                       (corner.point == edge.point || before.line != edge.line);
            }))
            return;
    }
    begin_at([&](const Corner& corner, const Corner&) { return corner.point == window[0].point; });
}

}  // namespace realmodel::strata
