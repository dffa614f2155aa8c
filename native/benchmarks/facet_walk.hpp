// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "base/index.hpp"
#include "exact/reach_filter.hpp"
#include "strata/tiling/surface_tiling.hpp"

// For one_pass_benchmark: what strata::TilingWalk does, with all that is known of an edge kept for
// the whole layer.
namespace realmodel::strata {

inline std::uint32_t after(std::uint32_t corner) {
    return corner < 2 ? corner + 1 : 0;
}

/// A corner of a triangle, and the edge that leaves it.
struct TriangleEdge {
    std::int32_t triangle = -1;
    std::uint32_t corner = 0;
};

/// Where an edge of a facet crosses one of the surface beneath.
struct Crossing {
    std::int32_t left, entered;  ///< triangles
    std::uint8_t left_corner, entered_corner;
    std::int32_t vertex;  ///< on the edge beneath; -1 until a face has it
};

/// An edge of facets.
struct FacetEdge {
    std::int32_t layer = -1;             ///< of what follows
    std::uint32_t first = 0, count = 0;  ///< crossings, in the direction of who walked
    bool is_walked = false, is_reversed = false;
    std::int32_t cell = -1;  ///< beneath the first facet that was closed
};

/// A triangle of a surface that is part of the envelope.
struct Facet {
    std::array<Corner, 3> corner;
    std::array<std::int32_t, 3> vertex;
    PlaneId plane;
    std::int32_t surface, cell, block;
    HeightRange heights;
    enum : std::uint8_t { kCloses, kStays, kSpecial } state;
};

/// Walks around facets through the triangles of the surface beneath.
class FacetWalk {
protected:
    explicit FacetWalk(exact::PlanArrangement& geometry)
        : geometry_(geometry), location_(geometry.vertex_count()) {}

    static PolygonView triangle(const SurfaceTiling& tiling, std::int32_t t) {
        return tiling.polygons[index(t)];
    }
    static TriangleEdge beyond(const SurfaceTiling& s, TriangleEdge edge) {
        const std::int32_t next = s.neighbor[index(edge.triangle)][edge.corner];
        if (next < 0) return {};
        const PointId to = triangle(s, edge.triangle)[after(edge.corner)].point;
        const PolygonView at = triangle(s, next);
        return {next, at[0].point == to ? 0U : (at[1].point == to ? 1U : 2U)};
    }
    int side(LocalArrangement& scope, const SurfaceTiling& s, TriangleEdge edge, PointId id) const {
        const PolygonView at = triangle(s, edge.triangle);
        const Corner &from = at[edge.corner], &to = at[after(edge.corner)];
        const auto filter = exact::reach_filter_between(
            geometry_.reach(), geometry_.point(from.point), geometry_.point(to.point));
        return side_of(scope, filter, from.line, id, exact::position_in_reach(scope, id));
    }

    bool locate(LocalArrangement& scope, const SurfaceTiling& s, const Facet& facet) {
        s.grid.candidates(scope, facet.corner, candidates_);
        const PointId id = facet.corner[0].point;
        for (const std::int32_t t : candidates_) {
            bool is_in = true;
            for (std::uint32_t i = 0; i < 3 && is_in; ++i)
                is_in = side(scope, s, {t, i}, id) > 0;
            if (is_in) location_[index(id)].triangle = t;
            if (is_in) return true;
        }
        return false;
    }

