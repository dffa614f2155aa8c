// SPDX-License-Identifier: GPL-3.0-or-later
#include "bedding/sheet_heights.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>

#include "base/index.hpp"
#include "base/vectors.hpp"
#include "exact/orient2d.hpp"
#include "realmodel/base/elementary.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::bedding {

namespace {

constexpr double kSame = 1e-6;  // of the heights of a sheet

}  // namespace

SheetPlan::SheetPlan(const TriangleView& sheet, double near) : near_(near) {
    add_triangles(sheet);
    std::vector<spatial::PlanBox> boxes;
    boxes.reserve(triangles_.size());
    spatial::PlanBox frame = spatial::kNoBox;
    for (const Triangle& triangle : triangles_) {
        boxes.push_back(spatial::box_around(triangle.corner).widened(near));
        frame = frame.united(boxes.back());
    }
    tiles_ = spatial::PlanTiles(frame, triangles_.size());
    triangles_at_ = bucketize<std::int32_t>(tiles_.size(), [&](const auto& put) {
        for (std::size_t t = 0; t < boxes.size(); ++t) {
            tiles_.for_each(tiles_.span(boxes[t]),
                            [&](std::size_t tile) { put(tile, static_cast<std::int32_t>(t)); });
        }
    });
}

/// Those that have an area in plan.
void SheetPlan::add_triangles(const TriangleView& sheet) {
    const std::size_t vertices = sheet.vertices.size() / 3;
    for (std::size_t t = 0; t < sheet.triangles.size() / 3; ++t) {
        std::array<std::int32_t, 3> v{};
        Triangle triangle;
        for (std::size_t i = 0; i < 3; ++i) {
            v[i] = sheet.triangles[3 * t + i];
            if (v[i] < 0 || static_cast<std::size_t>(v[i]) >= vertices) {
                throw InputError(
                    "bad_index",
                    "triangle " + std::to_string(t) + " refers to a vertex that does not exist", -1,
                    {static_cast<std::int64_t>(t)});
            }
        }
        const auto plan = [&](std::int32_t vertex) {
            const double* row = &sheet.vertices[3 * index(vertex)];
            return PlanPosition{row[0], row[1]};
        };
        const int way = exact::orient2d(plan(v[0]), plan(v[1]), plan(v[2]));
        if (way == 0) continue;
        if (way < 0) std::swap(v[1], v[2]);
        for (std::size_t i = 0; i < 3; ++i)
            triangle.corner[i] = plan(v[i]);
        for (std::size_t i = 0; i < 3; ++i) {
            const auto &a = triangle.corner[i], &b = triangle.corner[(i + 1) % 3];
            triangle.slack[i] = near_ * distance(a, b);
        }
        triangles_.push_back(triangle);
        numbers_.push_back(v);
    }
    find_borders(vertices);
}

/// A border is an edge that is not of two triangles.
void SheetPlan::find_borders(std::size_t vertices) {
    struct Edge {
        std::int32_t low, high, triangle, slot;
    };
    std::vector<Edge> edges;
    edges.reserve(3 * numbers_.size());
    for (std::size_t t = 0; t < numbers_.size(); ++t) {
        for (std::size_t i = 0; i < 3; ++i) {
            const auto [low, high] = std::minmax(numbers_[t][i], numbers_[t][(i + 1) % 3]);
            edges.push_back(
                {low, high, static_cast<std::int32_t>(t), static_cast<std::int32_t>(i)});
        }
    }
    std::ranges::sort(edges, [](const Edge& a, const Edge& b) {
        return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
    });
    std::vector<std::uint8_t> is_border(vertices, 0);
    for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
        while (end < edges.size() && edges[end].low == edges[begin].low &&
               edges[end].high == edges[begin].high)
            ++end;
        if (end - begin == 2) continue;
        for (std::size_t e = begin; e < end; ++e)
            triangles_[index(edges[e].triangle)].border_edges |=
                static_cast<std::uint8_t>(1U << static_cast<unsigned>(edges[e].slot));
        is_border[index(edges[begin].low)] = is_border[index(edges[begin].high)] = 1;
    }
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
        for (std::size_t i = 0; i < 3; ++i) {
            if (is_border[index(numbers_[t][i])] != 0)
                triangles_[t].border_corners |= static_cast<std::uint8_t>(1U << i);
        }
    }
}

