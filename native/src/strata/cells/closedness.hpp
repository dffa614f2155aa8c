// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "realmodel/strata/stack.hpp"

namespace realmodel::strata {

/// Whether the faces of every cell use each of its edges as often in one direction as in the other.
bool are_closed(const CellComplex& complex);

}  // namespace realmodel::strata