    /// Walks along an edge from triangle t, which has its first point.
    bool walk(LocalArrangement& scope, const SurfaceTiling& s, const exact::DirectedEdge& edge,
              std::int32_t t) {
        const std::int32_t goal = location_[index(edge.to)].triangle;
        if (t == goal) return true;
        const exact::ReachFilter line = exact::reach_filter(scope, edge);
        const auto side_of_corner = [&](std::uint32_t corner) {
            const PointId id = triangle(s, t)[corner].point;
            return side_of(scope, line, edge.line, id, exact::position_in_reach(scope, id));
        };
        const std::array sides{side_of_corner(0), side_of_corner(1), side_of_corner(2)};
        if (sides[0] == 0 || sides[1] == 0 || sides[2] == 0) return false;
        std::uint32_t out = 0;
        while (sides[out] > 0 || sides[after(out)] < 0)
            ++out;
        while (t != goal) {
            if (goal < 0) {
                const int at = side(scope, s, {t, out}, edge.to);
                if (at == 0) return false;
                if (at > 0) break;
            }
            const TriangleEdge entered = beyond(s, {t, out});
            if (entered.triangle < 0) return false;
            crossings_.push_back({t, entered.triangle, static_cast<std::uint8_t>(out),
                                  static_cast<std::uint8_t>(entered.corner), -1});
            t = entered.triangle;
            const std::uint32_t right = after(entered.corner);
            const int opposite = side_of_corner(after(right));
            if (opposite == 0) return false;
            out = opposite > 0 ? right : after(right);
        }
        location_[index(edge.to)].triangle = t;
        return true;
    }
    bool walk_around(LocalArrangement& scope, const SurfaceTiling& s, const Facet& facet) {
        std::size_t begin = 3;
        for (std::size_t i = 3; i-- > 0;) {
            if (location_[index(facet.corner[i].point)].triangle >= 0) begin = i;
        }
        if (begin == 3) {
            if (!locate(scope, s, facet)) return false;
            begin = 0;
        }
        for (std::size_t n = 0, i = begin; n < 3; ++n, i = i < 2 ? i + 1 : 0) {
            const exact::DirectedEdge edge = edge_of(facet.corner, i);
            FacetEdge& way = edges_[index(edge.line.id())];
            if (way.layer != k_) {
                const std::size_t first = crossings_.size();
                const bool is_walked = walk(scope, s, edge, location_[index(edge.from)].triangle);
                way = {k_,
                       static_cast<std::uint32_t>(first),
                       static_cast<std::uint32_t>(crossings_.size() - first),
                       is_walked,
                       edge.line.is_reversed(),
                       -1};
            }
            if (!way.is_walked) return false;
        }
        return true;
    }

    /// A stretch of a facet's border in one triangle.
    struct Stretch {
        TriangleEdge in, out;
        std::uint32_t crossing_in, crossing_out, first_corner, end_corner;
    };
    struct Met {
        std::int32_t triangle;
        std::size_t first, end;
    };

    /// Calls visit(number, is_reversed) for the crossings along an edge of a facet.
    template <class Visit>
    void for_each_crossing(DirectedLine line, const Visit& visit) const {
        const FacetEdge& way = edges_[index(line.id())];
        const bool is_reversed = line.is_reversed() != way.is_reversed;
        for (std::uint32_t n = 0; n < way.count; ++n)
            visit(is_reversed ? way.first + way.count - 1 - n : way.first + n, is_reversed);
    }

    void find_stretches(const Facet& facet) {
        stretches_.clear();
        TriangleEdge in{location_[index(facet.corner[0].point)].triangle, 0};
        std::uint32_t crossing_in = 0, first_corner = 0;
        for (std::uint32_t i = 0; i < 3; ++i) {
            for_each_crossing(facet.corner[i].line, [&](std::uint32_t number, bool is_reversed) {
                const Crossing& c = crossings_[number];
                TriangleEdge left{c.left, c.left_corner}, entered{c.entered, c.entered_corner};
                if (is_reversed) std::swap(left, entered);
                stretches_.push_back({in, left, crossing_in, number, first_corner, i + 1});
                in = entered;
                crossing_in = number;
                first_corner = i + 1;
            });
        }
        stretches_.push_back({in, {}, crossing_in, 0, first_corner, 3});
    }
    const Stretch& stretch(std::size_t o) const {
        return stretches_[index(unpacked_pair(order_[o])[1])];
    }
    std::uint32_t next_in(const Met& met, std::size_t o) const {
        return stretch(o + 1 < met.end ? o + 1 : met.first).in.corner;
    }

