// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/rounding/part_rounding.hpp"

namespace realmodel::cutting {

void round_parts(RoundedParts&& parts, const std::array<bool, 2>& touches) {
    assert(parts.are_closed());
    // First what moves many nodes at once or takes parts away, so that later passes have
    // less to do. Nodes are one before those that are left move: each moves for good to a position
    // that no other has. Extents are given by moves, too, and may bend polygons: these are divided
    // when all nodes stay where they are. Polygons are glued before, so that none is divided twice.
    drop_hollow(parts);  // of a cell that lies flat on the cutter
    level_base(parts);
    join_coincident(parts, touches, false);
    set_apart(parts);
    give_extents(parts);
    divide_bent(parts, glue_doubled(parts));
    drop_empty(parts);
    assert(parts.are_closed() && parts.are_apart());
}

}  // namespace realmodel::cutting
