// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "exact/reach_filter.hpp"
#include "strata/tiling/surface_tiling.hpp"

namespace realmodel::strata {

/// Walks along the edges of facets through the triangles of a tiling, from neighbor to neighbor:
/// which way an edge leaves a triangle follows from the side of one corner. What is found of an
/// edge is kept for the facet beyond it, points where lines cross included. Only where nothing
/// coincides, no corner with an edge of the other, and the tiling has neighbors all over the facet.
class TilingWalk {
public:
    TilingWalk(LocalArrangement& scope, const SurfaceTiling& tiling)
        : scope_(scope), tiling_(tiling) {}

    /// Begins with a facet, which has to stay where it is; false where this is not for the walk.
    bool begin(PolygonView facet);
    /// The triangles that share an area with the facet, ascending.
    std::size_t size() const { return met_.size(); }
    std::int32_t polygon(std::size_t i) const { return met_[i].polygon; }
    /// What the facet has in common with one of them, valid until the next call.
    PolygonView common(std::size_t i);
    /// Finds where to begin among polygons that may meet a facet of which nothing is known; false
    /// where something is, or this is not for the walk.
    bool locate(PolygonView facet, std::span<const std::int32_t> polygons);

private:
    /// Instead of a triangle: not known yet, in the interior of none with neighbors.
    static constexpr std::int32_t kUnknown = -1, kNowhere = -2;
    /// Known things are looked up in the slot that their number gives; who comes last stays.
    static constexpr std::size_t kKnown = 2048;
    /// So many triangles that no edge of the facet meets at most.
    static constexpr std::size_t kMostInside = 64;

    /// An edge of a triangle by its first corner.
    struct TilingEdge {
        std::int32_t triangle = kUnknown;
        std::uint32_t corner = 0;
    };
    /// Where an edge of a facet crosses an edge of the tiling: seen from both triangles.
    struct EdgeCrossing {
        TilingEdge left, entered;
        PointId point;  ///< kNone until it is asked for
    };
    /// An edge of a facet: its crossings, which are side by side.
    struct FacetEdge {
        LineId line = kNone;
        PointId from = kNone, to = kNone;
        std::uint32_t first = 0, end = 0;
        bool is_walked = false;  ///< whether it could be
        bool is_reversed = false;

        std::size_t size() const { return end - first; }
        std::uint32_t crossing(std::size_t n) const {
            return static_cast<std::uint32_t>(is_reversed ? end - 1 - n : first + n);
        }
        FacetEdge reversed() const {
            FacetEdge other = *this;
            other.is_reversed = true;
            return other;
        }
    };
    struct PointLocation {
        PointId point = kNone;
        std::int32_t triangle = kUnknown;
    };
    /// A piece of the facet's border in one triangle: where it comes in, corners, where it goes
    /// out. The border begins and ends at corner 0.
    struct Stretch {
        TilingEdge in, out;
        std::uint32_t crossing_in = 0, crossing_out = 0;
        std::uint32_t first_corner = 0, end_corner = 0;
    };
    /// A triangle that is met, with its stretches of the border, in order; none of it inside.
    struct Met {
        std::int32_t polygon;
        std::size_t first, end;
    };

    PolygonView triangle(std::int32_t t) const { return tiling_.polygons[index(t)]; }
    PointLocation& location(PointId point) { return locations_[index(point) % kKnown]; }
    std::int32_t known_triangle(PointId point) {
        return location(point).point == point ? location(point).triangle : kUnknown;
    }
    TilingEdge beyond(TilingEdge edge) const;
    int side(TilingEdge edge, PointId point);
    bool walk(const exact::DirectedEdge& edge, std::int32_t t);
    FacetEdge way_along(const exact::DirectedEdge& edge, std::int32_t t);
    EdgeCrossing seen_from(const FacetEdge& way, std::size_t n) const;
    void find_stretches();
    bool find_met();
    const Stretch& stretch(std::size_t o) const {
        return stretches_[static_cast<std::uint32_t>(order_[o])];
    }
    const Stretch& next_stretch(const Met& met, std::size_t o) const {
        return stretch(o + 1 < met.end ? o + 1 : met.first);
    }
    PointId point_of(std::size_t crossing, std::size_t edge);

    LocalArrangement& scope_;
    const SurfaceTiling& tiling_;
    PolygonView facet_;
    std::vector<FacetEdge> ways_;  ///< none until a location is known
    std::vector<PointLocation> locations_;
    Array<EdgeCrossing> crossings_;
    Array<FacetEdge> border_;  ///< the facet's edges
    Array<Stretch> stretches_;
    Array<std::uint64_t> order_;  ///< triangles with their stretches
    Array<Met> met_;
    Array<std::int32_t> inside_;
    Polygon result_;
    std::int32_t start_ = kUnknown;  ///< has corner 0
};

}  // namespace realmodel::strata