    /// Finds the triangles that share an area with the facet.
    bool find_met(const SurfaceTiling& s) {
        order_.clear();
        for (std::size_t i = 0; i < stretches_.size(); ++i)
            order_.push_back(packed_pair(stretches_[i].in.triangle, static_cast<std::int32_t>(i)));
        std::sort(order_.begin(), order_.end());
        met_.clear();
        inside_.clear();
        for (std::size_t o = 0, end = 0; o < order_.size(); o = end) {
            const std::int32_t t = unpacked_pair(order_[o])[0];
            while (end < order_.size() && unpacked_pair(order_[end])[0] == t)
                ++end;
            met_.push_back({t, o, end});
        }
        bool is_whole = true;
        const auto look_beyond = [&](TriangleEdge edge) {
            const std::int32_t next = beyond(s, edge).triangle;
            const auto is_met = [&](const Met& met) { return met.triangle == next; };
            is_whole &= next >= 0;
            if (next < 0 || std::ranges::any_of(met_, is_met) ||
                std::ranges::find(inside_, next) != inside_.end())
                return;
            inside_.push_back(next);
        };
        for (const Met& met : met_) {
            for (std::size_t o = met.first; o < met.end; ++o) {
                const TriangleEdge out = stretch(o).out;
                if (out.triangle < 0) continue;
                const std::uint32_t in = next_in(met, o);
                if (out.corner == in) continue;
                for (std::uint32_t c = after(out.corner); c != in; c = after(c))
                    look_beyond({met.triangle, c});
            }
        }
        for (std::size_t i = 0; i < inside_.size(); ++i) {
            for (std::uint32_t c = 0; c < 3; ++c)
                look_beyond({inside_[i], c});
        }
        return is_whole;
    }

    /// Whether a triangle lies below a facet by far more than rounding (1), above it (-1), or
    /// neither, or that is not known (0).
    int compare(LocalArrangement& scope, const SurfaceTiling& s, std::int32_t t,
                const Facet& facet) const {
        const PlaneId plane = s.plane[index(t)];
        if (!plane.has_value()) return 0;
        const HeightRange heights = s.heights[index(t)];
        const double margin = geometry_.clear_height(
            std::max({std::abs(heights.low), std::abs(heights.high), std::abs(facet.heights.low),
                      std::abs(facet.heights.high)}));
        if (heights.high + margin < facet.heights.low) return 1;
        if (heights.low >= facet.heights.high) return -1;
        const auto trace = geometry_.trace_filter(plane, facet.plane);
        const auto all_of = [&](PolygonView polygon, const auto& is) {
            return std::all_of(polygon.begin(), polygon.end(),
                               [&](const Corner& c) { return is(c.point); });
        };
        const auto is_below = [&](PointId id) { return scope.is_right_by(trace, id, margin); };
        const auto is_above = [&](PointId id) { return scope.is_left_for_certain(trace, id); };
        if (all_of(facet.corner, is_below) || all_of(triangle(s, t), is_below)) return 1;
        return all_of(facet.corner, is_above) || all_of(triangle(s, t), is_above) ? -1 : 0;
    }

    template <class Visit>
    void for_each_met(const Visit& visit) const {
        for (const Met& met : met_)
            visit(met.triangle);
        for (const std::int32_t t : inside_)
            visit(t);
    }

    exact::PlanArrangement& geometry_;
    struct Location {
        std::int32_t triangle = -1, vertex = -1;
    };
    std::vector<Location> location_;
    Array<Crossing> crossings_;
    std::vector<FacetEdge> edges_;  ///< of each line
    std::vector<Stretch> stretches_;
    std::vector<std::uint64_t> order_;
    std::vector<Met> met_;
    std::vector<std::int32_t> inside_;
    Array<std::int32_t> candidates_;
    std::int32_t k_ = 0;  ///< number of the surface
};

}  // namespace realmodel::strata
