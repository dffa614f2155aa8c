// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>

#include "arrangement/triangulate.hpp"
#include "base/lists.hpp"
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
        const double turn = cross(minus(b, a), minus(c, b));
        const double allowed = arrangement::slack(a, b, c, rounding);
        left = left && turn >= -allowed;
        right = right && turn <= allowed;
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
    const auto corners = mapped(nodes, [&](NodeId node) { return parts.at(node); });
    const Position normal = polygon_normal(corners);
    if (is_bent_too != nullptr && is_bent_too(corners)) return true;
    // what lay on one of the model's surfaces must be convex in plan, the rest as it is seen best
    const bool lay_on_surface = face >= 0 && !is_level && normal[2] != 0;
    const View seen = lay_on_surface ? View({0, 0, normal[2]}) : View(normal);
    const std::vector<PlanePosition> flat = mapped(corners, seen);
    const PlanePosition rounding = seen.rounding(corners);
    // of what has no area it is not sure how it is seen best
    const bool is_sure = lay_on_surface || is_wall || has_area(flat, normal[seen.axis()], rounding);
    return !is_sure || !is_nearly_convex(flat, rounding);
}

/// Whether triangles about a middle would include one of what may be a wall that has no extent in
/// plan.
bool lacks_extent(const RoundedParts& parts, std::size_t piece, std::span<const NodeId> nodes,
                  const Position& middle) {
    if (!parts.may_be_wall(piece)) return false;
    const auto is_below = [&](NodeId node) {
        return parts.at(node)[0] == middle[0] && parts.at(node)[1] == middle[1];
    };
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (is_below(nodes[i]) && is_below(nodes[(i + 1) % nodes.size()])) return true;
    }
    return false;
}

/// A new node in the middle of some nodes of a piece.
NodeId add_middle(RoundedParts& parts, std::size_t piece, std::span<const NodeId> nodes) {
    const Position first = parts.at(nodes[0]);
    Position middle = first;
    for (const NodeId node : nodes) {
        for (std::size_t k = 0; k < 3; ++k)
            middle[k] += (parts.at(node)[k] - first[k]) / static_cast<double>(nodes.size());
    }
    const bool is_base = parts.surface_of(piece, kCutFace) == kBase;
    return parts.add_node(middle, is_base ? Freedom::kLevel : Freedom::kAny);
}

/// Whether the middle of a polygon sees all of its edges from their left, but for rounding.
bool middle_sees_all(const arrangement::Loop& loop, const PlanePosition& rounding) {
    PlanePosition middle{0, 0};
    for (const arrangement::LoopCorner& corner : loop) {
        for (std::size_t axis = 0; axis < 2; ++axis)
            middle[axis] += (corner.at[axis] - loop[0].at[axis]) / static_cast<double>(loop.size());
    }
    for (std::size_t axis = 0; axis < 2; ++axis)
        middle[axis] += loop[0].at[axis];
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const PlanePosition &a = loop[i].at, &b = loop[(i + 1) % loop.size()].at;
        if (twice_area(a, b, middle) < -arrangement::slack(a, b, middle, rounding)) return false;
    }
    return true;
}

/// A piece in polygons whose middles see all of their edges: itself, or convex parts. Between two
/// parts there is a node of their own, as about a middle.
std::vector<std::vector<NodeId>> parts_with_middles(RoundedParts& parts, std::size_t piece) {
    const auto given = parts.pieces.polygons[piece];
    const std::vector<NodeId> nodes(given.begin(), given.end());
    const auto corners = mapped(nodes, [&](NodeId node) { return parts.at(node); });
    const View seen(polygon_normal(corners));
    const PlanePosition rounding = seen.rounding(corners);
    arrangement::Loop loop;
    std::vector<std::array<NodeId, 2>> sides;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        loop.push_back({nodes[i], seen(corners[i])});
        const NodeId next = nodes[(i + 1) % nodes.size()];
        sides.push_back(unordered(nodes[i], next));
    }
    if (middle_sees_all(loop, rounding)) return {nodes};
    arrangement::Polygons convex;  // a loop that crosses itself, but for rounding, has some, too
    arrangement::divide_convex({&loop, 1}, rounding, {}, convex);
    std::sort(sides.begin(), sides.end());
    std::map<std::array<NodeId, 2>, NodeId> between;
    std::vector<std::vector<NodeId>> found(convex.size());
    for (std::size_t k = 0; k < convex.size(); ++k) {
        const auto polygon = convex[k];
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            const std::array ends{polygon[i], polygon[(i + 1) % polygon.size()]};
            found[k].push_back(ends[0]);
            const auto edge = unordered(ends[0], ends[1]);
            if (std::binary_search(sides.begin(), sides.end(), edge)) continue;
            const auto [at, is_new] = between.try_emplace(edge, NodeId{});
            if (is_new) at->second = add_middle(parts, piece, ends);
            found[k].push_back(at->second);
        }
    }
    return found;
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
        for (const std::vector<NodeId>& nodes : parts_with_middles(parts, p)) {
            const NodeId center = add_middle(parts, p, nodes);
            while (lacks_extent(parts, p, nodes, parts.at(center))) {
                parts.moving(center) =
                    free_position_beside(parts.at(center), Freedom::kLevel, parts.taken);
            }
            for (std::size_t i = 0; i < nodes.size(); ++i)
                divided.add(std::array{nodes[i], nodes[(i + 1) % nodes.size()], center},
                            parts.pieces[p]);
        }
    }
    parts.pieces = std::move(divided);
}

}  // namespace realmodel::cutting
