// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/overlay/tiling_walk.hpp"

#include <algorithm>

namespace realmodel::strata {

namespace {

std::uint32_t after(std::uint32_t corner) {
    return corner < 2 ? corner + 1 : 0;
}

}  // namespace

/// The same edge seen from the neighbor; none where there is no neighbor.
TilingWalk::TilingEdge TilingWalk::beyond(TilingEdge edge) const {
    const std::int32_t next = tiling_.neighbor[index(edge.triangle)][edge.corner];
    if (next < 0) return {};
    const PointId to = triangle(edge.triangle)[after(edge.corner)].point;
    const PolygonView neighbor = triangle(next);
    return {next, neighbor[0].point == to ? 0U : (neighbor[1].point == to ? 1U : 2U)};
}

/// On which side of a triangle's edge a point lies: 1 that of the triangle.
inline int TilingWalk::side(TilingEdge edge, PointId id) {
    const exact::PlanArrangement& shared = scope_.shared();
    const PolygonView at = triangle(edge.triangle);
    const Corner &from = at[edge.corner], &to = at[after(edge.corner)];
    const auto filter = exact::reach_filter_between(shared.reach(), shared.point(from.point),
                                                    shared.point(to.point));
    return side_of(scope_, filter, from.line, id, exact::position_in_reach(scope_, id));
}

/// Walks along an edge from triangle t, which has its first point; false where something coincides
/// or a neighbor is missing.
bool TilingWalk::walk(const exact::DirectedEdge& edge, std::int32_t t) {
    const std::int32_t goal = known_triangle(edge.to);
    if (t == goal) return true;
    const exact::ReachFilter line = exact::reach_filter(scope_, edge);
    const auto side_of_corner = [&](std::uint32_t corner) {
        const PointId id = triangle(t)[corner].point;
        return side_of(scope_, line, edge.line, id, exact::position_in_reach(scope_, id));
    };
    // it goes out where the corners pass from its right to its left
    const std::array sides{side_of_corner(0), side_of_corner(1), side_of_corner(2)};
    if (sides[0] == 0 || sides[1] == 0 || sides[2] == 0) return false;
    std::uint32_t out = 0;
    while (sides[out] > 0 || sides[after(out)] < 0)
        ++out;
    while (t != goal) {
        if (goal == kUnknown) {
            const int s = side({t, out}, edge.to);
            if (s == 0) return false;
            if (s > 0) break;
        }
        const TilingEdge entered = beyond({t, out});
        if (entered.triangle < 0) return false;
        crossings_.push_back({{t, out}, entered, kNone});
        t = entered.triangle;
        const std::uint32_t right = after(entered.corner);
        const int opposite = side_of_corner(after(right));
        if (opposite == 0) return false;
        out = opposite > 0 ? right : after(right);
    }
    location(edge.to) = {edge.to, t};
    return true;
}

/// What an edge crosses; triangle t has its first point.
TilingWalk::FacetEdge TilingWalk::way_along(const exact::DirectedEdge& edge, std::int32_t t) {
    FacetEdge& way = ways_[index(edge.line.id()) % kKnown];
    if (way.line == edge.line.id()) {
        if (way.from == edge.from && way.to == edge.to) return way;
        if (way.from == edge.to && way.to == edge.from) return way.reversed();
    }
    const std::size_t first = crossings_.size();
    const bool is_walked = walk(edge, t);
    if (!is_walked) crossings_.resize(first);
    return way = {edge.line.id(),
                  edge.from,
                  edge.to,
                  static_cast<std::uint32_t>(first),
                  static_cast<std::uint32_t>(crossings_.size()),
                  is_walked,
                  false};
}

bool TilingWalk::locate(PolygonView facet, std::span<const std::int32_t> polygons) {
    if (tiling_.neighbor.empty()) return false;
    ways_.resize(kKnown);
    locations_.resize(kKnown);
    const auto is_known = [this](const Corner& c) { return known_triangle(c.point) != kUnknown; };
    if (std::ranges::any_of(facet, is_known)) return false;
    const PointId point = facet[0].point;
    PointLocation& of_point = location(point) = {point, kNowhere};
    for (const std::int32_t t : polygons) {
        if (std::ranges::max(tiling_.neighbor[index(t)]) < 0) continue;
        int least = 1;
        for (std::uint32_t i = 0; i < 3 && least >= 0; ++i)
            least = std::min(least, side({t, i}, point));
        if (least > 0) of_point.triangle = t;
        if (least >= 0) return least > 0;
    }
    return false;
}

bool TilingWalk::begin(PolygonView facet) {
    if (locations_.empty()) return false;
    facet_ = facet;
    std::size_t begin = 0;
    std::int32_t t = kUnknown;
    for (std::size_t i = facet.size(); i-- > 0;) {
        const std::int32_t known = known_triangle(facet[i].point);
        if (known == kNowhere) return false;
        if (known == kUnknown) continue;
        begin = i;
        t = known;
    }
    if (t == kUnknown) return false;
    border_.resize(facet.size());
    for (std::size_t n = 0, i = begin; n < facet.size(); ++n) {
        border_[i] = way_along(edge_of(facet, i), t);
        if (!border_[i].is_walked) return false;
        if (border_[i].size() > 0)
            t = seen_from(border_[i], border_[i].size() - 1).entered.triangle;
        i = i + 1 < facet.size() ? i + 1 : 0;
        if (i == 0) start_ = t;
    }
    find_stretches();
    return find_met();
}

/// The n-th crossing of a way, seen in its direction.
TilingWalk::EdgeCrossing TilingWalk::seen_from(const FacetEdge& way, std::size_t n) const {
    EdgeCrossing crossing = crossings_[way.crossing(n)];
    if (way.is_reversed) std::swap(crossing.left, crossing.entered);
    return crossing;
}

/// Divides the border of the facet where it crosses edges, from corner 0 to corner 0.
void TilingWalk::find_stretches() {
    stretches_.clear();
    TilingEdge in{start_, 0};
    std::uint32_t crossing_in = 0, first_corner = 0;
    for (std::uint32_t i = 0; i < border_.size(); ++i) {
        for (std::size_t n = 0; n < border_[i].size(); ++n) {
            const std::uint32_t number = border_[i].crossing(n);
            const EdgeCrossing crossing = seen_from(border_[i], n);
            stretches_.push_back({in, crossing.left, crossing_in, number, first_corner, i + 1});
            in = crossing.entered;
            crossing_in = number;
            first_corner = i + 1;
        }
    }
    stretches_.push_back(
        {in, {}, crossing_in, 0, first_corner, static_cast<std::uint32_t>(border_.size())});
}

/// Finds the triangles that are met: those of the border's stretches, and from these on those that
/// lie in the facet. False where these are many or missing.
bool TilingWalk::find_met() {
    order_.clear();
    for (std::size_t s = 0; s < stretches_.size(); ++s)
        order_.push_back(static_cast<std::uint64_t>(stretches_[s].in.triangle) << 32 | s);
    std::sort(order_.begin(), order_.end());
    met_.clear();
    for (std::size_t o = 0, end = 0; o < order_.size(); o = end) {
        const std::int32_t t = stretch(o).in.triangle;
        while (end < order_.size() && stretch(end).in.triangle == t)
            ++end;
        met_.push_back({t, o, end});
    }
    const std::span<const Met> on_border(met_.data(), met_.size());
    inside_.clear();
    const auto look_beyond = [&](TilingEdge edge) {
        const std::int32_t next = beyond(edge).triangle;
        if (next >= 0 && (std::ranges::binary_search(on_border, next, {}, &Met::polygon) ||
                          std::ranges::find(inside_, next) != inside_.end()))
            return true;
        inside_.push_back(next);
        return next >= 0 && inside_.size() <= kMostInside;
    };
    for (const Met& met : on_border) {
        for (std::size_t o = met.first; o < met.end; ++o) {
            const TilingEdge out = stretch(o).out;
            if (out.triangle < 0) continue;
            const std::uint32_t in = next_stretch(met, o).in.corner;
            if (out.corner == in) continue;
            for (std::uint32_t c = after(out.corner); c != in; c = after(c)) {
                if (!look_beyond({met.polygon, c})) return false;
            }
        }
    }
    for (std::size_t i = 0; i < inside_.size(); ++i) {
        for (std::uint32_t c = 0; c < 3; ++c) {
            if (!look_beyond({inside_[i], c})) return false;
        }
    }
    for (const std::int32_t t : inside_)
        met_.push_back({t, 0, 0});
    if (!inside_.empty()) std::ranges::sort(met_, {}, &Met::polygon);
    return true;
}

PointId TilingWalk::point_of(std::size_t crossing, std::size_t edge) {
    EdgeCrossing& at = crossings_[crossing];
    if (at.point == kNone) {
        const LineId line = triangle(at.left.triangle)[at.left.corner].line.id();
        at.point = scope_.crossing_between_ends(facet_[edge].line.id(), line);
    }
    return at.point;
}

PolygonView TilingWalk::common(std::size_t i) {
    const Met& met = met_[i];
    const PolygonView window = triangle(met.polygon);
    if (met.first == met.end) return window;
    if (stretches_.size() == 1) return facet_;
    result_.clear();
    for (std::size_t o = met.first; o < met.end; ++o) {
        const Stretch& s = stretch(o);
        if (s.first_corner > 0)
            result_.push_back(
                {point_of(s.crossing_in, s.first_corner - 1), facet_[s.first_corner - 1].line});
        result_.insert(result_.end(), facet_.begin() + static_cast<std::ptrdiff_t>(s.first_corner),
                       facet_.begin() + static_cast<std::ptrdiff_t>(s.end_corner));
        if (s.out.triangle < 0) continue;
        result_.push_back({point_of(s.crossing_out, s.end_corner - 1), window[s.out.corner].line});
        const std::uint32_t in = next_stretch(met, o).in.corner;
        for (std::uint32_t c = s.out.corner; c != in;) {
            c = after(c);
            result_.push_back(window[c]);
        }
    }
    return result_;
}

}  // namespace realmodel::strata
