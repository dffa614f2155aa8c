// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/key_numbers.hpp"
#include "cutting/polygons.hpp"

namespace realmodel::cutting {

/// Where a point may move to: anywhere, on its height only, or rather up and down than aside.
enum class Freedom { kAny, kLevel, kUpright };

using Positions = KeyNumbers<Position>;

/// A position as near to p as doubles allow that is not taken yet; it is then.
Position free_position_beside(const Position& p, Freedom freedom, Positions& taken);

}  // namespace realmodel::cutting
