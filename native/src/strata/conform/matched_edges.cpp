// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/conform/matched_edges.hpp"

#include <algorithm>
#include <cassert>

#include "base/packed_pair.hpp"

namespace realmodel::strata {

EdgeMatching::Name EdgeMatching::name(const LineEdge& edge, const exact::Line& line) const {
    const PlaneId plane = plane_of(edge);
    const Name first = geometry_.plane(plane).above(line);
    if (first.is_edge()) return first;
    // several edges in a row are one line, each on a line of its own
    const auto own = faces_.polygons.lines[edge.begin].id();
    const Name second = geometry_.plane(plane).above(geometry_.line(own));
    return second.is_edge() ? second : Name(plane);
}

/// Whether two edges of the same ends are one segment in space.
bool EdgeMatching::are_one_line(const LineEdge& left, const LineEdge& right,
                                const exact::Line& line) {
    const std::array planes{plane_of(left), plane_of(right)};
    if (planes[0] == planes[1] || planes == same_) return true;
    const Name of_left = name(left, line);
    if (of_left != name(right, line)) return false;
    // Segments that follow each other mostly lie between the same two triangles.
    if (of_left == geometry_.plane(planes[0]).above(line)) same_ = planes;
    return true;
}

/// Matches several edges of the same ends.
bool EdgeMatching::match(std::span<Segment> left, std::span<Segment> right,
                         const exact::Line& line) {
    const auto find_names = [&](std::span<Segment> segments, auto& names) {
        names.clear();
        for (const Segment& s : segments)
            names.emplace_back(name(*s.edge, line), s.edge);
        std::sort(names.begin(), names.end(),
                  [](const auto& a, const auto& b) { return a.first < b.first; });
    };
    find_names(left, left_names_);
    find_names(right, right_names_);
    for (std::size_t i = 0; i < left_names_.size(); ++i) {
        const Name& known = left_names_[i].first;
        if (known != right_names_[i].first) return false;
        if (i > 0 && known == left_names_[i - 1].first) return false;  // which is whose?
        add({left_names_[i].second, right_names_[i].second});
    }
    return true;
}

bool EdgeMatching::find_matches(std::span<const LineEdge> edges, LineId line_id) {
    segments_.resize(edges.size());
    Segment* next = segments_.begin();
    for (const LineEdge& edge : edges) {
        const bool is_right = edge.from > edge.to;
        const auto [low, high] =
            is_right ? std::pair(edge.to, edge.from) : std::pair(edge.from, edge.to);
        *next++ = {packed_pair(low, high) << 1 | (is_right ? 1 : 0), &edge};
    }
    std::sort(segments_.begin(), segments_.end(),
              [](const Segment& a, const Segment& b) { return a.ends_and_side < b.ends_and_side; });
    const exact::Line& line = geometry_.line(line_id);
    for (Segment *begin = segments_.begin(), *const last = segments_.end(); begin != last;) {
        if (begin->is_right() || begin + 1 == last) return false;
        if (begin[1].ends_and_side == begin->ends_and_side + 1) {  // one edge on each side
            if (!are_one_line(*begin->edge, *begin[1].edge, line)) return false;
            add({begin->edge, begin[1].edge});
            begin += 2;
            continue;
        }
        const auto right = std::find_if(begin, last, [](const Segment& s) { return s.is_right(); });
        const auto count = static_cast<std::size_t>(right - begin);
        if (static_cast<std::size_t>(last - right) < count ||
            right[count - 1].ends_and_side != begin->ends_and_side + 1 ||
            begin[count - 1].ends() != begin->ends() ||
            !match({begin, count}, {right, count}, line))
            return false;
        begin = right + count;
    }
    return true;
}

/// Adds a match, and what walls it bounds. A face is known to be as high as no other where it lies
/// between thick cells, or those and the outside.
void EdgeMatching::add(const Pair& pair) {
    const std::size_t left = index(pair.left->face), right = index(pair.right->face);
    const std::array above{faces_.above[left], faces_.above[right]};
    const std::array below{faces_.below[left], faces_.below[right]};
    const auto is_thick = [&](std::int32_t cell) {
        return cell < 0 ? cell == kOutsideCell : (*cell_is_thick_)[index(cell)] != 0;
    };
    if (!is_thick(above[0]) || !is_thick(above[1]) || !is_thick(below[0]) || !is_thick(below[1]))
        thin_.push_back(pair);
    if (above[0] != above[1]) add_bound(above, 1, *pair.left);
    if (below[0] != below[1]) add_bound(below, 0, *pair.left);
}

void EdgeMatching::add_bound(const std::array<std::int32_t, 2>& nodes, std::int32_t is_beneath,
                             const LineEdge& left) {
    const std::array cells{cell_of(nodes[0]), cell_of(nodes[1])};
    if (cells[0] == cells[1]) return;
    (is_beneath != 0 ? beneath_ : bounds_)
        .push_back({packed_pair(cells[0], cells[1]), packed_pair(is_beneath, left.from), &left});
}

void EdgeMatching::sort_bounds() {
    bounds_.append(beneath_.begin(), beneath_.end());
    const auto differs = [&](const Bound& bound) { return bound.cells != bounds_[0].cells; };
    if (std::none_of(bounds_.begin(), bounds_.end(), differs)) return;  // found along the line
    std::sort(bounds_.begin(), bounds_.end(), [](const Bound& a, const Bound& b) {
        return a.cells != b.cells ? a.cells < b.cells : a.plan_vertex < b.plan_vertex;
    });
}

/// Bounds that follow each other without a gap are those of one wall; above and beneath there must
/// be the same segments.
bool EdgeMatching::find_walls() {
    walls_.clear();
    const auto end_of_segments = [&](std::size_t i, std::size_t end) {
        for (++i; i < end && bounds_[i].edge->from == bounds_[i - 1].edge->to;)
            ++i;
        return i;
    };
    for (std::size_t begin = 0, end = 0; begin < bounds_.size(); begin = end) {
        std::size_t beneath = begin;
        for (end = begin; end < bounds_.size() && bounds_[end].cells == bounds_[begin].cells; ++end)
            beneath += bounds_[end].is_beneath() ? 0 : 1;
        const std::size_t last_above = beneath;
        for (std::size_t above = begin; above < last_above || beneath < end;) {
            if (above == last_above || beneath == end) return false;
            const Wall wall{above, beneath, end_of_segments(above, last_above),
                            end_of_segments(beneath, end)};
            if (bounds_[wall.above].edge->from != bounds_[wall.beneath].edge->from ||
                bounds_[wall.above_end - 1].edge->to != bounds_[wall.beneath_end - 1].edge->to)
                return false;
            walls_.push_back(wall);
            above = wall.above_end;
            beneath = wall.beneath_end;
        }
    }
    return true;
}

bool EdgeMatching::match_all(std::span<const LineEdge> edges, LineId line) {
    same_ = {kNone, kNone};
    thin_.clear();
    bounds_.clear();
    beneath_.clear();
    if (!find_matches(edges, line)) return false;
    sort_bounds();
    return find_walls();
}

std::uint32_t EdgeMatching::end_corner(const LineEdge& edge) const {
    const auto& offsets = faces_.polygons.offsets;
    const auto face = static_cast<std::size_t>(edge.face);
    return edge.begin + 1 < offsets[face + 1] ? edge.begin + 1 : offsets[face];
}

void EdgeMatching::add_walls(MatchedEdges& to) const {
    for (const Wall& wall : walls_) {
        const std::uint64_t cells = bounds_[wall.above].cells;
        to.walls.push_back({{static_cast<std::int32_t>(cells >> 32),
                             static_cast<std::int32_t>(cells & 0xffffffff)},
                            static_cast<std::uint32_t>(wall.above_end - wall.above),
                            static_cast<std::uint32_t>(wall.beneath_end - wall.beneath)});
        const auto add_corners = [&](std::size_t begin, std::size_t end) {
            assert(begin < end);
            for (std::size_t i = begin; i < end; ++i)
                to.corners.push_back(bounds_[i].edge->begin);
            to.corners.push_back(end_corner(*bounds_[end - 1].edge));
        };
        add_corners(wall.above, wall.above_end);
        add_corners(wall.beneath, wall.beneath_end);
    }
}

}  // namespace realmodel::strata
