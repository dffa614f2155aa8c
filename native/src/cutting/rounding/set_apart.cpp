// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/rounding/part_rounding.hpp"
#include "spatial/box_tree.hpp"

namespace realmodel::cutting {

void set_apart(RoundedParts& parts) {
    spatial::Box box = spatial::bounding_box(parts.new_positions);
    parts.taken.reserve(2 * parts.new_positions.size());
    if (!parts.new_positions.empty()) box.widen(16 * rounding_of(std::array{box.low, box.high}));
    for (const Position& p : parts.vertices) {
        if (box.contains(p)) parts.taken.insert(p);
    }
    std::vector<std::uint8_t> is_used(parts.vertices.size() + parts.new_positions.size(), 0);
    for (const NodeId node : parts.pieces.polygons.nodes)
        is_used[index(node)] = 1;
    for (std::size_t n = parts.vertices.size(); n < is_used.size(); ++n) {
        const auto node = static_cast<NodeId>(n);
        Position& p = parts.moving(node);
        if (is_used[n] != 0 && !parts.taken.insert(p))
            p = free_position_beside(p, parts.freedom_of(std::array{node}), parts.taken);
    }
}

}  // namespace realmodel::cutting
