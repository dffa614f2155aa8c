// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

#include "exact/side_rows.hpp"
#include "strata/tiling/polygon.hpp"

namespace realmodel::strata {

/// Cuts one facet after another with the polygons of a tiling. The common part of two convex
/// polygons follows from where the corners of each lie against the lines of the other, without a
/// question about a crossing; and polygons of a tiling have corners and lines in common, so what
/// was found of these is kept for as long as the facet lasts.
class FacetClipper {
public:
    explicit FacetClipper(LocalArrangement& scope) : scope_(scope), clipper_(scope) {}

    /// Begins with a facet, which has to stay where it is.
    void begin(PolygonView facet);
    /// The common part of the facet and a convex polygon, valid until the next call; empty without
    /// area.
    PolygonView intersect(PolygonView window);
    /// Whether the two share an area; makes no points.
    bool meets(PolygonView window);

private:
    bool fits(PolygonView window) const {
        return facet_.size() <= exact::kRowLength && window.size() <= exact::kRowLength;
    }
    bool compare(PolygonView window);
    /// Known things are looked up in the slot that their number gives; who comes later stays.
    static constexpr std::size_t kKnown = 64;
    struct KnownPoint {
        PointId point = kNone;
        std::uint32_t facet = 0;  ///< of which this is known
        exact::Sides sides;       ///< of the facet's lines
    };
    struct KnownLine {
        LineId line = kNone;
        std::uint32_t facet = 0;
        exact::Sides sides;  ///< of the facet's corners, seen along the line
    };

    exact::Sides sides_of_point(PointId point);
    KnownLine& known_line(PolygonView window, std::size_t edge);
    PolygonView follow(PolygonView window);
    void cut_by_lines(PolygonView window);
    void rotate_result(PolygonView window);
    PointId crossing(std::size_t facet_edge, LineId line);

    LocalArrangement& scope_;
    Clipper clipper_;
    PolygonView facet_;
    std::uint32_t number_ = 0;  ///< of the facet
    exact::PointRow corners_;
    exact::LineRow lines_;
    std::array<KnownPoint, kKnown> points_;
    std::array<KnownLine, kKnown> known_lines_;
    std::array<exact::Sides, exact::kRowLength> edges_;
    std::array<exact::Sides, exact::kRowLength> window_corners_;
    std::array<std::uint32_t, exact::kRowLength> crossed_;  ///< the facet's edges, by a window's
    bool on_line_ = false;  ///< whether a corner of one lies on a line of the other
    Polygon result_;
    /// A corner of what lines have left of the facet.
    struct Left : Corner {
        std::int32_t of_facet = -1;  ///< which corner of the facet it is, -1: a new one
    };
    std::vector<Left> left_, next_left_;
    std::vector<int> sides_;
};

}  // namespace realmodel::strata