bool SheetPlan::Triangle::has_border_near(const PlanPosition& p, const Areas& areas,
                                          double near) const {
    for (std::size_t i = 0; i < 3; ++i) {
        const unsigned bit = 1U << i;
        if ((border_edges & bit) != 0 && areas[i] <= slack[i]) return true;
        if ((border_corners & bit) != 0 && std::abs(p[0] - corner[i][0]) <= near &&
            std::abs(p[1] - corner[i][1]) <= near)
            return true;
    }
    return false;
}

SheetPlan::Areas SheetPlan::areas(std::int32_t triangle, const PlanPosition& position) const {
    return triangles_[index(triangle)].areas(position);
}

SheetPlan::Place SheetPlan::at(const PlanPosition& position) const {
    Place found;
    if (triangles_.empty() || !tiles_.frame().contains(position)) return found;
    double best = -HUGE_VAL;
    for (const std::int32_t t : triangles_at_[tiles_.tile_at(position)]) {
        const Triangle& triangle = triangles_[index(t)];
        const Areas areas = triangle.areas(position);
        const auto& slack = triangle.slack;
        if (!triangle.is_near(areas)) continue;
        if (areas[0] > slack[0] && areas[1] > slack[1] && areas[2] > slack[2])
            return {State::kHeight, t, areas};
        if (triangle.has_border_near(position, areas, near_)) return {State::kBorder, t, areas};
        const double least =
            std::min({areas[0] / slack[0], areas[1] / slack[1], areas[2] / slack[2]});
        if (least > best) {
            best = least;
            found = {State::kHeight, t, areas};
        }
    }
    return found;
}

std::int32_t SheetPlan::holding(const PlanPosition& position) const {
    if (triangles_.empty() || !tiles_.frame().contains(position)) return -1;
    for (const std::int32_t t : triangles_at_[tiles_.tile_at(position)]) {
        const Areas found = areas(t, position);
        if (found[0] >= 0 && found[1] >= 0 && found[2] >= 0) return t;
    }
    return -1;
}

template <class Visit>
void SheetPlan::for_each_near(const PlanPosition& position, const Visit& visit) const {
    for (const std::int32_t t : triangles_at_[tiles_.tile_at(position)]) {
        const Areas found = areas(t, position);
        if (triangles_[index(t)].is_near(found)) visit(t, found);
    }
}

SheetHeights::SheetHeights(const SheetPlan& plan, const TriangleView& sheet) : plan_(&plan) {
    double low = HUGE_VAL, high = -HUGE_VAL;
    heights_.reserve(plan.triangles().size());
    for (const auto& corners : plan.triangles()) {
        auto& own = heights_.emplace_back();
        for (std::size_t i = 0; i < 3; ++i) {
            own[i] = sheet.vertices[3 * index(corners[i]) + 2];
            low = std::min(low, own[i]);
            high = std::max(high, own[i]);
        }
    }
    same_ = kSame * std::max(0.0, high - low);
}

double SheetHeights::height(std::int32_t triangle, const SheetPlan::Areas& areas) const {
    const auto& own = heights_[index(triangle)];
    double sum = 0, weighted = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const double weight = std::max(0.0, areas[(i + 1) % 3]);  // of the corner across that edge
        sum += weight;
        weighted += weight * own[i];
    }
    if (!(sum > 0)) return own[0];
    const auto [low, high] = std::minmax({own[0], own[1], own[2]});
    return std::clamp(weighted / sum, low, high);
}

SheetHeights::Found SheetHeights::at(const SheetPlan::Place& place) const {
    return {place.state, place.state == State::kHeight ? height(place.triangle, place.areas) : 0.0};
}

SheetHeights::Found SheetHeights::beside(std::int32_t there, const PlanPosition& position) const {
    if (there < 0) return {State::kAbsent, 0};
    const double guess = height(there, plan_->areas(there, position));
    // Of the triangles around the position the first at about that height: all polygons on one side
    // get the same.
    std::vector<double> heights;
    plan_->for_each_near(position, [&](std::int32_t t, const SheetPlan::Areas& areas) {
        heights.push_back(height(t, areas));
    });
    double nearest = guess, apart = HUGE_VAL;
    for (const double height : heights) {
        if (std::abs(height - guess) >= apart) continue;
        apart = std::abs(height - guess);
        nearest = height;
    }
    const auto first = std::ranges::find_if(
        heights, [&](double height) { return std::abs(height - nearest) <= same_; });
    return {State::kHeight, first == heights.end() ? guess : *first};
}

}  // namespace realmodel::bedding
