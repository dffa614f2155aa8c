// SPDX-License-Identifier: GPL-3.0-or-later
#include "track_pairs.hpp"

#include <algorithm>

namespace realmodel::strata {

namespace {

std::uint64_t packed(std::int32_t high, std::int32_t low) {
    return std::uint64_t{static_cast<std::uint32_t>(high)} << 32 | static_cast<std::uint32_t>(low);
}

}  // namespace

TrackPairing::Name TrackPairing::name(const TrackEdge& edge, const exact::Line& line) const {
    const PlaneId plane = plane_of(edge);
    const exact::Plane& triangle = geometry_.plane(plane);
    const auto over = [&](const exact::Line& of_edge) {
        const bool is_edge = of_edge.kind == exact::Line::Kind::kEdge;
        const exact::SpaceId s = is_edge ? triangle.above(of_edge.first) : -1;
        return Name{s, s < 0 ? -1 : triangle.above(of_edge.second)};
    };
    const Name first = over(line);
    if (first[1] >= 0) return first;
    // several edges in a row are one track, each on a line of its own
    const auto own = exact::line_of(faces_.polygons.corners[edge.begin].line);
    const Name second = over(geometry_.line(own));
    return second[1] >= 0 ? second : Name{-1, plane};
}

/// Pairs edges of the same ends.
bool TrackPairing::match(std::span<Stretch> left, std::span<Stretch> right,
                         const exact::Line& line) {
    if (left.size() == 1) {
        const TrackEdge &l = *left[0].edge, &r = *right[0].edge;
        pairs_.push_back({&l, &r});
        return plane_of(l) == plane_of(r) || name(l, line) == name(r, line);
    }
    const auto find_names = [&](std::span<Stretch> stretches, auto& names) {
        names.clear();
        for (const Stretch& s : stretches)
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
        pairs_.push_back({left_names_[i].second, right_names_[i].second});
    }
    return true;
}

bool TrackPairing::find_pairs(std::span<const TrackEdge> edges, LineId line_id) {
    if (edges.size() % 2 != 0) return false;
    left_.clear();
    right_.clear();
    for (const TrackEdge& edge : edges) {
        if (edge.from < edge.to) {
            left_.push_back({packed(edge.from, edge.to), &edge});
        } else {
            right_.push_back({packed(edge.to, edge.from), &edge});
        }
    }
    if (left_.size() != right_.size()) return false;
    const auto in_order = [](const Stretch& a, const Stretch& b) { return a.ends < b.ends; };
    std::sort(left_.begin(), left_.end(), in_order);
    std::sort(right_.begin(), right_.end(), in_order);
    for (std::size_t i = 0; i < left_.size(); ++i) {
        if (left_[i].ends != right_[i].ends) return false;
    }
    const exact::Line& line = geometry_.line(line_id);
    pairs_.clear();
    for (std::size_t begin = 0, end = 0; begin < left_.size(); begin = end) {
        for (end = begin + 1; end < left_.size() && left_[end].ends == left_[begin].ends;)
            ++end;
        const std::size_t count = end - begin;
        if (!match({&left_[begin], count}, {&right_[begin], count}, line)) return false;
    }
    return true;
}

void TrackPairing::find_bounds() {
    bounds_.clear();
    for (const Pair& pair : pairs_) {
        const auto left = static_cast<std::size_t>(pair.left->face);
        const auto right = static_cast<std::size_t>(pair.right->face);
        const auto add = [&](std::int32_t l, std::int32_t r, std::int32_t is_beneath) {
            if (l != r)
                bounds_.push_back({packed(l, r), packed(is_beneath, pair.left->from), pair.left});
        };
        add(faces_.above[left], faces_.above[right], 1);
        add(faces_.below[left], faces_.below[right], 0);
    }
    std::sort(bounds_.begin(), bounds_.end(), [](const Bound& a, const Bound& b) {
        return a.cells != b.cells ? a.cells < b.cells : a.place < b.place;
    });
}

/// Bounds that follow each other without a gap are those of one wall; above and beneath there must
/// be the same stretches.
bool TrackPairing::find_walls() {
    walls_.clear();
    const auto end_of_stretch = [&](std::size_t i, std::size_t end) {
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
            const Wall wall{above, beneath, end_of_stretch(above, last_above),
                            end_of_stretch(beneath, end)};
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

bool TrackPairing::pair(std::span<const TrackEdge> edges, LineId line) {
    if (!find_pairs(edges, line)) return false;
    find_bounds();
    return find_walls();
}

std::int32_t TrackPairing::end_corner(const TrackEdge& edge) const {
    const auto& offsets = faces_.polygons.offsets;
    const auto face = static_cast<std::size_t>(edge.face);
    const auto next = static_cast<std::int64_t>(edge.begin) + 1;
    return static_cast<std::int32_t>(next < offsets[face + 1] ? next : offsets[face]);
}

void TrackPairing::add_walls(PairedEdges& to) const {
    for (const Wall& wall : walls_) {
        const std::uint64_t cells = bounds_[wall.above].cells;
        to.walls.insert(
            to.walls.end(),
            {static_cast<std::int32_t>(cells >> 32), static_cast<std::int32_t>(cells & 0xffffffff),
             static_cast<std::int32_t>(wall.above_end - wall.above),
             static_cast<std::int32_t>(wall.beneath_end - wall.beneath)});
        const auto add = [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                to.walls.push_back(static_cast<std::int32_t>(bounds_[i].edge->begin));
            to.walls.push_back(end_corner(*bounds_[end - 1].edge));
        };
        add(wall.above, wall.above_end);
        add(wall.beneath, wall.beneath_end);
    }
    to.wall_count += walls_.size();
}

}  // namespace realmodel::strata
