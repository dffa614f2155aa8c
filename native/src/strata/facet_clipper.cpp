// SPDX-License-Identifier: GPL-3.0-or-later
#include "facet_clipper.hpp"

namespace realmodel::strata {

using exact::Sides;

namespace {

/// An edge of a polygon.
exact::DirectedEdge edge_of(PolygonView polygon, std::size_t i) {
    return {polygon[i].line, polygon[i].point, polygon[i + 1 < polygon.size() ? i + 1 : 0].point};
}

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
        scope_.add_to(corners_, facet[i].point);
        scope_.add_to(lines_, edge_of(facet, i));
    }
}

const FacetClipper::KnownPoint& FacetClipper::known_point(PointId point) {
    KnownPoint& known = points_[static_cast<std::size_t>(point) % kKnown];
    if (known.point != point || known.facet != number_)
        known = {point, number_, scope_.sides(lines_, point)};
    return known;
}

FacetClipper::KnownLine& FacetClipper::known_line(PolygonView window, std::size_t edge) {
    const LineId line = exact::line_of(window[edge].line);
    KnownLine& known = known_lines_[static_cast<std::size_t>(line) % kKnown];
    if (known.line != line || known.facet != number_) {
        known.line = line;
        known.facet = number_;
        const exact::DirectedEdge along = edge_of(window, edge);
        known.sides = scope_.sides(along, corners_);
        if (exact::is_reversed(along.line)) std::swap(known.sides.left, known.sides.right);
        known.crossing.fill(-1);
    }
    return known;
}

PolygonView FacetClipper::intersect(PolygonView window) {
    if (!fits(window)) return clipper_.intersect(facet_, window);
    if (!compare(window)) return {};
    return on_line_ ? cut_by_lines(window) : follow(window);
}

bool FacetClipper::meets(PolygonView window) {
    return fits(window) ? compare(window) : clipper_.overlap(facet_, window);
}

/// Finds where the corners of facet and window lie against the lines of the other; false where one
/// of these lines has all of one to its left and nothing of the other.
bool FacetClipper::compare(PolygonView window) {
    const std::uint32_t all = (1U << facet_.size()) - 1U;
    on_line_ = false;
    for (std::size_t j = 0; j < window.size(); ++j) {
        KnownLine& known = known_line(window, j);
        Sides corners = known.sides;
        if (exact::is_reversed(window[j].line)) std::swap(corners.left, corners.right);
        if (corners.left == 0) return false;
        on_line_ |= (corners.left | corners.right) != all;
        edges_[j] = {&known, corners};
    }
    std::uint32_t reached = 0;
    for (std::size_t j = 0; j < window.size(); ++j) {
        window_corners_[j] = known_point(window[j].point).sides;
        reached |= window_corners_[j].left;
        on_line_ |= (window_corners_[j].left | window_corners_[j].right) != all;
    }
    return reached == all;
}

PointId FacetClipper::crossing(std::size_t i, std::size_t j, PolygonView window) {
    KnownLine& known = *edges_[j].known;
    const LineId line = exact::line_of(window[j].line);
    // two lines of the window may have the same place
    if (known.line != line)
        return scope_.crossing_between_ends(exact::line_of(facet_[i].line), line);
    PointId& point = known.crossing[i];
    if (point < 0) point = scope_.crossing_between_ends(exact::line_of(facet_[i].line), line);
    return point;
}

/// Goes around the facet, and from each edge where it leaves the window around the window until
/// that leaves the facet, where the facet comes in again. No corner lies on a line of the other.
PolygonView FacetClipper::follow(PolygonView window) {
    const std::size_t m = facet_.size(), n = window.size();
    const std::uint32_t all = (1U << m) - 1U;
    std::uint32_t inside = all;  // the facet's corners in the window
    for (std::size_t j = 0; j < n; ++j)
        inside &= edges_[j].corners.left;
    if (inside == all) return facet_;
    result_.clear();
    for (std::size_t i = 0; i < m; ++i) {
        const std::size_t to = i + 1 < m ? i + 1 : 0;
        if (bit(inside, i)) result_.push_back(facet_[i]);
        std::size_t out = n;
        for (std::size_t j = 0; j < n; ++j) {
            const bool here = bit(edges_[j].corners.left, i);
            if (here == bit(edges_[j].corners.left, to)) continue;
            const std::size_t next = j + 1 < n ? j + 1 : 0;
            if (bit(window_corners_[j].left, i) == bit(window_corners_[next].left, i)) continue;
            if (here) {
                out = j;
            } else {
                result_.push_back({crossing(i, j, window), facet_[i].line});
            }
        }
        if (out == n) continue;
        result_.push_back({crossing(i, out, window), window[out].line});
        for (std::size_t j = out + 1 < n ? out + 1 : 0; window_corners_[j].left == all && j != out;
             j = j + 1 < n ? j + 1 : 0)
            result_.push_back(window[j]);
    }
    if (result_.empty()) result_.assign(window.begin(), window.end());  // it lies in the facet
    return result_;
}

/// Clips the facet by the lines of the window in turn, as `clip` does, where a corner of one may
/// lie on a line of the other; only about new corners more is asked.
PolygonView FacetClipper::cut_by_lines(PolygonView window) {
    left_.clear();
    for (std::size_t i = 0; i < facet_.size(); ++i)
        left_.push_back({facet_[i], static_cast<std::int32_t>(i)});
    for (std::size_t j = 0; j < window.size(); ++j) {
        const DirectedLine line = window[j].line;
        const Sides& known = edges_[j].corners;
        bool any_left = false, any_right = false;
        sides_.clear();
        for (const Left& at : left_) {
            int side;
            if (at.of_facet < 0) {
                side = scope_.side(line, at.point);
            } else {
                const auto i = static_cast<std::size_t>(at.of_facet);
                side = bit(known.left, i) ? 1 : (bit(known.right, i) ? -1 : 0);
            }
            any_left |= side > 0;
            any_right |= side < 0;
            sides_.push_back(side);
        }
        if (!any_left) return {};
        if (!any_right) continue;
        next_left_.clear();
        keep_left(scope_, left_, line, sides_, next_left_);
        std::swap(left_, next_left_);
    }
    result_.assign(left_.begin(), left_.end());
    return result_;
}

}  // namespace realmodel::strata
