// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <set>

#include "polygons.hpp"

namespace realmodel::cutting {

/// The position nearest to one that no other has, counted in units in the last place; it is entered
/// among those taken.
Position free_position_beside(const Position& p, std::set<Position>& taken);

}  // namespace realmodel::cutting
