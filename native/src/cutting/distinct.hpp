// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <unordered_set>

#include "base/key_table.hpp"
#include "cutting/polygons.hpp"

namespace realmodel::cutting {

/// Where a point may move to: anywhere, on its height only, or rather up and down than aside.
enum class Freedom { kAny, kLevel, kUpright };

/// Both zeros are alike.
struct PositionHash {
    std::size_t operator()(const Position& p) const {
        return KeyTable::hash(std::array{std::bit_cast<std::uint64_t>(p[0] + 0.0),
                                         std::bit_cast<std::uint64_t>(p[1] + 0.0),
                                         std::bit_cast<std::uint64_t>(p[2] + 0.0)});
    }
};
using Positions = std::unordered_set<Position, PositionHash>;

/// A position as near to p as doubles allow that is not taken yet; it is then.
Position free_position_beside(const Position& p, Freedom freedom, Positions& taken);

}  // namespace realmodel::cutting
