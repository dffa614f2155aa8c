// SPDX-License-Identifier: GPL-3.0-or-later
#include <atomic>
#include <cmath>
#include <functional>

#include "base/parallel.hpp"
#include "cutting/rounding/part_rounding.hpp"
#include "spatial/box_tree.hpp"

namespace realmodel::cutting {

namespace {

/// Calls visit(i) one after another for those of so many things that are what is asked for then: a
/// visit may change what others are. The first of them is found on several threads.
template <class IsIt, class Visit>
void visit_where(const RoundedParts& parts, std::size_t count, const IsIt& is_it,
                 const Visit& visit) {
    std::size_t first = count;
    parallel_ranges(
        count, 1 << 12, parts.execution,
        [&](std::size_t begin, std::size_t end) {
            if (std::atomic_ref(first).load(std::memory_order_relaxed) < begin) return;
            std::size_t i = begin;
            while (i < end && !is_it(i))
                ++i;
            if (i < end) take_extreme(first, i, std::less<>());
        },
        0.05);
    for (std::size_t i = first; i < count; ++i) {
        if (is_it(i)) visit(i);
    }
}

/// Moves one of some new nodes up along an axis to a free position.
/// @param may_leave  whether it may go off the base or its walls
bool widen(RoundedParts& parts, std::span<const NodeId> nodes, std::size_t axis, bool may_leave) {
    constexpr int kUnits = 3;  // in the last place, that are tried
    for (const NodeId node : nodes) {
        const auto& bound = axis == 2 ? parts.on_base : parts.on_wall;
        if (!parts.is_new(node) || (!may_leave && bound[index(node)] != 0)) continue;
        Position to = parts.at(node);
        for (int i = 0; i < kUnits; ++i) {
            to[axis] = std::nextafter(to[axis], HUGE_VAL);
            if (!parts.taken.insert(to)) continue;
            parts.moving(node) = to;
            return true;
        }
    }
    return false;
}

}  // namespace

void give_extents(RoundedParts& parts) {
    const auto flat_axes = [&](std::size_t part) {
        std::vector<std::size_t> axes;
        if (!parts.is_changed(static_cast<std::int32_t>(part)) || parts.has_far_faces[part] != 0)
            return axes;
        spatial::Box box;
        for (const std::int32_t piece : parts.pieces_of[part]) {
            for (const NodeId node : parts.pieces.polygons[index(piece)])
                box.include(parts.at(node));
        }
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (box.low[axis] == box.high[axis]) axes.push_back(axis);
        }
        return axes;
    };
    const auto is_thin = [&](std::size_t part) { return !flat_axes(part).empty(); };
    visit_where(parts, parts.half_cells.size(), is_thin, [&](std::size_t part) {
        std::vector<NodeId> nodes;
        for (const std::int32_t piece : parts.pieces_of[part]) {
            const auto polygon = parts.pieces.polygons[index(piece)];
            nodes.insert(nodes.end(), polygon.begin(), polygon.end());
        }
        for (const std::size_t axis : flat_axes(part)) {
            if (!widen(parts, nodes, axis, false)) widen(parts, nodes, axis, true);
        }
    });
    const auto is_upright = [&](std::size_t p) { return parts.is_upright(p); };
    visit_where(parts, parts.pieces.size(), is_upright, [&](std::size_t p) {
        const auto nodes = parts.pieces.polygons[p];
        if (!widen(parts, nodes, 0, true)) widen(parts, nodes, 1, true);
    });
}

}  // namespace realmodel::cutting
