// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cassert>
#include <cmath>

#include "base/parallel.hpp"
#include "cutting/rounding/part_rounding.hpp"

namespace realmodel::cutting {

namespace {

/// Whether a polygon turns one way and rises and falls once on both axes, but for rounding.
bool is_nearly_convex(std::span<const PlanePosition> corners, const PlanePosition& rounding) {
    bool left = true, right = true;
    const std::size_t n = corners.size();
    for (std::size_t i = 0; i < n; ++i) {
        const PlanePosition &a = corners[i], &b = corners[(i + 1) % n], &c = corners[(i + 2) % n];
        const double ux = b[0] - a[0], uy = b[1] - a[1], vx = c[0] - b[0], vy = c[1] - b[1];
        const double cross = ux * vy - uy * vx;
        const double allowed = rounding[0] * (std::abs(uy) + std::abs(vy)) +
                               rounding[1] * (std::abs(ux) + std::abs(vx));
        left = left && cross >= -allowed;
        right = right && cross <= allowed;
    }
    if (!left && !right) return false;
    for (std::size_t axis = 0; axis < 2; ++axis) {
        int changes = 0, last = 0, first = 0;
        for (std::size_t i = 0; i < n; ++i) {
            const double step = corners[(i + 1) % n][axis] - corners[i][axis];
            if (step == 0) continue;
            const int direction = step > 0 ? 1 : -1;
            if (last == 0) first = direction;
            changes += last != 0 && direction != last ? 1 : 0;
            last = direction;
        }
        changes += last != first ? 1 : 0;
        if (changes > 2) return false;
    }
    return true;
}

/// Whether a polygon has more than the area that rounding may give to one that has none.
bool has_area(std::span<const PlanePosition> corners, double twice_area,
              const PlanePosition& rounding) {
    PlanePosition around{0, 0};  // the length along each axis
    for (std::size_t i = 0; i < corners.size(); ++i) {
        for (std::size_t axis = 0; axis < 2; ++axis)
            around[axis] += std::abs(corners[(i + 1) % corners.size()][axis] - corners[i][axis]);
    }
    return std::abs(twice_area) > 4 * (rounding[0] * around[1] + rounding[1] * around[0]);
}

/// Whether rounding may have bent a polygon, so that it is no longer convex.
bool is_bent(const RoundedParts& parts, std::size_t piece,
             bool (*is_bent_too)(std::span<const Position> corners)) {
    const auto nodes = parts.pieces.polygons[piece];
    const auto& [face, cells, sides, is_level, of] = parts.pieces[piece];
    const bool is_wall = parts.surface_of(piece, kCutFace) == kWall;
    if (nodes.size() <= 3 || parts.is_whole_face(piece) || (is_wall && !is_level)) return false;
    std::vector<Position> corners;
    for (const NodeId node : nodes)
        corners.push_back(parts.at(node));
    const Position normal = polygon_normal(corners);
    if (is_bent_too != nullptr && is_bent_too(corners)) return true;
    // what lay on one of the model's surfaces must be convex in plan, the rest as it is seen best
    const bool lay_on_surface = face >= 0 && !is_level && normal[2] != 0;
    const View seen = lay_on_surface ? View({0, 0, normal[2]}) : View(normal);
    std::vector<PlanePosition> flat;
    for (const Position& corner : corners)
        flat.push_back(seen(corner));
    const PlanePosition rounding = seen.rounding(corners);
    // of what has no area it is not sure how it is seen best
    const bool is_sure = lay_on_surface || is_wall || has_area(flat, normal[seen.axis()], rounding);
    return !is_sure || !is_nearly_convex(flat, rounding);
}

/// Whether triangles about a middle would include one of what may be a wall that has no extent in
/// plan.
bool lacks_extent(const RoundedParts& parts, std::size_t piece, const Position& middle) {
    if (!parts.may_be_wall(piece)) return false;
    const auto nodes = parts.pieces.polygons[piece];
    const auto is_below = [&](NodeId node) {
        return parts.at(node)[0] == middle[0] && parts.at(node)[1] == middle[1];
    };
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (is_below(nodes[i]) && is_below(nodes[(i + 1) % nodes.size()])) return true;
    }
    return false;
}

/// A new node in the middle of a polygon.
NodeId add_middle(RoundedParts& parts, std::size_t piece) {
    const auto nodes = parts.pieces.polygons[piece];
    const Position first = parts.at(nodes[0]);
    Position middle = first;
    for (const NodeId node : nodes) {
        for (std::size_t k = 0; k < 3; ++k)
            middle[k] += (parts.at(node)[k] - first[k]) / static_cast<double>(nodes.size());
    }
    const bool is_base = parts.surface_of(piece, kCutFace) == kBase;
    const NodeId center = parts.add_node(middle, is_base ? Freedom::kLevel : Freedom::kAny);
    while (lacks_extent(parts, piece, parts.at(center))) {
        parts.moving(center) = free_position_beside(parts.at(center), Freedom::kLevel, parts.taken);
    }
    return center;
}

}  // namespace

void divide_bent(RoundedParts& parts, std::span<const std::uint8_t> is_doubled,
                 bool (*is_bent_too)(std::span<const Position> corners)) {
    assert(is_doubled.size() == parts.pieces.size());
    // a node that is added moves no other
    std::vector<std::uint8_t> is_whole(parts.pieces.size());
    parallel_ranges(
        parts.pieces.size(), 1 << 12, parts.execution,
        [&](std::size_t begin, std::size_t end) {
            for (std::size_t p = begin; p < end; ++p) {
                is_whole[p] =
                    is_doubled[p] == 0 && !is_bent(parts, p, is_bent_too) && !parts.is_upright(p)
                        ? 1
                        : 0;
            }
        },
        0.05);
    if (std::ranges::count(is_whole, 0) == 0) return;
    CutPieces divided;
    for (std::size_t p = 0; p < parts.pieces.size(); ++p) {
        const std::size_t first = p;
        while (p < is_whole.size() && is_whole[p] != 0)
            ++p;
        divided.add(parts.pieces, first, p);
        if (p == is_whole.size()) break;
        const auto nodes = parts.pieces.polygons[p];
        const NodeId center = add_middle(parts, p);
        for (std::size_t i = 0; i < nodes.size(); ++i)
            divided.add(std::array{nodes[i], nodes[(i + 1) % nodes.size()], center},
                        parts.pieces[p]);
    }
    parts.pieces = std::move(divided);
}

}  // namespace realmodel::cutting
