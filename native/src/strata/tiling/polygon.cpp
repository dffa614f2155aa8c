// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/tiling/polygon.hpp"

#include <algorithm>

namespace realmodel::strata {

void keep_left(LocalArrangement& scope, PolygonView polygon, DirectedLine line,
               std::span<const std::int8_t> sides, Polygon& result) {
    result.clear();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const int side = sides[i], next = sides[i + 1 < polygon.size() ? i + 1 : 0];
        const Corner& corner = polygon[i];
        if (side >= 0) result.push_back({corner.point, side == 0 && next < 0 ? line : corner.line});
        if (side * next < 0)
            result.push_back(
                {scope.crossing(corner.line.id(), line.id()), side > 0 ? line : corner.line});
    }
}

void Clipper::begin(PolygonView subject) {
    subject_ = subject;
    ++number_;
    known_sides_.clear();
    filters_.clear();
    positions_.clear();
    for (std::size_t i = 0; i < subject.size(); ++i) {
        filters_.push_back(exact::reach_filter(scope_, edge_of(subject, i)));
        positions_.push_back(exact::position_in_reach(scope_, subject[i].point));
    }
}

/// Two polygons share an area where some corner of each lies to the left of each of the other's
/// edges. Polygons of a tiling have corners in common, so what is known of these stays.
bool Clipper::overlaps(PolygonView window) {
    const std::size_t m = subject_.size();
    const auto side = [this](const exact::ReachFilter& filter, DirectedLine line, PointId point,
                             const std::array<double, 2>& position) {
        return static_cast<std::int8_t>(exact::side_of(scope_, filter, line, point, position));
    };
    window_corners_.clear();
    for (const Corner& corner : window) {
        KnownCorner& known = known_[index(corner.point) % kKnown];
        if (known.point != corner.point || known.subject != number_) {
            known = {corner.point, number_, known_sides_.size()};
            const auto position = exact::position_in_reach(scope_, corner.point);
            for (std::size_t i = 0; i < m; ++i)
                known_sides_.push_back(side(filters_[i], subject_[i].line, corner.point, position));
        }
        window_corners_.push_back(known.first_side);
    }
    for (std::size_t i = 0; i < m; ++i) {
        if (std::ranges::none_of(window_corners_,
                                 [&](std::size_t first) { return known_sides_[first + i] > 0; }))
            return false;
    }
    subject_sides_.resize(window.size() * m);
    std::int8_t* at = subject_sides_.data();
    for (std::size_t j = 0; j < window.size(); ++j) {
        const exact::ReachFilter filter = exact::reach_filter(scope_, edge_of(window, j));
        bool any_left = false;
        for (std::size_t i = 0; i < m; ++i, ++at) {
            *at = side(filter, window[j].line, subject_[i].point, positions_[i]);
            any_left |= *at > 0;
        }
        if (!any_left) return false;
    }
    return true;
}

PolygonView Clipper::intersect(PolygonView window) {
    result_.clear();
    if (!overlaps(window)) return {};
    bool is_on_line = std::ranges::find(subject_sides_, 0) != subject_sides_.end();
    for (std::size_t j = 0; j < window.size() && !is_on_line; ++j)
        is_on_line = std::ranges::count(window_sides(j), 0) > 0;
    if (is_on_line) {
        cut_by_lines(window);
        rotate(window);
    } else {
        follow(window);
    }
    return result_;
}

/// Goes around the subject, and from each edge where it leaves the window around the window until
/// that leaves the subject, where the subject comes in again. No corner lies on a line of the
/// other.
void Clipper::follow(PolygonView window) {
    const std::size_t m = subject_.size(), n = window.size();
    const auto after = [](std::size_t i, std::size_t count) { return i + 1 < count ? i + 1 : 0; };
    const auto is_in_window = [&](std::size_t i) {
        for (; i < subject_sides_.size(); i += m) {
            if (subject_sides_[i] < 0) return false;
        }
        return true;
    };
    /// The window's edge that edge i crosses from a side, or n.
    const auto crossed = [&](std::size_t i, int side) {
        for (std::size_t j = 0; j < n; ++j) {
            if (subject_sides_[j * m + i] == side && subject_sides_[j * m + after(i, m)] == -side &&
                window_sides(j)[i] != window_sides(after(j, n))[i])
                return j;
        }
        return n;
    };
    const auto add_crossing = [&](std::size_t i, std::size_t j, DirectedLine leaving) {
        result_.push_back(
            {scope_.crossing_between_ends(subject_[i].line.id(), window[j].line.id()), leaving});
    };
    for (std::size_t i = 0; i < m; ++i) {
        if (is_in_window(i)) result_.push_back(subject_[i]);
        if (const std::size_t j = crossed(i, -1); j < n) add_crossing(i, j, subject_[i].line);
        const std::size_t out = crossed(i, 1);
        if (out == n) continue;
        add_crossing(i, out, window[out].line);
        for (std::size_t j = after(out, n); j != out && std::ranges::min(window_sides(j)) > 0;
             j = after(j, n))
            result_.push_back(window[j]);
    }
    if (result_.empty()) result_.assign(window.begin(), window.end());  // it lies in the subject
}

void Clipper::cut_by_lines(PolygonView window) {
    result_.assign(subject_.begin(), subject_.end());
    for (std::size_t j = 0; j < window.size(); ++j) {
        sides_.clear();
        for (const Corner& corner : result_) {
            const auto i = static_cast<std::size_t>(
                std::ranges::find(subject_, corner.point, &Corner::point) - subject_.begin());
            const int side = i < subject_.size() ? subject_sides_[j * subject_.size() + i]
                                                 : scope_.side(window[j].line, corner.point);
            sides_.push_back(static_cast<std::int8_t>(side));
        }
        if (std::ranges::max(sides_) <= 0) return result_.clear();
        if (std::ranges::min(sides_) >= 0) continue;
        keep_left(scope_, result_, window[j].line, sides_, next_);
        std::swap(result_, next_);
    }
}

/// Has the result begin where it would without corners on lines of the other polygon.
void Clipper::rotate(PolygonView window) {
    const auto begin_at = [this](const auto& is_first) {
        for (std::size_t k = 0; k < result_.size(); ++k) {
            if (!is_first(result_[k], result_[(k > 0 ? k : result_.size()) - 1])) continue;
            std::rotate(result_.begin(), result_.begin() + static_cast<std::ptrdiff_t>(k),
                        result_.end());
            return true;
        }
        return false;
    };
    for (const Corner& edge : subject_) {
        if (begin_at([&](const Corner& corner, const Corner& before) {
                return corner.line == edge.line &&
                       (corner.point == edge.point || before.line != edge.line);
            }))
            return;
    }
    begin_at([&](const Corner& corner, const Corner&) { return corner.point == window[0].point; });
}

}  // namespace realmodel::strata
