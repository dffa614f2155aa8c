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
        matches_.push_back({left_names_[i].second, right_names_[i].second});
    }
    return true;
}

bool EdgeMatching::find_matches(std::span<const LineEdge> edges, LineId line_id) {
    if (edges.size() % 2 != 0) return false;
    segments_.clear();
    for (const LineEdge& edge : edges) {
        const bool is_right = edge.from > edge.to;
        const auto [low, high] = std::minmax(edge.from, edge.to);
        segments_.push_back({packed_pair(low, high) << 1 | (is_right ? 1 : 0), &edge});
    }
    std::sort(segments_.begin(), segments_.end(),
              [](const Segment& a, const Segment& b) { return a.ends_and_side < b.ends_and_side; });
    const exact::Line& line = geometry_.line(line_id);
    matches_.clear();
    same_ = {kNone, kNone};
    for (std::size_t begin = 0, end = 0; begin < segments_.size(); begin = end) {
        std::size_t right = begin;
        for (end = begin;
             end < segments_.size() && segments_[end].ends() == segments_[begin].ends(); ++end)
            right += segments_[end].is_right() ? 0 : 1;
        if (end - right != right - begin) return false;
        if (end - right > 1) {
            if (!match({&segments_[begin], end - right}, {&segments_[right], end - right}, line))
                return false;
            continue;
        }
        matches_.push_back({segments_[begin].edge, segments_[right].edge});
        if (!are_one_line(*matches_.back().left, *matches_.back().right, line)) return false;
    }
    return true;
}

void EdgeMatching::find_bounds() {
    bounds_.clear();
    beneath_.clear();
    bool one_wall = true;
    for (const Pair& pair : matches_) {
        const auto left = static_cast<std::size_t>(pair.left->face);
        const auto right = static_cast<std::size_t>(pair.right->face);
        const auto add = [&](std::int32_t l, std::int32_t r, std::int32_t is_beneath, auto& to) {
            l = cell_of(l);
            r = cell_of(r);
            if (l == r) return;
            to.push_back({packed_pair(l, r), packed_pair(is_beneath, pair.left->from), pair.left});
            const Bound& first = bounds_.empty() ? beneath_[0] : bounds_[0];
            one_wall = one_wall && to.back().cells == first.cells;
        };
        add(faces_.above[left], faces_.above[right], 1, beneath_);
        add(faces_.below[left], faces_.below[right], 0, bounds_);
    }
    bounds_.insert(bounds_.end(), beneath_.begin(), beneath_.end());
    if (one_wall) return;  // matches are in order along the line
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
    if (!find_matches(edges, line)) return false;
    find_bounds();
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
